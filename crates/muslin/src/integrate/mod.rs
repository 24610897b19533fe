//! Methods that move a [`State`] forward in time.

mod adaptive_step;
mod block_bound;
mod block_forces;
mod central_difference;
mod limits;
mod memory;
mod motion;
mod one_pass;
mod pins;
mod running_summary;
mod stability;
mod stable_steps;
mod synchronous;
mod velocity_forces;
mod workers;

pub use adaptive_step::{AdaptiveStep, IdealStep};
pub use block_bound::block_stable_step;
pub use central_difference::CentralDifference;
pub use memory::advance_memory;
pub use stability::{constant_stiffness, guaranteed_stable_step, largest_stable_step};
pub use stable_steps::StableSteps;
pub use workers::{SplitArrays, Workers};

use crate::{Model, Motion, Points, State, StepSummary};

/// Steps [s] that are stable at one state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StableStep {
    /// For certain, by the norms of stiffness: the [`guaranteed_stable_step`], or somewhat less.
    pub by_norms: f64,
    /// By the directions of stiffness: the [`block_stable_step`], or an estimate of it.
    pub by_blocks: f64,
}

/// A method of numerical integration.
///
/// It owns its scratch memory: after the first step, a step allocates nothing.
///
/// A step is in two halves, so that whoever chooses its size can look at the forces in between: first the forces at a
/// state, then the motion under them. Forces that are not known yet at the state it is given a method evaluates when it needs
/// them. It takes that state for the one that it moved or looked at last: whoever changed it since, or has another one or another
/// model, begins with [`eval_forces`](Self::eval_forces).
pub trait Integrator: Send {
    /// Evaluates the forces at `state`.
    fn eval_forces(&mut self, model: &Model, state: &State);

    /// [`eval_forces`](Self::eval_forces), with the same bits, and stable steps at `state`, given the
    /// [`constant_stiffness`] [1/s²] of the model.
    ///
    /// The one by norms is the [`guaranteed_stable_step`] or somewhat less: where the stiffest part of the cloth has to do with
    /// springs that stiffen, and where with others, is not looked at. The one by blocks is an estimate: what
    /// [`eval_stable_step`](Self::eval_stable_step) found last, corrected by how the norms have changed since.
    fn eval_forces_and_stable_step(
        &mut self,
        model: &Model,
        state: &State,
        constant_stiffness: f64,
    ) -> StableStep;

    /// The [`block_stable_step`] [s] at `state`, from which later estimates start. Where the model has bounds that vary, those at
    /// `state` must be known from [`eval_forces_and_stable_step`](Self::eval_forces_and_stable_step) or
    /// [`step_to_and_bound`](Self::step_to_and_bound).
    fn eval_stable_step(&mut self, model: &Model, state: &State) -> f64;

    /// Moves `state` under the forces by `step` [s], which must be positive, to `time` [s], which is its time plus the step
    /// but for rounding.
    ///
    /// Whoever keeps the step calls [`accept`](Self::accept) after this.
    ///
    /// # Errors
    /// [`StepError::NotFinite`] if a position or velocity is no longer a finite number; `state` then holds it.
    fn move_by(&mut self, model: &Model, state: &mut State, step: f64, time: f64) -> Result<(), StepError>;

    /// [`move_by`](Self::move_by), with the same bits, and the energies of the motion.
    ///
    /// # Errors
    /// As [`move_by`](Self::move_by).
    fn move_and_measure(
        &mut self,
        model: &Model,
        state: &mut State,
        step: f64,
        time: f64,
    ) -> Result<Motion, StepError>;

    /// [Evaluates the forces](Self::eval_forces) at `state` and moves it as [`move_by`](Self::move_by) does, or if `is_measured`
    /// as [`move_and_measure`](Self::move_and_measure), with the same bits; a method may do both in one pass over the particles.
    /// What is not measured is zero. What `state` was before is left in `before`, if there is one: whoever takes the step
    /// back swaps them. Positions that `before` held must be finite, or empty: loops in vectors read more than they use, and
    /// zero times NaN is none.
    ///
    /// # Errors
    /// As [`move_by`](Self::move_by).
    fn step_to(
        &mut self,
        model: &Model,
        state: &mut State,
        before: Option<&mut State>,
        to: StepTo,
    ) -> Result<Motion, StepError>;

    /// [`step_to`](Self::step_to), and forces and the stable step at its end, as
    /// [`eval_forces_and_stable_step`](Self::eval_forces_and_stable_step) has them.
    fn step_to_and_bound(
        &mut self,
        model: &Model,
        state: &mut State,
        before: Option<&mut State>,
        to: StepTo,
        constant_stiffness: f64,
    ) -> (Result<Motion, StepError>, StableStep);

    /// Takes the step that led to `state` as final: forces that remember take note of it.
    ///
    /// No bit of a force at `state` changes, so that it does not matter whether they were evaluated before or after.
    fn accept(&self, model: &Model, state: &mut State) {
        advance_memory(self.workers(), model, state);
    }

    /// Estimates the error [m] that the step from `before` to `after` added to any position, from forces that are evaluated
    /// at both; those at `after` are left behind.
    fn eval_error(&mut self, model: &Model, before: &State, after: &State) -> f64;

    /// Overwrites `velocities` with the velocities [m/s] at the state's time, one per particle, from the forces.
    ///
    /// [`State::velocities`] may belong to an earlier time; these are as accurate as the positions.
    fn velocities(&mut self, model: &Model, state: &State, velocities: &mut Points);

    /// From now on finds a [summary](Self::take_summary) of steps, or no more if it is not `wanted`. No bit of a step changes.
    fn summarise(&mut self, is_wanted: bool);

    /// The summary of the steps since it was taken last; that of none if nobody wants it.
    ///
    /// A method may know strains only once it has the forces where a step ends: when that of the next step begins, or velocities
    /// are asked for. A step that is taken back counts, too: whoever does so takes the summary, and drops it.
    fn take_summary(&mut self) -> StepSummary;

    /// The threads that the method works with.
    fn workers(&self) -> &Workers;

    /// A whole step of `step` [s], which must be positive: forces and motion, and what forces remember of it.
    ///
    /// # Errors
    /// As [`move_by`](Self::move_by).
    fn step(&mut self, model: &Model, state: &mut State, step: f64) -> Result<(), StepError> {
        self.eval_forces(model, state);
        self.move_by(model, state, step, state.time + step)?;
        self.accept(model, state);
        Ok(())
    }

    /// [`velocities`](Self::velocities) after evaluating the forces.
    fn eval_velocities(&mut self, model: &Model, state: &State, velocities: &mut Points) {
        self.eval_forces(model, state);
        self.velocities(model, state, velocities);
    }
}

/// Where a step leads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepTo {
    /// Its size [s], positive.
    pub step: f64,
    /// Simulated time [s] at its end, which is that at its beginning and the step but for rounding.
    pub time: f64,
    /// Whether the energies of the motion are asked for.
    pub is_measured: bool,
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
    /// An adaptive step became so short that the run would not end.
    #[error("the step at {time} s would have to be shorter than {shortest:e} s")]
    TooShort {
        /// Simulated time [s] at which the step was to begin.
        time: f64,
        /// The shortest step [s] that is tried.
        shortest: f64,
    },
}
