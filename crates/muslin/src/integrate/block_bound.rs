//! The bound on the fastest frequency that looks at the directions of stiffness.

use std::ops::Range;

use super::stability::{configuration, larger, largest_damping_rate, largest_rate, stable_step};
use super::{SplitArrays, Workers};
use crate::force::{Configuration, StiffnessTensors, StiffnessTensorsMut};
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
    /// `varying` are the varying stiffness bounds [N/m] there, one per particle, which [`corrected`](Self::corrected) will
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
    pub(super) fn rates(&self, particles: &Particles, block: &Range<usize>, varying: &[f64]) -> [f64; 2] {
        let uncorrected = largest_rate(particles, block, varying);
        let Some(corrections) = self.corrections.get(block.clone()) else { return [uncorrected; 2] };
        let constants = particles.masses()[block.clone()].iter().zip(&particles.pinned()[block.clone()]);
        let bounds = varying.iter().zip(corrections).map(|(bound, correction)| bound + correction);
        let rates =
            bounds.zip(constants).map(|(bound, (mass, pinned))| if *pinned { 0.0 } else { bound / mass });
        [uncorrected, rates.fold(0.0, larger)]
    }
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
    for (index, eigenvalue) in eigenvalues.iter_mut().enumerate() {
        *eigenvalue = tensors.largest_eigenvalue(index);
    }
}
