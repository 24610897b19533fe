//! Equilibrium of a hanging sheet, reached by waiting.
//!
//! Of n + 1 particles of mass m under each other, with springs of stiffness k and rest length L, the first pinned,
//! spring j from below carries j of them, and the lowest hangs lower by u than without weight:
//!
//! ```text
//! k (ℓ_j − L) = j m g        u = n (n + 1) m g / 2 k
//! k (ℓ_j − L) ℓ_j / L = j m g    printed, divided by the rest length
//! ```
//!
//! A sheet of density ρ, height H = n L and modulus K = k L / b stretches by ρ g H² / 2 K, which is n² m g / 2 k with m
//! = ρ b L. With half a mass at the end u would be that for every n; with a whole one it is larger by the share 1 / n.

use std::sync::LazyLock;

use crate::common::setup::{GRAVITY, chain, settle};
use crate::common::{SceneNumbers, model_and_state};
use crate::report::{Problem, Row, order};

const MASS: f64 = 0.002;
const STIFFNESS: f64 = 60.0;
const HEIGHT: f64 = 1.0;

/// A sheet of three columns, with structural springs alone.
fn sheet(springs: usize) -> SceneNumbers {
    let mut numbers = chain(springs, HEIGHT, MASS, STIFFNESS);
    let cloth = &mut numbers.cloths[0];
    (cloth.columns, cloth.width, cloth.pins) = (3, 0.2, vec![(0, 0), (1, 0), (2, 0)]);
    // Critical for the slowest swing of springs in a row, ω = 2 √(k / m) sin(π / (4 n + 2)).
    let slowest = libm::sin(std::f64::consts::PI / (4 * springs + 2) as f64);
    cloth.drag = 4.0 * (MASS * STIFFNESS).sqrt() * slowest;
    numbers
}

/// Heights [m] of all particles at rest, to some roundings of the height.
fn heights(numbers: &SceneNumbers) -> Vec<f64> {
    let (model, mut state) = model_and_state(numbers);
    // Rounding of heights is felt as a force of up to k ε H.
    let bound = 8.0 * f64::EPSILON * HEIGHT * STIFFNESS / MASS;
    settle(&model, &mut state, 0.5 * (MASS / STIFFNESS).sqrt(), bound);
    state.positions.y.to_vec()
}

#[test]
fn hanging_columns_stretch_under_their_weight() {
    let springs = 9;
    let length = HEIGHT / springs as f64;
    for rest_length_direction in [false, true] {
        let mut numbers = sheet(springs);
        numbers.cloths[0].rest_length_direction = rest_length_direction;
        let found = heights(&numbers);
        let mut height = 0.0;
        for row in 1..=springs {
            let strain = (springs - row + 1) as f64 * MASS * GRAVITY / STIFFNESS / length;
            height -= if rest_length_direction {
                length * (0.5 + (0.25 + strain).sqrt())
            } else {
                length * (1.0 + strain)
            };
            for column in 0..3 {
                let error = (found[3 * row + column] - height).abs();
                assert!(error < HEIGHT_TOLERANCE * HEIGHT, "{error:e} m in row {row}");
            }
        }
    }
}

/// Of the height: forces of up to 8 ε k H, where the motion ends, on each of n particles displace the last by up to n²
/// / 2 times 8 ε H, for nine springs by 7e-14.
const HEIGHT_TOLERANCE: f64 = 1e-13;

/// Of the extension, in the same way: 8 ε H n² / 2u = 8 ε k H / m g is 5e-12 for any number of springs.
const TOLERANCE: f64 = 1e-11;

pub(crate) static PROBLEM: LazyLock<Problem> = LazyLock::new(|| {
    let continuous = 0.5;
    let counts = [1, 2, 5, 10, 25, 50];
    let measured = counts.map(|springs| {
        let found = heights(&sheet(springs));
        let weight = (springs * springs) as f64 * MASS * GRAVITY;
        (-found[found.len() - 1] - HEIGHT) * STIFFNESS / weight
    });
    let mut rows = Vec::new();
    for (springs, measured) in counts.into_iter().zip(measured) {
        let exact = continuous * (1.0 + 1.0 / springs as f64);
        rows.push(Row::new(format!("u K / ρ g H², n = {springs}"), exact, measured, TOLERANCE));
    }
    let order = order(measured[4] - continuous, measured[5] - continuous, 2.0);
    rows.push(
        Row::new("… n = 50, against the continuous sheet", continuous, measured[5], 0.02 + TOLERANCE)
            .with_order(order, 1.0, 1e-3),
    );
    Problem {
        title: "Sheet under its own weight",
        text: "The lowest row's displacement u after drag has brought a sheet of n springs under each other to rest, \
               in units of ρ g H² / K. Exact is n (n + 1) / 2 of m g / k. All masses of a `springs` fabric are equal, \
               and so the continuous value ½ is approached in first order; with half a mass at the lower edge it would \
               be met for every n.",
        rows,
    }
});

#[test]
fn sheet_stretches_as_it_must() {
    PROBLEM.assert();
}
