//! Bending rigidity of a grid, by second differences.

#[cfg(test)]
mod tests;

use std::ops::Range;

use glam::DVec3;

use super::{Configuration, Family, Force, PotentialEnergies, Sweep};
use crate::model::{Grid, Particles};
use crate::scene::BendingRigidity;
use crate::{Points, PointsMut};

/// Weights of particles in the second difference of three in a line.
const SECOND_DIFFERENCE: [f64; 3] = [1.0, -2.0, 1.0];

/// The rigidity of a grid against bending and twist, per width and so independent of the number of particles.
///
/// With particles x_ij of column i and row j and cells h_x × h_y:
///
/// ```text
/// E = ½ Σ b_x s_j |x_i−1,j − 2 x_ij + x_i+1,j|²        b_x = B_weft h_y / h_x³
///   + ½ Σ b_y s_i |x_i,j−1 − 2 x_ij + x_i,j+1|²        b_y = B_warp h_x / h_y³
///   + ½ Σ d |x_i+1,j+1 − x_i,j+1 − x_i+1,j + x_ij|²    d = 4 D / (h_x h_y)
/// ```
///
/// where s is ½ in lines along an edge, which stand for half a width, and 1 elsewhere. The sums are over all triples in a
/// line and over all cells: no triple reaches beyond an edge, so edges are free of moments. E is quadratic: forces are linear
/// in positions, the tangent is the same everywhere, and a flat sheet has no force however it is placed. It is a rigidity
/// for small angles: over a turn of θ at a particle, the energy is that of the rigidity times (sin(θ/2) / (θ/2))², 0.98 at
/// 30° and 0.91 at 60°.
///
/// Where two particles in a line are pinned and the next is free, as at the edge of a clamp with two rows of pins, the triple
/// around the second pin has twice its weight: its curvature is that of half a cell, from the clamp's edge on. Measured
/// from the second row of pins, a cantilever then has the right length to second order, where it would be half a cell too
/// long.
///
/// Its forces are found with those of the [springs](super::GridSprings) of the grid that it is given to, in the same loops; by
/// itself it finds them from particle to particle, and more slowly.
#[derive(Clone, Debug, PartialEq)]
pub struct GridBending {
    grid: Grid,
    /// b_x, b_y and d [N/m].
    along_columns: f64,
    along_rows: f64,
    twist: f64,
    /// Triples at clamps, as far as they count twice, by the particles around which they are.
    clamps: Vec<Triple>,
}

/// Three particles in a line with the energy ½ c |x₀ − 2 x₁ + x₂|².
#[derive(Clone, Copy, Debug, PartialEq)]
struct Triple {
    particles: [usize; 3],
    coefficient: f64,
}

/// The weights [N/m] with which a particle's force depends on where its neighbours are, relative to it.
///
/// A neighbour's place is in columns and rows; the weights of places outside of the grid are zero.
#[derive(Clone, Copy, Debug)]
struct Weights {
    /// Two and one columns before, one and two after.
    columns: [f64; 4],
    /// Two and one rows before, one and two after.
    rows: [f64; 4],
    /// On the diagonals: one row before and the column before and after, one row after and the same.
    diagonals: [f64; 4],
}

impl GridBending {
    /// The rigidity of `grid`, which has at least two columns and rows, some of whose `particles` are pinned.
    #[must_use]
    pub fn new(grid: Grid, rigidity: BendingRigidity, particles: &Particles) -> Self {
        let (hx, hy) = (grid.column_spacing, grid.row_spacing);
        let mut bending = Self {
            grid,
            along_columns: rigidity.weft * hy / (hx * hx * hx),
            along_rows: rigidity.warp * hx / (hy * hy * hy),
            twist: 4.0 * rigidity.twist / (hx * hy),
            clamps: Vec::new(),
        };
        let mut clamps = Vec::new();
        bending.for_each_triple(|triple| {
            let [before, at, after] = triple.particles.map(|particle| particles.pinned()[particle]);
            if at && before != after {
                clamps.push(triple);
            }
        });
        clamps.sort_by_key(|clamp| clamp.particles[1]);
        bending.clamps = clamps;
        bending
    }

    /// Whether nothing resists bending.
    #[must_use]
    pub fn is_zero(&self) -> bool {
        self.along_columns == 0.0 && self.along_rows == 0.0 && self.twist == 0.0
    }

    /// Calls `visit` with every triple in a line, those along columns first.
    fn for_each_triple(&self, mut visit: impl FnMut(Triple)) {
        let Grid { columns, rows, .. } = self.grid;
        for row in 0..rows {
            let coefficient = self.along_columns * share(row, rows);
            for column in 1..columns.saturating_sub(1) {
                let at = self.grid.particle(column, row);
                visit(Triple { particles: [at - 1, at, at + 1], coefficient });
            }
        }
        for row in 1..rows.saturating_sub(1) {
            for column in 0..columns {
                let at = self.grid.particle(column, row);
                let coefficient = self.along_rows * share(column, columns);
                visit(Triple { particles: [at - columns, at, at + columns], coefficient });
            }
        }
    }

    /// The weights of the neighbours of the particle at `column`, `row`.
    fn weights(&self, column: usize, row: usize) -> Weights {
        let Grid { columns, rows, .. } = self.grid;
        let [across, along] =
            [squared_second_difference(column, columns), squared_second_difference(row, rows)];
        let [cells_across, cells_along] =
            [squared_difference(column, columns), squared_difference(row, rows)];
        let b_x = self.along_columns * share(row, rows);
        let b_y = self.along_rows * share(column, columns);
        // Outer products of the differences across and along; in the middle of each stands its own weight.
        let [left, own_across, right] = cells_across.map(|weight| self.twist * weight);
        let [before, own_along, after] = cells_along;
        Weights {
            columns: [
                b_x * across[0],
                b_x * across[1] + left * own_along,
                b_x * across[3] + right * own_along,
                b_x * across[4],
            ],
            rows: [
                b_y * along[0],
                b_y * along[1] + own_across * before,
                b_y * along[3] + own_across * after,
                b_y * along[4],
            ],
            diagonals: [left * before, right * before, left * after, right * after],
        }
    }

    /// The grid that it is of.
    pub(super) fn grid(&self) -> &Grid {
        &self.grid
    }

    /// b_x, b_y and d [N/m].
    pub(super) fn coefficients(&self) -> [f64; 3] {
        [self.along_columns, self.along_rows, self.twist]
    }

    /// Adds `factor` K x to `sums` for the particles of `block`, with the constant tangent K and `points` x of all
    /// particles.
    fn add_products(&self, points: &Points, factor: f64, block: &Range<usize>, sums: &mut PointsMut<'_>) {
        let Some(rows) = self.grid.block_rows(block) else { return };
        for row in rows {
            for column in 0..self.grid.columns {
                let own = self.grid.particle(column, row);
                let place = points.get(own);
                let mut product = DVec3::ZERO;
                for (other, weight) in self.neighbours(column, row) {
                    product += weight * (points.get(other) - place);
                }
                sums.add(own - block.start, factor * product);
            }
        }
        self.add_clamp_products(points, factor, block, sums);
    }

    /// The part of [`add_products`](Self::add_products) that clamps have because they count twice.
    pub(super) fn add_clamp_products(
        &self,
        points: &Points,
        factor: f64,
        block: &Range<usize>,
        sums: &mut PointsMut<'_>,
    ) {
        for clamp in self.clamps_near(block) {
            let [a, b, c] = clamp.particles.map(|particle| points.get(particle));
            let product = ((a - b) + (c - b)) * (factor * clamp.coefficient);
            for (particle, weight) in clamp.particles.into_iter().zip(SECOND_DIFFERENCE) {
                if block.contains(&particle) {
                    sums.add(particle - block.start, product * weight);
                }
            }
        }
    }

    /// The clamps around particles of `block` and of the rows beside it.
    fn clamps_near(&self, block: &Range<usize>) -> &[Triple] {
        let columns = self.grid.columns;
        let first = self.clamps.partition_point(|clamp| clamp.particles[1] + columns < block.start);
        let end = self.clamps.partition_point(|clamp| clamp.particles[1] < block.end + columns);
        &self.clamps[first..end]
    }

    /// The neighbours of the particle at `column`, `row` with their weights [N/m]; itself, without weight, for those that
    /// it lacks.
    fn neighbours(&self, column: usize, row: usize) -> [(usize, f64); 12] {
        let Weights { columns: across, rows: along, diagonals } = self.weights(column, row);
        let own = self.grid.particle(column, row);
        let place = |columns: isize, rows: isize, weight: f64| {
            let column = column.checked_add_signed(columns).filter(|&column| column < self.grid.columns);
            let row = row.checked_add_signed(rows).filter(|&row| row < self.grid.rows);
            match (column, row) {
                (Some(column), Some(row)) => (self.grid.particle(column, row), weight),
                _ => (own, 0.0),
            }
        };
        [
            place(-2, 0, across[0]),
            place(-1, 0, across[1]),
            place(1, 0, across[2]),
            place(2, 0, across[3]),
            place(0, -2, along[0]),
            place(0, -1, along[1]),
            place(0, 1, along[2]),
            place(0, 2, along[3]),
            place(-1, -1, diagonals[0]),
            place(1, -1, diagonals[1]),
            place(-1, 1, diagonals[2]),
            place(1, 1, diagonals[3]),
        ]
    }
}

/// Share of a width that line `index` of `count` stands for: ½ along an edge.
fn share(index: usize, count: usize) -> f64 {
    if index == 0 || index + 1 == count { 0.5 } else { 1.0 }
}

/// Row `index` of DᵀD, with the second differences D of `count` particles: weights of the particles from two before to two
/// after.
fn squared_second_difference(index: usize, count: usize) -> [f64; 5] {
    let mut weights = [0.0; 5];
    // The particle is at place `own` of the triples around the particle before, itself and the one after.
    for (own, weight) in SECOND_DIFFERENCE.into_iter().enumerate() {
        let centre = (index + 1).checked_sub(own).filter(|&centre| 1 <= centre && centre + 1 < count);
        if centre.is_some() {
            for (other, other_weight) in SECOND_DIFFERENCE.into_iter().enumerate() {
                weights[2 + other - own] += weight * other_weight;
            }
        }
    }
    weights
}

/// Row `index` of DᵀD, with the first differences D of `count` particles: weights of the particle before, itself and the
/// one after.
fn squared_difference(index: usize, count: usize) -> [f64; 3] {
    let [before, after] = [0 < index, index + 1 < count].map(|exists| if exists { 1.0 } else { 0.0 });
    [-before, before + after, -after]
}

impl Force for GridBending {
    fn add_forces(
        &self,
        at: Configuration<'_>,
        block: &Range<usize>,
        forces: &mut PointsMut<'_>,
        _: &mut Sweep,
    ) {
        self.add_products(at.positions, -1.0, block, forces);
    }

    fn add_tangent_products(
        &self,
        _: Configuration<'_>,
        displacements: &Points,
        block: &Range<usize>,
        products: &mut PointsMut<'_>,
    ) {
        self.add_products(displacements, 1.0, block, products);
    }

    /// The sum of the sizes of a particle's row of the tangent, but for what belongs to pins: Gershgorin's theorem.
    fn add_stiffness_bounds(&self, at: Configuration<'_>, block: &Range<usize>, bounds: &mut [f64]) {
        let Some(rows) = self.grid.block_rows(block) else { return };
        let pinned = at.particles.pinned();
        for row in rows {
            for column in 0..self.grid.columns {
                let neighbours = self.neighbours(column, row);
                let own: f64 = neighbours.iter().map(|(_, weight)| weight).sum();
                let others =
                    neighbours.iter().filter(|(place, _)| !pinned[*place]).map(|(_, weight)| weight.abs());
                bounds[self.grid.particle(column, row) - block.start] += own.abs() + others.sum::<f64>();
            }
        }
        for Triple { particles, coefficient } in self.clamps_near(block) {
            for (&particle, weight) in particles.iter().zip(SECOND_DIFFERENCE) {
                if block.contains(&particle) {
                    let others = particles.iter().zip(SECOND_DIFFERENCE);
                    let free = others.filter(|(other, _)| !pinned[**other] || **other == particle);
                    let sum: f64 = free.map(|(_, weight)| weight.abs()).sum();
                    bounds[particle - block.start] += coefficient * weight.abs() * sum;
                }
            }
        }
    }

    fn add_forces_and_varying_bounds(
        &self,
        at: Configuration<'_>,
        block: &Range<usize>,
        forces: &mut PointsMut<'_>,
        _: &mut [f64],
        _: &mut Sweep,
    ) {
        self.add_products(at.positions, -1.0, block, forces);
    }

    fn add_constant_bounds(&self, at: Configuration<'_>, block: &Range<usize>, bounds: &mut [f64]) {
        self.add_stiffness_bounds(at, block, bounds);
    }

    fn has_varying_bounds(&self) -> bool {
        false
    }

    fn add_energies(&self, at: Configuration<'_>, energies: &mut PotentialEnergies) {
        let mut energy = 0.0;
        let mut add = |triple: Triple| {
            let [a, b, c] = triple.particles.map(|particle| at.positions.get(particle));
            energy += 0.5 * triple.coefficient * ((a - b) + (c - b)).length_squared();
        };
        self.for_each_triple(&mut add);
        self.clamps.iter().copied().for_each(&mut add);
        for row in 1..self.grid.rows {
            for column in 1..self.grid.columns {
                let [[a, b], [c, d]] = [row - 1, row].map(|row| {
                    [column - 1, column].map(|column| at.positions.get(self.grid.particle(column, row)))
                });
                energy += 0.5 * self.twist * ((a - b) - (c - d)).length_squared();
            }
        }
        energies.elastic[Family::Bend as usize] += energy;
    }
}
