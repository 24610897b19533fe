//! The record of a run: one line per frame.

use serde::{Deserialize, Serialize};

use super::{EnergyLedger, EnergyTerms, FamilyStrain, Frame, Observer, StateHash, StrainMonitor};
use crate::{Model, State, StepSummary};

/// What was measured in one frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FrameRecord {
    /// Simulated time [s].
    pub time: f64,
    /// The step that led here [s]; zero in the first frame.
    pub step: f64,
    /// Energies [J].
    pub energies: EnergyTerms,
    /// Strains [1] per family, in the order of [`Family::ALL`](crate::force::Family::ALL); none without springs.
    pub strains: [Option<FamilyStrain>; 3],
    /// Height [m] of the lowest particle.
    pub lowest_point: f64,
    /// Hash of positions and velocities.
    pub hash: StateHash,
}

/// Number and sizes of the steps of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StepCounts {
    /// Steps taken.
    pub accepted: u64,
    /// Steps tried, found too long and taken again.
    pub rejected: u64,
    /// Smallest step [s]; none before the first.
    pub smallest: Option<f64>,
    /// Largest step [s]; none before the first.
    pub largest: Option<f64>,
}

/// Records every frame of a run: energies, strains, lowest point and hash.
#[derive(Clone, Debug, Default)]
pub struct Recorder {
    ledger: EnergyLedger,
    strains: StrainMonitor,
    steps: StepCounts,
    frames: Vec<FrameRecord>,
}

impl Recorder {
    /// A recorder that continues a run from `state`, the last of the recorded `frames`.
    ///
    /// `max_strains` [1] are the largest of the steps so far.
    #[must_use]
    pub fn resume(
        model: &Model,
        state: &State,
        steps: StepCounts,
        max_strains: [Option<f64>; 3],
        frames: Vec<FrameRecord>,
    ) -> Self {
        let ledger = match (frames.first(), frames.last()) {
            (Some(first), Some(last)) => EnergyLedger::resume(model, state, first.energies, last.energies),
            _ => EnergyLedger::default(),
        };
        Self { ledger, strains: StrainMonitor::resume(max_strains), steps, frames }
    }

    /// The frames so far.
    #[must_use]
    pub fn frames(&self) -> &[FrameRecord] {
        &self.frames
    }

    /// The steps so far.
    #[must_use]
    pub fn steps(&self) -> &StepCounts {
        &self.steps
    }

    /// Largest strain [1] over all steps so far, per family in the order of [`Family::ALL`](crate::force::Family::ALL).
    #[must_use]
    pub fn max_strains(&self) -> [Option<f64>; 3] {
        self.strains.maxima()
    }
}

impl Observer for Recorder {
    fn step(&mut self, model: &Model, state: &State) {
        let step = state.last_step;
        self.steps.accepted += 1;
        self.steps.smallest = Some(self.steps.smallest.map_or(step, |smallest| smallest.min(step)));
        self.steps.largest = Some(self.steps.largest.map_or(step, |largest| largest.max(step)));
        self.ledger.step(model, state);
    }

    fn wants_summary(&self) -> bool {
        true
    }

    fn summary(&mut self, summary: &StepSummary) {
        self.ledger.summary(summary);
        self.strains.summary(summary);
    }

    fn refused_step(&mut self, _: &Model, _: &State) {
        self.steps.rejected += 1;
    }

    fn frame(&mut self, model: &Model, frame: &Frame<'_>) {
        self.ledger.frame(model, frame);
        self.strains.frame(model, frame);
        let positions = &frame.state.positions;
        self.frames.push(FrameRecord {
            time: frame.state.time,
            step: if frame.index == 0 { 0.0 } else { frame.state.last_step },
            energies: *self.ledger.terms(),
            strains: self.strains.current(),
            lowest_point: positions.y.iter().copied().fold(f64::INFINITY, f64::min),
            hash: StateHash::new(positions, frame.velocities),
        });
    }
}
