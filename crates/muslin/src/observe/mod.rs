//! What is measured during a run: energies, strains, hashes.
//!
//! An [`Observer`] sees the state and cannot change it, so a run has the same bits with and without observers.

mod energy;
mod expect;
mod hash;
mod pin_work;
mod record;
mod strain;

pub use energy::{EnergyLedger, EnergyTerms, relative_residual};
pub use expect::ExpectOutcome;
pub use hash::StateHash;
pub use record::{FrameRecord, Recorder, StepCounts};
pub use strain::{FamilyStrain, StrainMonitor};

use crate::{Model, Points, State, StepSummary};

/// The state at one of the times at which a run is written.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// Number of the frame; the first, at time zero, is 0.
    pub index: u64,
    /// Time and positions. Its velocities belong to an earlier time.
    pub state: &'a State,
    /// Velocities [m/s] at the state's time, one per particle.
    pub velocities: &'a Points,
}

/// Something that looks at a run: the first frame (see [`Simulation::observe`](crate::Simulation::observe)), then every step
/// and every frame that is reached.
pub trait Observer: Send {
    /// Looks at `state` after a step of [`State::last_step`].
    fn step(&mut self, model: &Model, state: &State) {
        let _ = (model, state);
    }

    /// Whether it wants a [`summary`](Self::summary) of the next steps, which makes them about a tenth longer.
    fn wants_summary(&self) -> bool {
        false
    }

    /// Hears what was found over the steps since the last frame: before it looks at the next one, or before a run ends
    /// with an error.
    fn summary(&mut self, summary: &StepSummary) {
        let _ = summary;
    }

    /// Hears that a step was tried and taken back; `state` is the one that it began from.
    fn refused_step(&mut self, model: &Model, state: &State) {
        let _ = (model, state);
    }

    /// Looks at `frame`: first at the initial one, then at each that is reached.
    fn frame(&mut self, model: &Model, frame: &Frame<'_>) {
        let _ = (model, frame);
    }
}
