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

use std::sync::LazyLock;

use muslin::State;

use crate::common::{ClothNumbers, SceneNumbers, finish, for_each_step, larger};
use crate::report::{Problem, Row};

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

/// A row for the height [m] at the end, with the largest distance of any height from `exact(n)` after any step as its
/// error.
fn row(what: &str, numbers: &SceneNumbers, exact: impl Fn(f64) -> f64 + Sync) -> Row {
    let (mut max_error, mut last) = (0.0, [f64::NAN; 2]);
    for_each_step(numbers, |n, state: &State| {
        for height in &state.positions.y {
            last = [exact(f64::from(n)), *height];
            max_error = larger(max_error, (last[1] - last[0]).abs());
        }
    });
    Row::new(format!("{what}: height after 1 s [m]"), last[0], last[1], TOLERANCE).with_error(max_error)
}

fn fall_with_drag(drag: f64, as_printed_start: bool) -> Row {
    let numbers = falling(drag, as_printed_start);
    let (h, mass, y0) = (numbers.step(), numbers.cloths[0].mass, numbers.cloths[0].origin[1]);
    let c = drag * h / (2.0 * mass);
    let slope = GRAVITY * h * h / (2.0 * c);
    let first = if as_printed_start { GRAVITY * h * h / (1.0 + c) } else { 0.5 * GRAVITY * h * h };
    let r = (1.0 - c) / (1.0 + c);
    let beta = (slope - first) / (r - 1.0);
    let start = if as_printed_start { "start as printed" } else { "consistent start" };
    let exact = |n| y0 - beta + beta * libm::pow(r, n) - slope * n;
    row(&format!("drag {drag} kg/s, {start}"), &numbers, exact)
}

/// Without drag the consistent start is exact at every step, y = y₀ − ½ g t². The paper's start is that of a cloth
/// thrown down with g h / 2: at time t it is ½ g h t too low.
fn free_fall(as_printed_start: bool) -> Row {
    let numbers = falling(0.0, as_printed_start);
    let (h, y0) = (numbers.step(), numbers.cloths[0].origin[1]);
    let start = if as_printed_start { "start as printed" } else { "consistent start" };
    let velocity = if as_printed_start { 0.5 * GRAVITY * h } else { 0.0 };
    row(&format!("no drag, {start}"), &numbers, |n| {
        let time = h * n;
        y0 - 0.5 * GRAVITY * time * time - velocity * time
    })
}

/// After 125 time constants m / k_d the speed is m g / k_d to round-off, whatever the step.
fn terminal_speed() -> Row {
    let drag = 0.25;
    let mut simulation = falling(drag, false).simulation();
    finish(&mut simulation, &mut muslin::observe::StrainMonitor::default());
    let exact = -simulation.model().particles().masses()[0] * GRAVITY / drag;
    let speeds = &simulation.frame().velocities.y;
    let error = speeds.iter().map(|speed| (speed / exact - 1.0).abs()).fold(0.0, larger);
    // A few roundings of each step remain: the older ones are damped away.
    Row::new(format!("terminal velocity with {drag} kg/s [m/s]"), exact, speeds[0], 1e-13).with_error(error)
}

pub(crate) static PROBLEM: LazyLock<Problem> = LazyLock::new(|| {
    let mut rows = Vec::new();
    for drag in [0.002, 0.05, 0.5] {
        rows.extend([false, true].map(|as_printed_start| fall_with_drag(drag, as_printed_start)));
    }
    rows.extend([false, true].map(free_fall));
    rows.push(terminal_speed());
    Problem {
        title: "Fall",
        text: "A free cloth of 4 x 3 from 1 m, in steps of 4 ms; errors are the largest of any particle over all \
               steps, in metres. Exact is the solution of the difference equation, y_n = α + β rⁿ − (g h²/2c) n with c \
               = k_d h/2m and r = (1 − c) / (1 + c), and without drag y₀ − ½ g t², and ½ g h t below that with the \
               start as printed.",
        rows,
    }
});

#[test]
fn cloth_falls_as_it_must() {
    PROBLEM.assert();
}
