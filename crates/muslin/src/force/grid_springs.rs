//! All springs of a grid.

use std::ops::Range;

use super::grid_stiffness::AddTensors;
use super::grid_strains::{self, RaiseMaxStrains};
use super::law::{LawVisitor, SpringLaw, TensionLaw};
use super::row_sweep::RowSweep;
use super::spring::{Spring, SpringLength};
use super::{
    Configuration, Family, Force, PotentialEnergies, SpringEnds, StiffnessTensorsMut, StrainSums, Sweep,
};
use crate::InstructionSet;
use crate::model::Grid;
use crate::scene::{ForceDirection, SpringsFabric};
use crate::{Points, PointsMut};

/// The structural, shear and bend springs of one grid.
///
/// A particle has up to twelve neighbours at fixed places in the grid, so there are no index arrays: loops run over a
/// row of particles and the row of their neighbours. A family without stiffness has no springs.
#[derive(Clone, Debug)]
pub struct GridSprings {
    pub(super) grid: Grid,
    pub(super) families: Vec<GridFamily>,
    instructions: InstructionSet,
}

/// The springs of one family: a law and the places of the neighbours.
#[derive(Clone, Debug)]
pub(super) struct GridFamily {
    pub(super) family: Family,
    pub(super) law: SpringLaw,
    direction: ForceDirection,
    neighbours: Vec<Neighbour>,
    /// Rest lengths [m] of the two springs that each particle has.
    rest_lengths: [f64; 2],
}

/// A neighbour's place in the grid, relative to a particle's.
#[derive(Clone, Copy, Debug)]
struct Neighbour {
    columns: isize,
    rows: isize,
    rest_length: f64,
}

/// The particles of one row that have a certain neighbour, and the row of these neighbours.
pub(super) struct RowPair {
    pub(super) own: Range<usize>,
    pub(super) other: Range<usize>,
}

impl GridSprings {
    /// The springs that `fabric` gives `grid`, evaluated with `instructions`.
    #[must_use]
    pub fn new(grid: Grid, fabric: &SpringsFabric, instructions: InstructionSet) -> Self {
        let families = [
            (Family::Structural, &fabric.structural, [(-1, 0), (1, 0), (0, -1), (0, 1)]),
            (Family::Shear, &fabric.shear, [(-1, -1), (1, -1), (-1, 1), (1, 1)]),
            (Family::Bend, &fabric.bend, [(-2, 0), (2, 0), (0, -2), (0, 2)]),
        ];
        let families = families
            .into_iter()
            .filter(|(_, settings, _)| settings.has_springs())
            .map(|(family, settings, places)| {
                let neighbours = places.map(|(columns, rows)| Neighbour::new(&grid, columns, rows));
                GridFamily {
                    family,
                    law: SpringLaw::new(settings),
                    direction: fabric.force_direction,
                    rest_lengths: [neighbours[1].rest_length, neighbours[3].rest_length],
                    neighbours: neighbours.to_vec(),
                }
            })
            .collect();
        Self { grid, families, instructions }
    }

    /// Calls `visit` with family, the pairs of rows and the rest length, once for every spring.
    #[inline(always)]
    pub(super) fn for_each_spring_row(&self, mut visit: impl FnMut(&GridFamily, RowPair, f64)) {
        for family in &self.families {
            for row in 0..self.grid.rows {
                for neighbour in family.neighbours.iter().filter(|neighbour| neighbour.is_ahead()) {
                    if let Some(pair) = neighbour.row_pair(&self.grid, row) {
                        visit(family, pair, neighbour.rest_length);
                    }
                }
            }
        }
    }

    /// Calls `visit` with family and springs for every row of particles of `block` and each of their neighbours.
    fn for_each_row(
        &self,
        at: Configuration<'_>,
        block: &Range<usize>,
        mut visit: impl FnMut(&GridFamily, SpringRow<'_>),
    ) {
        let Some(rows) = self.grid.block_rows(block) else { return };
        for family in &self.families {
            for row in rows.clone() {
                for neighbour in &family.neighbours {
                    if let Some(pair) = &neighbour.row_pair(&self.grid, row) {
                        let (rest_length, direction) = (neighbour.rest_length, family.direction);
                        let offset = block.start;
                        visit(family, SpringRow { at, pair, offset, rest_length, direction });
                    }
                }
            }
        }
    }

    /// Calls `visit` with family, particle, neighbour and rest length, for the neighbours of each particle of `block`.
    fn for_each_neighbour(
        &self,
        block: &Range<usize>,
        mut visit: impl FnMut(&GridFamily, usize, usize, f64),
    ) {
        let Some(rows) = self.grid.block_rows(block) else { return };
        for family in &self.families {
            for row in rows.clone() {
                for neighbour in &family.neighbours {
                    if let Some(pair) = neighbour.row_pair(&self.grid, row) {
                        for (own, other) in pair.own.zip(pair.other) {
                            visit(family, own, other, neighbour.rest_length);
                        }
                    }
                }
            }
        }
    }
}

impl GridFamily {
    /// Whether its springs are equally stiff at all lengths: along its current length a linear spring is k stiff, and
    /// across it k (1 − L / ℓ), which is less.
    pub(super) fn has_constant_stiffness(&self) -> bool {
        self.law.is_linear() && self.direction == ForceDirection::CurrentLength
    }

    /// A spring of the family's first or second [direction](RowSweep), under its `law`.
    #[inline(always)]
    pub(super) fn spring_of<L: TensionLaw>(&self, law: L, index: usize) -> Spring<L> {
        Spring { law, rest_length: self.rest_lengths[index], direction: self.direction }
    }

    /// A spring of `rest_length` [m].
    pub(super) fn spring(&self, rest_length: f64) -> Spring<&SpringLaw> {
        Spring { law: &self.law, rest_length, direction: self.direction }
    }
}

impl Neighbour {
    fn new(grid: &Grid, columns: isize, rows: isize) -> Self {
        let [across, along] = [columns as f64 * grid.column_spacing, rows as f64 * grid.row_spacing];
        Self { columns, rows, rest_length: (across * across + along * along).sqrt() }
    }

    /// Whether this end numbers the spring: one of two opposite neighbours does.
    fn is_ahead(&self) -> bool {
        0 < self.rows || (self.rows == 0 && 0 < self.columns)
    }

    /// The particles of `row` that have this neighbour, or `None` if there are none.
    fn row_pair(&self, grid: &Grid, row: usize) -> Option<RowPair> {
        let other_row = row.checked_add_signed(self.rows).filter(|&other| other < grid.rows)?;
        let first = self.columns.min(0).unsigned_abs();
        let end = grid.columns.checked_sub(self.columns.max(0).unsigned_abs()).filter(|&end| first < end)?;
        let start = grid.particle(first, row);
        let other_start = grid.particle(first.checked_add_signed(self.columns)?, other_row);
        let count = end - first;
        Some(RowPair { own: start..start + count, other: other_start..other_start + count })
    }
}

/// One row of springs from `own` to `other` particles; `offset` is the first particle of the arrays that are added to.
#[derive(Clone, Copy)]
pub(super) struct SpringRow<'a> {
    pub(super) at: Configuration<'a>,
    pub(super) pair: &'a RowPair,
    offset: usize,
    rest_length: f64,
    direction: ForceDirection,
}

impl SpringRow<'_> {
    pub(super) fn spring<L: TensionLaw>(&self, law: L) -> Spring<L> {
        Spring { law, rest_length: self.rest_length, direction: self.direction }
    }

    /// Where the springs' own particles are in the arrays that are added to.
    pub(super) fn target(&self) -> Range<usize> {
        self.pair.own.start - self.offset..self.pair.own.end - self.offset
    }

    /// Positions of the particles `range`, coordinate by coordinate.
    #[inline(always)]
    pub(super) fn positions(&self, range: &Range<usize>) -> [&[f64]; 3] {
        let Points { x, y, z } = self.at.positions;
        [x, y, z].map(|values| &values[range.clone()])
    }
}

/// Adds the stiffness bounds of a row of springs.
struct AddBounds<'a> {
    row: SpringRow<'a>,
    bounds: &'a mut [f64],
}

impl LawVisitor for AddBounds<'_> {
    fn visit<L: TensionLaw>(self, law: L) {
        let Self { row, bounds } = self;
        let spring = row.spring(law);
        let pinned = row.at.particles.pinned();
        let ends = row.pair.own.clone().zip(row.pair.other.clone());
        for (bound, (own, other)) in bounds[row.target()].iter_mut().zip(ends) {
            let length = SpringLength::of(row.at.positions.get(other) - row.at.positions.get(own));
            let (_, stiffness) = spring.coefficient_and_stiffness(length);
            *bound += columns(pinned[other]) * stiffness;
        }
    }
}

/// How many columns of a particle's row of the tangent a spring fills: its own, and its neighbour's unless that is pinned.
#[inline(always)]
pub(super) fn columns(is_neighbour_pinned: bool) -> f64 {
    if is_neighbour_pinned { 1.0 } else { 2.0 }
}

impl Force for GridSprings {
    fn add_forces(
        &self,
        at: Configuration<'_>,
        block: &Range<usize>,
        forces: &mut PointsMut<'_>,
        sweep: &mut Sweep,
    ) {
        let Some(rows) = self.grid.block_rows(block) else { return };
        self.instructions.run(RowSweep { springs: self, at, rows, forces, bounds: None, sweep });
    }

    fn add_stiffness_bounds(&self, at: Configuration<'_>, block: &Range<usize>, bounds: &mut [f64]) {
        self.for_each_row(at, block, |family, row| family.law.visit(AddBounds { row, bounds }));
    }

    fn add_stiffness_tensors(
        &self,
        at: Configuration<'_>,
        block: &Range<usize>,
        tensors: &mut StiffnessTensorsMut<'_>,
    ) {
        self.for_each_row(at, block, |family, row| family.law.visit(AddTensors { row, tensors }));
    }

    fn add_forces_and_varying_bounds(
        &self,
        at: Configuration<'_>,
        block: &Range<usize>,
        forces: &mut PointsMut<'_>,
        bounds: &mut [f64],
        sweep: &mut Sweep,
    ) {
        let Some(rows) = self.grid.block_rows(block) else { return };
        let bounds = self.has_varying_bounds().then_some(bounds);
        self.instructions.run(RowSweep { springs: self, at, rows, forces, bounds, sweep });
    }

    fn add_constant_bounds(&self, at: Configuration<'_>, block: &Range<usize>, bounds: &mut [f64]) {
        self.for_each_row(at, block, |family, row| {
            if family.has_constant_stiffness() {
                family.law.visit(AddBounds { row, bounds });
            }
        });
    }

    fn has_varying_bounds(&self) -> bool {
        !self.families.iter().all(GridFamily::has_constant_stiffness)
    }

    fn add_tangent_products(
        &self,
        at: Configuration<'_>,
        displacements: &Points,
        block: &Range<usize>,
        products: &mut PointsMut<'_>,
    ) {
        self.for_each_neighbour(block, |family, own, other, rest_length| {
            let vector = at.positions.get(other) - at.positions.get(own);
            let displacement = displacements.get(own) - displacements.get(other);
            let product = family.spring(rest_length).tangent_product(vector, displacement);
            products.add(own - block.start, product);
        });
    }

    fn add_energies(&self, at: Configuration<'_>, energies: &mut PotentialEnergies) {
        self.for_each_spring_row(|family, pair, rest_length| {
            for (own, other) in pair.own.zip(pair.other) {
                let length = at.positions.get(own).distance(at.positions.get(other));
                energies.elastic[family.family as usize] += family.spring(rest_length).energy(length);
            }
        });
    }

    fn spring_counts(&self) -> [u64; 3] {
        let mut counts = [0; 3];
        self.for_each_spring_row(|family, pair, _| counts[family.family as usize] += pair.own.len() as u64);
        counts
    }

    fn visit_springs(&self, visit: &mut dyn FnMut(SpringEnds)) {
        self.for_each_spring_row(|family, pair, rest_length| {
            for (own, other) in pair.own.zip(pair.other) {
                visit(SpringEnds { family: family.family, particles: [own, other], rest_length });
            }
        });
    }

    fn add_strains(&self, at: Configuration<'_>, strains: &mut [StrainSums; 3]) {
        grid_strains::add_strains(self, at.positions, strains);
    }

    fn raise_max_strains(&self, at: Configuration<'_>, max_strains: &mut [f64; 3]) {
        self.instructions.run(RaiseMaxStrains { springs: self, positions: at.positions, max_strains });
    }

    fn eval_particle_strains(&self, at: Configuration<'_>, strains: &mut [f32]) {
        grid_strains::eval_particle_strains(self, at.positions, strains);
    }
}
