//! The energy ledger: what it cannot account for is the error of the method and falls as the step squared.

use muslin::integrate::{Workers, largest_stable_step};
use muslin::observe::{EnergyTerms, Recorder, relative_residual};

use crate::common::{ClothNumbers, SceneNumbers, WindNumbers, finish};

/// The paper's Fig. 3, with this project's constants: three seconds of a cloth of 10 x 10 held by two corners.
fn hanging(steps_per_frame: u32) -> SceneNumbers {
    SceneNumbers { frame_intervals: 180, frame_rate: 60.0, steps_per_frame, ..SceneNumbers::default() }
}

fn residual(numbers: &SceneNumbers) -> f64 {
    let mut recorder = Recorder::default();
    finish(&mut numbers.simulation(), &mut recorder);
    let energies: Vec<EnergyTerms> = recorder.frames().iter().map(|frame| frame.energies).collect();
    relative_residual(&energies)
}

/// Half of the largest stable step is 2.54 ms; 6 and 7 steps per frame are 2.78 ms and 2.38 ms, on both sides of it.
#[test]
fn hanging_cloth_accounts_for_its_energy_at_half_the_stable_step() {
    let numbers = hanging(7);
    let simulation = numbers.simulation();
    let largest = largest_stable_step(simulation.model(), simulation.frame().state, &Workers::single());
    assert!(numbers.step() < 0.5 * largest && 0.5 * largest < hanging(6).step(), "{largest} s");
    for numbers in [hanging(6), numbers] {
        let residual = residual(&numbers);
        assert!(residual < 1e-3, "{residual:e} of the largest change at {} s", numbers.step());
    }
}

/// Orders between neighbours of the residuals of halved steps.
fn orders(residuals: &[f64]) -> Vec<f64> {
    residuals.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect()
}

#[test]
fn residual_of_the_hanging_cloth_falls_as_the_step_squared() {
    let orders = orders(&[16, 32, 64].map(|steps| residual(&hanging(steps))));
    assert!(orders.iter().all(|order| (order - 2.0).abs() < 0.05), "{orders:?}");
}

/// All terms at once: drag, two winds, both force directions.
#[test]
fn residual_with_wind_falls_as_the_step_squared() {
    for rest_length_direction in [false, true] {
        let residuals = [10, 20, 40, 80].map(|steps_per_frame| {
            let wind = |phase: f64, direction: [f64; 3]| WindNumbers {
                amplitude: 0.01,
                angular_frequency: 9.0,
                phase,
                direction,
                noise: [0.0; 2],
            };
            let cloth =
                ClothNumbers { columns: 7, rows: 5, pins: vec![(0, 0), (0, 4)], ..ClothNumbers::default() };
            residual(&SceneNumbers {
                frame_intervals: 60,
                frame_rate: 60.0,
                steps_per_frame,
                winds: vec![wind(0.0, [0.0, 0.0, 1.0]), wind(1.0, [1.0, 0.5, 0.0])],
                cloths: vec![ClothNumbers { rest_length_direction, ..cloth }],
                ..SceneNumbers::default()
            })
        });
        let orders = orders(&residuals);
        assert!(residuals[0] < 1e-3, "{residuals:?}");
        assert!(orders.iter().all(|order| (order - 2.0).abs() < 0.05), "{orders:?}");
    }
}

/// The paper's start puts energy in that is in no term at time zero: it counts as that of the velocity ½ h F / m, which
/// the start amounts to, so that the ledger closes as well.
#[test]
fn residual_of_the_as_printed_start_is_of_the_method_alone() {
    let residuals = [16, 32, 64].map(|steps| {
        residual(&SceneNumbers { as_printed_start: true, frame_intervals: 60, ..hanging(steps) })
    });
    let orders = orders(&residuals);
    assert!(orders.iter().all(|order| (order - 2.0).abs() < 0.05), "{orders:?}");
}

/// Without drag, wind and start-up the method's energy error is bounded: it does not grow over 200 periods.
///
/// One mass on one spring: ½ m v² + ½ k u² with v = (v₋ + v₊) / 2 deviates by at most (ω h)² / 4 of the energy, since
/// v = ω u₀ sin(nφ) sin φ / ωh and (sin φ / ωh)² = 1 − (ω h)² / 4.
#[test]
fn energy_of_an_oscillator_stays_within_its_band() {
    let cloth = ClothNumbers {
        columns: 1,
        rows: 2,
        height_axis: [0.0, -1.0, 0.0],
        pins: vec![(0, 0)],
        mass: 0.1,
        drag: 0.0,
        stiffnesses: [10.0, 0.0, 0.0],
        ..ClothNumbers::default()
    };
    let numbers = SceneNumbers {
        frame_intervals: 6000,
        frame_rate: 48.0,
        steps_per_frame: 1,
        cloths: vec![cloth],
        ..SceneNumbers::default()
    };
    let mut recorder = Recorder::default();
    finish(&mut numbers.simulation(), &mut recorder);
    let (stiffness, mass) = (10.0_f64, 0.1_f64);
    let amplitude = mass * 9.81 / stiffness;
    let band = 0.5 * stiffness * amplitude.powi(2) * (stiffness / mass) * numbers.step().powi(2) / 4.0;
    let energies = recorder.frames().iter().map(|frame| frame.energies.residual.abs());
    let largest = energies.fold(0.0, f64::max);
    // Reached to the extent that a step comes near a quarter period, and never left but for rounding.
    assert!(0.99 * band < largest && largest < band * (1.0 + 1e-9), "{largest:e} J for {band:e} J");
}
