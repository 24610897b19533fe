//! Forces of all springs of a grid, row by row.
//!
//! Every spring is evaluated once, with the row of its upper end, and kept until both of its ends have been given their
//! part. What a particle gets still has an order of its own: first from the springs that it begins, then from those of its
//! own row that it ends, then from those of rows above. So it does not matter where a block of rows begins.

use std::ops::Range;

use super::Configuration;
use super::grid_springs::{GridSprings, columns};
use super::row_sums::{Border, Pending, Pulls};
use super::tile::{EndCopies, SHAPES, TILE, Tile};
use super::tile_springs::TileSprings;
use crate::instructions::Vectorise;
use crate::{Points, PointsMut};

/// What forces keep from one block of particles for the next.
///
/// Whoever asks for the forces of blocks in ascending order lends them one, after [`restart`](Self::restart) whenever
/// anything has moved. It has no influence on results.
#[derive(Clone, Debug, Default)]
pub struct Sweep {
    /// First particle of the block for which something is kept, and whether that includes stiffness.
    next: Option<(usize, bool)>,
    tile: Option<Box<TileMemory>>,
    /// What springs from earlier rows do to the next row, and to the one after it.
    kept: [KeptRow; 2],
}

impl Sweep {
    /// Forgets what it keeps.
    pub fn restart(&mut self) {
        self.next = None;
    }
}

/// All that is computed of a tile.
#[derive(Clone, Debug)]
struct TileMemory {
    springs: TileSprings,
    pulls: Pulls,
    end_copies: EndCopies,
}

/// The opposite of forces [N] on the particles of a row, and bounds [N/m] on their stiffness.
#[derive(Clone, Debug, Default)]
struct KeptRow {
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
    fn run(self) {
        let Self { springs, at, rows, forces, mut bounds, sweep } = self;
        let grid = springs.grid;
        let is_bounded = bounds.is_some();
        // Where one grid ends the next begins, but nothing of it goes on there.
        let goes_on = sweep.next == Some((grid.particle(0, rows.start), is_bounded));
        let starts = rows.start == 0 || !goes_on;
        let Sweep { next, tile, kept } = sweep;
        let tile = tile.get_or_insert_with(|| Box::new(TileMemory::ZERO));
        let mut pass = RowPass { springs, at, tile, kept, is_bounded };
        if starts {
            pass.start();
            // Two rows up is as far as springs reach.
            for row in rows.start.saturating_sub(2)..rows.start {
                pass.strip(row..row + 1, None, None);
            }
        }
        let rows_per_strip = (TILE / grid.columns).max(1);
        for first in rows.clone().step_by(rows_per_strip) {
            let strip = first..(first + rows_per_strip).min(rows.end);
            let own = (strip.start - rows.start) * grid.columns..(strip.end - rows.start) * grid.columns;
            let PointsMut { x, y, z } = &mut *forces;
            let strip_forces = [x, y, z].map(|forces| &mut forces[own.clone()]);
            let strip_bounds = bounds.as_mut().map(|bounds| &mut bounds[own.clone()]);
            pass.strip(strip, Some(strip_forces), strip_bounds);
        }
        *next = Some((grid.particle(0, rows.end), is_bounded));
    }
}

impl TileMemory {
    const ZERO: Self = Self { springs: TileSprings::ZERO, pulls: Pulls::ZERO, end_copies: EndCopies::ZERO };
}

/// One strip of rows after the other: a strip is as many rows as fit into a tile, or one.
struct RowPass<'a> {
    springs: &'a GridSprings,
    at: Configuration<'a>,
    tile: &'a mut TileMemory,
    kept: &'a mut [KeptRow; 2],
    is_bounded: bool,
}

impl RowPass<'_> {
    /// Makes room, and begins with nothing from earlier rows.
    fn start(&mut self) {
        let columns = self.springs.grid.columns;
        if !self.springs.has_bend_springs() {
            self.tile.pulls.clear_far();
        }
        for KeptRow { forces, bounds } in &mut *self.kept {
            // Another grid may have had longer rows.
            if forces.len() < columns {
                *forces = Points::zeros(columns);
            }
            forces.slice_mut(&(0..columns)).fill(0.0);
            bounds.clear();
            bounds.resize(if self.is_bounded { columns } else { 0 }, 0.0);
        }
    }

    /// Evaluates the springs of `rows`, adds what all springs do to them to their `forces` and `bounds`, and keeps what they
    /// do to later rows.
    #[inline(always)]
    fn strip(
        &mut self,
        rows: Range<usize>,
        mut forces: Option<[&mut [f64]; 3]>,
        mut bounds: Option<&mut [f64]>,
    ) {
        let columns = self.springs.grid.columns;
        let tiles = columns.div_ceil(TILE);
        let mut borders = [Border::default(); 3];
        for tile in 0..tiles {
            let tile =
                Tile { rows: rows.clone(), columns: tile * columns / tiles..(tile + 1) * columns / tiles };
            let TileMemory { springs, pulls, end_copies } = &mut *self.tile;
            let grid = &self.springs.grid;
            let coordinates = end_copies.coordinates(&tile, grid, self.at.positions);
            let has_bend_springs = self.springs.has_bend_springs();
            springs.eval_lengths(coordinates, has_bend_springs, &tile);
            let families = if has_bend_springs { 3 } else { 2 };
            for (index, directions) in self.springs.swept().into_iter().enumerate().take(families) {
                for (direction, group) in directions.into_iter().enumerate() {
                    let place = [index, direction];
                    if self.is_bounded && group.is_some_and(|group| !group.has_constant_stiffness()) {
                        springs.eval_coefficients::<true>(place, group, &tile, grid);
                    } else {
                        springs.eval_coefficients::<false>(place, group, &tile, grid);
                    }
                }
            }
            let [next, after] = &mut *self.kept;
            let kept = [
                (&mut next.forces.x, &mut after.forces.x),
                (&mut next.forces.y, &mut after.forces.y),
                (&mut next.forces.z, &mut after.forces.z),
            ];
            for (axis, (next, after)) in kept.into_iter().enumerate() {
                pulls.eval(springs, has_bend_springs, coordinates[axis], borders[axis], &tile);
                borders[axis] = pulls.border(tile.columns.len());
                let (next, after) = (&mut next[tile.columns.clone()], &mut after[tile.columns.clone()]);
                let mut forces = forces.as_mut().map(|forces| &mut *forces[axis]);
                // The first two rows get something from earlier strips, all others from this one alone.
                let apart = rows.len().min(2);
                for row in 0..apart {
                    let own = row * columns + tile.columns.start..row * columns + tile.columns.end;
                    let forces = forces.as_mut().map(|forces| &mut forces[own]);
                    pulls.add_to_row(row * columns, forces, Pending { next, after });
                }
                if apart < rows.len() {
                    let forces = forces.map(|forces| &mut forces[apart * columns..]);
                    pulls.add_to_rows(columns, tile.len(), forces, Pending { next, after });
                }
            }
            if self.is_bounded {
                for row in rows.clone() {
                    let first = (row - rows.start) * columns;
                    let bounds = bounds.as_mut().map(|bounds| &mut bounds[first..first + columns]);
                    self.add_bounds(row, first, &tile, bounds);
                }
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
            let [next, after] = &mut *self.kept;
            if let Some(bounds) = &mut bounds {
                add(bounds, &next.bounds);
            }
            std::mem::swap(&mut next.bounds, &mut after.bounds);
            after.bounds.fill(0.0);
        }
        let first = if tile.rows.len() > 1 { first } else { 0 };
        for (index, directions) in self.springs.swept().into_iter().enumerate() {
            for (direction, (group, shape)) in directions.into_iter().zip(&SHAPES[index]).enumerate() {
                let varies = group.is_some_and(|group| !group.has_constant_stiffness());
                let end = tile.columns.end.min(grid.columns.saturating_sub(shape.reach()));
                if !varies || grid.rows <= row + shape.rows || end <= tile.columns.start {
                    continue;
                }
                let count = end - tile.columns.start;
                let stiffness = &self.tile.springs.stiffnesses[index][direction][first..first + count];
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
                    let kept = &mut self.kept[shape.rows - 1].bounds;
                    add_weighted(&mut kept[other..], stiffness, own_pinned);
                }
            }
        }
    }
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
