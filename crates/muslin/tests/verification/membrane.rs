//! Vibrations of a loaded string and of a prestressed square membrane.
//!
//! Masses m on a line or square lattice of N intervals, held at all ends, with springs stretched from L to l = L (1 +
//! e) and so under the tension T = k L e. Out of the plane they vibrate with
//!
//! ```text
//! ω² = (4 T / m l) [sin²(½ π p / N) + sin²(½ π q / N)]        second term for the membrane alone
//! ```
//!
//! exactly, and with N → ∞ with ω = π √(T / ρ) √(p² + q²) / a, for a tension T / l per width, a mass ρ = m / l² per
//! area and the side a = N l. A grid starts unstretched, so its state is stretched here by hand.
//!
//! A step h shows ω as an angle φ per step with cos φ = 1 − ω² h² / 2, exactly. The amplitude is 1e-6 of a spring,
//! which changes the tension by the square of that; and the plane is at z = 0, where heights keep all their digits.

use std::f64::consts::PI;
use std::sync::LazyLock;

use glam::DVec3;

use crate::common::setup::{grid_points, move_by};
use crate::common::spectrum::Spectrum;
use crate::common::{ClothNumbers, Random, SceneNumbers, model_and_state};
use crate::report::{Problem, Row, order};

const LENGTH: f64 = 0.1;
const STRAIN: f64 = 0.25;
const STIFFNESS: f64 = 100.0;
const MASS: f64 = 0.01;

/// T / m l [1/s²].
const SQUARE: f64 = STIFFNESS * STRAIN / (1.0 + STRAIN) / MASS;

const STEP: f64 = 4e-3;

/// What is seen of a free particle near a corner, from random heights: of a grid of `intervals`, or of a single row of
/// it.
fn spectrum(intervals: usize, is_string: bool, samples: usize) -> Spectrum {
    let columns = intervals + 1;
    let rows = if is_string { 1 } else { columns };
    let is_edge =
        |i: usize, j: usize| i.is_multiple_of(intervals) || (!is_string && j.is_multiple_of(intervals));
    let cells = (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j)));
    let numbers = SceneNumbers {
        gravity: [0.0; 3],
        cloths: vec![ClothNumbers {
            columns,
            rows,
            width: intervals as f64 * LENGTH,
            height: intervals as f64 * LENGTH,
            pins: cells.filter(|&(i, j)| is_edge(i, j)).collect(),
            mass: MASS,
            drag: 0.0,
            stiffnesses: [STIFFNESS, 0.0, 0.0],
            ..ClothNumbers::default()
        }],
        ..SceneNumbers::default()
    };
    let (model, mut state) = model_and_state(&numbers);
    let mut random = Random::new(intervals as u64);
    let heights: Vec<f64> = (0..columns * rows).map(|_| 1e-6 * LENGTH * random.next()).collect();
    state.positions = grid_points(columns, rows, |i, j| {
        let height = if is_edge(i, j) { 0.0 } else { heights[j * columns + i] };
        DVec3::new(i as f64, j as f64, 0.0) * (LENGTH * (1.0 + STRAIN)) + DVec3::Z * height
    });
    let seen = if is_string { 1 } else { columns + 1 };
    let mut motion = Vec::with_capacity(samples);
    move_by(&model, &mut state, STEP, samples, |state| motion.push(state.positions.z[seen]));
    Spectrum::new(&motion)
}

/// ω of the mode (p, q) [rad/s]; q = 0 for a string.
fn exact(intervals: usize, p: usize, q: usize) -> f64 {
    let term = |number: usize| {
        let sine = libm::sin(0.5 * PI * number as f64 / intervals as f64);
        sine * sine
    };
    (4.0 * SQUARE * (term(p) + term(q))).sqrt()
}

/// ω of the highest peak within 2 % of `expected` [rad/s]. The nearest other of those looked for is 2.3 % away, 17
/// bins.
fn found(spectrum: &Spectrum, expected: f64) -> f64 {
    let angle = |frequency: f64| 2.0 * libm::asin(0.5 * STEP * frequency);
    2.0 / STEP * libm::sin(0.5 * spectrum.peak(angle(0.98 * expected), angle(1.02 * expected)))
}

/// Errors of the lowest mode against the continuous string or membrane, at 4, 8 and 16 intervals of the same spring.
///
/// Frequencies are relative to the continuous one of the same side.
fn convergence(is_string: bool) -> Row {
    let waves = if is_string { 1.0 } else { 2.0_f64 };
    let ratios = [4, 8, 16].map(|intervals| {
        let expected = exact(intervals, 1, usize::from(!is_string));
        let continuous = PI * (SQUARE * waves).sqrt() / intervals as f64;
        found(&spectrum(intervals, is_string, 16_384), expected) / continuous
    });
    let order = order(1.0 - ratios[1], 1.0 - ratios[2], 2.0);
    let what = if is_string { "string" } else { "membrane" };
    // (sin x / x) − 1 = −x² / 6 with x = π / 32, and the next term changes the order by x² / 8.
    Row::new(format!("{what}, lowest mode at N = 16 against the continuous one"), 1.0, ratios[2], 2e-3)
        .with_order(order, 2.0, 0.01)
}

/// Side lobes of modes 17 bins away shift a peak by 1e-8 bins, at 16 384 samples and ω h > 0.1 by less than 4e-11 of
/// it; rounding of 1e-16 in heights of 1e-6 of an unpinned spring is less. What is left is the amplitude: 1e-12 · k /
/// T.
const TOLERANCE: f64 = 1e-10;

pub(crate) static PROBLEM: LazyLock<Problem> = LazyLock::new(|| {
    let mut rows = Vec::new();
    let string = spectrum(10, true, 16_384);
    for p in [1, 2, 3, 5, 9] {
        let exact = exact(10, p, 0);
        rows.push(Row::new(format!("string, N = 10, p = {p}"), exact, found(&string, exact), TOLERANCE));
    }
    let membrane = spectrum(8, false, 16_384);
    for (p, q) in [(1, 1), (1, 2), (2, 2), (1, 3), (2, 3), (3, 3)] {
        let exact = exact(8, p, q);
        let what = format!("membrane, N = 8, (p, q) = ({p}, {q})");
        rows.push(Row::new(what, exact, found(&membrane, exact), TOLERANCE));
    }
    rows.extend([true, false].map(convergence));
    Problem {
        title: "Loaded string and prestressed membrane",
        text: "Angular frequencies [rad/s] of a row and of a square grid of N intervals that is stretched by a quarter \
               and held at all edges, released from random heights: peaks of the spectrum of one particle near a \
               corner. Exact is ω² = (4T / m l) [sin²(πp/2N) + sin²(πq/2N)], the second term for the membrane. The \
               known shift by the step is taken out. The last rows compare with π √(T/ρ) √(p² + q²) / a, relative to \
               it.",
        rows,
    }
});

#[test]
fn string_and_membrane_vibrate_as_they_must() {
    PROBLEM.assert();
}
