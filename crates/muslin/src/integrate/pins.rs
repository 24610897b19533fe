//! Pins that move.

use crate::{Model, State};

/// Places the moving pins of `model` where their paths are at `time` [s], the end of a step of `step` [s] from `state`.
///
/// Their velocities become their mean velocities over the step, which are those half of it before `time`.
pub(super) fn place_pins(model: &Model, time: f64, step: f64, state: &mut State) {
    for (particle, position) in model.moving_pins().positions(time) {
        state.velocities.set(particle, (position - state.positions.get(particle)) / step);
        state.positions.set(particle, position);
    }
}
