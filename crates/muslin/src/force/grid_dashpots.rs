//! Internal damping of a grid.

use std::ops::Range;

use super::elements::{CHUNK, Chunk, Coordinate, GridElements, Line, Segment};
use super::{Configuration, Force, Sweep};
use crate::instructions::Vectorise;
use crate::model::Grid;
use crate::scene::{MeasuredFabric, SpringsFabric};
use crate::{InstructionSet, PointsMut};

/// Dashpots inside of a cloth, along one coordinate q of its grid: a force against the rate of the coordinate.
///
/// ```text
/// f = c dq/dt        power c (dq/dt)², which is lost
/// ```
///
/// Beside springs along the same coordinate they are those of Kelvin and Voigt. They take no energy from rigid motion, and exert neither
/// a net force nor a net moment.
#[derive(Clone, Debug, PartialEq)]
pub struct GridDashpots {
    elements: GridElements,
    /// Coefficient c [N s] per unit of the coordinate; kg/s along lengths.
    coefficient: f64,
    instructions: InstructionSet,
}

impl GridDashpots {
    /// Those of a fabric of kind `"springs"`: one along each spring of a family that has any.
    #[must_use]
    pub fn of_springs(fabric: &SpringsFabric, grid: Grid, instructions: InstructionSet) -> Vec<Self> {
        let families = [
            (&fabric.structural, [(1, 0), (0, 1)]),
            (&fabric.shear, [(1, 1), (-1, 1)]),
            (&fabric.bend, [(2, 0), (0, 2)]),
        ];
        let damped = families.into_iter().filter(|(springs, _)| 0.0 < springs.damping);
        let dashpots = damped.flat_map(|(springs, places)| {
            places.map(|(columns, rows)| {
                // Rates do not depend on it.
                let coordinate = Coordinate::Extension { columns, rows, rest_length: 0.0 };
                let elements = GridElements { grid, coordinate, has_half_edges: false };
                Self { elements, coefficient: springs.damping, instructions }
            })
        });
        dashpots.collect()
    }

    /// Those of `fabric` on `grid`, which has at least two columns and rows.
    ///
    /// With the retardation times τ and cells h_x × h_y, of which those along edges have half:
    ///
    /// ```text
    /// shear        q = sin γ      c = τ G h_x h_y
    /// weft         q = ℓ − h_x    c = τ K h_y / h_x    with the modulus K at rest
    /// weft, bent   q = κ h_x²     c = τ B h_y / h_x³
    /// ```
    ///
    /// and the same along the warp.
    #[must_use]
    pub fn of_measured(fabric: &MeasuredFabric, grid: Grid, instructions: InstructionSet) -> Vec<Self> {
        let [hx, hy] = [grid.column_spacing, grid.row_spacing];
        let (times, bending) = (fabric.damping, fabric.bending);
        let extension = |columns, rows, rest_length| Coordinate::Extension { columns, rows, rest_length };
        let coefficients = [
            (Coordinate::Shear, times.shear * fabric.shear_modulus * hx * hy),
            (extension(1, 0, hx), times.weft * fabric.weft.slope(0.0) * hy / hx),
            (extension(0, 1, hy), times.warp * fabric.warp.slope(0.0) * hx / hy),
            (Coordinate::Bend(Line::Weft), times.bend * bending.weft * hy / (hx * hx * hx)),
            (Coordinate::Bend(Line::Warp), times.bend * bending.warp * hx / (hy * hy * hy)),
        ];
        let damped = coefficients.into_iter().filter(|(_, coefficient)| 0.0 < *coefficient);
        let dashpots = damped.map(|(coordinate, coefficient)| {
            let has_half_edges = coordinate != Coordinate::Shear;
            let elements = GridElements { grid, coordinate, has_half_edges };
            Self { elements, coefficient, instructions }
        });
        dashpots.collect()
    }

    /// Makes `chunk` the elements of `segment`; their coefficients.
    #[inline(always)]
    fn eval(&self, chunk: &mut Chunk, at: Configuration<'_>, segment: &Segment) -> [f64; CHUNK] {
        chunk.eval(&self.elements, segment, at.positions, at.particles);
        chunk.shares_of(self.coefficient)
    }
}

/// Adds the forces of dashpots on a block.
struct AddDamping<'a, 'b> {
    dashpots: &'a GridDashpots,
    at: Configuration<'a>,
    block: &'a Range<usize>,
    forces: &'a mut PointsMut<'b>,
}

impl Vectorise for AddDamping<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { dashpots, at, block, forces } = self;
        let Some(rows) = dashpots.elements.grid.block_rows(block) else { return };
        let (mut chunk, mut factors) = (Chunk::EMPTY, [0.0; CHUNK]);
        for segment in dashpots.elements.touching(block) {
            let coefficients = dashpots.eval(&mut chunk, at, &segment);
            chunk.eval_rates(at.velocities, &mut factors);
            for (factor, coefficient) in factors.iter_mut().zip(&coefficients) {
                *factor *= -coefficient;
            }
            chunk.add_gradients(&factors, &rows, block.start, forces);
        }
    }
}

impl Force for GridDashpots {
    fn add_forces(
        &self,
        at: Configuration<'_>,
        block: &Range<usize>,
        forces: &mut PointsMut<'_>,
        _: &mut Sweep,
    ) {
        self.instructions.run(AddDamping { dashpots: self, at, block, forces });
    }

    /// Gradients of lengths are unit vectors.
    fn has_varying_bounds(&self) -> bool {
        !matches!(self.elements.coordinate, Coordinate::Extension { .. })
    }

    fn depends_on_velocity(&self) -> bool {
        true
    }

    fn add_damping_bounds(&self, at: Configuration<'_>, block: &Range<usize>, bounds: &mut [f64]) {
        let Some(rows) = self.elements.grid.block_rows(block) else { return };
        let mut chunk = Chunk::EMPTY;
        for segment in self.elements.touching(block) {
            let coefficients = self.eval(&mut chunk, at, &segment);
            chunk.add_bounds(&coefficients, at.particles.pinned(), &rows, block.start, bounds);
        }
    }

    fn damping_power(&self, at: Configuration<'_>) -> f64 {
        let (mut chunk, mut rates, mut power) = (Chunk::EMPTY, [0.0; CHUNK], 0.0);
        for segment in self.elements.all() {
            let coefficients = self.eval(&mut chunk, at, &segment);
            chunk.eval_rates(at.velocities, &mut rates);
            for (coefficient, rate) in coefficients.iter().zip(&rates[..chunk.len()]) {
                power += coefficient * rate * rate;
            }
        }
        power
    }
}
