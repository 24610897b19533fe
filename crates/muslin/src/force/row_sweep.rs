//! Forces of all springs of a grid, row by row.
//!
//! Every spring is evaluated once, with the row of its upper end, and kept until both of its ends have been given their
//! part. What a particle gets still has an order of its own: first from the springs of the rows above, then from those of
//! its own row, family by family. So it does not matter where a block of rows begins.

use std::ops::Range;

use super::Configuration;
use super::grid_laws::Lines;
use super::grid_springs::{GridFamily, GridSprings, columns};
use super::law::{LawVisitor, TensionLaw};
use super::row_sums::{gather, gather_within, pass_down};
use super::spring::{Spring, SpringLength};
use crate::instructions::Vectorise;
use crate::model::Grid;
use crate::{Points, PointsMut};

/// Particles of a row that are worked on at a time, so that their springs stay in a core's first-level cache.
const TILE: usize = 128;

/// Springs that are evaluated side by side where few are left of a row.
const REST_LANES: usize = 8;

/// Room for the springs of the last particles before a tile.
const PAD: usize = 8;

/// How the springs of one family lie: two for each particle.
///
/// Spring `i` of a row joins the particle at column `i + own` of that row and the one at `i + other`, `rows` further down.
#[derive(Clone, Copy, Debug)]
struct Shape {
    own: usize,
    other: usize,
    rows: usize,
}

/// The springs of all families, in the order of [`Family::ALL`](super::Family::ALL). The second diagonal is counted from
/// its lower end's column, so that no spring has to do with an earlier column than its number.
const SHAPES: [[Shape; 2]; 3] = [
    [Shape { own: 0, other: 1, rows: 0 }, Shape { own: 0, other: 0, rows: 1 }],
    [Shape { own: 0, other: 1, rows: 1 }, Shape { own: 1, other: 0, rows: 1 }],
    [Shape { own: 0, other: 2, rows: 0 }, Shape { own: 0, other: 0, rows: 2 }],
];

/// What forces keep from one block of particles for the next.
///
/// Whoever asks for the forces of blocks in ascending order lends them one, after [`restart`](Self::restart) whenever
/// anything has moved. It has no influence on results.
#[derive(Clone, Debug, Default)]
pub struct Sweep {
    /// First particle of the block for which something is kept, and whether that includes stiffness.
    next: Option<(usize, bool)>,
    /// Springs of a tile, two per family in the order of [`Family::ALL`](super::Family::ALL).
    springs: Vec<[TileSprings; 2]>,
    /// What springs from earlier rows do to the next row, and to the one after it.
    pending: [Pending; 2],
}

impl Sweep {
    /// Forgets what it keeps.
    pub fn restart(&mut self) {
        self.next = None;
    }
}

/// Springs of a tile: the force [N] of each on its own end, and its stiffness [N/m].
#[derive(Clone, Debug)]
struct TileSprings {
    x: [f64; PAD + TILE],
    y: [f64; PAD + TILE],
    z: [f64; PAD + TILE],
    stiffness: [f64; PAD + TILE],
}

impl TileSprings {
    const ZERO: Self = Self {
        x: [0.0; PAD + TILE],
        y: [0.0; PAD + TILE],
        z: [0.0; PAD + TILE],
        stiffness: [0.0; PAD + TILE],
    };

    fn arrays(&mut self) -> [&mut [f64; PAD + TILE]; 4] {
        [&mut self.x, &mut self.y, &mut self.z, &mut self.stiffness]
    }
}

/// Forces [N] on the particles of a row, and bounds [N/m] on their stiffness.
#[derive(Clone, Debug, Default)]
struct Pending {
    forces: Points,
    bounds: Vec<f64>,
}

/// Adds the forces of all `springs` on a block of `rows`, and their stiffness bounds if there are any to add to.
pub(super) struct RowSweep<'a, 'b> {
    pub(super) springs: &'a GridSprings,
    pub(super) at: Configuration<'a>,
    pub(super) rows: Range<usize>,
    pub(super) forces: &'a mut PointsMut<'b>,
    pub(super) bounds: Option<&'a mut [f64]>,
    pub(super) sweep: &'a mut Sweep,
}

impl Vectorise for RowSweep<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<const LANES: usize>(self) {
        let Self { springs, at, rows, forces, mut bounds, sweep } = self;
        let grid = springs.grid;
        let mut pass = RowPass { springs, at, sweep, is_bounded: bounds.is_some() };
        // Where one grid ends the next begins, but nothing of it goes on there.
        let goes_on = pass.sweep.next == Some((grid.particle(0, rows.start), bounds.is_some()));
        if rows.start == 0 || !goes_on {
            pass.start();
            // Two rows up is as far as springs reach.
            for row in rows.start.saturating_sub(2)..rows.start {
                pass.strip::<LANES>(row..row + 1, None, None);
            }
        }
        let rows_per_strip = (TILE / grid.columns).max(1);
        for first in rows.clone().step_by(rows_per_strip) {
            let strip = first..(first + rows_per_strip).min(rows.end);
            let own = (strip.start - rows.start) * grid.columns..(strip.end - rows.start) * grid.columns;
            let strip_forces = slice_of(forces, own.clone());
            let strip_bounds = bounds.as_mut().map(|bounds| &mut bounds[own.clone()]);
            pass.strip::<LANES>(strip, Some(strip_forces), strip_bounds);
        }
        sweep.next = Some((grid.particle(0, rows.end), bounds.is_some()));
    }
}

/// One strip of rows after the other: a strip is as many rows as fit into a tile, or one.
struct RowPass<'a> {
    springs: &'a GridSprings,
    at: Configuration<'a>,
    sweep: &'a mut Sweep,
    is_bounded: bool,
}

impl RowPass<'_> {
    /// Makes room, and begins with nothing from earlier rows.
    fn start(&mut self) {
        let columns = self.springs.grid.columns;
        self.sweep.springs.resize(SHAPES.len(), [TileSprings::ZERO, TileSprings::ZERO]);
        for (index, springs) in self.sweep.springs.iter_mut().enumerate() {
            for (direction, springs) in springs.iter_mut().enumerate() {
                // Where there are no springs, what another grid left must not count as some.
                let mut groups = self.springs.swept().filter(|group| group.family as usize == index);
                let has_any = groups.any(|group| group.has_direction(direction));
                let end = if has_any { PAD } else { PAD + TILE };
                springs.arrays().into_iter().for_each(|values| values[PAD - 2..end].fill(0.0));
            }
        }
        for Pending { forces, bounds } in &mut self.sweep.pending {
            for values in [&mut forces.x, &mut forces.y, &mut forces.z] {
                values.clear();
                values.resize(columns, 0.0);
            }
            bounds.clear();
            bounds.resize(if self.is_bounded { columns } else { 0 }, 0.0);
        }
    }

    /// Evaluates the springs of `rows`, adds what all springs do to them to their `forces` and `bounds`, and keeps what they
    /// do to later rows.
    #[inline(always)]
    fn strip<const LANES: usize>(
        &mut self,
        rows: Range<usize>,
        mut forces: Option<PointsMut<'_>>,
        mut bounds: Option<&mut [f64]>,
    ) {
        let columns = self.springs.grid.columns;
        let tiles = columns.div_ceil(TILE);
        for tile in 0..tiles {
            let tile =
                Tile { rows: rows.clone(), columns: tile * columns / tiles..(tile + 1) * columns / tiles };
            for family in self.springs.swept() {
                let springs = &mut self.sweep.springs[family.family as usize];
                let (grid, at, tile) = (self.springs.grid, self.at, &tile);
                if self.is_bounded && !family.has_constant_stiffness() {
                    family.law.visit(EvalSprings::<LANES, true> { grid, tile, family, at, springs });
                } else {
                    family.law.visit(EvalSprings::<LANES, false> { grid, tile, family, at, springs });
                }
            }
            // The first two rows get something from earlier strips, all others from this one alone.
            let apart = rows.len().min(2);
            for row in 0..apart {
                let own = row * columns + tile.columns.start..row * columns + tile.columns.end;
                self.distribute(&tile, row * columns, forces.as_mut().map(|forces| slice_of(forces, own)));
            }
            if apart < rows.len() {
                let others = apart * columns..rows.len() * columns;
                self.distribute_within(columns, forces.as_mut().map(|forces| slice_of(forces, others)));
            }
            if self.is_bounded {
                for row in rows.clone() {
                    let first = (row - rows.start) * columns;
                    let bounds = bounds.as_mut().map(|bounds| &mut bounds[first..first + columns]);
                    self.add_bounds(row, first, &tile, bounds);
                }
            }
            self.keep_ends(&tile);
        }
    }

    /// Gives both ends of the springs of one row of a tile their forces; `forces` [N] are those of the row in the tile, and
    /// `first` the number of its first spring.
    #[inline(always)]
    fn distribute(&mut self, tile: &Tile, first: usize, forces: Option<PointsMut<'_>>) {
        let Sweep { springs, pending, .. } = &mut *self.sweep;
        let [structural, shear, bend] = &springs[..] else { return };
        let [below, after] = pending;
        let first = PAD + if tile.rows.len() > 1 { first } else { 0 };
        macro_rules! axis {
            ($axis:ident, $forces:expr) => {
                let [across, down, diagonal, other_diagonal, far_across, far_down] =
                    [&structural[0], &structural[1], &shear[0], &shear[1], &bend[0], &bend[1]]
                        .map(|springs| &springs.$axis[first - 2..]);
                let below = &mut below.forces.$axis[tile.columns.clone()];
                if let Some(forces) = $forces {
                    gather(
                        forces,
                        below,
                        (&across[2..], &across[1..]),
                        &down[2..],
                        (&diagonal[2..], &other_diagonal[1..]),
                        (&far_across[2..], far_across),
                        &far_down[2..],
                    );
                }
                pass_down(
                    below,
                    &mut after.forces.$axis[tile.columns.clone()],
                    &down[2..],
                    (&diagonal[1..], &other_diagonal[2..]),
                    &far_down[2..],
                );
            };
        }
        let [x, y, z] = forces.map_or([None, None, None], |forces| [forces.x, forces.y, forces.z].map(Some));
        axis!(x, x);
        axis!(y, y);
        axis!(z, z);
    }

    /// Gives both ends of the springs of a strip of some rows their forces, but for its first two rows; `forces` [N] are those
    /// of the rows after them.
    #[inline(always)]
    fn distribute_within(&mut self, columns: usize, forces: Option<PointsMut<'_>>) {
        let Some(forces) = forces else { return };
        let Sweep { springs, pending, .. } = &mut *self.sweep;
        let [structural, shear, bend] = &springs[..] else { return };
        let [below, after] = pending;
        macro_rules! axis {
            ($axis:ident) => {
                let springs = [&structural[0], &structural[1], &shear[0], &shear[1], &bend[0], &bend[1]]
                    .map(|springs| &springs.$axis[PAD - 2..]);
                let last = columns + forces.$axis.len();
                gather_within(forces.$axis, columns, springs);
                let [_, down, diagonal, other_diagonal, _, far_down] = springs.map(|values| &values[last..]);
                let before_last = &springs[5][last - columns..];
                let (below, after) = (&mut below.forces.$axis, &mut after.forces.$axis);
                after.iter_mut().zip(&before_last[2..]).for_each(|(after, force)| *after = -force);
                pass_down(below, after, &down[2..], (&diagonal[1..], &other_diagonal[2..]), &far_down[2..]);
            };
        }
        axis!(x);
        axis!(y);
        axis!(z);
    }

    /// The last springs of a tile pull at the first particles of the next in the same row; in the last tile they do not exist.
    fn keep_ends(&mut self, tile: &Tile) {
        let (count, is_last) = (tile.columns.len(), tile.columns.end == self.springs.grid.columns);
        for values in self.sweep.springs.iter_mut().flatten().flat_map(TileSprings::arrays) {
            for i in 0..2 {
                values[PAD - 2 + i] = if is_last { 0.0 } else { values[PAD + count - 2 + i] };
            }
        }
    }

    /// Adds the stiffness of the springs of a row of a tile to the bounds of both ends, if it varies; `bounds` [N/m] are those
    /// of the row, and `first` the number of its first spring.
    #[inline(always)]
    fn add_bounds(&mut self, row: usize, first: usize, tile: &Tile, mut bounds: Option<&mut [f64]>) {
        let grid = &self.springs.grid;
        let pinned = self.at.particles.pinned();
        if tile.columns.start == 0 {
            let [below, after] = &mut self.sweep.pending;
            if let Some(bounds) = &mut bounds {
                add(bounds, &below.bounds);
            }
            std::mem::swap(&mut below.bounds, &mut after.bounds);
            after.bounds.fill(0.0);
        }
        let first = PAD + if tile.rows.len() > 1 { first } else { 0 };
        for family in self.springs.swept().filter(|family| !family.has_constant_stiffness()) {
            let index = family.family as usize;
            for (direction, shape) in SHAPES[index].iter().enumerate() {
                let springs = &self.sweep.springs[index][direction];
                let end = tile.columns.end.min(grid.columns.saturating_sub(shape.reach()));
                let exists = family.has_direction(direction) && row + shape.rows < grid.rows;
                if !exists || end <= tile.columns.start {
                    continue;
                }
                let count = end - tile.columns.start;
                let stiffness = &springs.stiffness[first..first + count];
                let ends = |shift: usize, row: usize| {
                    let column = tile.columns.start + shift;
                    let particle = grid.particle(column, row);
                    (column, &pinned[particle..particle + count])
                };
                let (own, own_pinned) = ends(shape.own, row);
                let (other, other_pinned) = ends(shape.other, row + shape.rows);
                if let Some(bounds) = &mut bounds {
                    add_weighted(&mut bounds[own..], stiffness, other_pinned);
                    if shape.rows == 0 {
                        add_weighted(&mut bounds[other..], stiffness, own_pinned);
                    }
                }
                if shape.rows > 0 {
                    let pending = &mut self.sweep.pending[shape.rows - 1].bounds;
                    add_weighted(&mut pending[other..], stiffness, own_pinned);
                }
            }
        }
    }
}

/// Some columns of one row, or all columns of some rows.
struct Tile {
    rows: Range<usize>,
    columns: Range<usize>,
}

impl Shape {
    /// So many columns before the last begins no spring.
    fn reach(self) -> usize {
        self.own.max(self.other)
    }
}

/// Evaluates the springs of one family in one tile, with their stiffness if `BOUNDED`.
///
/// Several rows are one row to it: springs from the end of one to the beginning of the next are made zero again.
struct EvalSprings<'a, const LANES: usize, const BOUNDED: bool> {
    grid: Grid,
    tile: &'a Tile,
    family: &'a GridFamily,
    at: Configuration<'a>,
    springs: &'a mut [TileSprings; 2],
}

impl<const LANES: usize, const BOUNDED: bool> LawVisitor for EvalSprings<'_, LANES, BOUNDED> {
    #[inline(always)]
    fn visit<L: TensionLaw>(self, law: L) {
        let Self { grid, tile, family, at, springs } = self;
        let Tile { rows, columns } = tile;
        let shapes = &SHAPES[family.family as usize];
        for (index, (shape, springs)) in shapes.iter().zip(springs.iter_mut()).enumerate() {
            let Some(spring) = family.spring_of(&law, index) else { continue };
            let rows_end = rows.end.min(grid.rows.saturating_sub(shape.rows));
            let columns_end = columns.end.min(grid.columns.saturating_sub(shape.reach()));
            let mut count = 0;
            if rows.start < rows_end && columns.start < columns_end {
                count = (rows_end - 1 - rows.start) * grid.columns + columns_end - columns.start;
                let own = grid.particle(columns.start + shape.own, rows.start);
                let other = grid.particle(columns.start + shape.other, rows.start + shape.rows);
                let Points { x, y, z } = at.positions;
                let own = [x, y, z].map(|values| &values[own..own + count]);
                let other = [x, y, z].map(|values| &values[other..other + count]);
                eval_row::<LANES, BOUNDED, _>(&spring, own, other, springs);
            }
            let end = PAD + rows.len() * columns.len();
            let arrays = if BOUNDED { 4 } else { 3 };
            for values in springs.arrays().into_iter().take(arrays) {
                if shape.reach() > 0 && rows.len() > 1 {
                    for row_end in (columns.len()..=count).step_by(columns.len()) {
                        // Up to two, which are not worth a call.
                        values[PAD + row_end - shape.reach()] = 0.0;
                        values[PAD + row_end - 1] = 0.0;
                    }
                }
                for value in &mut values[PAD + count..end] {
                    *value = 0.0;
                }
            }
            if family.lines == Lines::Inner {
                halve_edges(&grid, tile, shape, springs);
            }
        }
    }
}

/// Halves the springs that lie along the edges of a grid: they stand for half as wide a strip of cloth.
fn halve_edges(grid: &Grid, tile: &Tile, shape: &Shape, springs: &mut TileSprings) {
    let Tile { rows, columns } = tile;
    for values in springs.arrays() {
        for row in rows.clone() {
            let values = &mut values[PAD + (row - rows.start) * columns.len()..][..columns.len()];
            if shape.rows > 0 {
                let ends = [(columns.start == 0, 0), (columns.end == grid.columns, columns.len() - 1)];
                ends.iter().filter(|(is_edge, _)| *is_edge).for_each(|(_, column)| values[*column] *= 0.5);
            } else if row == 0 || row + 1 == grid.rows {
                values.iter_mut().for_each(|value| *value *= 0.5);
            }
        }
    }
}

/// Evaluates a row of springs from `own` to `other` positions [m].
#[inline(always)]
fn eval_row<const LANES: usize, const BOUNDED: bool, L: TensionLaw>(
    spring: &Spring<L>,
    own: [&[f64]; 3],
    other: [&[f64]; 3],
    springs: &mut TileSprings,
) {
    let count = own[0].len();
    let whole = count - count % LANES;
    for start in (0..whole).step_by(LANES) {
        eval_lanes::<LANES, BOUNDED, _>(spring, own, other, springs, start);
    }
    if count < REST_LANES {
        for start in whole..count {
            eval_lanes::<1, BOUNDED, _>(spring, own, other, springs, start);
        }
        return;
    }
    for start in (whole..count).step_by(REST_LANES) {
        // In the end some springs again, which costs less than the last ones one by one.
        let start = start.min(count - REST_LANES);
        eval_lanes::<REST_LANES, BOUNDED, _>(spring, own, other, springs, start);
    }
}

/// Evaluates `LANES` springs from number `start` on, side by side.
#[inline(always)]
fn eval_lanes<const LANES: usize, const BOUNDED: bool, L: TensionLaw>(
    spring: &Spring<L>,
    own: [&[f64]; 3],
    other: [&[f64]; 3],
    springs: &mut TileSprings,
    start: usize,
) {
    let lanes = |values: &[f64]| -> [f64; LANES] {
        let mut lanes = [0.0; LANES];
        lanes.copy_from_slice(&values[start..start + LANES]);
        lanes
    };
    let ([x, y, z], [other_x, other_y, other_z]) = (own.map(lanes), other.map(lanes));
    let target = PAD + start..PAD + start + LANES;
    let force_x = &mut springs.x[target.clone()];
    let force_y = &mut springs.y[target.clone()];
    let force_z = &mut springs.z[target.clone()];
    let stiffnesses = &mut springs.stiffness[target];
    for i in 0..LANES {
        let [dx, dy, dz] = [other_x[i] - x[i], other_y[i] - y[i], other_z[i] - z[i]];
        let length = SpringLength::from_squared(dx * dx + dy * dy + dz * dz);
        let coefficient = if BOUNDED {
            let (coefficient, stiffness) = spring.coefficient_and_stiffness(length);
            stiffnesses[i] = stiffness;
            coefficient
        } else {
            spring.coefficient(length)
        };
        force_x[i] = coefficient * dx;
        force_y[i] = coefficient * dy;
        force_z[i] = coefficient * dz;
    }
}

/// The points of `range`.
#[inline(always)]
fn slice_of<'a>(points: &'a mut PointsMut<'_>, range: Range<usize>) -> PointsMut<'a> {
    PointsMut { x: &mut points.x[range.clone()], y: &mut points.y[range.clone()], z: &mut points.z[range] }
}

/// Adds `values` to `sums`.
#[inline(always)]
fn add(sums: &mut [f64], values: &[f64]) {
    sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
}

/// Adds the stiffness of springs to the bounds of their one ends; of the others it matters whether they are pinned.
#[inline(always)]
fn add_weighted(bounds: &mut [f64], stiffness: &[f64], other_pinned: &[bool]) {
    for ((bound, stiffness), pinned) in bounds.iter_mut().zip(stiffness).zip(other_pinned) {
        *bound += columns(*pinned) * stiffness;
    }
}
