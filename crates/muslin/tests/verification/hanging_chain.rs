//! Small swings of a hanging chain.
//!
//! Of N equal masses on links of length l, the frequencies are given by the zeros x of the Laguerre polynomial L_N,
//! those of the continuous chain of length L = N l by the zeros j of the Bessel function J₀:
//!
//! ```text
//! ω² l / g = x    ω √(L / g) = √(N x) → ½ j
//! ```
//!
//! A step h shows ω as an angle φ per step with cos φ = 1 − ω² h² / 2, exactly, so ω = (2 / h) sin(½ φ). Springs
//! stretch, the upper ones more; with strain e of the uppermost the frequency is a regular function of e, and those at
//! e, e/2 and e/4 give that of rigid links to about e³ / 8. The swing is 1e-6 of a link: it changes frequencies by the
//! square of that.

use std::sync::LazyLock;

use crate::common::setup::{GRAVITY, chain, extrapolated, move_by, table};
use crate::common::spectrum::Spectrum;
use crate::common::{Random, model_and_state};
use crate::report::{Problem, Row, order};

const LINK: f64 = 0.1;
const MASS: f64 = 0.01;

/// Strain of the uppermost spring in the softest of three chains; an eighth of its third power is 1e-9.
const STRAIN: f64 = 2e-3;

/// Frequencies ω √(L / g) of the chain of `count` masses, each the highest peak of the spectrum within ±0.4 of
/// `expected`.
///
/// Neighbouring modes are at least 1.4 apart. The motion lasts 150 √(L / g), in which that is 33 bins.
fn frequencies(count: usize, strain: f64, expected: &[f64]) -> Vec<f64> {
    const SAMPLES: usize = 4096;
    let n = count as f64;
    let stiffness = n * MASS * GRAVITY / (strain * LINK);
    let (model, mut state) = model_and_state(&chain(count, n * LINK, MASS, stiffness));
    let mut random = Random::new(count as u64);
    let mut height = 0.0;
    for particle in 1..=count {
        height -= LINK + (count - particle + 1) as f64 * MASS * GRAVITY / stiffness;
        state.positions.y[particle] = height;
        state.positions.x[particle] = 1e-6 * LINK * random.next();
    }
    let swing = (n * LINK / GRAVITY).sqrt();
    // A quarter of the period of the fastest mode there could be, ω² = 4 k / m, divided by ½ π.
    let step = 0.5 * (MASS / stiffness).sqrt();
    let steps_per_sample = (150.0 * swing / step / SAMPLES as f64).round() as usize;
    let mut samples = Vec::with_capacity(SAMPLES);
    for _ in 0..SAMPLES {
        samples.push(state.positions.x[count]);
        move_by(&model, &mut state, step, steps_per_sample, |_| ());
    }
    let spectrum = Spectrum::new(&samples);
    let angle = |frequency: f64| frequency / swing * step * steps_per_sample as f64;
    let frequency = |expected: &f64| {
        let found = spectrum.peak(angle(expected - 0.4), angle(expected + 0.4)) / steps_per_sample as f64;
        2.0 / step * libm::sin(0.5 * found) * swing
    };
    expected.iter().map(frequency).collect()
}

/// Frequencies of the chain of rigid links.
fn rigid_frequencies(count: usize, expected: &[f64]) -> Vec<f64> {
    let [soft, middle, stiff] = [1.0, 0.5, 0.25].map(|share| frequencies(count, share * STRAIN, expected));
    soft.iter().zip(&middle).zip(&stiff).map(|((a, b), c)| extrapolated([*a, *b, *c])).collect()
}

/// Found to 1e-8: extrapolation leaves 1e-9 times a factor below one (5/16 for one mass, where ω² = g / l (1 + e)), and
/// rounding of 1e-16 of a link in swings of 1e-6 of one is 1e-10, made up to five times as large by the extrapolation.
pub(crate) static PROBLEM: LazyLock<Problem> = LazyLock::new(|| {
    let discrete = table(include_str!("reference/hanging_chain.csv"));
    let bessel = 0.5 * 2.404_825_557_695_773;
    let mut rows = Vec::new();
    let mut first_modes = Vec::new();
    for count in [1, 2, 3, 5, 10, 20] {
        let exact: Vec<f64> =
            discrete.iter().filter(|row| row[0] == f64::from(count)).map(|row| row[2]).collect();
        let found = rigid_frequencies(count as usize, &exact);
        first_modes.push(found[0]);
        for (mode, (exact, found)) in exact.iter().zip(found).enumerate() {
            let what = format!("ω √(L/g), N = {count}, mode {}", mode + 1);
            rows.push(Row::new(what, *exact, found, 1e-8));
        }
    }
    let [.., at_10, at_20] = first_modes[..] else { panic!("two chains at least") };
    let order = order(at_10 - bessel, at_20 - bessel, 2.0);
    rows.push(
        Row::new("… N = 20, mode 1, against the continuous chain", bessel, at_20, 0.0125)
            .with_order(order, 1.0, 0.05),
    );
    Problem {
        title: "Hanging chain",
        text: "Small swings of N equal masses on links of length l = L / N, released from random places: frequencies \
               are the peaks of the spectrum of the lowest mass. Exact are the zeros x of the Laguerre polynomial of \
               degree N, ω² l / g = x. The known shift by the step is taken out, cos φ = 1 − ω²h²/2, and the springs' \
               extension by extrapolation from three stiffnesses. The continuous chain (zeros of the Bessel function \
               J₀) is approached in first order, since the last mass is a whole one; with half of it the order would \
               be two.",
        rows,
    }
});

#[test]
fn hanging_chain_swings_as_it_must() {
    PROBLEM.assert();
}
