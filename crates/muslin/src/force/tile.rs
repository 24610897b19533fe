//! What is worked on at a time of a grid: where its springs lie, and the positions that they look at.

use std::ops::Range;

use crate::Points;
use crate::model::Grid;

/// Particles of a tile at most, so that all that is computed for it stays in a core's first-level cache.
pub(super) const TILE: usize = 128;

/// Loops over the springs of a tile are as long as a multiple of this, so that no vector is half empty. What they compute beyond
/// the tile is used by nobody.
const STRIDE: usize = 8;

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
    /// Number of its particles, at most [`TILE`].
    pub(super) fn len(&self) -> usize {
        self.rows.len() * self.columns.len()
    }

    /// Length of the loops over its springs, at most [`TILE`].
    pub(super) fn padded_len(&self) -> usize {
        self.len().next_multiple_of(STRIDE)
    }
}

/// One coordinate [m] of the particles of a tile and of all that springs join to them: `rows[k]` begins k rows below its first
/// particle, and is 2 − k longer than the loops over its springs.
#[derive(Clone, Copy)]
pub(super) struct Coordinates<'a> {
    pub(super) rows: [&'a [f64]; 3],
}

/// Copies of coordinates [m] near the end of a grid, with zeros where it has no particles.
#[derive(Clone, Debug)]
pub(super) struct EndCopies([[[f64; TILE + 2]; 3]; 3]);

impl EndCopies {
    pub(super) const ZERO: Self = Self([[[0.0; TILE + 2]; 3]; 3]);

    /// The coordinates x, y and z of a `tile` of `grid`: those in `positions`, or copies if there are too few.
    #[inline(always)]
    pub(super) fn coordinates<'a>(
        &'a mut self,
        tile: &Tile,
        grid: &Grid,
        positions: &'a Points,
    ) -> [Coordinates<'a>; 3] {
        let count = tile.padded_len();
        let first = grid.particle(tile.columns.start, tile.rows.start);
        let [own, next, last] = [first, first + grid.columns, first + 2 * grid.columns];
        let rows = [own..own + count + 2, next..next + count + 1, last..last + count];
        let Points { x, y, z } = positions;
        if rows.iter().all(|row| row.end <= x.len()) {
            let [own, next, last] = rows;
            let of = |values: &'a [f64]| Coordinates {
                rows: [&values[own.clone()], &values[next.clone()], &values[last.clone()]],
            };
            return [of(x), of(y), of(z)];
        }
        for (copies, values) in self.0.iter_mut().zip([x, y, z]) {
            for (copy, row) in copies.iter_mut().zip(&rows) {
                let there = &values[row.start.min(values.len())..row.end.min(values.len())];
                copy[..there.len()].copy_from_slice(there);
                copy[there.len()..row.len()].fill(0.0);
            }
        }
        let [x, y, z] = &self.0;
        let of = |[own, next, last]: &'a [[f64; TILE + 2]; 3]| Coordinates {
            rows: [&own[..count + 2], &next[..count + 1], &last[..count]],
        };
        [of(x), of(y), of(z)]
    }
}
