//! The bound on the fastest frequency that looks at the directions of stiffness.

use std::ops::Range;

use super::Workers;
use super::stability::{configuration, larger, largest_damping_rate, stable_step};
use super::workers::for_each_block;
use crate::force::{Configuration, StiffnessTensors, Sweep};
use crate::instructions::Vectorise;
use crate::model::Particles;
use crate::{Model, State};

/// A step [s] that is stable for certain at the state's time and positions, by the stiffness of every particle in its
/// stiffest direction; +∞ if nothing is stiff.
///
/// ```text
/// ω² ≤ max_i λ_i    and    h = 2 / (ω + 2γ)
/// ```
///
/// with λ_i of [`Force::add_stiffness_tensors`](crate::force::Force::add_stiffness_tensors) and γ as in
/// [`guaranteed_stable_step`](super::guaranteed_stable_step). It is never shorter than that one but for 1e-6 of it, and
/// the [`largest_stable_step`](super::largest_stable_step) itself for a large flat grid of squares without bend springs;
/// it costs about as much as two steps. In other shapes it is another one even if all springs are linear.
#[must_use]
pub fn block_stable_step(model: &Model, state: &State) -> f64 {
    let stiffness = BlockBound::default().eval(&Workers::single(), model, state, &[]);
    let at = configuration(model, state);
    let mut bounds = vec![0.0; state.positions.len()];
    let damping = model.blocks().iter().fold(0.0, |damping, block| {
        larger(damping, largest_damping_rate(model, at, block, &mut bounds[block.clone()]))
    });
    stable_step(stiffness, damping)
}

/// Memory for the bound, and for what corrects the cheaper one until it is evaluated again.
#[derive(Debug, Default)]
pub(super) struct BlockBound {
    /// One per thread.
    helpers: Vec<Helper>,
    /// What the varying stiffness bounds [N/m] have to be raised by, less than zero at most places.
    corrections: Vec<f64>,
}

impl BlockBound {
    /// The largest λ_i [1/s²] at `state`.
    ///
    /// `varying` are the varying stiffness bounds [N/m] there, one per particle, which [`rates`](Self::rates) will
    /// correct by what they differ now; empty if nothing varies.
    pub(super) fn eval(&mut self, workers: &Workers, model: &Model, state: &State, varying: &[f64]) -> f64 {
        self.corrections.resize(state.positions.len(), 0.0);
        self.helpers.resize_with(workers.count(), Helper::default);
        let at = configuration(model, state);
        let eval_band = |blocks: &[Range<usize>], corrections: &mut [f64], helper: &mut Helper| {
            helper.sweep.restart();
            let eval_block = |block: &Range<usize>, corrections: &mut [f64]| {
                helper.eval(model, at, block, corrections);
                let (particles, varying) = (at.particles, varying.get(block.clone()).unwrap_or_default());
                model.instructions().run(Settle { particles, block, varying, corrections })
            };
            for_each_block(blocks, corrections, eval_block, larger)
        };
        let corrections = self.corrections.as_mut_slice();
        workers.for_bands(model.blocks(), corrections, &mut self.helpers, &eval_band, &larger).unwrap_or(0.0)
    }

    /// The largest of bound / mass [1/s²] over the free particles of `block`, where the varying stiffness bounds have
    /// become `varying` [N/m], and the same of the corrected bounds; without corrections before the first evaluation.
    pub(super) fn rates(&self, model: &Model, block: &Range<usize>, varying: &[f64]) -> [f64; 2] {
        let corrections = self.corrections.get(block.clone());
        let particles = model.particles();
        model.instructions().run(LargestRates { particles, block, varying, corrections })
    }
}

/// What a thread works with.
#[derive(Debug, Default)]
struct Helper {
    sweep: Sweep,
    /// Of one block.
    tensors: StiffnessTensors,
}

impl Helper {
    /// Overwrites `eigenvalues` [N/m] of a block with the largest ones of the stiffness tensors.
    fn eval(&mut self, model: &Model, at: Configuration<'_>, block: &Range<usize>, eigenvalues: &mut [f64]) {
        let Self { sweep, tensors } = self;
        if tensors.diagonal.len() < block.len() {
            *tensors = StiffnessTensors::zeros(block.len());
        }
        let mut tensors = tensors.first_mut(block.len());
        tensors.clear();
        for force in model.forces() {
            force.add_stiffness_tensors(at, block, &mut tensors, sweep);
        }
        tensors.eval_largest_eigenvalues(model.instructions(), eigenvalues);
    }
}

/// Finds the largest ratio of bound and mass over the free particles of a block, whose `corrections` hold the bounds, and takes off what
/// of these varies now.
struct Settle<'a, 'b> {
    particles: &'a Particles,
    block: &'a Range<usize>,
    /// Bounds [N/m] on the particles of the block; empty if nothing varies.
    varying: &'a [f64],
    corrections: &'b mut [f64],
}

impl Vectorise for Settle<'_, '_> {
    type Output = f64;

    #[inline(always)]
    fn run(self) -> f64 {
        let Self { particles, block, varying, corrections } = self;
        let mut rate = 0.0;
        for run in particles.runs(block).filter(|run| !run.is_pinned) {
            let own = run.particles.start - block.start..run.particles.end - block.start;
            let bounds = &corrections[own];
            rate = larger(rate, largest_in_lanes(bounds, bounds)[0] / run.mass);
        }
        for (correction, bound) in corrections.iter_mut().zip(varying) {
            *correction -= bound;
        }
        rate
    }
}

/// Largest ratios of bound and mass over the free particles of a block.
struct LargestRates<'a> {
    particles: &'a Particles,
    block: &'a Range<usize>,
    /// Bounds [N/m] on the particles of the block.
    varying: &'a [f64],
    corrections: Option<&'a [f64]>,
}

impl Vectorise for LargestRates<'_> {
    type Output = [f64; 2];

    #[inline(always)]
    fn run(self) -> [f64; 2] {
        let Self { particles, block, varying, corrections } = self;
        let mut rates = [0.0; 2];
        for run in particles.runs(block).filter(|run| !run.is_pinned) {
            let own = run.particles.start - block.start..run.particles.end - block.start;
            let varying = &varying[own.clone()];
            let [uncorrected, corrected] = match corrections {
                Some(corrections) => largest_in_lanes(varying, &corrections[own]),
                None => [largest_in_lanes(varying, varying)[0]; 2],
            };
            rates = [larger(rates[0], uncorrected / run.mass), larger(rates[1], corrected / run.mass)];
        }
        rates
    }
}

/// The largest of `bounds`, and of bounds and `corrections` together, and zero at least; NaN where any of these is.
#[inline(always)]
fn largest_in_lanes(bounds: &[f64], corrections: &[f64]) -> [f64; 2] {
    let mut lanes = Lanes::default();
    let (chunks, bounds_rest) = bounds.as_chunks::<LANES>();
    let (correction_chunks, corrections_rest) = corrections.as_chunks::<LANES>();
    let correction_chunks = &correction_chunks[..chunks.len()];
    for i in 0..chunks.len() {
        lanes.raise(&chunks[i], &correction_chunks[i]);
    }
    lanes.raise(bounds_rest, corrections_rest);
    let largest = lanes.largest();
    if largest[1].is_nan() { largest_with_nan(bounds, corrections) } else { largest }
}

const LANES: usize = 8;

/// Largest values so far, lane by lane.
#[derive(Default)]
struct Lanes {
    uncorrected: [f64; LANES],
    corrected: [f64; LANES],
    /// Comparisons pass over what is not a number, sums do not.
    sums: [f64; LANES],
}

impl Lanes {
    #[inline(always)]
    fn raise(&mut self, bounds: &[f64], corrections: &[f64]) {
        for lane in 0..bounds.len().min(corrections.len()).min(LANES) {
            let sum = bounds[lane] + corrections[lane];
            self.uncorrected[lane] = raised(self.uncorrected[lane], bounds[lane]);
            self.corrected[lane] = raised(self.corrected[lane], sum);
            self.sums[lane] += sum;
        }
    }

    /// Called once at the end of a loop, and not inlined: seeing how lanes end, the compiler would take them apart in every turn.
    #[inline(never)]
    fn largest(self) -> [f64; 2] {
        let is_nan = self.sums.iter().any(|sum| sum.is_nan());
        let corrected = self.corrected.into_iter().fold(0.0, raised);
        [self.uncorrected.into_iter().fold(0.0, raised), if is_nan { f64::NAN } else { corrected }]
    }
}

#[inline(always)]
fn raised(largest: f64, value: f64) -> f64 {
    if largest < value { value } else { largest }
}

/// What [`largest_in_lanes`] finds where something is no number.
#[cold]
fn largest_with_nan(bounds: &[f64], corrections: &[f64]) -> [f64; 2] {
    let sums = bounds.iter().zip(corrections).map(|(bound, correction)| bound + correction);
    [bounds.iter().copied().fold(0.0, larger), sums.fold(0.0, larger)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Wherever it is: in a vector or behind the last whole one.
    #[test]
    fn largest_values_are_found_and_no_number_stays_none() {
        let (bounds, corrections) = ([1.0; 19], [-0.25; 19]);
        assert_eq!(largest_in_lanes(&bounds, &corrections), [1.0, 0.75]);
        assert_eq!(largest_in_lanes(&bounds, &[-2.0; 19]), [1.0, 0.0]);
        assert_eq!(largest_in_lanes(&[], &[]), [0.0, 0.0]);
        for place in 0..bounds.len() {
            let with = |values: &[f64; 19], value: f64| {
                let mut values = *values;
                values[place] = value;
                values
            };
            assert_eq!(largest_in_lanes(&with(&bounds, 5.0), &corrections), [5.0, 4.75]);
            assert_eq!(largest_in_lanes(&bounds, &with(&corrections, 7.0)), [1.0, 8.0]);
            // Corrections come from another state, which says nothing of the bounds.
            let [uncorrected, corrected] = largest_in_lanes(&bounds, &with(&corrections, f64::NAN));
            assert!(uncorrected == 1.0 && corrected.is_nan());
            let largest = largest_in_lanes(&with(&bounds, f64::NAN), &corrections);
            assert!(largest.into_iter().all(f64::is_nan));
        }
    }
}
