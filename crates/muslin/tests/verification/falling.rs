//! A falling cloth, against the exact solution of the difference equation.
//!
//! Nothing stretches a cloth that falls from rest, so that each of its particles falls alone:
//!
//! ```text
//! (1 + c) y₊ − 2 y + (1 − c) y₋ = −g h²        c = k_d h / 2m
//!
//! with drag      y_n = α + β rⁿ − (g h² / 2c) n    r = (1 − c) / (1 + c)    terminal speed g h / 2c = m g / k_d
//! without        y_n = y₀ + n (y₁ − y₀) − ½ g h² n (n − 1)
//! ```
//!
//! with β from y₁ and α = y₀ − β. From rest y₁ = y₀ − ½ g h²; as printed, y₋₁ = y₀, so y₁ = y₀ − g h² / (1 + c).

use muslin::State;

use crate::common::{ClothNumbers, SceneNumbers, finish, for_each_step, larger};

const GRAVITY: f64 = 9.81;

/// Rounding gives each step's velocity an error of ε |S| / h, and without drag nothing holds it: after n steps the
/// position is wrong by about ε |S| n^1.5, here 3e-13 m for |S| up to 5 m and 250 steps.
const TOLERANCE: f64 = 1e-12;

fn falling(drag: f64, as_printed_start: bool) -> SceneNumbers {
    SceneNumbers {
        frame_intervals: 5,
        frame_rate: 5.0,
        steps_per_frame: 50,
        as_printed_start,
        cloths: vec![ClothNumbers { columns: 4, rows: 3, pins: vec![], drag, ..ClothNumbers::default() }],
        ..SceneNumbers::default()
    }
}

/// The largest distance [m] of any height from `exact(n)` after any step.
fn max_error(numbers: &SceneNumbers, exact: impl Fn(f64) -> f64 + Sync) -> f64 {
    let mut max_error = 0.0_f64;
    for_each_step(numbers, |n, state: &State| {
        for height in &state.positions.y {
            max_error = larger(max_error, (height - exact(f64::from(n))).abs());
        }
    });
    max_error
}

#[test]
fn fall_with_drag() {
    for drag in [0.002, 0.05, 0.5] {
        for as_printed_start in [false, true] {
            let numbers = falling(drag, as_printed_start);
            let (h, mass, y0) = (numbers.step(), numbers.cloths[0].mass, numbers.cloths[0].origin[1]);
            let c = drag * h / (2.0 * mass);
            let slope = GRAVITY * h * h / (2.0 * c);
            let first = if as_printed_start { GRAVITY * h * h / (1.0 + c) } else { 0.5 * GRAVITY * h * h };
            let r = (1.0 - c) / (1.0 + c);
            let beta = (slope - first) / (r - 1.0);
            let error = max_error(&numbers, |n| y0 - beta + beta * r.powf(n) - slope * n);
            assert!(error < TOLERANCE, "{error:e} m with {drag} kg/s");
        }
    }
}

/// After 125 time constants m / k_d the speed is m g / k_d to round-off, whatever the step.
#[test]
fn terminal_speed() {
    let drag = 0.25;
    let mut simulation = falling(drag, false).simulation();
    finish(&mut simulation, &mut muslin::observe::StrainMonitor::default());
    let exact = -simulation.model().particles().masses()[0] * GRAVITY / drag;
    for speed in &simulation.frame().velocities.y {
        // A few roundings of each step remain: the older ones are damped away.
        assert!((speed / exact - 1.0).abs() < 1e-13, "{speed} m/s for {exact} m/s");
    }
}

/// Without drag the consistent start is exact at every step, y = y₀ − ½ g t².
#[test]
fn free_fall_is_exact() {
    let numbers = falling(0.0, false);
    let (h, y0) = (numbers.step(), numbers.cloths[0].origin[1]);
    let error = max_error(&numbers, |n| y0 - 0.5 * GRAVITY * (h * n).powi(2));
    assert!(error < TOLERANCE, "{error:e} m");
}

/// The paper's start is that of a cloth thrown down with g h / 2: at time t it is ½ g h t too low.
#[test]
fn as_printed_start_falls_ahead() {
    let numbers = falling(0.0, true);
    let (h, y0) = (numbers.step(), numbers.cloths[0].origin[1]);
    let error = max_error(&numbers, |n| y0 - 0.5 * GRAVITY * (h * n).powi(2) - 0.5 * GRAVITY * h * (h * n));
    assert!(error < TOLERANCE, "{error:e} m");
}
