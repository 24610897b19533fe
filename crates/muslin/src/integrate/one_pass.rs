//! Forces and motion in one pass over the blocks, so that what one half of a step leaves in a core's caches the other finds there.

use std::ops::Range;

use super::block_forces::eval_block;
use super::motion::{MoveBlock, Moved, Steps, Wanted, combined};
use super::stability::configuration;
use super::workers::for_each_block;
use super::{SplitArrays, StepTo, Workers};
use crate::force::{Configuration, Sweep};
use crate::{Model, Points, PointsMut, State};

/// What one thread keeps while it goes from block to block.
#[derive(Debug, Default)]
pub(super) struct BandMemory {
    pub(super) sweep: Sweep,
    /// Forces [N] on a block and on the one after it; nobody needs them for longer.
    forces: [Points; 2],
}

/// Evaluates the forces at a state and moves its particles under them; no array of all forces is written or read.
#[derive(Debug, Default)]
pub(super) struct OnePass {
    /// Of each block.
    moved: Vec<Moved>,
}

impl OnePass {
    /// Moves all particles of `state`, whose positions and velocities are those of `from`, on threads with their `memories`.
    pub(super) fn step_from(
        &mut self,
        (model, workers): (&Model, &Workers),
        state: &mut State,
        from: &State,
        (StepTo { step, .. }, wanted): (StepTo, Wanted),
        memories: &mut [BandMemory],
    ) -> Option<Moved> {
        let steps = Steps { last: state.last_step, next: step };
        let (at, particles) = (configuration(model, from), model.particles());
        let moved = self.of_blocks(model.blocks());
        let arrays = ((state.positions.as_mut(), state.velocities.as_mut()), moved);
        let step_band = |blocks: &[Range<usize>],
                         (arrays, moved): (_, OfBlocks<'_>),
                         memory: &mut BandMemory| {
            let BandMemory { sweep, forces: [forces, _] } = memory;
            let mut moved = moved.values.iter_mut();
            sweep.restart();
            let step_block =
                |block: &Range<usize>, (positions, velocities): (PointsMut<'_>, PointsMut<'_>)| {
                    eval_block(model, at, block, room_for(forces, block), sweep);
                    let forces = forces.slice(&(0..block.len()));
                    let from = Some(from);
                    let task =
                        MoveBlock { from, particles, steps, block, positions, velocities, forces, wanted };
                    if let Some(moved) = moved.next() {
                        *moved = model.instructions().run(task);
                    }
                };
            for_each_block(blocks, arrays, step_block, |(), ()| ());
        };
        workers.for_bands(model.blocks(), arrays, memories, &step_band, &|(), ()| ());
        combined(&self.moved)
    }

    /// The same with the same bits, in place on this thread.
    pub(super) fn step_in_place(
        &mut self,
        model: &Model,
        state: &mut State,
        (StepTo { step, .. }, wanted): (StepTo, Wanted),
        BandMemory { sweep, forces }: &mut BandMemory,
    ) -> Option<Moved> {
        let steps = Steps { last: state.last_step, next: step };
        let (particles, blocks) = (model.particles(), model.blocks());
        let moved = self.of_blocks(blocks).values;
        sweep.restart();
        // Forces look at neighbours in the blocks beside their own at most: a block may move when those of the next are known.
        for next in 0..=blocks.len() {
            if let Some(block) = blocks.get(next) {
                let forces = room_for(&mut forces[next % 2], block);
                eval_block(model, configuration(model, state), block, forces, sweep);
            }
            if let Some(index) = next.checked_sub(1) {
                let block = &blocks[index];
                let (positions, velocities) =
                    (state.positions.slice_mut(block), state.velocities.slice_mut(block));
                let forces = forces[index % 2].slice(&(0..block.len()));
                let from = None;
                let task = MoveBlock { from, particles, steps, block, positions, velocities, forces, wanted };
                moved[index] = model.instructions().run(task);
            }
        }
        combined(&self.moved)
    }

    /// Moves all particles of `state` on this thread, whose positions and velocities are those of `from` if there is one, under
    /// `forces` [N] that are known, and calls `eval` for those where they arrive, at the step's end in time. No pin may move.
    pub(super) fn move_and_eval(
        &mut self,
        model: &Model,
        (state, from): (&mut State, Option<&State>),
        (StepTo { step, time, .. }, wanted): (StepTo, Wanted),
        forces: &mut Points,
        BandMemory { sweep, .. }: &mut BandMemory,
        mut eval: impl FnMut(Configuration<'_>, &Range<usize>, PointsMut<'_>, &mut Sweep),
    ) -> Option<Moved> {
        let steps = Steps { last: state.last_step, next: step };
        (state.time, state.last_step) = (time, step);
        let (particles, blocks) = (model.particles(), model.blocks());
        let moved = self.of_blocks(blocks).values;
        sweep.restart();
        // Forces look at neighbours in the next block at most.
        for next in 0..=blocks.len() {
            if let Some((block, moved)) = blocks.get(next).zip(moved.get_mut(next)) {
                let (positions, velocities) =
                    (state.positions.slice_mut(block), state.velocities.slice_mut(block));
                let forces = forces.slice(block);
                let task = MoveBlock { from, particles, steps, block, positions, velocities, forces, wanted };
                *moved = model.instructions().run(task);
            }
            if let Some(block) = next.checked_sub(1).map(|index| &blocks[index]) {
                eval(configuration(model, state), block, forces.slice_mut(block), sweep);
            }
        }
        combined(&self.moved)
    }

    /// Room for what comes of each of `blocks`.
    fn of_blocks<'a>(&'a mut self, blocks: &'a [Range<usize>]) -> OfBlocks<'a> {
        self.moved.resize(blocks.len(), Moved::default());
        OfBlocks { blocks, values: &mut self.moved }
    }
}

/// The first of `forces`, as many as a `block` has.
fn room_for<'a>(forces: &'a mut Points, block: &Range<usize>) -> PointsMut<'a> {
    if forces.len() < block.len() {
        *forces = Points::zeros(block.len());
    }
    forces.slice_mut(&(0..block.len()))
}

/// What came of moving each of some blocks.
struct OfBlocks<'a> {
    blocks: &'a [Range<usize>],
    values: &'a mut [Moved],
}

impl SplitArrays for OfBlocks<'_> {
    fn split_arrays(self, count: usize) -> (Self, Self) {
        let start = self.blocks.first().map_or(0, |block| block.start);
        let first = self.blocks.partition_point(|block| block.start < start + count);
        let (blocks, rest) = self.blocks.split_at(first);
        let (values, other_values) = self.values.split_at_mut(first);
        (Self { blocks, values }, Self { blocks: rest, values: other_values })
    }
}
