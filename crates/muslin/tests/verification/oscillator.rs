//! One mass on one spring, against the exact solution of the difference equation.
//!
//! A column of two particles hangs along gravity from its pinned end. The extension is u + m g / k, and u obeys
//!
//! ```text
//! (1 + c) u₊ − (2 − ω² h²) u + (1 − c) u₋ = 0        ω² = k / m    c = k_d h / 2m
//!
//! u_n = ρⁿ (u₀ cos nθ + b sin nθ)    ρ = √((1 − c) / (1 + c))    cos θ = (2 − ω² h²) / (2 √(1 − c²))
//! ```
//!
//! with b from u₁ = ρ (u₀ cos θ + b sin θ). The starts differ in u₁:
//!
//! ```text
//! consistent   u₁ = u₀ + h v₀ − h²/2 (ω² u₀ + k_d/m v₀)
//! as printed   u₋₁ = u₀, so (1 + c) u₁ = (1 + c − ω² h²) u₀
//! ```

use std::sync::LazyLock;

use muslin::integrate::{CentralDifference, Integrator, Workers};

use crate::common::setup::{GRAVITY, chain};
use crate::common::{SceneNumbers, for_each_step, larger, model_and_state};
use crate::report::{Problem, Row};

/// Of the amplitude. Rounding gives each step's velocity an error of ε ℓ / h, which the spring carries on as an
/// oscillation of ε ℓ / ωh; over n steps these add up like a random walk to ε ℓ √n / ωh = 1e-13 of the amplitude here.
const TOLERANCE: f64 = 1e-12;

const MASS: f64 = 0.2;
const STIFFNESS: f64 = 5.0;
const LENGTH: f64 = 1.0;

/// Three seconds, about 2.4 periods of ω = 5 rad/s, with ω h = 0.05.
fn hanging_mass(drag: f64, as_printed_start: bool) -> SceneNumbers {
    let mut numbers = chain(1, LENGTH, MASS, STIFFNESS);
    (numbers.frame_intervals, numbers.frame_rate, numbers.steps_per_frame) = (3, 1.0, 100);
    numbers.as_printed_start = as_printed_start;
    numbers.cloths[0].drag = drag;
    numbers
}

/// The exact solution from `u0` [m] and `u1` [m].
fn exact(n: u32, u0: f64, u1: f64, h: f64, drag: f64) -> f64 {
    let c = drag * h / (2.0 * MASS);
    let decay = ((1.0 - c) / (1.0 + c)).sqrt();
    let cosine = (2.0 - STIFFNESS / MASS * h * h) / (2.0 * (1.0 - c * c).sqrt());
    let angle = libm::acos(cosine);
    let b = (u1 / decay - u0 * cosine) / libm::sin(angle);
    let n = f64::from(n);
    libm::pow(decay, n) * (u0 * libm::cos(n * angle) + b * libm::sin(n * angle))
}

/// u₁ of a start at `u0` [m] with `velocity` [m/s].
fn first(u0: f64, velocity: f64, h: f64, drag: f64, as_printed_start: bool) -> f64 {
    let (square, rate) = (STIFFNESS / MASS, drag / MASS);
    if as_printed_start {
        u0 - square * h * h * u0 / (1.0 + 0.5 * rate * h)
    } else {
        u0 + h * velocity - 0.5 * h * h * (square * u0 + rate * velocity)
    }
}

/// Extension beyond that of rest under gravity [m] where the free particle is at `height` [m].
fn displacement(height: f64) -> f64 {
    -height - LENGTH - MASS * GRAVITY / STIFFNESS
}

fn row(drag: f64, as_printed_start: bool) -> Row {
    let numbers = hanging_mass(drag, as_printed_start);
    let (h, u0) = (numbers.step(), displacement(-LENGTH));
    let u1 = first(u0, 0.0, h, drag, as_printed_start);
    let (mut max_error, mut last) = (0.0_f64, [f64::NAN; 2]);
    for_each_step(&numbers, |n, state| {
        last = [exact(n, u0, u1, h, drag), displacement(state.positions.y[1])];
        max_error = larger(max_error, (last[1] - last[0]).abs() / u0.abs());
        assert_eq!((state.positions.x[1], state.positions.z[1]), (0.0, 0.0), "stays on its line");
    });
    let start = if as_printed_start { "start as printed" } else { "consistent start" };
    let what = format!("drag {drag} kg/s, {start}: u / u₀ after 3 s");
    Row::new(what, last[0] / u0, last[1] / u0, TOLERANCE).with_error(max_error)
}

pub(crate) static PROBLEM: LazyLock<Problem> = LazyLock::new(|| {
    let mut rows = Vec::new();
    for drag in [0.0, 0.01, 0.3, 1.0] {
        rows.extend([false, true].map(|as_printed_start| row(drag, as_printed_start)));
    }
    Problem {
        title: "Oscillator",
        text: "A mass on a spring, ω = 5/s, in steps of 10 ms; errors are the largest over all steps, relative to the \
               amplitude. Exact is the solution of the difference equation, u_n = ρⁿ (u₀ cos nθ + b sin nθ) with ρ = \
               √((1 − c) / (1 + c)), cos θ = (2 − ω²h²) / 2√(1 − c²) and b from the start.",
        rows,
    }
});

#[test]
fn oscillator_moves_as_it_must() {
    PROBLEM.assert();
}

/// A scene starts at rest; the method itself starts from any velocity.
#[test]
fn oscillator_with_initial_velocity() {
    for drag in [0.0, 0.3] {
        let numbers = hanging_mass(drag, false);
        let (model, mut state) = model_and_state(&numbers);
        let (h, u0, velocity) = (numbers.step(), displacement(-LENGTH), -0.7);
        state.velocities.y[1] = -velocity;
        let u1 = first(u0, velocity, h, drag, false);
        let mut method = CentralDifference::new(Workers::single());
        let mut max_error = 0.0_f64;
        for n in 1..=300 {
            method.step(&model, &mut state, h).unwrap();
            let found = displacement(state.positions.y[1]);
            max_error = larger(max_error, (found - exact(n, u0, u1, h, drag)).abs() / u0.abs());
        }
        assert!(max_error < TOLERANCE, "{max_error:e} of the amplitude");
    }
}
