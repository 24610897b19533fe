//! All springs of a grid, and its rigidity.

use std::ops::Range;

use super::grid_laws::{GridLaws, Lines, SpringGroup};
use super::grid_stiffness::TensorSweep;
use super::grid_strains;
use super::law::{LawVisitor, SpringLaw, TensionLaw};
use super::row_sums::TileBending;
use super::row_sweep::RowSweep;
use super::spring::{Spring, SpringLength};
use super::{
    Configuration, Family, Force, GridBending, PotentialEnergies, SpringEnds, StiffnessTensorsMut,
    StrainSums, Sweep,
};
use crate::InstructionSet;
use crate::model::Grid;
use crate::scene::ForceDirection;
use crate::{Points, PointsMut};

/// The structural, shear and bend springs of one grid, or in place of bend springs its rigidity.
///
/// A particle has up to twelve neighbours at fixed places in the grid, so there are no index arrays: loops run over a
/// row of particles and the row of their neighbours. A family without stiffness has no springs.
#[derive(Clone, Debug)]
pub struct GridSprings {
    pub(super) grid: Grid,
    pub(super) families: Vec<GridFamily>,
    /// Which of them have springs of a family, in the order of [`Family::ALL`], and direction; not those along edges.
    swept: [[Option<usize>; 2]; 3],
    /// Its forces are found with those of the springs. Invariant: there are no bend springs then.
    pub(super) bending: Option<GridBending>,
    instructions: InstructionSet,
}

/// The springs of one group: a law, the places of the neighbours, and the lines that they lie in.
#[derive(Clone, Debug)]
pub(super) struct GridFamily {
    pub(super) family: Family,
    pub(super) law: SpringLaw,
    direction: ForceDirection,
    neighbours: Vec<Neighbour>,
    /// Rest lengths [m] of the springs of the family's first and second direction, where the group has them.
    rest_lengths: [Option<f64>; 2],
    pub(super) lines: Lines,
}

/// A neighbour's place in the grid, relative to a particle's.
#[derive(Clone, Copy, Debug)]
pub(super) struct Neighbour {
    columns: isize,
    rows: isize,
    rest_length: f64,
}

/// The particles of one row that have a certain neighbour, and the row of these neighbours.
pub(super) struct RowPair {
    pub(super) own: Range<usize>,
    pub(super) other: Range<usize>,
}

impl RowPair {
    /// The springs in `columns`, if there are any.
    fn part(&self, columns: Range<usize>) -> Option<Self> {
        let part = |particles: &Range<usize>| particles.start + columns.start..particles.start + columns.end;
        (!columns.is_empty()).then(|| Self { own: part(&self.own), other: part(&self.other) })
    }
}

impl GridSprings {
    /// The springs of `grid` under `laws`, evaluated with `instructions`.
    #[must_use]
    pub fn new(grid: Grid, laws: GridLaws, instructions: InstructionSet) -> Self {
        let direction = laws.direction;
        let groups = laws.groups.into_iter().map(|SpringGroup { family, law, neighbours, lines }| {
            let neighbours: Vec<Neighbour> =
                neighbours.into_iter().map(|(columns, rows)| Neighbour::new(&grid, columns, rows)).collect();
            let ahead = |is_second: bool| {
                let mut ahead = neighbours.iter().filter(|neighbour| neighbour.is_ahead());
                ahead.find(|neighbour| neighbour.is_second() == is_second).map(|found| found.rest_length)
            };
            let rest_lengths = [ahead(false), ahead(true)];
            GridFamily { family, law, direction, neighbours, rest_lengths, lines }
        });
        let families: Vec<GridFamily> = groups.collect();
        let mut swept = [[None; 2]; 3];
        for (index, group) in families.iter().enumerate().filter(|(_, group)| group.lines != Lines::Edges) {
            for (place, rest_length) in swept[group.family as usize].iter_mut().zip(group.rest_lengths) {
                *place = place.or(rest_length.map(|_| index));
            }
        }
        Self { grid, families, swept, bending: None, instructions }
    }

    /// The same with a rigidity against `bending` of the same grid.
    ///
    /// # Panics
    /// If it is of another grid, there are bend springs, or structural springs are not those of inner [lines](Lines) with others
    /// along edges, or shear springs not in all cells: twist is added to the springs of a cell, half as much along edges.
    #[must_use]
    pub fn with_bending(self, bending: GridBending) -> Self {
        assert_eq!(*bending.grid(), self.grid, "a rigidity of another grid");
        assert!(!self.has_bend_springs(), "a grid bends by springs or has a rigidity");
        let swept = self.swept();
        let are_all = |family: Family, lines: Lines| {
            swept[family as usize].iter().flatten().all(|group| group.lines == lines)
        };
        assert!(are_all(Family::Structural, Lines::Inner), "springs along edges are a group of their own");
        assert!(are_all(Family::Shear, Lines::All), "shear springs are in all cells");
        Self { bending: Some(bending), ..self }
    }

    /// What resists bending.
    pub(super) fn tile_bending(&self) -> TileBending {
        match (&self.bending, self.has_bend_springs()) {
            (Some(_), _) => TileBending::Rigidity,
            (None, true) => TileBending::Springs,
            (None, false) => TileBending::None,
        }
    }

    /// Adds forces to all that are swept: where a clamp holds.
    fn add_clamp_forces(&self, at: Configuration<'_>, block: &Range<usize>, forces: &mut PointsMut<'_>) {
        if let Some(bending) = &self.bending {
            bending.add_clamp_forces(at.positions, block, forces);
        }
    }

    /// The groups of springs by family and direction, but for those along edges that are half as stiff as others of their kind.
    pub(super) fn swept(&self) -> [[Option<&GridFamily>; 2]; 3] {
        self.swept.map(|directions| directions.map(|group| group.map(|group| &self.families[group])))
    }

    /// Whether there are springs of the family [`Family::Bend`].
    pub(super) fn has_bend_springs(&self) -> bool {
        self.swept[Family::Bend as usize].iter().any(Option::is_some)
    }

    /// Calls `visit` with family, the pairs of rows and the rest length, once for every spring.
    pub(super) fn for_each_spring_row(&self, mut visit: impl FnMut(&GridFamily, RowPair, f64)) {
        for family in &self.families {
            for row in 0..self.grid.rows {
                for neighbour in family.neighbours.iter().filter(|neighbour| neighbour.is_ahead()) {
                    for pair in neighbour.row_pairs(&self.grid, row, family.lines) {
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
                    for pair in neighbour.row_pairs(&self.grid, row, family.lines) {
                        visit(family, family.row(at, &pair, block.start, neighbour));
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
                    for pair in neighbour.row_pairs(&self.grid, row, family.lines) {
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

    /// The springs of `pair` to a `neighbour`; the arrays that are added to begin with particle `offset`.
    #[inline(always)]
    pub(super) fn row<'a>(
        &self,
        at: Configuration<'a>,
        pair: &'a RowPair,
        offset: usize,
        neighbour: &Neighbour,
    ) -> SpringRow<'a> {
        SpringRow { at, pair, offset, rest_length: neighbour.rest_length, direction: self.direction }
    }

    /// A spring of the family's first or second direction under its `law`, if the group has such springs.
    #[inline(always)]
    pub(super) fn spring_of<L>(&self, law: L, index: usize) -> Option<Spring<L>> {
        self.rest_lengths[index].map(|rest_length| Spring { law, rest_length, direction: self.direction })
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

    /// Whether it is in the second of the two directions that the springs of a family have: down a column, or down and back.
    fn is_second(&self) -> bool {
        self.columns <= 0
    }

    /// Whether this end numbers the spring: one of two opposite neighbours does.
    fn is_ahead(&self) -> bool {
        0 < self.rows || (self.rows == 0 && 0 < self.columns)
    }

    /// The particles of `row` that have this neighbour, as far as the springs between them lie in `lines`.
    #[inline(always)]
    pub(super) fn row_pairs(
        &self,
        grid: &Grid,
        row: usize,
        lines: Lines,
    ) -> impl Iterator<Item = RowPair> + use<> {
        let is_edge = row == 0 || row + 1 == grid.rows;
        let pair = self.row_pair(grid, row);
        let columns = grid.columns;
        let pairs = match (lines, self.rows == 0) {
            (Lines::All, _) => [pair, None],
            (Lines::Inner, true) => [pair.filter(|_| !is_edge), None],
            (Lines::Edges, true) => [pair.filter(|_| is_edge), None],
            (Lines::Inner, false) => [pair.and_then(|pair| pair.part(1..columns.max(2) - 1)), None],
            (Lines::Edges, false) => [
                pair.as_ref().and_then(|pair| pair.part(0..1)),
                pair.and_then(|pair| pair.part(columns.max(2) - 1..columns)),
            ],
        };
        pairs.into_iter().flatten()
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
        self.add_clamp_forces(at, block, forces);
    }

    fn add_stiffness_bounds(&self, at: Configuration<'_>, block: &Range<usize>, bounds: &mut [f64]) {
        self.for_each_row(at, block, |family, row| family.law.visit(AddBounds { row, bounds }));
        self.bending.iter().for_each(|bending| bending.add_stiffness_bounds(at, block, bounds));
    }

    fn add_stiffness_tensors(
        &self,
        at: Configuration<'_>,
        block: &Range<usize>,
        tensors: &mut StiffnessTensorsMut<'_>,
        sweep: &mut Sweep,
    ) {
        let Some(rows) = self.grid.block_rows(block) else { return };
        self.instructions.run(TensorSweep { springs: self, at, rows, tensors, sweep });
        self.bending.iter().for_each(|bending| bending.add_stiffness_tensors(at, block, tensors, sweep));
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
        self.add_clamp_forces(at, block, forces);
    }

    fn add_constant_bounds(&self, at: Configuration<'_>, block: &Range<usize>, bounds: &mut [f64]) {
        self.for_each_row(at, block, |family, row| {
            if family.has_constant_stiffness() {
                family.law.visit(AddBounds { row, bounds });
            }
        });
        self.bending.iter().for_each(|bending| bending.add_constant_bounds(at, block, bounds));
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
        self.bending
            .iter()
            .for_each(|bending| bending.add_tangent_products(at, displacements, block, products));
    }

    fn add_energies(&self, at: Configuration<'_>, energies: &mut PotentialEnergies) {
        self.for_each_spring_row(|family, pair, rest_length| {
            for (own, other) in pair.own.zip(pair.other) {
                let length = at.positions.get(own).distance(at.positions.get(other));
                energies.elastic[family.family as usize] += family.spring(rest_length).energy(length);
            }
        });
        self.bending.iter().for_each(|bending| bending.add_energies(at, energies));
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

    fn eval_particle_strains(&self, at: Configuration<'_>, strains: &mut [f32]) {
        grid_strains::eval_particle_strains(self, at.positions, strains);
    }
}
