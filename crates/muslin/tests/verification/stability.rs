//! The largest stable step, against closed forms and an eigenvalue found another way, and what happens beyond it.

use glam::DVec3;
use muslin::integrate::{
    CentralDifference, Integrator, Workers, block_stable_step, guaranteed_stable_step, largest_stable_step,
};
use muslin::{Model, Points, Simulation, SimulationError, State};

use crate::common::setup::forces;
use crate::common::{AirNumbers, ClothNumbers, Random, SceneNumbers, model_and_state};

const MASS: f64 = 0.01;
const STIFFNESS: f64 = 400.0;

/// A column of `count` particles along x, with structural springs alone.
fn chain(count: usize, pins: &[(usize, usize)]) -> SceneNumbers {
    SceneNumbers {
        gravity: [0.0; 3],
        cloths: vec![ClothNumbers {
            columns: count,
            rows: 1,
            pins: pins.to_vec(),
            mass: MASS,
            drag: 0.0,
            stiffnesses: [STIFFNESS, 0.0, 0.0],
            ..ClothNumbers::default()
        }],
        ..SceneNumbers::default()
    }
}

fn largest(numbers: &SceneNumbers) -> f64 {
    let (model, state) = model_and_state(numbers);
    largest_stable_step(&model, &state, &Workers::single())
}

/// Of `N` free masses on `N` springs from a pin, ω = 2 √(k/m) sin((2N − 1) π / (4N + 2)) is the fastest mode.
fn chain_step(free: usize) -> f64 {
    let n = free as f64;
    let sine = ((2.0 * n - 1.0) * std::f64::consts::PI / (4.0 * n + 2.0)).sin();
    (MASS / STIFFNESS).sqrt() / sine
}

#[test]
fn step_of_one_spring() {
    let pinned = largest(&chain(2, &[(0, 0)]));
    assert!((pinned / (2.0 * (MASS / STIFFNESS).sqrt()) - 1.0).abs() < 1e-14, "{pinned} s");
    // Two free masses move against each other with ω² = 2 k / m.
    let free = largest(&chain(2, &[]));
    assert!((free / (2.0 * (0.5 * MASS / STIFFNESS).sqrt()) - 1.0).abs() < 1e-14, "{free} s");
}

/// Exact while Lanczos iteration exhausts the modes; too large by less than 0.1 % where it does not.
#[test]
fn step_of_a_chain() {
    for (free, tolerance) in
        [(1, 1e-13), (2, 1e-13), (5, 1e-13), (20, 1e-9), (100, 1e-9), (1000, 1e-3), (20_000, 1e-3)]
    {
        let found = largest(&chain(free + 1, &[(0, 0)]));
        let excess = found / chain_step(free) - 1.0;
        assert!(-1e-13 < excess && excess < tolerance, "{excess:e} too large for {free} masses");
    }
}

#[test]
fn nothing_stiff_is_always_stable() {
    for numbers in [chain(1, &[]), chain(2, &[(0, 0), (1, 0)])] {
        let (model, state) = model_and_state(&numbers);
        assert_eq!(largest_stable_step(&model, &state, &Workers::single()), f64::INFINITY);
        assert_eq!(guaranteed_stable_step(&model, &state), f64::INFINITY);
        assert_eq!(block_stable_step(&model, &state), f64::INFINITY);
    }
}

/// The largest eigenvalue of K / m by power iteration on differences of the forces, which knows nothing of tangents.
///
/// K u = (F(x − δu) − F(x + δu)) / 2δ: truncation of δ² and rounding of ε / δ are both below 1e-9 of K for δ = 1e-5 of
/// the spacing. The Rayleigh quotient is wrong by the square of what is left of other modes.
fn eigenvalue_by_differences(model: &Model, state: &State, mass: f64) -> f64 {
    let count = state.positions.len();
    let mut vector = Random::new(3).points(count, 1.0);
    let mut eigenvalue = 0.0;
    for _ in 0..4000 {
        for pin in model.particles().pins() {
            vector.set(pin, DVec3::ZERO);
        }
        let length = vector.iter().map(DVec3::length_squared).sum::<f64>().sqrt();
        let unit: Points = vector.iter().map(|v| v / length).collect();
        let moved = |delta: f64| -> Points {
            state.positions.iter().zip(unit.iter()).map(|(x, u)| x + u * delta).collect()
        };
        let delta = 1e-6;
        let (behind, ahead) = (forces(model, &moved(-delta)), forces(model, &moved(delta)));
        vector = behind.iter().zip(ahead.iter()).map(|(b, a)| (b - a) / (2.0 * delta * mass)).collect();
        eigenvalue = vector.iter().zip(unit.iter()).map(|(product, u)| product.dot(u)).sum();
    }
    eigenvalue
}

#[test]
fn step_of_a_grid_is_that_of_its_fastest_mode() {
    for (columns, rows, pins, rest_length_direction) in
        [(5, 4, vec![], false), (4, 5, vec![(0, 0), (3, 4)], true), (3, 7, vec![(0, 0)], false)]
    {
        let cloth = ClothNumbers { columns, rows, pins, rest_length_direction, ..ClothNumbers::default() };
        let numbers = SceneNumbers { cloths: vec![cloth], ..SceneNumbers::default() };
        let (model, mut state) = model_and_state(&numbers);
        for crumpled in [false, true] {
            if crumpled {
                let offsets = Random::new(4).points(state.positions.len(), 0.05);
                let moved = state.positions.iter().zip(offsets.iter()).map(|(x, offset)| x + offset);
                state.positions = moved.collect();
            }
            let expected = 2.0 / eigenvalue_by_differences(&model, &state, numbers.cloths[0].mass).sqrt();
            let found = largest_stable_step(&model, &state, &Workers::single());
            assert!((found / expected - 1.0).abs() < 1e-6, "{found} s for {expected} s");
        }
    }
}

/// A free square grid of structural springs alone is a set of chains: ω = 2 √(k/m) cos(π / 2n) on each line.
#[test]
fn step_of_a_large_grid() {
    for count in [10_usize, 100] {
        let cloth = ClothNumbers {
            columns: count,
            rows: count,
            pins: vec![],
            mass: MASS,
            stiffnesses: [STIFFNESS, 0.0, 0.0],
            ..ClothNumbers::default()
        };
        let found = largest(&SceneNumbers { cloths: vec![cloth], ..SceneNumbers::default() });
        let exact = (MASS / STIFFNESS).sqrt() / (std::f64::consts::PI / (2.0 * count as f64)).cos();
        assert!((-1e-13..1e-3).contains(&(found / exact - 1.0)), "{found} s for {exact} s");
    }
}

/// A flat square grid without bend springs: neighbours that move against each other along the grid have ω² = 4 (k + k_s) / m
/// in the inside, which is the block bound; a free edge makes the fastest mode slower by O(1/n²).
#[test]
fn block_bound_of_a_flat_square_grid_is_exact() {
    for shear in [0.0, 0.3 * STIFFNESS] {
        let cloth = ClothNumbers {
            columns: 100,
            rows: 100,
            pins: vec![],
            mass: MASS,
            stiffnesses: [STIFFNESS, shear, 0.0],
            ..ClothNumbers::default()
        };
        let (model, state) =
            model_and_state(&SceneNumbers { cloths: vec![cloth], ..SceneNumbers::default() });
        let exact = (MASS / (STIFFNESS + shear)).sqrt();
        let by_blocks = block_stable_step(&model, &state);
        assert!((-2e-6..=0.0).contains(&(by_blocks / exact - 1.0)), "{by_blocks} s for {exact} s");
        let largest = largest_stable_step(&model, &state, &Workers::single());
        assert!((0.0..2e-3).contains(&(largest / by_blocks - 1.0)), "{by_blocks} s for {largest} s");
    }
}

/// Two free masses at one place: their spring may pull in any direction, and ω² = 2 k / m counts in all.
#[test]
fn block_bound_of_coincident_ends_is_that_of_any_direction() {
    let (model, mut state) = model_and_state(&chain(2, &[]));
    state.positions = Points::zeros(2);
    let exact = 2.0 * (0.5 * MASS / STIFFNESS).sqrt();
    let by_blocks = block_stable_step(&model, &state);
    assert!((-2e-6..=0.0).contains(&(by_blocks / exact - 1.0)), "{by_blocks} s for {exact} s");
}

/// The largest distance [m] of any particle from where it started, over 2000 steps of `share` of the largest stable
/// one.
///
/// The chain starts with a small random stretch, so that it stays linear as long as it is stable.
fn excursion(numbers: &SceneNumbers, share: f64) -> f64 {
    let (model, mut state) = model_and_state(numbers);
    let step = share * largest_stable_step(&model, &state, &Workers::single());
    let mut random = Random::new(9);
    let spacing = model.cloths()[0].grid.column_spacing;
    let origin = state.positions.clone();
    for particle in 1..state.positions.len() {
        state.positions.x[particle] += 1e-3 * spacing * random.next();
    }
    let mut method = CentralDifference::new(Workers::single());
    let mut largest = 0.0_f64;
    for _ in 0..2000 {
        if method.step(&model, &mut state, step).is_err() {
            return f64::INFINITY;
        }
        largest = largest.max(crate::common::max_distance(&state.positions, &origin));
    }
    largest / spacing
}

/// Below the limit each mode keeps its amplitude, and the norm of all of them that of the start. Above it, the fastest
/// mode grows by ω²h²/2 − 1 + √((ω²h²/2 − 1)² − 1) = 1.33 a step at 1.01 of the limit.
#[test]
fn motion_is_bounded_below_the_limit_and_not_above() {
    for free in [1, 8, 50] {
        let numbers = chain(free + 1, &[(0, 0)]);
        let (below, above) = (excursion(&numbers, 0.999), excursion(&numbers, 1.01));
        assert!(below <= 1e-3 * (free as f64).sqrt(), "{below:e} spacings below the limit");
        assert!(1e3 < above, "{above:e} spacings above the limit");
    }
}

/// A mass on a spring with a dashpot, `ratio` = γ / ω.
fn damped(ratio: f64) -> SceneNumbers {
    let mut numbers = chain(2, &[(0, 0)]);
    numbers.cloths[0].dampings = [ratio * (STIFFNESS * MASS).sqrt(), 0.0, 0.0];
    numbers
}

/// ω h at the limit of a mass on a spring with a dashpot, γ = c / m: a step takes (h v⁻, x) to
///
/// ```text
/// h v⁺ = (1 − z + ½ z²) h v⁻ − ω²h² (1 − ½ z) x        x⁺ = x + h v⁺        z = γ h
/// ```
///
/// whose determinant 1 − z + ½ z² is below one for z < 2, and whose trace lets −1 be no root for ω²h² < 4 + 2 z² / (2 − z).
fn damped_limit(ratio: f64) -> f64 {
    let is_stable = |step: f64| {
        let z = ratio * step;
        z < 2.0 && step * step < 4.0 + 2.0 * z * z / (2.0 - z)
    };
    let (mut low, mut high) = (1.0, 8.0);
    if 1.0 < ratio {
        low /= ratio;
    }
    assert!(is_stable(low) && !is_stable(high));
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if is_stable(middle) { low = middle } else { high = middle }
    }
    low
}

/// With damping that is taken explicitly the limit is where the closed form has it; the largest stable step is min(2/ω, 2/γ), never
/// beyond it and not below half of it.
#[test]
fn step_of_a_damped_spring() {
    let frequency = (STIFFNESS / MASS).sqrt();
    for ratio in [0.0, 0.1, 0.3, 0.6, 1.0, 3.0] {
        let limit = damped_limit(ratio) / frequency;
        let largest = largest(&damped(ratio));
        let exact = 2.0 / f64::max(1.0, ratio) / frequency;
        assert!((largest / exact - 1.0).abs() < 1e-13, "{largest} s for {exact} s at {ratio}");
        assert!((0.5..1.0 + 1e-12).contains(&(largest / limit)), "{largest} s of {limit} s at {ratio}");
        for (share, is_stable) in [(0.99, true), (1.01, false)] {
            let left = what_is_left(&damped(ratio), share * limit);
            // Without damping the amplitude stays as it is; at 0.99 of the limit it is up to 8 times the start's.
            assert_eq!(
                left < if ratio == 0.0 { 8.0 } else { 1e-3 },
                is_stable,
                "{left:e} at {share}, γ = {ratio} ω"
            );
        }
    }
}

/// How far [1] any particle is from where it is at rest after 3000 steps of `step` [s], relative to a small random offset at the
/// start.
fn what_is_left(numbers: &SceneNumbers, step: f64) -> f64 {
    const OFFSET: f64 = 1e-6;
    let (model, mut state) = model_and_state(numbers);
    let origin = state.positions.clone();
    let mut random = Random::new(11);
    for particle in (0..origin.len()).filter(|&particle| !model.particles().pinned()[particle]) {
        state.positions.x[particle] += OFFSET * random.next();
    }
    let mut method = CentralDifference::new(Workers::single());
    let mut largest = 0.0_f64;
    for n in 0..3000 {
        if method.step(&model, &mut state, step).is_err() {
            return f64::INFINITY;
        }
        if 2900 < n {
            largest = largest.max(crate::common::max_distance(&state.positions, &origin));
        }
    }
    largest / OFFSET
}

/// In a stretched sheet stiffness and damping have no modes in common, and drag comes besides: below the largest stable step all the
/// same nothing grows.
#[test]
fn a_damped_sheet_is_stable_up_to_its_step() {
    for (dampings, drag) in [([0.05, 0.0, 0.0], 0.0), ([0.0, 0.4, 0.0], 0.01), ([0.3, 0.05, 0.6], 0.05)] {
        let cloth = ClothNumbers {
            columns: 6,
            rows: 5,
            pins: (0..5).flat_map(|row| [(0, row), (5, row)]).collect(),
            dampings,
            drag,
            ..ClothNumbers::default()
        };
        let numbers = SceneNumbers { gravity: [0.0; 3], cloths: vec![cloth], ..SceneNumbers::default() };
        let left = what_is_left(&numbers, 0.999 * largest(&numbers));
        assert!(left < 1.0, "{left:e} of the start is left with dashpots of {dampings:?} kg/s");
    }
}

/// A light film held at two edges in a wind along its normal, whose damping needs shorter steps than its springs.
fn film(frame_intervals: u32, step: f64, airs: Vec<AirNumbers>) -> SceneNumbers {
    SceneNumbers {
        frame_intervals,
        frame_rate: 1.0 / step,
        steps_per_frame: 1,
        gravity: [0.0; 3],
        airs,
        cloths: vec![ClothNumbers {
            columns: 6,
            rows: 5,
            width: 0.5,
            height: 0.4,
            pins: (0..5).flat_map(|row| [(0, row), (5, row)]).collect(),
            mass: 2e-5,
            drag: 0.0,
            stiffnesses: [20.0, 5.0, 0.0],
            ..ClothNumbers::default()
        }],
        ..SceneNumbers::default()
    }
}

/// A constant step that springs allow and air does not is refused; taken all the same, the film is soon beyond all numbers. With a
/// step below the limit it fills and hangs in the wind, slower than 0.1 m/s.
#[test]
fn a_constant_step_counts_air() {
    let wind = || vec![AirNumbers::steady([0.0, 5.0, 0.0], [1.5, 0.0])];
    let [still, windy] = [Vec::new(), wind()].map(|airs| largest(&film(1, 1e-4, airs)));
    // ρ C_N A w of a particle inside, which stands for 10 cm x 10 cm.
    let exact = 2.0 * 2e-5 / (1.2 * 1.5 * 0.1 * 0.1 * 5.0);
    assert!((windy / exact - 1.0).abs() < 1e-12 && 1.9 * windy < still, "{windy} s and {still} s");
    let simulation = |numbers: &SceneNumbers| {
        let scene = numbers.scene();
        Simulation::new(&scene, Simulation::integrator(&scene, Workers::single()))
    };
    let refused = simulation(&film(1, 1.8 * windy, wind()));
    assert!(matches!(refused, Err(SimulationError::UnstableStep { .. })));
    let speed = |step: f64| {
        let mut numbers = film(4000, step, wind());
        numbers.allow_unstable = true;
        let mut simulation = simulation(&numbers).unwrap_or_else(|error| panic!("{error}"));
        while !simulation.is_finished() {
            if simulation.advance(&mut []).is_err() {
                return f64::INFINITY;
            }
        }
        simulation.frame().velocities.iter().map(DVec3::length).fold(0.0, f64::max)
    };
    let [below, above] = [0.9, 1.8].map(|share| speed(share * windy));
    assert!(below < 0.1 && above == f64::INFINITY, "{below:e} m/s and {above:e} m/s");
}
