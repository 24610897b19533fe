//! All springs of a grid.

use std::ops::Range;

use super::grid_laws::{GridLaws, Lines, SpringGroup};
use super::law::{LawVisitor, SpringLaw, TensionLaw};
use super::spring::Spring;
use super::{Configuration, Family, Force, PotentialEnergies, SpringEnds, StrainSums};
use crate::model::Grid;
use crate::scene::ForceDirection;
use crate::{Points, PointsMut};

/// Partial results that loops over springs keep side by side, so that the compiler can use vector registers.
const LANES: usize = 8;

/// The structural, shear and bend springs of one grid.
///
/// A particle has up to twelve neighbours at fixed places in the grid, so there are no index arrays: for each neighbour
/// the loop runs over a row of particles and the row of their neighbours. A family without stiffness has no springs.
#[derive(Clone, Debug)]
pub struct GridSprings {
    grid: Grid,
    families: Vec<GridFamily>,
}

/// The springs of one group: a law, the places of the neighbours, and the lines that they lie in.
#[derive(Clone, Debug)]
struct GridFamily {
    family: Family,
    law: SpringLaw,
    direction: ForceDirection,
    neighbours: Vec<Neighbour>,
    lines: Lines,
}

/// A neighbour's place in the grid, relative to a particle's.
#[derive(Clone, Copy, Debug)]
struct Neighbour {
    columns: isize,
    rows: isize,
    rest_length: f64,
}

/// The particles of one row that have a certain neighbour, and the row of these neighbours.
struct RowPair {
    own: Range<usize>,
    other: Range<usize>,
}

impl RowPair {
    /// The springs in `columns`, if there are any.
    fn part(&self, columns: Range<usize>) -> Option<Self> {
        let part = |particles: &Range<usize>| particles.start + columns.start..particles.start + columns.end;
        (!columns.is_empty()).then(|| Self { own: part(&self.own), other: part(&self.other) })
    }
}

impl GridSprings {
    /// The springs of `grid` under `laws`.
    #[must_use]
    pub fn new(grid: Grid, laws: GridLaws) -> Self {
        let direction = laws.direction;
        let groups = laws.groups.into_iter().map(|SpringGroup { family, law, neighbours, lines }| {
            let neighbours =
                neighbours.into_iter().map(|(columns, rows)| Neighbour::new(&grid, columns, rows)).collect();
            GridFamily { family, law, direction, neighbours, lines }
        });
        Self { grid, families: groups.collect() }
    }

    /// Calls `visit` with family, the pairs of rows and the rest length, once for every spring.
    fn for_each_spring_row(&self, mut visit: impl FnMut(&GridFamily, RowPair, f64)) {
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
                        let (rest_length, direction) = (neighbour.rest_length, family.direction);
                        let offset = block.start;
                        visit(family, SpringRow { at, pair: &pair, offset, rest_length, direction });
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
    fn has_constant_stiffness(&self) -> bool {
        self.law.is_linear() && self.direction == ForceDirection::CurrentLength
    }

    /// A spring of `rest_length` [m].
    fn spring(&self, rest_length: f64) -> Spring<&SpringLaw> {
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

    /// The particles of `row` that have this neighbour, as far as the springs between them lie in `lines`.
    fn row_pairs(&self, grid: &Grid, row: usize, lines: Lines) -> impl Iterator<Item = RowPair> + use<> {
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
struct SpringRow<'a> {
    at: Configuration<'a>,
    pair: &'a RowPair,
    offset: usize,
    rest_length: f64,
    direction: ForceDirection,
}

impl SpringRow<'_> {
    fn spring<L: TensionLaw>(&self, law: L) -> Spring<L> {
        Spring { law, rest_length: self.rest_length, direction: self.direction }
    }

    /// Where the springs' own particles are in the arrays that are added to.
    fn target(&self) -> Range<usize> {
        self.pair.own.start - self.offset..self.pair.own.end - self.offset
    }

    /// Positions of the particles `range`, coordinate by coordinate.
    #[inline(always)]
    fn positions(&self, range: &Range<usize>) -> [&[f64]; 3] {
        let Points { x, y, z } = self.at.positions;
        [x, y, z].map(|values| &values[range.clone()])
    }
}

/// Adds the forces of a row of springs.
struct AddForces<'a, 'b> {
    row: SpringRow<'a>,
    forces: &'a mut PointsMut<'b>,
}

impl LawVisitor for AddForces<'_, '_> {
    fn visit<L: TensionLaw>(self, law: L) {
        let Self { row, forces } = self;
        let spring = row.spring(law);
        let (count, target) = (row.pair.own.len(), row.target());
        let [x, y, z] = row.positions(&row.pair.own).map(|values| &values[..count]);
        let [other_x, other_y, other_z] = row.positions(&row.pair.other).map(|values| &values[..count]);
        let force_x = &mut forces.x[target.clone()][..count];
        let force_y = &mut forces.y[target.clone()][..count];
        let force_z = &mut forces.z[target][..count];
        for i in 0..count {
            let [dx, dy, dz] = [other_x[i] - x[i], other_y[i] - y[i], other_z[i] - z[i]];
            let length = (dx * dx + dy * dy + dz * dz).sqrt();
            let coefficient = spring.coefficient(length);
            force_x[i] += coefficient * dx;
            force_y[i] += coefficient * dy;
            force_z[i] += coefficient * dz;
        }
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
            let length = row.at.positions.get(own).distance(row.at.positions.get(other));
            let (_, stiffness) = spring.coefficient_and_stiffness(length);
            *bound += columns(pinned[other]) * stiffness;
        }
    }
}

/// Adds both in one loop.
struct AddForcesAndBounds<'a, 'b> {
    row: SpringRow<'a>,
    forces: &'a mut PointsMut<'b>,
    bounds: &'a mut [f64],
}

impl LawVisitor for AddForcesAndBounds<'_, '_> {
    fn visit<L: TensionLaw>(self, law: L) {
        let Self { row, forces, bounds } = self;
        let spring = row.spring(law);
        let (count, target) = (row.pair.own.len(), row.target());
        let [x, y, z] = row.positions(&row.pair.own).map(|values| &values[..count]);
        let [other_x, other_y, other_z] = row.positions(&row.pair.other).map(|values| &values[..count]);
        let pinned = &row.at.particles.pinned()[row.pair.other.clone()][..count];
        let force_x = &mut forces.x[target.clone()][..count];
        let force_y = &mut forces.y[target.clone()][..count];
        let force_z = &mut forces.z[target.clone()][..count];
        let bounds = &mut bounds[target][..count];
        for i in 0..count {
            let [dx, dy, dz] = [other_x[i] - x[i], other_y[i] - y[i], other_z[i] - z[i]];
            let length = (dx * dx + dy * dy + dz * dz).sqrt();
            let (coefficient, stiffness) = spring.coefficient_and_stiffness(length);
            force_x[i] += coefficient * dx;
            force_y[i] += coefficient * dy;
            force_z[i] += coefficient * dz;
            bounds[i] += columns(pinned[i]) * stiffness;
        }
    }
}

/// How many columns of a particle's row of the tangent a spring fills: its own, and its neighbour's unless that is pinned.
#[inline(always)]
fn columns(is_neighbour_pinned: bool) -> f64 {
    if is_neighbour_pinned { 1.0 } else { 2.0 }
}

/// The largest squared length [m²] of the springs between `own` and `other` particles.
fn max_length_squared(positions: &Points, pair: &RowPair) -> f64 {
    let count = pair.own.len();
    let [x, y, z] =
        [&positions.x, &positions.y, &positions.z].map(|values| &values[pair.own.clone()][..count]);
    let [other_x, other_y, other_z] =
        [&positions.x, &positions.y, &positions.z].map(|values| &values[pair.other.clone()][..count]);
    let length_squared = |i: usize| {
        let [dx, dy, dz] = [other_x[i] - x[i], other_y[i] - y[i], other_z[i] - z[i]];
        dx * dx + dy * dy + dz * dz
    };
    let mut maxima = [0.0_f64; LANES];
    let whole = count - count % LANES;
    for start in (0..whole).step_by(LANES) {
        for (lane, max) in maxima.iter_mut().enumerate() {
            let value = length_squared(start + lane);
            *max = if value > *max { value } else { *max };
        }
    }
    (whole..count).map(length_squared).chain(maxima).fold(0.0, f64::max)
}

impl Force for GridSprings {
    fn add_forces(&self, at: Configuration<'_>, block: &Range<usize>, forces: &mut PointsMut<'_>) {
        self.for_each_row(at, block, |family, row| family.law.visit(AddForces { row, forces }));
    }

    fn add_stiffness_bounds(&self, at: Configuration<'_>, block: &Range<usize>, bounds: &mut [f64]) {
        self.for_each_row(at, block, |family, row| family.law.visit(AddBounds { row, bounds }));
    }

    fn add_forces_and_varying_bounds(
        &self,
        at: Configuration<'_>,
        block: &Range<usize>,
        forces: &mut PointsMut<'_>,
        bounds: &mut [f64],
    ) {
        self.for_each_row(at, block, |family, row| {
            if family.has_constant_stiffness() {
                family.law.visit(AddForces { row, forces });
            } else {
                family.law.visit(AddForcesAndBounds { row, forces, bounds });
            }
        });
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
        self.for_each_spring_row(|family, pair, rest_length| {
            let sums = &mut strains[family.family as usize];
            for (own, other) in pair.own.zip(pair.other) {
                let vector = at.positions.get(other) - at.positions.get(own);
                let strain = strain(vector.length_squared(), rest_length);
                sums.count += 1;
                sums.min = sums.min.min(strain);
                sums.max = sums.max.max(strain);
                sums.sum += strain;
            }
        });
    }

    fn raise_max_strains(&self, at: Configuration<'_>, max_strains: &mut [f64; 3]) {
        self.for_each_spring_row(|family, pair, rest_length| {
            let max = &mut max_strains[family.family as usize];
            *max = max.max(strain(max_length_squared(at.positions, &pair), rest_length));
        });
    }

    fn eval_particle_strains(&self, at: Configuration<'_>, strains: &mut [f32]) {
        let mut raise = |particle: usize, value: f64| {
            if f64::from(strains[particle]).abs() < value.abs() {
                strains[particle] = value as f32;
            }
        };
        self.for_each_spring_row(|family, pair, rest_length| {
            if family.family == Family::Structural {
                for (own, other) in pair.own.zip(pair.other) {
                    let vector = at.positions.get(other) - at.positions.get(own);
                    let value = strain(vector.length_squared(), rest_length);
                    raise(own, value);
                    raise(other, value);
                }
            }
        });
    }
}

/// Strain e = ℓ / L − 1 [1] from the squared length [m²] and the rest length [m].
fn strain(length_squared: f64, rest_length: f64) -> f64 {
    (length_squared.sqrt() - rest_length) / rest_length
}
