//! The largest stable step, against closed forms and an eigenvalue found another way, and what happens beyond it.

use glam::DVec3;
use muslin::integrate::{
    CentralDifference, Integrator, Workers, block_stable_step, guaranteed_stable_step, largest_stable_step,
};
use muslin::{Model, Points, State};

use crate::common::setup::forces;
use crate::common::{ClothNumbers, Random, SceneNumbers, model_and_state};

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
