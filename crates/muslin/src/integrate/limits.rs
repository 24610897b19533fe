//! Limits against super-elongation, applied at the end of a step.

use glam::DVec3;

use super::motion::Moved;
use crate::{LimitWork, Model, Points, State};

/// Applies limits, with memory of its own.
#[derive(Debug, Default)]
pub(super) struct Limiter {
    impulses: Points,
}

impl Limiter {
    /// Applies the limits of `model` to `state` at the end of a step of `step` [s] that began with `forces` [N].
    ///
    /// Where a limit moves a free particle by p / m, its velocity over the step changes by Δ = p / m h. That is an impulse
    /// m Δ at the beginning of the step. With v the velocity there, and v⁺ and v⁺ + Δ over the step before and after the
    /// correction, it does the work
    ///
    /// ```text
    /// m Δ · (v + ½ Δ) + ½ h k_d Δ · (v⁺ + Δ)        v = v⁺ − h/2m (F − k_d v⁺)
    ///     = Δ · [(m + h k_d) (v⁺ + ½ Δ) − ½ h F]
    /// ```
    ///
    /// The second term is the drag that the energy ledger takes from v⁺ + Δ, and the step itself from v. Without drag
    /// this is exact: forces and limits together change the kinetic energy by their works, and by nothing else. On a pin
    /// that moves with v⁺ it does the work p · v⁺ / h.
    ///
    /// What is known of the motion after the step, of the velocities v⁺, changes by what is returned.
    pub(super) fn apply(&mut self, model: &Model, forces: &Points, step: f64, state: &mut State) -> Moved {
        state.limit_work = LimitWork::default();
        let mut moved = Moved { is_finite: true, ..Moved::default() };
        if model.limits().is_empty() {
            return moved;
        }
        let particles = model.particles();
        if self.impulses.len() != state.positions.len() {
            self.impulses = Points::zeros(state.positions.len());
        }
        self.impulses.fill(0.0);
        for limit in model.limits() {
            limit.correct(particles, &mut state.positions, &mut self.impulses);
        }
        for (particle, impulse) in self.impulses.iter().enumerate() {
            if impulse == DVec3::ZERO {
                continue;
            }
            let velocity = state.velocities.get(particle);
            if particles.pinned()[particle] {
                state.limit_work.on_pins += impulse.dot(velocity) / step;
                continue;
            }
            let (mass, drag) = (particles.masses()[particle], particles.drags()[particle]);
            let change = impulse / (mass * step);
            let momentum = (velocity + 0.5 * change) * (mass + step * drag);
            state.limit_work.on_free += change.dot(momentum - forces.get(particle) * (0.5 * step));
            state.velocities.set(particle, velocity + change);
            let growth = change.dot(velocity + 0.5 * change);
            moved.motion.power_after += change.dot(forces.get(particle));
            moved.motion.kinetic_energy += mass * growth;
            moved.drag_power += 2.0 * drag * growth;
        }
        moved
    }
}
