//! What is worked on at a time of a grid: where its springs lie, and the positions that they look at.

use std::ops::Range;

use super::grid_springs::columns;
use crate::Points;
use crate::model::{Grid, Particles};

/// Particles of a tile at most, so that all that is computed for it stays in a core's first-level cache.
pub(super) const TILE: usize = 128;

/// Loops over the springs of a tile are as long as a multiple of this, so that no vector is half empty. What they compute beyond
/// the tile is used by nobody.
pub(super) const STRIDE: usize = 8;

/// How the springs of one family lie: two for each particle.
///
/// Spring `i` of a row joins the particle at column `i + own` of that row and the one at `i + other`, `rows` further down.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape {
    pub(super) own: usize,
    pub(super) other: usize,
    pub(super) rows: usize,
}

/// The springs of all families, in the order of [`Family::ALL`](super::Family::ALL). The second diagonal is counted from
/// its lower end's column, so that no spring has to do with an earlier column than its number.
pub(super) const SHAPES: [[Shape; 2]; 3] = [
    [Shape { own: 0, other: 1, rows: 0 }, Shape { own: 0, other: 0, rows: 1 }],
    [Shape { own: 0, other: 1, rows: 1 }, Shape { own: 1, other: 0, rows: 1 }],
    [Shape { own: 0, other: 2, rows: 0 }, Shape { own: 0, other: 0, rows: 2 }],
];

impl Shape {
    /// So many columns before the last begins no spring.
    pub(super) fn reach(self) -> usize {
        self.own.max(self.other)
    }
}

/// Some columns of one row, or all columns of some rows.
///
/// Its particles are consecutive, and loops go over them as one long row; what seems to lead from the end of a row to the
/// beginning of the next is no spring.
#[derive(Clone, Debug)]
pub(super) struct Tile {
    pub(super) rows: Range<usize>,
    pub(super) columns: Range<usize>,
}

impl Tile {
    /// The tiles of some `rows` of `grid`, which must be one or fit into a tile, from left to right.
    pub(super) fn of(grid: &Grid, rows: &Range<usize>) -> impl Iterator<Item = Self> + use<> {
        let (rows, columns) = (rows.clone(), grid.columns);
        let count = columns.div_ceil(TILE);
        (0..count).map(move |tile| Self {
            rows: rows.clone(),
            columns: tile * columns / count..(tile + 1) * columns / count,
        })
    }

    /// Particles of its own and of the two rows below that springs join to them, of `grid` or where it would have them: those
    /// that [`Coordinates::rows`] has.
    fn neighbourhood(&self, grid: &Grid) -> [Range<usize>; 3] {
        let count = self.padded_len();
        let first = grid.particle(self.columns.start, self.rows.start);
        let [own, next, last] = [first, first + grid.columns, first + 2 * grid.columns];
        [own..own + count + 2, next..next + count + 1, last..last + count]
    }

    /// Whether no particle is pinned of those that its springs join, with some more.
    #[inline(always)]
    pub(super) fn is_free(&self, grid: &Grid, particles: &Particles) -> bool {
        let rows = self.neighbourhood(grid);
        let has_pin = |row: &Range<usize>| particles.runs(row).any(|run| run.is_pinned);
        // Most often there is no pin anywhere near.
        !has_pin(&(rows[0].start..rows[2].end)) || !rows.iter().any(has_pin)
    }

    /// Number of its particles, at most [`TILE`].
    pub(super) fn len(&self) -> usize {
        self.rows.len() * self.columns.len()
    }

    /// Length of the loops over its springs, at most [`TILE`].
    pub(super) fn padded_len(&self) -> usize {
        self.len().next_multiple_of(STRIDE)
    }
}

/// Whether there are no rows above `first_row` of a `grid` of which two would fit into a tile: room for zeros in their place.
pub(super) fn has_none_above(grid: &Grid, first_row: usize) -> bool {
    first_row == 0 && 2 * grid.columns <= TILE
}

/// One coordinate [m], or another number, of the particles of a tile and of all that springs join to them: `rows[k]` begins k
/// rows below its first particle, and is 2 − k longer than the loops over its springs.
#[derive(Clone, Copy)]
pub(super) struct Coordinates<'a> {
    pub(super) rows: [&'a [f64]; 3],
}

impl<'a> Coordinates<'a> {
    #[inline(always)]
    fn of_rows(values: &'a [f64], [own, next, last]: &[Range<usize>; 3]) -> Self {
        Self { rows: [&values[own.clone()], &values[next.clone()], &values[last.clone()]] }
    }

    fn of_copies([own, next, last]: &'a [[f64; TILE + 2]; 3], count: usize) -> Self {
        Self { rows: [&own[..count + 2], &next[..count + 1], &last[..count]] }
    }
}

/// One coordinate [m] of the particles that springs begin and end at, one per particle of a tile.
#[derive(Clone, Copy)]
pub(super) struct Ends<'a> {
    pub(super) own: &'a [f64],
    pub(super) right: &'a [f64],
    pub(super) far_right: &'a [f64],
    pub(super) down: &'a [f64],
    pub(super) down_right: &'a [f64],
    pub(super) far_down: &'a [f64],
}

impl<'a> Ends<'a> {
    #[inline(always)]
    pub(super) fn of(Coordinates { rows: [own, next, last] }: Coordinates<'a>, count: usize) -> Self {
        Self {
            own: &own[..count],
            right: &own[1..][..count],
            far_right: &own[2..][..count],
            down: &next[..count],
            down_right: &next[1..][..count],
            far_down: &last[..count],
        }
    }
}

/// The particle at the place `i` [m], the ones to the right and below, and the one below to the right.
#[inline(always)]
pub(super) fn cell([x, y, z]: [Ends<'_>; 3], i: usize) -> [[f64; 3]; 4] {
    [
        [x.own[i], y.own[i], z.own[i]],
        [x.right[i], y.right[i], z.right[i]],
        [x.down[i], y.down[i], z.down[i]],
        [x.down_right[i], y.down_right[i], z.down_right[i]],
    ]
}

/// Copies of coordinates [m] near the end of a wide grid, with zeros where it has no particles.
#[derive(Clone, Debug)]
pub(super) struct EndCopies([[[f64; TILE + 2]; 3]; 3]);

impl EndCopies {
    pub(super) const ZERO: Self = Self([[[0.0; TILE + 2]; 3]; 3]);

    /// The coordinates x, y and z of a `tile` of `grid`: those in `positions` with the zeros behind them, or copies if
    /// these are too few.
    #[inline(always)]
    pub(super) fn coordinates<'a>(
        &'a mut self,
        tile: &Tile,
        grid: &Grid,
        positions: &'a Points,
    ) -> [Coordinates<'a>; 3] {
        let rows = tile.neighbourhood(grid);
        let values = positions.with_zeros_behind();
        if rows.iter().all(|row| row.end <= values[0].len()) {
            let [x, y, z] = values;
            return [
                Coordinates::of_rows(x, &rows),
                Coordinates::of_rows(y, &rows),
                Coordinates::of_rows(z, &rows),
            ];
        }
        for (copies, values) in self.0.iter_mut().zip(values) {
            for (copy, row) in copies.iter_mut().zip(&rows) {
                let there = &values[row.start.min(values.len())..row.end.min(values.len())];
                copy[..there.len()].copy_from_slice(there);
                copy[there.len()..row.len()].fill(0.0);
            }
        }
        let count = tile.padded_len();
        let [x, y, z] = &self.0;
        [x, y, z].map(|copies| Coordinates::of_copies(copies, count))
    }
}

/// How many [`columns`] of their rows of the tangent neighbours fill: of the particles of a tile and of all that springs
/// join to them.
#[derive(Clone, Debug)]
pub(super) struct Weights {
    rows: [[f64; TILE + 2]; 3],
    /// Whether they are all those of free particles.
    are_free: bool,
}

impl Weights {
    pub(super) const ZERO: Self = Self { rows: [[0.0; TILE + 2]; 3], are_free: false };

    /// Those of a `tile` of `grid`, and whether all of them are free: [`columns`] of a free neighbour.
    #[inline(always)]
    pub(super) fn eval(
        &mut self,
        tile: &Tile,
        grid: &Grid,
        particles: &Particles,
    ) -> (Coordinates<'_>, bool) {
        let are_free = tile.is_free(grid, particles);
        if !(are_free && self.are_free) {
            let pinned = particles.pinned();
            for (weights, row) in self.rows.iter_mut().zip(tile.neighbourhood(grid)) {
                weights.fill(columns(false));
                for (weight, &is_pinned) in
                    weights.iter_mut().zip(pinned.iter().take(row.end).skip(row.start))
                {
                    *weight = columns(is_pinned);
                }
            }
            self.are_free = are_free;
        }
        (Coordinates::of_copies(&self.rows, tile.padded_len()), are_free)
    }
}
