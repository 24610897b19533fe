//! The work of pins that move.

use std::ops::Range;

use glam::DVec3;

use crate::force::{Configuration, Sweep};
use crate::{Model, Points, State};

/// Forces on the moving pins, from step to step.
///
/// A pin that moves by Δ in a step works against the total force F that springs, gravity and wind exert on its particle
/// (forces on relative velocity apart: neither they nor their work there reach the cloth):
///
/// ```text
/// work = −½ Σ (F_before + F_after) · Δ
/// ```
#[derive(Clone, Debug, Default)]
pub(super) struct PinWork {
    /// Blocks with moving pins, and these in ascending order.
    blocks: Vec<(Range<usize>, Vec<usize>)>,
    /// Forces [N] on these pins, in the same order, at the latest time.
    forces: Vec<DVec3>,
    /// Forces [N] on all particles of one block.
    block_forces: Points,
    sweep: Sweep,
}

impl PinWork {
    /// The forces on the pins of `model` in `state`.
    pub(super) fn new(model: &Model, state: &State) -> Self {
        let mut pins: Vec<usize> = model.moving_pins().particles().collect();
        pins.sort_unstable();
        let mut work = Self { forces: vec![DVec3::ZERO; pins.len()], ..Self::default() };
        let mut pins = pins.as_slice();
        for block in model.blocks() {
            let (own, others) = pins.split_at(pins.partition_point(|pin| *pin < block.end));
            if !own.is_empty() {
                work.blocks.push((block.clone(), own.to_vec()));
            }
            pins = others;
        }
        let longest = work.blocks.iter().map(|(block, _)| block.len()).max().unwrap_or(0);
        work.block_forces = Points::zeros(longest);
        work.add_step(model, state);
        work
    }

    /// Work [J] of the pins over the step that led to `state`.
    pub(super) fn add_step(&mut self, model: &Model, state: &State) -> f64 {
        let at = Configuration {
            time: state.time,
            particles: model.particles(),
            positions: &state.positions,
            velocities: &state.velocities,
            memory: &state.memory,
        };
        let mut work = 0.0;
        let mut forces = self.forces.iter_mut();
        self.sweep.restart();
        for (block, pins) in &self.blocks {
            let (mut block_forces, _) = self.block_forces.as_mut().split_at(block.len());
            block_forces.fill(0.0);
            for force in model.forces().iter().filter(|force| !force.depends_on_velocity()) {
                force.add_forces(at, block, &mut block_forces, &mut self.sweep);
            }
            for (&pin, force) in pins.iter().zip(&mut forces) {
                let before = std::mem::replace(force, self.block_forces.get(pin - block.start));
                work -= 0.5 * (before + *force).dot(state.velocities.get(pin)) * state.last_step;
            }
        }
        work
    }
}
