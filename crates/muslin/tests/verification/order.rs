//! Measured order of convergence against the stated one.
//!
//! ```text
//! order = log₂(error(h) / error(h / 2))
//! ```
//!
//! An error is the maximum over a run: at times at which leading terms cancel, a first-order method can seem of third.

use std::sync::LazyLock;

use muslin::integrate::{CentralDifference, Integrator, Workers};
use muslin::{Points, State};

use crate::common::{
    CURVE, ClothNumbers, LINEAR, Random, SceneNumbers, WindNumbers, for_each_step, larger, max_distance,
    model_and_state,
};
use crate::report::{Problem, Row, order};

const MASS: f64 = 0.2;
const STIFFNESS: f64 = 5.0;

/// A mass on a spring along x, free of gravity: x = 1 m + u, ü = −ω² u − 2 γ u̇.
fn oscillator(drag: f64, steps_per_frame: u32, as_printed_start: bool) -> SceneNumbers {
    SceneNumbers {
        frame_intervals: 1,
        frame_rate: 0.5,
        steps_per_frame,
        as_printed_start,
        // What holds the mass away from the rest of the spring: u₀ = −g / ω² is where it starts.
        gravity: [2.5, 0.0, 0.0],
        cloths: vec![ClothNumbers {
            columns: 2,
            rows: 1,
            width: 1.0,
            origin: [0.0; 3],
            pins: vec![(0, 0)],
            mass: MASS,
            drag,
            stiffnesses: [STIFFNESS, 0.0, 0.0],
            ..ClothNumbers::default()
        }],
        ..SceneNumbers::default()
    }
}

/// u(t) [m] of the differential equation, from rest at u₀ = −0.1 m about the equilibrium at 1.1 m.
fn exact_position(time: f64, drag: f64) -> f64 {
    let gamma = drag / (2.0 * MASS);
    let omega = (STIFFNESS / MASS - gamma * gamma).sqrt();
    let (sine, cosine) = libm::sincos(omega * time);
    1.1 - 0.1 * libm::exp(-gamma * time) * (cosine + gamma / omega * sine)
}

fn oscillator_error(drag: f64, steps_per_frame: u32, as_printed_start: bool) -> f64 {
    let numbers = oscillator(drag, steps_per_frame, as_printed_start);
    let mut error = 0.0_f64;
    for_each_step(&numbers, |_, state| {
        error = larger(error, (state.positions.x[1] - exact_position(state.time, drag)).abs());
    });
    error
}

/// Orders between neighbours of a sequence of errors of halved steps.
fn orders(errors: &[f64]) -> Vec<f64> {
    errors.windows(2).map(|pair| order(pair[0], pair[1], 2.0)).collect()
}

/// A row for the order between neighbours that is farthest from the stated one.
fn row(what: &str, orders: &[f64], stated: f64, tolerance: f64) -> Row {
    let distance = |order: f64| (order - stated).abs();
    // NaN is the farthest.
    let farther = |a: f64, b: f64| if a.is_nan() || distance(b) <= distance(a) { a } else { b };
    let farthest = orders.iter().copied().fold(stated, farther);
    Row::of_order(what, stated, farthest, tolerance)
}

/// The next term of the error is of relative size (ω h)² and puts the order off by about as much: 0.0025 at 200 steps.
fn consistent_start(drag: f64) -> Row {
    let errors = [200, 400, 800, 1600].map(|steps| oscillator_error(drag, steps, false));
    row(&format!("oscillator, drag {drag} kg/s"), &orders(&errors), 2.0, 0.02)
}

/// The second-order error of the method is ω h T / 12 of the first-order one of the start and puts the order off by as
/// much: 0.04 at 200 steps.
fn as_printed_start(drag: f64) -> Row {
    let errors = [400, 800, 1600, 3200].map(|steps| oscillator_error(drag, steps, true));
    row(&format!("oscillator, drag {drag} kg/s, start as printed"), &orders(&errors), 1.0, 0.05)
}

/// A cloth has no closed form: differences between runs of h, h/2, h/4, … fall like the errors (Richardson).
fn cloth_orders(as_printed_start: bool, noise: [f64; 2]) -> Vec<f64> {
    law_orders(as_printed_start, noise, LINEAR)
}

/// The same with structural springs of any law.
fn law_orders(as_printed_start: bool, noise: [f64; 2], law: &'static str) -> Vec<f64> {
    let run = |steps_per_frame: u32| {
        let numbers = SceneNumbers {
            frame_intervals: 10,
            frame_rate: 20.0,
            steps_per_frame,
            as_printed_start,
            winds: vec![WindNumbers {
                amplitude: 0.01,
                angular_frequency: 8.0,
                phase: 0.5,
                direction: [0.3, 0.1, 1.0],
                noise,
            }],
            cloths: vec![ClothNumbers {
                columns: 6,
                rows: 5,
                pins: vec![(0, 0), (5, 0)],
                laws: [law, LINEAR, LINEAR],
                ..ClothNumbers::default()
            }],
            ..SceneNumbers::default()
        };
        let mut frames = Vec::new();
        for_each_step(&numbers, |n, state| {
            if n % steps_per_frame == 0 {
                frames.push(state.positions.clone());
            }
        });
        frames
    };
    let runs: Vec<Vec<Points>> = [50, 100, 200, 400, 800].map(run).into();
    let differences: Vec<f64> = runs
        .windows(2)
        .map(|pair| pair[0].iter().zip(&pair[1]).map(|(a, b)| max_distance(a, b)).fold(0.0, larger))
        .collect();
    orders(&differences)
}

/// With kinks inside of steps each costs up to h² more or less, so only the order over all halvings is meaningful.
#[test]
fn cloth_in_noise_of_any_time_is_of_second_order() {
    let orders = cloth_orders(false, [0.01, 0.23]);
    let mean = orders.iter().sum::<f64>() / orders.len() as f64;
    assert!((mean - 2.0).abs() < 0.3, "{orders:?}");
}

/// A new value at each step is another force with other steps: the runs do not approach each other by squares.
#[test]
fn cloth_in_white_noise_does_not_converge_as_it_should() {
    let orders = cloth_orders(false, [0.01, 0.0]);
    let mean = orders.iter().sum::<f64>() / orders.len() as f64;
    assert!(mean < 1.0, "{orders:?}");
}

/// The largest error [m] over two seconds in steps of the sizes of `pattern`, relative to each other.
fn varied_error(drag: f64, pattern: &[f64]) -> f64 {
    let (model, mut state) = model_and_state(&oscillator(drag, 200, false));
    let mut method = CentralDifference::new(Workers::single());
    let sum: f64 = pattern.iter().sum();
    let mut error = 0.0_f64;
    for size in pattern {
        method.step(&model, &mut state, 2.0 * size / sum).unwrap_or_else(|error| panic!("{error}"));
        error = larger(error, (state.positions.x[1] - exact_position(state.time, drag)).abs());
    }
    error
}

/// Each step is a symmetric map of position and velocity, so the order is two for any sequence of steps. Using three
/// positions, as equation (5) does, an alternating step does not converge at all.
fn alternating_steps(drag: f64) -> Row {
    let errors = [200, 400, 800, 1600].map(|count| {
        let pattern: Vec<f64> = (0..count).map(|i| if i % 2 == 0 { 3.0 } else { 1.0 }).collect();
        varied_error(drag, &pattern)
    });
    row(&format!("oscillator, drag {drag} kg/s, steps of 3 : 1 by turns"), &orders(&errors), 2.0, 0.05)
}

/// Steps that differ by up to four, drawn anew for each resolution. The error of one sequence varies by some per cent,
/// the mean over eight by a third of that, so that an order over four halvings is known to about 0.01.
fn random_steps(drag: f64) -> Row {
    let [coarse, fine] = [400_u32, 6400].map(|count| {
        let mut random = Random::new(u64::from(count));
        let mut draw = || varied_error(drag, &Vec::from_iter((0..count).map(|_| random.between(1.0, 4.0))));
        (0..8).map(|_| draw()).sum::<f64>()
    });
    let order = order(coarse, fine, 16.0);
    Row::of_order(format!("oscillator, drag {drag} kg/s, random steps of 4 : 1"), 2.0, order, 0.05)
}

/// Noise with a correlation time is a function of time: halved steps see the same. It is straight over τ / 32 = 10 ms,
/// a whole number of steps of every run here, so that its kinks fall between steps and the order is as clean as
/// without.
const NOISE: [f64; 2] = [0.01, 0.32];

pub(crate) static PROBLEM: LazyLock<Problem> = LazyLock::new(|| {
    let mut rows = Vec::new();
    for drag in [0.0, 0.3] {
        rows.extend(
            [consistent_start, alternating_steps, random_steps, as_printed_start].map(|row| row(drag)),
        );
    }
    rows.push(row("cloth of 6 x 5 in wind", &cloth_orders(false, [0.0; 2]), 2.0, 0.02));
    rows.push(row("cloth in noisy wind", &cloth_orders(false, NOISE), 2.0, 0.03));
    rows.push(row("cloth of a tabulated law", &law_orders(false, [0.0; 2], CURVE), 2.0, 0.05));
    rows.push(row("cloth in wind, start as printed", &cloth_orders(true, [0.0; 2]), 1.0, 0.05));
    Problem {
        title: "Order in the step",
        text: "Orders log₂(error(h) / error(h/2)) of the largest error over a run, the one farthest from the stated \
               order where there are several halvings. The oscillator is compared with its differential equation; a \
               cloth with itself at half the step.",
        rows,
    }
});

#[test]
fn errors_fall_in_the_stated_order() {
    PROBLEM.assert();
}

/// A changing step leaves a steady motion alone: the velocity does not jump with it.
#[test]
fn changing_steps_keep_a_free_velocity() {
    let mut numbers = oscillator(0.0, 200, false);
    numbers.gravity = [0.0; 3];
    numbers.cloths[0].pins.clear();
    let (model, mut state) = model_and_state(&numbers);
    let start: State = state.clone();
    state.velocities.y.fill(2.0);
    let mut method = CentralDifference::new(Workers::single());
    for step in [0.01, 0.04, 0.0025, 0.03, 0.01] {
        method.step(&model, &mut state, step).unwrap();
        for (y, y0) in state.positions.y.iter().zip(&start.positions.y) {
            // A rounding of each of the five steps.
            assert!((y - y0 - 2.0 * state.time).abs() < 5.0 * f64::EPSILON, "{y} m after {} s", state.time);
        }
    }
}
