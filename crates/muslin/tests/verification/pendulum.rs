//! A stiff pendulum that swings widely.
//!
//! A mass on a rigid link of length L, released at the angle θ₀, has the period T and at the bottom the tension F:
//!
//! ```text
//! T = 4 K(sin ½ θ₀) √(L / g)        F = m g (3 − 2 cos θ₀)
//! ```
//!
//! with the complete elliptic integral K. The link here is a spring that its weight would stretch by e L, moved by
//! steps of s √(m / k). Both deviate in first order of e, since the square of the step is proportional to it; from e,
//! e/2 and e/4 follows the rigid link.
//!
//! That needs a spring that does not ring, so it starts with the tension f that it has in a swing without ringing. At
//! rest at θ₀, to first order in e, the link's length changes with ℓ″ = 3 e g sin² θ₀, since f = m g (3 cos θ − 2 cos θ₀);
//! and central differences add h²/12 of the fourth derivative of the place, whose radial part is −3 (g / L)² L sin² θ₀:
//!
//! ```text
//! f = m g [cos θ₀ − (3 − s² / 4) e sin² θ₀]
//! ```

use std::sync::LazyLock;

use crate::common::model_and_state;
use crate::common::setup::{GRAVITY, chain, extrapolated, move_by, root, table};
use crate::report::{Problem, Row};

const LENGTH: f64 = 0.5;
const MASS: f64 = 0.02;
const STRAIN: f64 = 1e-4;

/// Angle ω h of the spring's own oscillation per step [rad].
const PHASE: f64 = 0.3;

/// How many periods the measured one is a mean of.
const PERIODS: usize = 3;

/// Lagrange weights of four points at −1, 0, 1, 2 for the value at `x`.
fn weights(x: f64) -> [f64; 4] {
    [
        -x * (x - 1.0) * (x - 2.0) / 6.0,
        (x + 1.0) * (x - 1.0) * (x - 2.0) / 2.0,
        -(x + 1.0) * x * (x - 2.0) / 2.0,
        (x + 1.0) * x * (x - 1.0) / 6.0,
    ]
}

fn interpolated(values: [f64; 4], x: f64) -> f64 {
    weights(x).iter().zip(values).map(|(weight, value)| weight * value).sum()
}

/// Period √(g / L) T and tension F / m g at the bottom, of the link of this `strain` from `amplitude` [rad].
///
/// Both by cubic interpolation between steps, whose error is (ω h)⁴ = 1e-10.
fn swing(amplitude: f64, strain: f64) -> [f64; 2] {
    let stiffness = MASS * GRAVITY / (strain * LENGTH);
    let (model, mut state) = model_and_state(&chain(1, LENGTH, MASS, stiffness));
    let (sine, cosine) = libm::sincos(amplitude);
    let length = LENGTH * (1.0 + strain * (cosine - (3.0 - 0.25 * PHASE * PHASE) * strain * sine * sine));
    state.positions.x[1] = length * sine;
    state.positions.y[1] = -length * cosine;
    let step = PHASE * (MASS / stiffness).sqrt();
    // Places x and tensions of the last four steps, and times and tensions at every pass from right to left.
    let mut last = [[f64::NAN; 2]; 4];
    let mut passes: Vec<[f64; 2]> = Vec::new();
    let swing = (LENGTH / GRAVITY).sqrt();
    let longest = 7.5 * swing * (PERIODS as f64 + 0.5);
    move_by(&model, &mut state, step, (longest / step) as usize, |state| {
        let place = state.positions.get(1);
        last.rotate_left(1);
        last[3] = [place.x, stiffness * (place.length() - LENGTH) / (MASS * GRAVITY)];
        let [places, tensions] = [0, 1].map(|i| last.map(|values| values[i]));
        if 0.0 < places[1] && places[2] <= 0.0 {
            let fraction = root(0.0, 1.0, |x| -interpolated(places, x));
            passes.push([state.time - (2.0 - fraction) * step, interpolated(tensions, fraction)]);
        }
    });
    let period = (passes[PERIODS][0] - passes[0][0]) / PERIODS as f64;
    [period / swing, passes[0][1]]
}

/// Ringing of second order in e, which extrapolation does not remove, is 1e-8 times a few; the third order is less. The
/// error of the interpolations is (g / L) h² to the square, 1e-10.
const TOLERANCE: f64 = 3e-8;

pub(crate) static PROBLEM: LazyLock<Problem> = LazyLock::new(|| {
    let mut rows = Vec::new();
    for exact in table(include_str!("reference/pendulum.csv")) {
        let degrees = exact[0];
        let swings = [1.0, 0.5, 0.25].map(|share| swing(degrees.to_radians(), share * STRAIN));
        let [period, tension] = [0, 1].map(|i| extrapolated(swings.map(|swing| swing[i])));
        rows.push(Row::new(format!("period T √(g/L) from {degrees}°"), exact[1], period, TOLERANCE));
        rows.push(Row::new(format!("tension F / m g below, from {degrees}°"), exact[3], tension, TOLERANCE));
    }
    Problem {
        title: "Stiff pendulum",
        text: "A mass on a spring so stiff that its weight stretches it by 1e-4, 5e-5 and 2.5e-5, and from these by \
               extrapolation on a rigid link, released at rest. Exact are T = 4 K(sin ½θ₀) √(L/g) with the complete \
               elliptic integral K, and F = m g (3 − 2 cos θ₀). The period is measured between passes through the \
               lowest point, the tension in one.",
        rows,
    }
});

#[test]
fn pendulum_swings_as_it_must() {
    PROBLEM.assert();
}
