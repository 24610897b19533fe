//! The bound on the fastest frequency that looks at the directions of stiffness.

use std::ops::Range;

use super::stability::{configuration, larger, largest_damping_rate, largest_rate, stable_step};
use super::{SplitArrays, Workers};
use crate::force::{Configuration, StiffnessTensors, StiffnessTensorsMut};
use crate::instructions::Vectorise;
use crate::model::Particles;
use crate::{Model, State};

impl SplitArrays for StiffnessTensorsMut<'_> {
    fn split_arrays(self, count: usize) -> (Self, Self) {
        let (diagonal, diagonal_rest) = self.diagonal.split_at(count);
        let (off_diagonal, off_diagonal_rest) = self.off_diagonal.split_at(count);
        let rest = Self { diagonal: diagonal_rest, off_diagonal: off_diagonal_rest };
        (Self { diagonal, off_diagonal }, rest)
    }
}

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
/// it costs about as much as five steps. In other shapes it is another one even if all springs are linear.
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
    tensors: StiffnessTensors,
    /// What the varying stiffness bounds [N/m] have to be raised by, less than zero at most places.
    corrections: Vec<f64>,
}

impl BlockBound {
    /// The largest λ_i [1/s²] at `state`.
    ///
    /// `varying` are the varying stiffness bounds [N/m] there, one per particle, which [`rates`](Self::rates) will
    /// correct by what they differ now; empty if nothing varies.
    pub(super) fn eval(&mut self, workers: &Workers, model: &Model, state: &State, varying: &[f64]) -> f64 {
        let count = state.positions.len();
        if self.tensors.diagonal.len() != count {
            self.tensors = StiffnessTensors::zeros(count);
        }
        self.corrections.resize(count, 0.0);
        let at = configuration(model, state);
        let eval_block =
            |block: &Range<usize>, (mut tensors, corrections): (StiffnessTensorsMut<'_>, &mut [f64])| {
                eval_block(model, at, block, &mut tensors, corrections);
                let largest = largest_rate(at.particles, block, corrections);
                for (correction, bound) in
                    corrections.iter_mut().zip(varying.get(block.clone()).unwrap_or_default())
                {
                    *correction -= bound;
                }
                largest
            };
        let arrays = (self.tensors.as_mut(), self.corrections.as_mut_slice());
        workers.for_blocks(model.blocks(), arrays, &eval_block, &larger).unwrap_or(0.0)
    }

    /// The largest of bound / mass [1/s²] over the free particles of `block`, where the varying stiffness bounds have
    /// become `varying` [N/m], and the same of the corrected bounds; without corrections before the first evaluation.
    pub(super) fn rates(&self, model: &Model, block: &Range<usize>, varying: &[f64]) -> [f64; 2] {
        let corrections = self.corrections.get(block.clone());
        let particles = model.particles();
        model.instructions().run(LargestRates { particles, block, varying, corrections })
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
            let uncorrected = largest_in_lanes(varying, |_, bound| bound);
            let corrected = match corrections {
                Some(corrections) => {
                    let corrections = &corrections[own][..varying.len()];
                    largest_in_lanes(varying, |i, bound| bound + corrections[i])
                }
                None => uncorrected,
            };
            rates = [larger(rates[0], uncorrected / run.mass), larger(rates[1], corrected / run.mass)];
        }
        rates
    }
}

/// The largest `term(index, value)` of `values`, and zero at least; NaN if any is.
#[inline(always)]
fn largest_in_lanes(values: &[f64], term: impl Fn(usize, f64) -> f64) -> f64 {
    let mut lanes = [0.0_f64; 8];
    let chunks = values.chunks_exact(8);
    let rest = chunks.remainder();
    for (chunk_index, chunk) in chunks.enumerate() {
        for lane in 0..8 {
            lanes[lane] = larger(lanes[lane], term(8 * chunk_index + lane, chunk[lane]));
        }
    }
    let done = values.len() - rest.len();
    let rest = rest.iter().enumerate().map(|(offset, &value)| term(done + offset, value));
    rest.chain(lanes).fold(0.0, larger)
}

/// Overwrites `eigenvalues` [N/m] of a block with the largest ones of the stiffness tensors.
fn eval_block(
    model: &Model,
    at: Configuration<'_>,
    block: &Range<usize>,
    tensors: &mut StiffnessTensorsMut<'_>,
    eigenvalues: &mut [f64],
) {
    tensors.clear();
    for force in model.forces() {
        force.add_stiffness_tensors(at, block, tensors);
    }
    tensors.eval_largest_eigenvalues(model.instructions(), eigenvalues);
}
