//! What is found on the way through steps.

use super::motion::{Moved, Wanted};
use super::one_pass::BandMemory;
use crate::StepSummary;

/// Sums up steps, if anybody wants it.
#[derive(Debug, Default)]
pub(super) struct RunningSummary {
    summary: Option<StepSummary>,
}

impl RunningSummary {
    /// From now on sums up steps whose forces are found in `bands`, or no more if it is not wanted.
    pub(super) fn want(&mut self, is_wanted: bool, bands: &mut [BandMemory]) {
        if is_wanted != self.summary.is_some() {
            self.summary = is_wanted.then(StepSummary::default);
            bands.iter_mut().for_each(|band| band.sweep.watch_strains(is_wanted));
        }
    }

    /// What is to be found of a motion whose energies are asked for or not.
    pub(super) fn wanted(&self, energies: bool) -> Wanted {
        Wanted { energies, drag_power: self.summary.is_some() }
    }

    /// The summary since it was taken last.
    pub(super) fn take(&mut self) -> StepSummary {
        self.summary.as_mut().map(std::mem::take).unwrap_or_default()
    }

    /// Adds the strains that were found with the forces in `bands`, or forgets them if they do not `count`.
    pub(super) fn add_strains(&mut self, bands: &mut [BandMemory], count: bool) {
        let Some(summary) = &mut self.summary else { return };
        for BandMemory { sweep, .. } in bands {
            let max_strains = sweep.take_max_strains();
            if count {
                summary.raise_strains(max_strains);
            }
        }
    }

    /// Adds what drag took in a step of `step` [s].
    pub(super) fn add_drag(&mut self, step: f64, moved: &Moved) {
        if let Some(summary) = &mut self.summary {
            summary.drag_loss += step * moved.drag_power;
        }
    }
}
