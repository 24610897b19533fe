//! Internal friction of a grid.

mod limit;
mod of_measured;
mod stops;

use std::ops::Range;

use limit::FrictionLimit;
use stops::Stops;

use super::elements::{CHUNK, Chunk, GridElements, Segment};
use super::{Configuration, Family, Force, PotentialEnergies, StiffnessTensorsMut, Sweep};
use crate::instructions::Vectorise;
use crate::{InstructionSet, Points, PointsMut};

/// Friction inside of a cloth that does not depend on speed, along one coordinate of its grid: in shear, along yarns, or in
/// bending.
///
/// Each element is a stop of Prandtl and Ishlinskii: a spring whose other end slips once its force would exceed a limit Y. It remembers
/// its slip, one value that belongs to the particle that owns the element. Forces along the coordinate act on the element's
/// particles by its gradients, so that there is neither a net force nor a moment, nor any force in rigid motion.
///
/// To bounds, elements are as stiff as those that hold, whether they do or not, since they may at any time; how their forces turn with
/// the cloth is in no tangent and in no bound, since friction is small against what it turns with.
#[derive(Clone, Debug, PartialEq)]
pub struct GridFriction {
    elements: GridElements,
    /// Stiffness k of an element that holds, along its coordinate.
    stiffness: f64,
    /// 1/k.
    compliance: f64,
    limit: FrictionLimit,
    /// The layer of memory that holds the slips.
    layer: usize,
    /// The family whose energy the energy is added to.
    family: Family,
    instructions: InstructionSet,
}

impl GridFriction {
    /// Layers of memory of a whole configuration or of a block.
    fn layers(memory: &[f64], particles: usize) -> usize {
        memory.len().checked_div(particles).unwrap_or(0)
    }

    /// Where the slips of `segment` begin in a whole memory, or one that begins with particle `first`.
    #[inline(always)]
    fn slips_start(&self, segment: &Segment, first: usize, layers: usize) -> usize {
        segment.memory(&self.elements.grid, first, layers, self.layer).start
    }

    /// Energy [J] that all elements hold.
    fn energy(&self, at: Configuration<'_>) -> f64 {
        let (mut chunk, mut copy, mut energies) = (Chunk::EMPTY, [0.0; CHUNK], [0.0; CHUNK]);
        let layers = Self::layers(at.memory, at.particles.len());
        for segment in self.elements.all() {
            chunk.eval_coordinates(&self.elements, &segment, at.positions, at.particles);
            let start = self.slips_start(&segment, 0, layers);
            let slips = slips(at.memory, start, chunk.padded_len(), &mut copy);
            Stops { friction: self, chunk: &chunk, slips }.add_energies(&mut energies);
        }
        energies.iter().sum()
    }

    /// Adds forces [N] on the particles of `block`, and stiffness bounds [N/m] if they are asked for.
    fn add(
        &self,
        at: Configuration<'_>,
        block: &Range<usize>,
        forces: &mut PointsMut<'_>,
        bounds: Option<&mut [f64]>,
    ) {
        self.instructions.run(AddFriction { friction: self, at, block, forces, bounds });
    }
}

/// Adds the forces of friction, and its stiffness bounds.
struct AddFriction<'a, 'b> {
    friction: &'a GridFriction,
    at: Configuration<'a>,
    block: &'a Range<usize>,
    forces: &'a mut PointsMut<'b>,
    bounds: Option<&'a mut [f64]>,
}

impl Vectorise for AddFriction<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { friction, at, block, forces, mut bounds } = self;
        let Some(rows) = friction.elements.grid.block_rows(block) else { return };
        let (mut chunk, mut copy, mut factors) = (Chunk::EMPTY, [0.0; CHUNK], [0.0; CHUNK]);
        let layers = GridFriction::layers(at.memory, at.particles.len());
        for segment in friction.elements.touching(block) {
            chunk.eval(&friction.elements, &segment, at.positions, at.particles);
            let start = friction.slips_start(&segment, 0, layers);
            let slips = slips(at.memory, start, chunk.padded_len(), &mut copy);
            Stops { friction, chunk: &chunk, slips }.eval_factors(&mut factors);
            chunk.add_gradients(&factors, &rows, block.start, forces);
            if let Some(bounds) = bounds.as_deref_mut() {
                let pinned = at.particles.pinned();
                chunk.add_bounds(&chunk.shares_of(friction.stiffness), pinned, &rows, block.start, bounds);
            }
        }
    }
}

/// `count` slips from `start` on in `memory`, or in a `copy` with zeros where it has none: loops run past the end.
#[inline(always)]
fn slips<'a>(memory: &'a [f64], start: usize, count: usize, copy: &'a mut [f64; CHUNK]) -> &'a [f64] {
    if let Some(slips) = memory.get(start..start + count) {
        return slips;
    }
    let there = memory.get(start..).unwrap_or(&[]);
    copy.fill(0.0);
    copy[..there.len()].copy_from_slice(there);
    &copy[..count]
}

impl Force for GridFriction {
    fn add_forces(
        &self,
        at: Configuration<'_>,
        block: &Range<usize>,
        forces: &mut PointsMut<'_>,
        _: &mut Sweep,
    ) {
        self.add(at, block, forces, None);
    }

    fn add_forces_and_varying_bounds(
        &self,
        at: Configuration<'_>,
        block: &Range<usize>,
        forces: &mut PointsMut<'_>,
        bounds: &mut [f64],
        _: &mut Sweep,
    ) {
        self.add(at, block, forces, Some(bounds));
    }

    fn add_stiffness_bounds(&self, at: Configuration<'_>, block: &Range<usize>, bounds: &mut [f64]) {
        let Some(rows) = self.elements.grid.block_rows(block) else { return };
        let mut chunk = Chunk::EMPTY;
        for segment in self.elements.touching(block) {
            chunk.eval(&self.elements, &segment, at.positions, at.particles);
            let pinned = at.particles.pinned();
            chunk.add_bounds(&chunk.shares_of(self.stiffness), pinned, &rows, block.start, bounds);
        }
    }

    fn add_stiffness_tensors(
        &self,
        at: Configuration<'_>,
        block: &Range<usize>,
        tensors: &mut StiffnessTensorsMut<'_>,
        _sweep: &mut Sweep,
    ) {
        let Some(rows) = self.elements.grid.block_rows(block) else { return };
        let mut chunk = Chunk::EMPTY;
        for segment in self.elements.touching(block) {
            chunk.eval(&self.elements, &segment, at.positions, at.particles);
            let pinned = at.particles.pinned();
            chunk.add_tensors(&chunk.shares_of(self.stiffness), pinned, &rows, block.start, tensors);
        }
    }

    fn add_tangent_products(
        &self,
        at: Configuration<'_>,
        displacements: &Points,
        block: &Range<usize>,
        products: &mut PointsMut<'_>,
    ) {
        let Some(rows) = self.elements.grid.block_rows(block) else { return };
        let (mut chunk, mut copy, mut factors) = (Chunk::EMPTY, [0.0; CHUNK], [0.0; CHUNK]);
        let layers = Self::layers(at.memory, at.particles.len());
        for segment in self.elements.touching(block) {
            chunk.eval(&self.elements, &segment, at.positions, at.particles);
            chunk.eval_rates(displacements, &mut factors);
            let start = self.slips_start(&segment, 0, layers);
            let slips = slips(at.memory, start, chunk.padded_len(), &mut copy);
            Stops { friction: self, chunk: &chunk, slips }.multiply_by_tangents(&mut factors);
            chunk.add_gradients(&factors, &rows, block.start, products);
        }
    }

    fn memory_layers(&self) -> usize {
        self.layer + 1
    }

    fn advance_memory(&self, at: Configuration<'_>, block: &Range<usize>, memory: &mut [f64]) -> f64 {
        self.instructions.run(AdvanceMemory { friction: self, at, block, memory })
    }

    fn add_energies(&self, at: Configuration<'_>, energies: &mut PotentialEnergies) {
        energies.elastic[self.family as usize] += self.energy(at);
    }
}

/// Brings the slips of a block up to date.
struct AdvanceMemory<'a> {
    friction: &'a GridFriction,
    at: Configuration<'a>,
    block: &'a Range<usize>,
    memory: &'a mut [f64],
}

impl Vectorise for AdvanceMemory<'_> {
    type Output = f64;

    #[inline(always)]
    fn run(self) -> f64 {
        let Self { friction, at, block, memory } = self;
        let layers = GridFriction::layers(memory, block.len());
        let (mut chunk, mut copy) = (Chunk::EMPTY, [0.0; CHUNK]);
        let (mut slipped, mut losses) = ([0.0; CHUNK], [0.0; CHUNK]);
        for segment in friction.elements.owned(block) {
            chunk.eval_coordinates(&friction.elements, &segment, at.positions, at.particles);
            let start = friction.slips_start(&segment, block.start, layers);
            let slips = slips(memory, start, chunk.padded_len(), &mut copy);
            Stops { friction, chunk: &chunk, slips }.slip(&mut slipped, &mut losses);
            memory[start..start + chunk.len()].copy_from_slice(&slipped[..chunk.len()]);
        }
        losses.iter().sum()
    }
}
