//! Methods that move a [`State`] forward in time.

mod central_difference;
mod limits;
mod pins;
mod stability;
mod workers;

pub use central_difference::CentralDifference;
pub use stability::{guaranteed_stable_step, largest_stable_step};
pub use workers::Workers;

use crate::{Model, Points, State};

/// A method of numerical integration.
///
/// It owns its scratch memory: after the first step, a step allocates nothing.
pub trait Integrator: Send {
    /// Moves `state` by `step` [s], which must be positive.
    ///
    /// # Errors
    /// [`StepError::NotFinite`] if a position or velocity is no longer a finite number; `state` then holds it.
    fn step(&mut self, model: &Model, state: &mut State, step: f64) -> Result<(), StepError>;

    /// Overwrites `velocities` with the velocities [m/s] at the state's time, one per particle.
    ///
    /// [`State::velocities`] may belong to an earlier time; these are as accurate as the positions.
    fn eval_velocities(&mut self, model: &Model, state: &State, velocities: &mut Points);

    /// The threads that the method works with.
    fn workers(&self) -> &Workers;
}

/// Why a step failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StepError {
    /// The motion left the range of numbers, most likely because the step is larger than the largest stable one.
    #[error("particle {particle} has no finite position or velocity at {time} s")]
    NotFinite {
        /// First such particle that is not pinned.
        particle: usize,
        /// Simulated time [s] at the end of the failed step.
        time: f64,
    },
}
