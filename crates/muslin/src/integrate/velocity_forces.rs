//! Forces that depend on velocities, in a method that keeps those of the middle of a step.

use std::ops::Range;

use super::Workers;
use super::stability::{configuration, larger, largest_damping_rate};
use super::synchronous::Synchronise;
use crate::force::{Configuration, Sweep};
use crate::{Model, Points, PointsMut, State};

/// Finds forces that depend on velocities, with memory of its own.
#[derive(Debug, Default)]
pub(super) struct VelocityForces {
    /// Velocities [m/s] at the state's time.
    velocities: Points,
    damping_bounds: Vec<f64>,
}

impl VelocityForces {
    /// Adds the forces of `model` that depend on velocities at `state` to all other `forces` [N].
    pub(super) fn add(&mut self, workers: &Workers, model: &Model, state: &State, forces: &mut Points) {
        if self.velocities.len() != state.positions.len() {
            self.velocities = Points::zeros(state.positions.len());
        }
        let at = configuration(model, state);
        let moving = || model.forces().iter().filter(|force| force.depends_on_velocity());
        let other_forces = &*forces;
        let predict_block = |block: &Range<usize>, mut velocities: PointsMut<'_>| {
            // First the forces, then in their place the velocities.
            velocities.fill(0.0);
            let mut sweep = Sweep::default();
            moving().for_each(|force| force.add_forces(at, block, &mut velocities, &mut sweep));
            let axes = [&mut *velocities.x, &mut *velocities.y, &mut *velocities.z];
            for (values, forces) in axes.into_iter().zip(other_forces.slice(block)) {
                values.iter_mut().zip(forces).for_each(|(value, force)| *value += force);
            }
            let (particles, older) = (at.particles, at.velocities.slice(block));
            let task =
                Synchronise { particles, block, last_step: state.last_step, older, values: velocities };
            model.instructions().run(task);
        };
        workers.for_blocks(model.blocks(), self.velocities.as_mut(), &predict_block, &|(), ()| ());
        model.moving_pins().eval_velocities(at.time, &mut self.velocities);
        let at = Configuration { velocities: &self.velocities, ..at };
        let add_block = |block: &Range<usize>, mut forces: PointsMut<'_>| {
            let mut sweep = Sweep::default();
            moving().for_each(|force| force.add_forces(at, block, &mut forces, &mut sweep));
        };
        workers.for_blocks(model.blocks(), forces.as_mut(), &add_block, &|(), ()| ());
    }

    /// The largest of damping bound / mass [1/s] at `state`, the last one for which [`add`](Self::add) was called.
    pub(super) fn largest_damping_rate(&mut self, workers: &Workers, model: &Model, state: &State) -> f64 {
        self.damping_bounds.resize(state.positions.len(), 0.0);
        let at = Configuration { velocities: &self.velocities, ..configuration(model, state) };
        let eval_block =
            |block: &Range<usize>, bounds: &mut [f64]| largest_damping_rate(model, at, block, bounds);
        let bounds = self.damping_bounds.as_mut_slice();
        workers.for_blocks(model.blocks(), bounds, &eval_block, &larger).unwrap_or(0.0)
    }
}
