//! Bending rigidity of a grid, by second differences.

mod line_rigidity;
#[cfg(test)]
mod tests;

use std::ops::Range;

use glam::DVec3;

pub(super) use self::line_rigidity::LineRigidity;
use super::{Configuration, Family, Force, PotentialEnergies, Sweep};
use crate::model::{Grid, Particles};
use crate::scene::BendingRigidity;
use crate::{Points, PointsMut};

/// Weights of particles in the second difference of three in a line.
const LINE: [f64; 3] = [1.0, -2.0, 1.0];

/// Weights of particles in the mixed difference of a cell, row by row.
const CELL: [f64; 4] = [1.0, -1.0, -1.0, 1.0];

/// The rigidity of a grid against bending and twist, per width and so independent of the number of particles.
///
/// With particles x_ij of column i and row j and cells h_x × h_y:
///
/// ```text
/// E = Σ s_j b_x e(x_i−1,j − 2 x_ij + x_i+1,j, h_x)        b_x = B_weft h_y / h_x³
///   + Σ s_i b_y e(x_i,j−1 − 2 x_ij + x_i,j+1, h_y)        b_y = B_warp h_x / h_y³
///   + ½ Σ d |x_i+1,j+1 − x_i,j+1 − x_i+1,j + x_ij|²       d = 4 D / (h_x h_y)
///
/// e(d, h) = ½ |d|² (1 + |d|² / 12h²)  if |d| ≤ 2h,  5/6 |d|² − 2/3 h²  else
/// ```
///
/// where s is ½ in lines along an edge, which stand for half a width, and 1 elsewhere. The sums are over all triples in a
/// line and over all cells: no triple reaches beyond an edge, so edges are free of moments, and a flat sheet has no force
/// however it is placed. Where a line turns by θ at a particle |d| is 2h sin(θ/2), and the energy that of the rigidity,
/// ½ B θ² / h per width, but for a factor of 0.999 at 30°, 0.988 at 60° and 0.95 at 90°: the moment follows B κ to fourth
/// order in κ h. Only in lines that are folded and stretched can |d| be more than 2h; forces go on there in proportion.
///
/// Where two particles in a line are pinned and the next is free, as at the edge of a clamp with two rows of pins, the triple
/// around the second pin has twice its weight: its curvature is that of half a cell, from the clamp's edge on. Measured
/// from the second row of pins, a cantilever then has the right length to second order, where it would be half a cell too
/// long.
///
/// Its forces are found with those of the [springs](super::GridSprings) of the grid that it is given to, in the same loops; by
/// itself it finds them from triple to triple, and more slowly.
#[derive(Clone, Debug, PartialEq)]
pub struct GridBending {
    grid: Grid,
    /// Of lines along columns and along rows, with b_x and b_y.
    rigidities: [LineRigidity; 2],
    /// d [N/m].
    twist: f64,
    /// Triples at clamps, as far as they count twice, by the particles around which they are.
    clamps: Vec<Triple>,
}

/// Three particles in a line.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Triple {
    particles: [usize; 3],
    rigidity: LineRigidity,
}

impl Triple {
    /// Its second difference d [m].
    fn difference(&self, points: &Points) -> DVec3 {
        let [a, b, c] = self.particles.map(|particle| points.get(particle));
        (a - b) + (c - b)
    }
}

impl GridBending {
    /// The rigidity of `grid`, which has at least two columns and rows, some of whose `particles` are pinned.
    #[must_use]
    pub fn new(grid: Grid, rigidity: BendingRigidity, particles: &Particles) -> Self {
        let (hx, hy) = (grid.column_spacing, grid.row_spacing);
        let rigidities = [LineRigidity::new(rigidity.weft, hy, hx), LineRigidity::new(rigidity.warp, hx, hy)];
        let twist = 4.0 * rigidity.twist / (hx * hy);
        let mut bending = Self { grid, rigidities, twist, clamps: Vec::new() };
        let mut clamps = Vec::new();
        bending.for_each_triple(&(0..grid.rows), |triple| {
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
        self.rigidities.iter().all(|rigidity| rigidity.coefficient == 0.0) && self.twist == 0.0
    }

    /// The grid that it is of.
    pub(super) fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Of lines along columns and along rows that stand for a whole width.
    pub(super) fn rigidities(&self) -> [LineRigidity; 2] {
        self.rigidities
    }

    /// Twist as springs without length beside those inside of a grid: their coefficients [N/m], by family in the order of
    /// [`Family::ALL`].
    ///
    /// The mixed difference of a cell, squared, is the sum of the squares of its four sides less those of its two diagonals;
    /// and sides are shared by two cells.
    pub(super) fn twists(&self) -> [f64; 3] {
        [2.0 * self.twist, -self.twist, 0.0]
    }

    /// Calls `visit` with every triple in a line that has particles in some `rows`, those along columns first.
    fn for_each_triple(&self, rows: &Range<usize>, mut visit: impl FnMut(Triple)) {
        let Grid { columns, rows: count, .. } = self.grid;
        let [across, along] = self.rigidities;
        for row in rows.clone() {
            let rigidity = across.with_coefficient(across.coefficient * share(row, count));
            for column in 1..columns.saturating_sub(1) {
                let at = self.grid.particle(column, row);
                visit(Triple { particles: [at - 1, at, at + 1], rigidity });
            }
        }
        for row in rows.start.saturating_sub(1).max(1)..(rows.end + 1).min(count.saturating_sub(1)) {
            for column in 0..columns {
                let at = self.grid.particle(column, row);
                let rigidity = along.with_coefficient(along.coefficient * share(column, columns));
                visit(Triple { particles: [at - columns, at, at + columns], rigidity });
            }
        }
    }

    /// Calls `visit` with the particles of every cell that has some in `rows`, row by row.
    fn for_each_cell(&self, rows: &Range<usize>, mut visit: impl FnMut([usize; 4])) {
        let Grid { columns, rows: count, .. } = self.grid;
        for row in rows.start.saturating_sub(1)..rows.end.min(count.saturating_sub(1)) {
            for column in 1..columns {
                let at = self.grid.particle(column, row);
                visit([at - 1, at, at + columns - 1, at + columns]);
            }
        }
    }

    /// The clamps around particles of `block` and of the rows beside it.
    fn clamps_near(&self, block: &Range<usize>) -> impl Iterator<Item = Triple> + '_ {
        let columns = self.grid.columns;
        let first = self.clamps.partition_point(|clamp| clamp.particles[1] + columns < block.start);
        let end = self.clamps.partition_point(|clamp| clamp.particles[1] < block.end + columns);
        self.clamps[first..end].iter().copied()
    }

    /// Adds what the clamps near a `block` do because they count twice.
    pub(super) fn add_clamp_forces(&self, points: &Points, block: &Range<usize>, forces: &mut PointsMut<'_>) {
        self.clamps_near(block).for_each(|clamp| add_force(&clamp, points, block, forces));
    }
}

/// Adds the force of a `triple` to those on the particles of `block`.
fn add_force(triple: &Triple, points: &Points, block: &Range<usize>, forces: &mut PointsMut<'_>) {
    let difference = triple.difference(points);
    let force = -triple.rigidity.force_coefficient(difference.length_squared()) * difference;
    add_to_block((triple.particles, LINE), force, block, forces);
}

/// Adds a `value` to the `sums` of the particles of `block`, by their weights.
fn add_to_block<const N: usize>(
    (particles, weights): ([usize; N], [f64; N]),
    value: DVec3,
    block: &Range<usize>,
    sums: &mut PointsMut<'_>,
) {
    for (particle, weight) in particles.into_iter().zip(weights) {
        if block.contains(&particle) {
            sums.add(particle - block.start, weight * value);
        }
    }
}

/// Adds the sums of the sizes of particles' rows of the tangent, but for what belongs to pins, to the `bounds` of `block`:
/// `stiffness` [N/m] is that of the difference with the `weights`.
fn add_bounds<const N: usize>(
    (particles, weights): ([usize; N], [f64; N]),
    stiffness: f64,
    pinned: &[bool],
    block: &Range<usize>,
    bounds: &mut [f64],
) {
    for (particle, weight) in particles.into_iter().zip(weights) {
        if block.contains(&particle) {
            let others = particles.into_iter().zip(weights);
            let free = others.filter(|(other, _)| !pinned[*other] || *other == particle);
            let sum: f64 = free.map(|(_, weight)| weight.abs()).sum();
            bounds[particle - block.start] += stiffness * weight.abs() * sum;
        }
    }
}

/// The mixed difference [m] of a cell.
fn cell_difference(particles: [usize; 4], points: &Points) -> DVec3 {
    let [a, b, c, d] = particles.map(|particle| points.get(particle));
    (a - b) - (c - d)
}

/// Share of a width that line `index` of `count` stands for: ½ along an edge.
fn share(index: usize, count: usize) -> f64 {
    if index == 0 || index + 1 == count { 0.5 } else { 1.0 }
}

impl Force for GridBending {
    fn add_forces(
        &self,
        at: Configuration<'_>,
        block: &Range<usize>,
        forces: &mut PointsMut<'_>,
        _: &mut Sweep,
    ) {
        let Some(rows) = self.grid.block_rows(block) else { return };
        self.for_each_triple(&rows, |triple| add_force(&triple, at.positions, block, forces));
        self.for_each_cell(&rows, |cell| {
            let force = -self.twist * cell_difference(cell, at.positions);
            add_to_block((cell, CELL), force, block, forces);
        });
        self.add_clamp_forces(at.positions, block, forces);
    }

    fn add_tangent_products(
        &self,
        at: Configuration<'_>,
        displacements: &Points,
        block: &Range<usize>,
        products: &mut PointsMut<'_>,
    ) {
        let Some(rows) = self.grid.block_rows(block) else { return };
        let mut add = |triple: Triple| {
            let difference = triple.difference(at.positions);
            let change = triple.difference(displacements);
            let [all, along] = triple.rigidity.tangent(difference.length_squared());
            let product = all * change + along * difference.dot(change) * difference;
            add_to_block((triple.particles, LINE), product, block, products);
        };
        self.for_each_triple(&rows, &mut add);
        self.clamps_near(block).for_each(&mut add);
        self.for_each_cell(&rows, |cell| {
            let product = self.twist * cell_difference(cell, displacements);
            add_to_block((cell, CELL), product, block, products);
        });
    }

    /// By Gershgorin's theorem, for lines as stiff as they can be, so that the bound is the same in all states: three times that
    /// of straight ones, which matters only where bending is what makes cloth stiff.
    fn add_stiffness_bounds(&self, at: Configuration<'_>, block: &Range<usize>, bounds: &mut [f64]) {
        let Some(rows) = self.grid.block_rows(block) else { return };
        let pinned = at.particles.pinned();
        let mut add = |triple: Triple| {
            let stiffness = triple.rigidity.largest_stiffness();
            add_bounds((triple.particles, LINE), stiffness, pinned, block, bounds);
        };
        self.for_each_triple(&rows, &mut add);
        self.clamps_near(block).for_each(&mut add);
        self.for_each_cell(&rows, |cell| add_bounds((cell, CELL), self.twist, pinned, block, bounds));
    }

    fn add_forces_and_varying_bounds(
        &self,
        at: Configuration<'_>,
        block: &Range<usize>,
        forces: &mut PointsMut<'_>,
        _: &mut [f64],
        sweep: &mut Sweep,
    ) {
        self.add_forces(at, block, forces, sweep);
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
            energy += triple.rigidity.energy(triple.difference(at.positions).length_squared());
        };
        let rows = 0..self.grid.rows;
        self.for_each_triple(&rows, &mut add);
        self.clamps.iter().copied().for_each(&mut add);
        self.for_each_cell(&rows, |cell| {
            energy += 0.5 * self.twist * cell_difference(cell, at.positions).length_squared();
        });
        energies.elastic[Family::Bend as usize] += energy;
    }
}
