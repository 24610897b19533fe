//! What winds do over time: spectrum of their force, deviation and correlation time of their noise, and that nothing else
//! changes it.

use std::f64::consts::PI;

use glam::DVec3;
use muslin::force::{Configuration, Sweep};
use muslin::{Model, Points, State};

use crate::common::{
    AirNumbers, ClothNumbers, EachStep, SceneNumbers, WindNumbers, finish, model_and_state, simulation,
    workers,
};

/// Sum [N] of the forces on all particles.
fn total_force(model: &Model, time: f64, state: &State) -> DVec3 {
    let at = Configuration {
        time,
        particles: model.particles(),
        positions: &state.positions,
        velocities: &state.velocities,
        memory: &[],
    };
    let mut forces = Points::zeros(state.positions.len());
    let mut rest = forces.as_mut();
    for block in model.blocks() {
        let (mut own, others) = rest.split_at(block.len());
        model.forces().iter().for_each(|force| force.add_forces(at, block, &mut own, &mut Sweep::default()));
        rest = others;
    }
    forces.iter().sum()
}

/// A sheet of 1 m² in the plane of x and y that cannot move, eight seconds long in 256 frames.
fn held() -> SceneNumbers {
    SceneNumbers {
        frame_intervals: 256,
        frame_rate: 32.0,
        steps_per_frame: 1,
        allow_unstable: true,
        gravity: [0.0; 3],
        cloths: vec![ClothNumbers {
            columns: 3,
            rows: 2,
            height_axis: [0.0, 1.0, 0.0],
            pins: (0..6).map(|p| (p % 3, p / 3)).collect(),
            ..ClothNumbers::default()
        }],
        ..SceneNumbers::default()
    }
}

/// The force [N] along z at every frame after the first.
fn recorded_force(numbers: &SceneNumbers, threads: usize) -> Vec<f64> {
    let (mut forces, steps_per_frame, mut count) = (Vec::new(), numbers.steps_per_frame, 0);
    let mut observer = EachStep(|model: &Model, state: &State| {
        count += 1;
        if count % steps_per_frame == 0 {
            forces.push(total_force(model, state.time, state).z);
        }
    });
    finish(&mut simulation(&numbers.scene(), workers(threads)), &mut observer);
    forces
}

/// Amplitudes at 0, 1, 2, … periods in all of `values`: the discrete Fourier transform, term by term.
fn amplitudes(values: &[f64]) -> Vec<f64> {
    let count = values.len();
    let amplitude = |periods: usize| {
        let turn = |k: usize| 2.0 * PI * (periods * k % count) as f64 / count as f64;
        let part = |function: fn(f64) -> f64| -> f64 {
            values.iter().enumerate().map(|(k, value)| value * function(turn(k))).sum()
        };
        let scale = if periods == 0 { 1.0 } else { 2.0 };
        scale / count as f64 * part(f64::cos).hypot(part(f64::sin))
    };
    (0..count / 2).map(amplitude).collect()
}

/// Twelve periods in eight seconds.
const PERIODS: usize = 12;

fn sine(amplitude: f64) -> WindNumbers {
    let angular_frequency = 2.0 * PI * PERIODS as f64 / 8.0;
    WindNumbers { amplitude, angular_frequency, phase: 0.7, direction: [0.0, 0.0, 1.0], noise: [0.0; 2] }
}

/// All of the paper's wind is at its angular frequency: six particles, A = 2 mN each.
#[test]
fn particle_force_has_its_frequency() {
    let found = amplitudes(&recorded_force(&SceneNumbers { winds: vec![sine(0.002)], ..held() }, 1));
    for (periods, amplitude) in found.into_iter().enumerate() {
        let exact = if periods == PERIODS { 0.012 } else { 0.0 };
        assert!((amplitude - exact).abs() < 1e-15, "{periods} periods: {amplitude:e} N");
    }
}

/// The force is ½ ρ C_N A (v + a sin)² = c (v² + ½ a² + 2 v a sin − ½ a² cos 2·): a mean, a peak, and an octave.
#[test]
fn aerodynamic_force_has_its_frequency() {
    let (mean, amplitude) = (4.0, 1.0);
    let air = AirNumbers { gust: sine(amplitude), ..AirNumbers::steady([0.0, 0.0, mean], [1.5, 0.1]) };
    let found = amplitudes(&recorded_force(&SceneNumbers { airs: vec![air], ..held() }, 1));
    let c = 0.5 * 1.2 * 1.5;
    for (periods, found) in found.into_iter().enumerate() {
        let exact = match periods {
            0 => c * (mean * mean + 0.5 * amplitude * amplitude),
            PERIODS => c * 2.0 * mean * amplitude,
            periods if periods == 2 * PERIODS => c * 0.5 * amplitude * amplitude,
            _ => 0.0,
        };
        assert!((found - exact).abs() < 1e-13, "{periods} periods: {found} N for {exact} N");
    }
}

/// A sine without a mean blows both ways, with the sign of the sine: odd harmonics only, the first the largest.
#[test]
fn gust_without_mean_peaks_at_its_frequency() {
    let air = AirNumbers { gust: sine(3.0), ..AirNumbers::steady([0.0; 3], [1.5, 0.0]) };
    let found = amplitudes(&recorded_force(&SceneNumbers { airs: vec![air], ..held() }, 1));
    // The first coefficient of sin |sin| is 8 / 3π; samples fold harmonics beyond the 21st onto lower ones, below 1e-4.
    let exact = 0.5 * 1.2 * 1.5 * 9.0 * 8.0 / (3.0 * PI);
    assert!((found[PERIODS] / exact - 1.0).abs() < 1e-3, "{} N for {exact} N", found[PERIODS]);
    let largest = found.iter().copied().fold(0.0, f64::max);
    assert_eq!(largest, found[PERIODS]);
    assert!(found[2 * PERIODS] < 1e-3 * exact, "{} N", found[2 * PERIODS]);
}

/// From the force F = c (v + ε)² of a mean wind, ε = √(F / c) − v: an Ornstein-Uhlenbeck process of the given deviation and
/// correlation time. Over T = 20,000 τ its autocorrelation σ² exp(−|t| / τ) is known to σ² √(2 τ / T) = 0.01 σ², and straight
/// lines between the values lift it by up to 0.5 %.
#[test]
fn noise_of_the_air_has_its_deviation_and_correlation_time() {
    let (mean, deviation, time) = (10.0, 0.8, 0.05);
    let gust = WindNumbers { noise: [deviation, time], direction: [0.0, 0.0, 1.0], ..WindNumbers::default() };
    let air = AirNumbers { gust, ..AirNumbers::steady([0.0, 0.0, mean], [1.5, 0.0]) };
    let numbers = SceneNumbers {
        frame_intervals: 1000,
        frame_rate: 1.0,
        steps_per_frame: 1,
        airs: vec![air],
        ..held()
    };
    let (model, state) = model_and_state(&numbers);
    let (count, interval) = (400_000, 0.0025);
    let noise: Vec<f64> = (0..count)
        .map(|k| (total_force(&model, f64::from(k) * interval, &state).z / 0.9).sqrt() - mean)
        .collect();
    let mean = noise.iter().sum::<f64>() / noise.len() as f64;
    assert!(mean.abs() < 4.0 * 0.01 * deviation, "mean {mean}");
    for lag in [0, 10, 20, 40] {
        let products: f64 = noise.iter().zip(&noise[lag..]).map(|(a, b)| a * b).sum();
        let found = products / (noise.len() - lag) as f64;
        let exact = deviation * deviation * (-(lag as f64) * interval / time).exp();
        let error = (found - exact).abs() / (deviation * deviation);
        assert!(error < 0.045, "lag {lag}: {found} for {exact}");
    }
}

/// The same seed gives the same wind: with other steps, other frames and on other threads the force at a time has the same
/// bits. Another seed gives another.
#[test]
fn wind_depends_on_nothing_but_time_and_seed() {
    let gust = |deviation: f64| WindNumbers { noise: [deviation, 0.1], ..sine(5.0 * deviation) };
    let air = AirNumbers { gust: gust(0.5), ..AirNumbers::steady([0.0, 1.0, 3.0], [1.5, 0.1]) };
    let numbers = SceneNumbers { winds: vec![gust(1e-4)], airs: vec![air], ..held() };
    let expected = recorded_force(&numbers, 1);
    let with = |steps_per_frame: u32, frames: u32, threads: usize| {
        let frame_intervals = frames * numbers.frame_intervals;
        let frame_rate = f64::from(frames) * numbers.frame_rate;
        let changed = SceneNumbers { frame_intervals, frame_rate, steps_per_frame, ..numbers.clone() };
        let forces = recorded_force(&changed, threads);
        forces.into_iter().skip(frames as usize - 1).step_by(frames as usize).collect::<Vec<f64>>()
    };
    for (steps_per_frame, frames, threads) in [(7, 1, 1), (1, 2, 1), (3, 4, 2), (2, 1, 3)] {
        assert_eq!(
            with(steps_per_frame, frames, threads),
            expected,
            "{steps_per_frame}, {frames}, {threads}"
        );
    }
    let text = numbers.text().replace("[run]\n", "[run]\nseed = 1\n");
    let scene = muslin::Scene::parse(&text).unwrap_or_else(|error| panic!("{}", error.render("test", &text)));
    let (model, state) = (Model::new(&scene), Model::new(&scene).initial_state(&scene));
    assert_ne!(total_force(&model, 1.0, &state).z, expected[31]);
}
