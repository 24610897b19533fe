//! Products of a grid's bending stiffness with points, many rows as one.

use std::ops::Range;

use super::GridBending;
use crate::instructions::Vectorise;
use crate::{Points, PointsMut};

/// Particles that are worked on at a time, so that what is kept of them stays in a core's first-level cache.
const TILE: usize = 512;

/// Room for the particle before a tile and the one after it.
const PAD: usize = 1;

/// Adds `factor` K x to `sums` for the particles of `rows`, with the tangent K but for clamps, and `points` x of all
/// particles.
///
/// One coordinate after the other, and of each particle first what its column does, then what its row does:
///
/// ```text
/// K x = b_y s_i (d_j−1 − 2 d_j + d_j+1) + q_i−1 − 2 q_i + q_i+1        q_i = b_x s_j c_i + d r_i
/// ```
///
/// with the second differences c along the row and d along the column, which are zero around particles at its ends, and
/// the differences r of a particle from those before and after it in its column, r_j = x_j−1 − 2 x_j + x_j+1 in inner rows.
/// Past the ends of a row q is what it is there: c is zero on both sides then, and no cell is beyond.
pub(super) struct AddProducts<'a, 'b> {
    pub(super) bending: &'a GridBending,
    pub(super) points: &'a Points,
    pub(super) factor: f64,
    pub(super) rows: Range<usize>,
    pub(super) sums: &'a mut PointsMut<'b>,
}

impl Vectorise for AddProducts<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { bending, points, factor, rows, sums } = self;
        let axes = [(&points.x, &mut *sums.x), (&points.y, &mut *sums.y), (&points.z, &mut *sums.z)];
        let columns = bending.grid.columns;
        let mut kept = Kept { across: [0.0; PAD + TILE + PAD], along: [0.0; TILE], ends: [0.0; TILE] };
        let inner = bending.inner_rows();
        for (values, sums) in axes {
            let mut row = rows.start;
            while row < rows.end {
                // Rows that have two rows on either side differ in nothing.
                let end = if inner.contains(&row) { inner.end.min(rows.end) } else { row + 1 };
                let strip = Strip::new(bending, values, factor, row);
                let sums = &mut sums[(row - rows.start) * columns..(end - rows.start) * columns];
                if inner.contains(&row) {
                    strip.add::<true>(&mut kept, sums);
                } else {
                    strip.add::<false>(&mut kept, sums);
                }
                row = end;
            }
        }
    }
}

impl GridBending {
    /// The rows that have two rows before and two after them.
    fn inner_rows(&self) -> Range<usize> {
        2..self.grid.rows.saturating_sub(2).max(2)
    }
}

/// What is kept of a tile: q of its particles and of those beside them, what their columns do to them, and the sums of those
/// at the ends of a row.
struct Kept {
    across: [f64; PAD + TILE + PAD],
    along: [f64; TILE],
    ends: [f64; TILE],
}

/// One coordinate of consecutive rows that are worked on as one, and their coefficients [N/m].
struct Strip<'a> {
    values: &'a [f64],
    columns: usize,
    /// First particles of the first row and of its neighbours, from the second row before to the second after; its own in
    /// place of those that do not exist.
    first: [usize; 5],
    /// b_x s of the rows.
    across: f64,
    /// b_y around the row before, the row itself and the row after, where such triples exist.
    along: [f64; 3],
    /// d of the cells before and after, where they exist.
    twist: [f64; 2],
}

impl<'a> Strip<'a> {
    fn new(bending: &GridBending, values: &'a [f64], factor: f64, row: usize) -> Self {
        let grid = &bending.grid;
        let count = grid.rows;
        let coefficient = |exists: bool, coefficient: f64| if exists { factor * coefficient } else { 0.0 };
        let first = |other: Option<usize>| {
            let other = other.filter(|&other| other < count);
            grid.particle(0, other.unwrap_or(row))
        };
        let (b_y, twist) = (bending.along_rows, bending.twist);
        Self {
            values,
            columns: grid.columns,
            first: [
                first(row.checked_sub(2)),
                first(row.checked_sub(1)),
                first(Some(row)),
                first(Some(row + 1)),
                first(Some(row + 2)),
            ],
            across: factor * bending.along_columns * super::share(row, count),
            along: [
                coefficient(2 <= row, b_y),
                coefficient(1 <= row && row + 1 < count, b_y),
                coefficient(row + 2 < count, b_y),
            ],
            twist: [coefficient(1 <= row, twist), coefficient(row + 1 < count, twist)],
        }
    }

    /// Adds the products to the `sums` of its particles; `INNER` if the two rows on either side exist, which is shorter.
    #[inline(always)]
    fn add<const INNER: bool>(&self, kept: &mut Kept, sums: &mut [f64]) {
        for (tile, sums) in sums.chunks_mut(TILE).enumerate() {
            let tile = tile * TILE..tile * TILE + sums.len();
            self.eval_tile::<INNER>(&tile, kept);
            let ends = self.ends(&tile);
            for own in ends.into_iter().flat_map(|end| (end..tile.len()).step_by(self.columns)) {
                kept.ends[own] = sums[own];
            }
            add(sums, kept);
            // The ends of a row have been taken for neighbours of the rows before and after.
            for (end, beside) in ends.into_iter().zip([PAD + 1, PAD - 1]) {
                for own in (end..tile.len()).step_by(self.columns) {
                    let (along, across) = (kept.along[own], kept.across[PAD + own]);
                    sums[own] = kept.ends[own] + (along + (kept.across[own + beside] - across));
                }
            }
        }
    }

    /// Where in `tile` the first particle is that begins a row, and the first that ends one.
    #[inline(always)]
    fn ends(&self, tile: &Range<usize>) -> [usize; 2] {
        let column = tile.start % self.columns;
        [if column == 0 { 0 } else { self.columns - column }, self.columns - 1 - column]
    }

    /// Evaluates what is kept of `tile`.
    #[inline(always)]
    fn eval_tile<const INNER: bool>(&self, tile: &Range<usize>, kept: &mut Kept) {
        let (columns, count) = (self.columns, tile.len());
        // Ends of a row come later, and what is beyond them does not count.
        let starts_row = tile.start.is_multiple_of(columns);
        let ends_row = tile.end.is_multiple_of(columns);
        let inner = usize::from(starts_row)..count - usize::from(ends_row);
        let length = inner.len();
        let slices = self.slices(tile.start + inner.start, length);
        let across = &mut kept.across[PAD + inner.start..PAD + inner.end];
        let along = &mut kept.along[inner];
        self.eval_row::<INNER>(&slices, across, along);
        if !starts_row {
            kept.across[PAD - 1] = self.beside::<INNER>(tile.start - 1);
        }
        if !ends_row {
            kept.across[PAD + count] = self.beside::<INNER>(tile.end);
        }
        for end in self.ends(tile) {
            for own in (end..count).step_by(columns) {
                let (across, along) = self.end::<INNER>(tile.start + own);
                // It stands for half a width.
                (kept.across[PAD + own], kept.along[own]) = (across, 0.5 * along);
            }
        }
    }

    /// The five rows of `count` particles from number `start` on, and those beside them before and after.
    #[inline(always)]
    fn slices(&self, start: usize, count: usize) -> [&'a [f64]; 7] {
        let [far_before, before, own, after, far_after] = self.first;
        // Without particles there is none beside them.
        let left = (own + start).saturating_sub(1);
        let right = if count == 0 { left } else { own + start + 1 };
        let slice = |first: usize| &self.values[first..first + count];
        [
            slice(far_before + start),
            slice(before + start),
            slice(own + start),
            slice(after + start),
            slice(far_after + start),
            slice(left),
            slice(right),
        ]
    }

    /// q of particle number `index`, which may be the end of a row.
    #[inline(always)]
    fn beside<const INNER: bool>(&self, index: usize) -> f64 {
        let column = index % self.columns;
        if column == 0 || column + 1 == self.columns {
            return self.end::<INNER>(index).0;
        }
        let own = self.first[2] + index;
        self.products::<INNER>(self.column(index), [self.values[own - 1], self.values[own + 1]]).0
    }

    /// q of the end of a row, particle number `index`, as if neighbours in the row were where a straight line leads, and what
    /// its column does.
    #[inline(always)]
    fn end<const INNER: bool>(&self, index: usize) -> (f64, f64) {
        let column = self.column(index);
        self.products::<INNER>(column, [column[2]; 2])
    }

    /// Particle number `index` and its neighbours in its column.
    #[inline(always)]
    fn column(&self, index: usize) -> [f64; 5] {
        let [far_before, before, own, after, far_after] = self.first;
        let value = |first: usize| self.values[first + index];
        [value(far_before), value(before), value(own), value(after), value(far_after)]
    }

    /// Evaluates the particles of `slices`.
    #[inline(always)]
    fn eval_row<const INNER: bool>(&self, slices: &[&[f64]; 7], across: &mut [f64], along: &mut [f64]) {
        let count = across.len();
        let [far_before, before, own, after, far_after, left, right] = slices.map(|slice| &slice[..count]);
        let along = &mut along[..count];
        for i in 0..count {
            let column = [far_before[i], before[i], own[i], after[i], far_after[i]];
            (across[i], along[i]) = self.products::<INNER>(column, [left[i], right[i]]);
        }
    }

    /// q of one particle, and what its column does: of places in its column and beside it.
    #[inline(always)]
    fn products<const INNER: bool>(
        &self,
        [far_before, before, own, after, far_after]: [f64; 5],
        [left, right]: [f64; 2],
    ) -> (f64, f64) {
        let twice = own + own;
        let second_difference = (left + right) - twice;
        if INNER {
            let difference = (before + after) - twice;
            let along = self.along[1] * (((far_before + far_after) - twice) - 4.0 * difference);
            return (self.across * second_difference + self.twist[0] * difference, along);
        }
        let [around_before, around_own, around_after] = self.along;
        let along = (around_before * ((far_before + own) - (before + before))
            + around_after * ((own + far_after) - (after + after)))
            - 2.0 * (around_own * ((before + after) - twice));
        let difference = self.twist[0] * (before - own) + self.twist[1] * (after - own);
        (self.across * second_difference + difference, along)
    }
}

/// Adds what is kept of a tile to its `sums`, as if no row ended in it.
#[inline(always)]
fn add(sums: &mut [f64], kept: &Kept) {
    let count = sums.len();
    let along = &kept.along[..count];
    let before = &kept.across[PAD - 1..][..count];
    let own = &kept.across[PAD..][..count];
    let after = &kept.across[PAD + 1..][..count];
    for i in 0..count {
        sums[i] += along[i] + ((before[i] + after[i]) - (own[i] + own[i]));
    }
}
