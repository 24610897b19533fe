//! Internal friction of a grid.

mod of_measured;

use std::ops::Range;

use super::elements::{CHUNK, Chunk, GridElements, Segment};
use super::law::{LawVisitor, SpringLaw, TensionLaw};
use super::stop::Stop;
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
    limit: FrictionLimit,
    /// The layer of memory that holds the slips.
    layer: usize,
    /// The family whose energy the energy is added to.
    family: Family,
    instructions: InstructionSet,
}

/// The force Y along the coordinate q at which an element slips.
#[derive(Clone, Debug, PartialEq)]
enum FrictionLimit {
    /// Y = Y₀ + c |q|
    Affine { at_rest: f64, growth: f64 },
    /// Y = μ f(q) in tension, none in compression, with the elastic tension f [N] along the yarns.
    Tension { law: SpringLaw, ratio: f64, rest_length: f64 },
}

impl FrictionLimit {
    /// Overwrites `limits` with Y and `growths` with dY/dq at `coordinates`.
    #[inline(always)]
    fn eval(&self, coordinates: &[f64], limits: &mut [f64; CHUNK], growths: &mut [f64; CHUNK]) {
        match self {
            Self::Affine { at_rest, growth } => {
                for i in 0..coordinates.len() {
                    limits[i] = at_rest + growth * coordinates[i].abs();
                    growths[i] = if coordinates[i] < 0.0 { -growth } else { *growth };
                }
            }
            Self::Tension { law, ratio, rest_length } => law.visit(EvalTensions {
                coordinates,
                limits,
                growths,
                ratio: *ratio,
                rest_length: *rest_length,
            }),
        }
    }
}

/// Evaluates limits in proportion to a tension.
struct EvalTensions<'a> {
    coordinates: &'a [f64],
    limits: &'a mut [f64; CHUNK],
    growths: &'a mut [f64; CHUNK],
    ratio: f64,
    rest_length: f64,
}

impl LawVisitor for EvalTensions<'_> {
    #[inline(always)]
    fn visit<L: TensionLaw>(self, law: L) {
        for i in 0..self.coordinates.len() {
            let (tension, tangent) = law.tension_and_tangent(self.coordinates[i], self.rest_length);
            let share = if 0.0 < self.coordinates[i] { self.ratio } else { 0.0 };
            self.limits[i] = share * tension;
            self.growths[i] = share * tangent;
        }
    }
}

/// Elements of a segment with their stops.
struct Stops {
    chunk: Chunk,
    stiffnesses: [f64; CHUNK],
    limits: [f64; CHUNK],
    growths: [f64; CHUNK],
}

impl Stops {
    /// Room for stops.
    #[inline(always)]
    fn empty() -> Self {
        let [stiffnesses, limits, growths] = [[0.0; CHUNK]; 3];
        Self { chunk: Chunk::empty(), stiffnesses, limits, growths }
    }

    /// Becomes those of `friction` in `segment`.
    #[inline(always)]
    fn eval(&mut self, friction: &GridFriction, at: Configuration<'_>, segment: &Segment) {
        let Self { chunk, stiffnesses, limits, growths } = self;
        chunk.eval(&friction.elements, segment, at.positions, at.particles);
        let count = chunk.len();
        friction.limit.eval(&chunk.coordinates[..count], limits, growths);
        for i in 0..count {
            stiffnesses[i] = friction.stiffness * chunk.shares[i];
            limits[i] *= segment.share;
            growths[i] *= segment.share;
        }
    }

    /// One of them, with its slip.
    #[inline(always)]
    fn stop(&self, i: usize, slip: f64) -> Stop {
        Stop { stiffness: self.stiffnesses[i], slip, limit: self.limits[i] }
    }
}

impl GridFriction {
    /// Layers of memory of a whole configuration or of a block.
    fn layers(memory: &[f64], particles: usize) -> usize {
        memory.len().checked_div(particles).unwrap_or(0)
    }

    /// The slips of `segment`; none if nothing is remembered.
    #[inline(always)]
    fn slips<'a>(&self, at: Configuration<'a>, segment: &Segment) -> &'a [f64] {
        let layers = Self::layers(at.memory, at.particles.len());
        at.memory.get(segment.memory(&self.elements.grid, 0, layers, self.layer)).unwrap_or(&[])
    }

    /// Calls `visit` with the stops of every element, its number among those of its segment and its coordinate.
    fn for_each_stop(&self, at: Configuration<'_>, mut visit: impl FnMut(Stop, f64)) {
        let mut stops = Stops::empty();
        for segment in self.elements.all() {
            stops.eval(self, at, &segment);
            let slips = self.slips(at, &segment);
            for i in 0..stops.chunk.len() {
                let slip = slips.get(i).copied().unwrap_or(0.0);
                visit(stops.stop(i, slip), stops.chunk.coordinates[i]);
            }
        }
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
        let (mut stops, mut slips, mut factors) = (Stops::empty(), [0.0; CHUNK], [0.0; CHUNK]);
        for segment in friction.elements.touching(block) {
            stops.eval(friction, at, &segment);
            let known = friction.slips(at, &segment);
            slips[..known.len()].copy_from_slice(known);
            for i in 0..stops.chunk.len() {
                factors[i] = -stops.stop(i, slips[i]).force(stops.chunk.coordinates[i]);
            }
            stops.chunk.add_gradients(&factors, &rows, block.start, forces);
            if let Some(bounds) = bounds.as_deref_mut() {
                let pinned = at.particles.pinned();
                stops.chunk.add_bounds(&stops.stiffnesses, pinned, &rows, block.start, bounds);
            }
        }
    }
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
        let mut stops = Stops::empty();
        for segment in self.elements.touching(block) {
            stops.eval(self, at, &segment);
            let pinned = at.particles.pinned();
            stops.chunk.add_bounds(&stops.stiffnesses, pinned, &rows, block.start, bounds);
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
        let mut stops = Stops::empty();
        for segment in self.elements.touching(block) {
            stops.eval(self, at, &segment);
            let pinned = at.particles.pinned();
            stops.chunk.add_tensors(&stops.stiffnesses, pinned, &rows, block.start, tensors);
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
        let (mut stops, mut factors) = (Stops::empty(), [0.0; CHUNK]);
        for segment in self.elements.touching(block) {
            stops.eval(self, at, &segment);
            stops.chunk.eval_rates(displacements, &mut factors);
            let slips = self.slips(at, &segment);
            for (i, factor) in factors.iter_mut().enumerate().take(stops.chunk.len()) {
                let stop = stops.stop(i, slips.get(i).copied().unwrap_or(0.0));
                *factor *= stop.tangent(stops.chunk.coordinates[i], stops.growths[i]);
            }
            stops.chunk.add_gradients(&factors, &rows, block.start, products);
        }
    }

    fn memory_layers(&self) -> usize {
        self.layer + 1
    }

    fn advance_memory(&self, at: Configuration<'_>, block: &Range<usize>, memory: &mut [f64]) -> f64 {
        self.instructions.run(AdvanceMemory { friction: self, at, block, memory })
    }

    fn add_energies(&self, at: Configuration<'_>, energies: &mut PotentialEnergies) {
        let mut energy = 0.0;
        self.for_each_stop(at, |stop, coordinate| energy += stop.energy(coordinate));
        energies.elastic[self.family as usize] += energy;
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
        let grid = &friction.elements.grid;
        let (mut stops, mut lost) = (Stops::empty(), 0.0);
        for segment in friction.elements.owned(block) {
            stops.eval(friction, at, &segment);
            let slips = &mut memory[segment.memory(grid, block.start, layers, friction.layer)];
            for (i, slip) in slips.iter_mut().enumerate() {
                let stop = stops.stop(i, *slip);
                let slipped = stop.slipped(stops.chunk.coordinates[i]);
                lost += if slipped == *slip { 0.0 } else { stop.loss(slipped, stops.growths[i]) };
                *slip = slipped;
            }
        }
        lost
    }
}
