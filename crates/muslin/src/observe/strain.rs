//! Strains of the springs.

use serde::{Deserialize, Serialize};

use super::{Frame, Observer};
use crate::force::{Configuration, StrainSums};
use crate::{Model, StepSummary};

/// Strains e = (ℓ − L) / L [1] of one family of springs in one frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FamilyStrain {
    /// Smallest; negative is compression.
    pub min: f64,
    /// Mean over the springs.
    pub mean: f64,
    /// Largest.
    pub max: f64,
}

/// Follows the strains of every family: the largest over all steps, and the spread in each frame.
///
/// Families without springs have no strains.
#[derive(Clone, Debug)]
pub struct StrainMonitor {
    maxima: [f64; 3],
    current: [Option<FamilyStrain>; 3],
}

impl Default for StrainMonitor {
    fn default() -> Self {
        Self { maxima: [f64::NEG_INFINITY; 3], current: [None; 3] }
    }
}

impl StrainMonitor {
    /// A monitor that continues from `maxima` [1] of earlier steps.
    #[must_use]
    pub fn resume(maxima: [Option<f64>; 3]) -> Self {
        Self { maxima: maxima.map(|max| max.unwrap_or(f64::NEG_INFINITY)), ..Self::default() }
    }

    /// Largest strain over all steps so far, per family in the order of [`Family::ALL`](crate::force::Family::ALL).
    #[must_use]
    pub fn maxima(&self) -> [Option<f64>; 3] {
        self.maxima.map(|max| (max > f64::NEG_INFINITY).then_some(max))
    }

    /// Strains in the latest frame, per family.
    #[must_use]
    pub fn current(&self) -> [Option<FamilyStrain>; 3] {
        self.current
    }
}

impl Observer for StrainMonitor {
    fn wants_summary(&self) -> bool {
        true
    }

    fn summary(&mut self, summary: &StepSummary) {
        for (max, strain) in self.maxima.iter_mut().zip(summary.max_strains) {
            *max = max.max(strain);
        }
    }

    fn frame(&mut self, model: &Model, frame: &Frame<'_>) {
        let particles = model.particles();
        let at = Configuration {
            time: frame.state.time,
            particles,
            positions: &frame.state.positions,
            velocities: frame.velocities,
            memory: &frame.state.memory,
        };
        let mut sums = [StrainSums::default(); 3];
        for force in model.forces() {
            force.add_strains(at, &mut sums);
        }
        for ((current, sums), max) in self.current.iter_mut().zip(sums).zip(&mut self.maxima) {
            *current = (sums.count > 0).then(|| FamilyStrain {
                min: sums.min,
                mean: sums.sum / sums.count as f64,
                max: sums.max,
            });
            *max = max.max(sums.max);
        }
    }
}
