//! What forces remember from step to step.

use super::{SplitArrays, Workers};
use crate::force::Configuration;
use crate::{Model, State};

/// Brings the memory of all forces up to date at `state`, and notes in it the energy that friction lost.
///
/// To be called once a step to `state` is final, and as often as one likes besides: a second call changes nothing but that the
/// energy noted is zero. No bit of a force at `state` changes. Models without such forces pay nothing.
///
/// Whoever looks for states of equilibrium evaluates forces with the memory as it is, as often as it takes, and calls this
/// once one is found.
pub fn advance_memory(workers: &Workers, model: &Model, state: &mut State) {
    state.friction_loss = 0.0;
    let layers = model.memory_layers();
    if layers == 0 {
        return;
    }
    state.memory.resize(layers * state.positions.len(), 0.0);
    let at = Configuration {
        time: state.time,
        particles: model.particles(),
        positions: &state.positions,
        velocities: &state.velocities,
        memory: &[],
    };
    let advance = |block: &std::ops::Range<usize>, rows: Rows<'_>| -> f64 {
        model.forces().iter().map(|force| force.advance_memory(at, block, rows.values)).sum()
    };
    let rows = Rows { values: &mut state.memory, layers };
    let lost = workers.for_blocks(model.blocks(), rows, &advance, &|first, second| first + second);
    state.friction_loss = lost.unwrap_or(0.0);
}

/// The memory of whole rows.
struct Rows<'a> {
    values: &'a mut [f64],
    layers: usize,
}

impl SplitArrays for Rows<'_> {
    fn split_arrays(self, count: usize) -> (Self, Self) {
        let (first, second) = self.values.split_at_mut(self.layers * count);
        (Self { values: first, ..self }, Self { values: second, layers: self.layers })
    }
}
