//! Whether a run gave what its scene expects.

use super::{Recorder, relative_residual};
use crate::scene::{Expectation, ExpectedQuantity, ExpectedRange};

/// One line of a scene's `[expect]` table, and what the run gave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExpectOutcome {
    /// Which quantity.
    pub quantity: ExpectedQuantity,
    /// The range it must lie in.
    pub range: ExpectedRange,
    /// Its value, NaN if the run has none.
    pub value: f64,
    /// Whether the value lies in the range; NaN lies in none.
    pub met: bool,
}

impl Expectation {
    /// Compares with the finished run that `recorder` has followed.
    #[must_use]
    pub fn check(&self, recorder: &Recorder) -> ExpectOutcome {
        let frames = recorder.frames();
        let value = match self.quantity {
            ExpectedQuantity::MaxStrain => recorder.max_strains()[0].unwrap_or(f64::NAN),
            ExpectedQuantity::LowestPoint => frames.last().map_or(f64::NAN, |frame| frame.lowest_point),
            ExpectedQuantity::EnergyResidual => relative_residual(frames.iter().map(|frame| &frame.energies)),
        };
        let met = match self.range {
            ExpectedRange::Below(limit) => value < limit,
            ExpectedRange::Above(limit) => limit < value,
            ExpectedRange::Between(low, high) => low <= value && value <= high,
        };
        ExpectOutcome { quantity: self.quantity, range: self.range, value, met }
    }
}
