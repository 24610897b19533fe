//! Pins that move: where they are, what they do to a mass on a spring, and the work that they do.

use std::f64::consts::TAU;

use glam::DVec3;
use muslin::observe::{EnergyTerms, Recorder, relative_residual};

use crate::common::setup::{GRAVITY, chain};
use crate::common::{ClothNumbers, SceneNumbers, SineNumbers, finish, for_each_step, larger};

const MASS: f64 = 0.2;
const STIFFNESS: f64 = 5.0;
const LENGTH: f64 = 1.0;

/// A mass under a pin that moves up and down with `amplitude` [m] and `frequency` [1/s].
///
/// With a rest length of 1 m and a spring that hangs 0.39 m longer, the spring stays along the vertical and taut.
fn driven_mass(frequency: f64, amplitude: f64, phase: f64, steps_per_frame: u32) -> SceneNumbers {
    let mut numbers = chain(1, LENGTH, MASS, STIFFNESS);
    (numbers.frame_intervals, numbers.frame_rate, numbers.steps_per_frame) = (4, 1.0, steps_per_frame);
    numbers.cloths[0].motion = Some(SineNumbers { axis: [0.0, 2.0, 0.0], amplitude, frequency, phase });
    numbers
}

/// With p_n = A sin(nθ), θ = 2π f h, the displacement u of the mass from where it would rest below the pin's middle obeys
///
/// ```text
/// u₊ − 2u + u₋ = ω² h² (p − u)        u_n = B sin(nθ) + C cos(nφ) + D sin(nφ)
///
/// B = A / (1 − (4 / ω²h²) sin²(θ/2))    sin(φ/2) = ωh/2
/// C = u₀                                D from u₁ = u₀ + ω² h² (p₀ − u₀) / 2
/// ```
///
/// exactly, for frequencies below and above that of the mass.
#[test]
fn a_mass_under_a_moving_pin_follows_the_exact_solution() {
    let square = STIFFNESS / MASS;
    for (frequency, amplitude) in [(0.3, 0.1), (0.7, 0.05), (3.0, 0.1)] {
        let numbers = driven_mass(frequency, amplitude, 0.0, 100);
        let h = numbers.step();
        let (theta, phi) = (TAU * frequency * h, 2.0 * (0.5 * square.sqrt() * h).asin());
        let b = amplitude / (1.0 - 4.0 / (square * h * h) * (0.5 * theta).sin().powi(2));
        let rest = -LENGTH - MASS * GRAVITY / STIFFNESS;
        let u0 = -LENGTH - rest;
        let u1 = u0 - 0.5 * square * h * h * u0;
        let d = (u1 - b * theta.sin() - u0 * phi.cos()) / phi.sin();
        let mut max_error = 0.0_f64;
        for_each_step(&numbers, |n, state| {
            let n = f64::from(n);
            let exact = b * (n * theta).sin() + u0 * (n * phi).cos() + d * (n * phi).sin();
            max_error = larger(max_error, (state.positions.y[1] - rest - exact).abs());
        });
        // As for the oscillator that hangs from a pin at rest: roundings of ε ℓ / h in the velocity.
        assert!(max_error < 1e-12, "{max_error:e} m at {frequency} turns per second");
    }
}

/// The pin is on its path at every step, and its half-step velocity is the mean over the step.
#[test]
fn a_pin_is_on_its_path() {
    let numbers = driven_mass(3.0, 0.1, 0.8, 100);
    let motion = numbers.cloths[0].motion.expect("it moves");
    let mut simulation = numbers.simulation();
    let speed = |time: f64| 0.1 * TAU * 3.0 * (TAU * 3.0 * time + 0.8).cos();
    assert_eq!(simulation.frame().state.positions.get(0).y, motion.displacement(0.0));
    assert!((simulation.frame().velocities.get(0).y - speed(0.0)).abs() < 1e-14);
    let mut before = motion.displacement(0.0);
    let mut observer = crate::common::EachStep(|_: &muslin::Model, state: &muslin::State| {
        let place = motion.displacement(state.time);
        // Time is counted; the step's own sum of times is a rounding away, and the pin moves by 2 m/s.
        assert!((state.positions.get(0) - DVec3::Y * place).length() < 1e-14, "{} s", state.time);
        let mean = (place - before) / state.last_step;
        assert!((state.velocities.get(0).y - mean).abs() < 1e-14 / state.last_step, "{} s", state.time);
        before = place;
    });
    while !simulation.is_finished() {
        simulation.advance(&mut [&mut observer]).expect("it is stable");
        let frame = simulation.frame();
        assert!((frame.velocities.get(0).y - speed(frame.state.time)).abs() < 1e-13);
    }
}

fn last_energies(numbers: &SceneNumbers) -> (EnergyTerms, f64) {
    let mut recorder = Recorder::default();
    finish(&mut numbers.simulation(), &mut recorder);
    let energies: Vec<EnergyTerms> = recorder.frames().iter().map(|frame| frame.energies).collect();
    (energies[energies.len() - 1], relative_residual(&energies))
}

/// A sheet hung by its upper edge, or by two corners, and shaken across and along itself, with drag and no wind.
#[test]
fn residual_of_a_shaken_sheet_falls_as_the_step_squared() {
    let pins = [(0..8).map(|column| (column, 0)).collect(), vec![(0, 0), (7, 0)]];
    for (pins, axis) in pins.into_iter().zip([[0.0, 0.0, 1.0], [1.0, 1.0, 0.3]]) {
        let residuals = [20, 40, 80].map(|steps_per_frame| {
            let cloth = ClothNumbers {
                columns: 8,
                rows: 6,
                height_axis: [0.0, -1.0, 0.0],
                pins: Vec::clone(&pins),
                motion: Some(SineNumbers { axis, amplitude: 0.05, frequency: 3.0, phase: 0.4 }),
                ..ClothNumbers::default()
            };
            let numbers = SceneNumbers {
                frame_intervals: 30,
                frame_rate: 60.0,
                steps_per_frame,
                cloths: vec![cloth],
                ..SceneNumbers::default()
            };
            let (last, residual) = last_energies(&numbers);
            assert!(last.pin_work.abs() > 1e-3, "the pins work: {} J", last.pin_work);
            residual
        });
        let orders: Vec<f64> = residuals.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect();
        assert!(residuals[0] < 1e-3, "{residuals:?}");
        assert!(orders.iter().all(|order| (order - 2.0).abs() < 0.05), "{orders:?} from {residuals:?}");
    }
}

/// Lifting takes m g A for the mass and as much for the pin's own particle, over a quarter turn.
///
/// The mass swings by m g / k meanwhile, so that the spring pulls m g (1 − cos ωt). Against that the pin, which turns with
/// Ω, begins at a node of the swing's sine and ends at rest: integrating by parts twice, what is left is below
/// 2 m g A (Ω/ω)², 0.6 % of the work.
#[test]
fn lifting_slowly_works_against_the_weight() {
    let numbers = driven_mass(1.0 / 16.0, 0.02, 0.0, 400);
    let (last, _) = last_energies(&numbers);
    let weight = 2.0 * MASS * GRAVITY * 0.02;
    assert!((last.pin_work - weight).abs() < 0.006 * weight, "{} J for {weight} J", last.pin_work);
}
