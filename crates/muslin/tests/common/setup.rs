//! Set-ups that several problems share: chains, forces by hand, and motions that drag brings to rest.

use glam::DVec3;
use muslin::force::{Configuration, PotentialEnergies, Sweep};
use muslin::integrate::{CentralDifference, Integrator, Workers};
use muslin::{Model, Points, State};

use super::{ClothNumbers, SceneNumbers, larger};

/// Standard gravity here [m/s²], along −y.
pub(crate) const GRAVITY: f64 = 9.81;

/// A chain of `links` springs that hangs along gravity from a pin at the origin; particle 0 is the pin.
pub(crate) fn chain(links: usize, length: f64, mass: f64, stiffness: f64) -> SceneNumbers {
    SceneNumbers {
        gravity: [0.0, -GRAVITY, 0.0],
        cloths: vec![ClothNumbers {
            columns: 1,
            rows: links + 1,
            width: 0.0,
            height: length,
            origin: [0.0; 3],
            height_axis: [0.0, -1.0, 0.0],
            pins: vec![(0, 0)],
            mass,
            drag: 0.0,
            stiffnesses: [stiffness, 0.0, 0.0],
            ..ClothNumbers::default()
        }],
        ..SceneNumbers::default()
    }
}

/// Forces [N] on all particles at `positions` [m] and time zero, but for drag.
pub(crate) fn forces(model: &Model, positions: &Points) -> Points {
    let mut forces = Points::zeros(positions.len());
    let velocities = Points::zeros(positions.len());
    let at = Configuration {
        time: 0.0,
        particles: model.particles(),
        positions,
        velocities: &velocities,
        memory: &[],
    };
    let mut rest = forces.as_mut();
    for block in model.blocks() {
        let (mut own, others) = rest.split_at(block.len());
        model.forces().iter().for_each(|force| force.add_forces(at, block, &mut own, &mut Sweep::default()));
        rest = others;
    }
    forces
}

/// Energy [J] of all springs at `positions` [m].
pub(crate) fn elastic_energy(model: &Model, positions: &Points) -> f64 {
    let velocities = Points::zeros(positions.len());
    let at = Configuration {
        time: 0.0,
        particles: model.particles(),
        positions,
        velocities: &velocities,
        memory: &[],
    };
    let mut energies = PotentialEnergies::default();
    model.forces().iter().for_each(|force| force.add_energies(at, &mut energies));
    energies.elastic.iter().sum()
}

/// Moves `state` by `count` steps of `step` [s] and hands every state to `visit`.
pub(crate) fn move_by(
    model: &Model,
    state: &mut State,
    step: f64,
    count: usize,
    mut visit: impl FnMut(&State),
) {
    let mut method = CentralDifference::new(Workers::single());
    for _ in 0..count {
        method.step(model, state, step).unwrap_or_else(|error| panic!("{error}"));
        visit(state);
    }
}

/// The largest acceleration [m/s²] of a free particle: by the forces, or by drag at its speed.
///
/// Both must be small: a particle that swings through its place of rest has no force on it.
pub(crate) fn largest_acceleration(model: &Model, state: &State) -> f64 {
    let particles = model.particles();
    let forces = forces(model, &state.positions);
    let free = (0..particles.len()).filter(|&particle| !particles.pinned()[particle]);
    free.map(|particle| {
        let drag = particles.drags()[particle] * state.velocities.get(particle);
        larger(forces.get(particle).length(), drag.length()) / particles.masses()[particle]
    })
    .fold(0.0, larger)
}

/// Moves `state` by steps of `step` [s], under the drag of its scene, until no acceleration exceeds `bound` [m/s²].
///
/// What is left of the way to the place of rest is of the size of `bound` / ω², with ω of the slowest mode.
///
/// # Panics
/// If that takes more than two million steps.
pub(crate) fn settle(model: &Model, state: &mut State, step: f64, bound: f64) {
    const STEPS: usize = 500;
    for _ in 0..4000 {
        if largest_acceleration(model, state) < bound {
            return;
        }
        move_by(model, state, step, STEPS, |_| ());
    }
    panic!("still {:e} m/s² after {} s", largest_acceleration(model, state), state.time);
}

/// The value at zero of a quantity that is regular in `x`, from those at x, x/2 and x/4: what is left is of third
/// order.
pub(crate) fn extrapolated([at_x, at_half, at_quarter]: [f64; 3]) -> f64 {
    let (coarse, fine) = (2.0 * at_half - at_x, 2.0 * at_quarter - at_half);
    (4.0 * fine - coarse) / 3.0
}

/// The root of an increasing `function` between `low` and `high`, to the last digit.
pub(crate) fn root(mut low: f64, mut high: f64, function: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if function(middle) < 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Positions [m] of all particles of a single grid of `columns`, from column and row.
pub(crate) fn grid_points(columns: usize, rows: usize, position: impl Fn(usize, usize) -> DVec3) -> Points {
    (0..rows)
        .flat_map(|row| (0..columns).map(move |column| (column, row)))
        .map(|(i, j)| position(i, j))
        .collect()
}

/// Rows of a table of reference values: comma-separated numbers under a header, comments after `#`.
pub(crate) fn table(text: &str) -> Vec<Vec<f64>> {
    let lines = text.lines().filter(|line| !line.starts_with('#')).skip(1);
    let number = |value: &str| value.parse().unwrap_or_else(|_| panic!("`{value}` is no number"));
    lines.map(|line| line.split(',').map(number).collect()).collect()
}
