//! What the springs of a tile do to its particles and to later rows, one coordinate at a time.

use super::tile::{Coordinates, Ends, TILE, Tile, has_none_above};
use super::tile_springs::TileSprings;
use crate::model::Grid;

/// Room for the springs of the last particles before a tile.
pub(super) const PAD: usize = 8;

/// The same, and before these room for two rows above a narrow grid, which has none there: always zeros.
pub(super) const ABOVE: usize = TILE + PAD;

type Padded = [f64; PAD + TILE];

type PaddedAbove = [f64; ABOVE + TILE];

/// What the springs numbered by the particles of a tile pull at along one axis [N]. A spring's force on one end is the
/// opposite of that on the other.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Pulls {
    /// Of all springs but the second diagonal, on the particle itself.
    pub(super) own: Padded,
    /// On the particle to the right.
    pub(super) right: Padded,
    /// On the particle below, the opposite.
    pub(super) down: PaddedAbove,
    /// On the particle below to the right, the opposite.
    pub(super) down_right: PaddedAbove,
}

/// What resists bending, and so reaches to the next particle but one, pulls at along one axis [N], with the signs of [`Pulls`].
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct FarPulls {
    /// On the next particle but one to the right, the opposite.
    pub(super) right: Padded,
    /// On the particle two rows down, the opposite.
    pub(super) down: PaddedAbove,
}

/// The pulls along one axis [N] of the last springs of a tile on the first particles of the next in the same row.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Border {
    right: f64,
    far_right: [f64; 2],
    down_right: f64,
}

/// What springs of earlier rows do to the next row, and to the row after it, along one axis [N]: the opposite of it.
pub(super) struct Pending<'a> {
    pub(super) next: &'a mut [f64],
    pub(super) after: &'a mut [f64],
}

/// What resists bending in a tile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum TileBending {
    None,
    /// Bend springs.
    Springs,
    /// Second differences along rows and columns.
    Rigidity,
}

impl FarPulls {
    /// Nothing resists bending.
    pub(super) const ZERO: Self = Self { right: [0.0; PAD + TILE], down: [0.0; ABOVE + TILE] };
}

impl Pulls {
    pub(super) const ZERO: Self = Self {
        own: [0.0; PAD + TILE],
        right: [0.0; PAD + TILE],
        down: [0.0; ABOVE + TILE],
        down_right: [0.0; ABOVE + TILE],
    };

    /// Finds the pulls of `springs` whose ends have the `coordinates` [m], beside the tile that left the `border`. Those of a
    /// rigidity are `far` already; where nothing resists bending these must be zero, and stay so.
    #[inline(always)]
    pub(super) fn eval(
        &mut self,
        far: &mut FarPulls,
        (springs, bending): (&TileSprings, TileBending),
        coordinates: Coordinates<'_>,
        border: Border,
        tile: &Tile,
    ) {
        self.begin(far, border);
        let count = tile.padded_len();
        match bending {
            TileBending::None => eval_pulls::<false, false>(self, far, springs, coordinates, count),
            TileBending::Springs => eval_pulls::<true, false>(self, far, springs, coordinates, count),
            TileBending::Rigidity => eval_pulls::<false, true>(self, far, springs, coordinates, count),
        }
    }

    /// Finds the stiffness [N/m] of structural `springs` and of other families if it `varies`, in place of pulls, for
    /// particles with the `weights` of neighbours, beside the tile that left the `border`. What is not written must be
    /// zero.
    ///
    /// Both ends have it with the same sign, and what pulls hold of springs from above or from the left is the opposite.
    #[inline(always)]
    pub(super) fn eval_bounds(
        &mut self,
        far: &mut FarPulls,
        springs: &TileSprings,
        varies: [bool; 3],
        weights: Coordinates<'_>,
        border: Border,
        tile: &Tile,
    ) {
        self.begin(far, border);
        match varies {
            [_, false, false] => eval_bounds::<false, false>(self, far, springs, weights, tile),
            [_, true, false] => eval_bounds::<true, false>(self, far, springs, weights, tile),
            [_, false, true] => eval_bounds::<false, true>(self, far, springs, weights, tile),
            [_, true, true] => eval_bounds::<true, true>(self, far, springs, weights, tile),
        }
    }

    /// Begins beside the tile that left the `border`.
    pub(super) fn begin(&mut self, far: &mut FarPulls, border: Border) {
        self.right[PAD - 1] = border.right;
        [far.right[PAD - 2], far.right[PAD - 1]] = border.far_right;
        self.down_right[ABOVE - 1] = border.down_right;
    }

    /// What the first `count` particles leave to the next tile.
    pub(super) fn border(&self, far: &FarPulls, count: usize) -> Border {
        // In the second to last column of a grid only the first two can be.
        let last = count - 1;
        Border {
            right: self.right[PAD + last],
            far_right: [far.right[PAD + last - 1], far.right[PAD + last]],
            down_right: self.down_right[ABOVE + last],
        }
    }

    /// Adds to the `forces` of a strip all that pulls at the particles of a `tile` of `grid`, and passes on what
    /// its springs do to later rows.
    #[inline(always)]
    pub(super) fn add_to_tile(
        &self,
        far: &FarPulls,
        tile: &Tile,
        grid: &Grid,
        mut forces: Option<&mut [f64]>,
        Pending { next, after }: Pending<'_>,
    ) {
        let columns = grid.columns;
        // The first two rows get something from earlier strips, all others from this one alone.
        let apart = if has_none_above(grid, tile.rows.start) { 0 } else { tile.rows.len().min(2) };
        for row in 0..apart {
            let first = row * columns;
            let own = first + tile.columns.start..first + tile.columns.end;
            match &mut forces {
                Some(forces) => add_to_row(self, far, first, &mut forces[own], next, after),
                None => pass_down(self, far, first, next, after),
            }
        }
        if apart < tile.rows.len() {
            if let Some(forces) = forces {
                add_within(self, far, [apart * columns, columns], &mut forces[apart * columns..]);
            }
            if tile.rows.end < grid.rows {
                let last = tile.len() - columns;
                after.copy_from_slice(&far.down[ABOVE + last - columns..][..columns]);
                pass_down(self, far, last, next, after);
            }
        }
    }
}

#[inline(always)]
fn eval_pulls<const BEND: bool, const RIGID: bool>(
    pulls: &mut Pulls,
    far: &mut FarPulls,
    springs: &TileSprings,
    coordinates: Coordinates<'_>,
    count: usize,
) {
    let count = count.min(TILE);
    let Ends { own, right, far_right, down, down_right, far_down } = Ends::of(coordinates, count);
    let [[across_c, down_c], [diagonal_c, other_diagonal_c], [far_across_c, far_down_c]] =
        &springs.coefficients;
    let pulls_own = &mut pulls.own[PAD..][..count];
    let pulls_right = &mut pulls.right[PAD..][..count];
    let pulls_down = &mut pulls.down[ABOVE..][..count];
    let pulls_down_right = &mut pulls.down_right[ABOVE..][..count];
    let (pulls_far_right, pulls_far_down) = (&mut far.right[PAD..][..count], &mut far.down[ABOVE..][..count]);
    for i in 0..count {
        let across = across_c[i] * (right[i] - own[i]);
        let below = down_c[i] * (down[i] - own[i]);
        let diagonal = diagonal_c[i] * (down_right[i] - own[i]);
        let other_diagonal = other_diagonal_c[i] * (down[i] - right[i]);
        pulls_own[i] = across + below + diagonal;
        pulls_right[i] = other_diagonal - across;
        pulls_down[i] = below + other_diagonal;
        pulls_down_right[i] = diagonal;
        if BEND {
            let far_across = far_across_c[i] * (far_right[i] - own[i]);
            let far_below = far_down_c[i] * (far_down[i] - own[i]);
            pulls_own[i] += far_across + far_below;
            pulls_far_right[i] = far_across;
            pulls_far_down[i] = far_below;
        }
        if RIGID {
            // Three in a line are pulled at their ends, and twice as much the other way at their middle.
            let (across, along) = (pulls_far_right[i], pulls_far_down[i]);
            pulls_own[i] -= across + along;
            pulls_right[i] += across + across;
            pulls_down[i] -= along + along;
        }
    }
}

#[inline(always)]
fn eval_bounds<const SHEAR: bool, const BEND: bool>(
    pulls: &mut Pulls,
    far: &mut FarPulls,
    springs: &TileSprings,
    weights: Coordinates<'_>,
    tile: &Tile,
) {
    let count = tile.padded_len().min(TILE);
    let weights = Ends::of(weights, count);
    let [[across, down], [diagonal, other_diagonal], [far_across, far_down]] = springs.stiffnesses();
    let pulls_own = &mut pulls.own[PAD..][..count];
    let pulls_right = &mut pulls.right[PAD..][..count];
    let pulls_down = &mut pulls.down[ABOVE..][..count];
    let pulls_down_right = &mut pulls.down_right[ABOVE..][..count];
    let (pulls_far_right, pulls_far_down) = (&mut far.right[PAD..][..count], &mut far.down[ABOVE..][..count]);
    for i in 0..count {
        let (own, right, below) = (weights.own[i], weights.right[i], weights.down[i]);
        let mut sum = right * across[i] + below * down[i];
        if SHEAR {
            sum += weights.down_right[i] * diagonal[i];
            pulls_right[i] = own * across[i] + below * other_diagonal[i];
            pulls_down[i] = -(own * down[i] + right * other_diagonal[i]);
            pulls_down_right[i] = -(own * diagonal[i]);
        } else {
            pulls_right[i] = own * across[i];
            pulls_down[i] = -(own * down[i]);
        }
        if BEND {
            sum += weights.far_right[i] * far_across[i] + weights.far_down[i] * far_down[i];
            pulls_far_right[i] = -(own * far_across[i]);
            pulls_far_down[i] = -(own * far_down[i]);
        }
        pulls_own[i] = sum;
    }
}

/// What [`Pulls::eval_bounds`] and [`Pulls::add_to_tile`] do, with the same bits, where no other springs than structural ones vary
/// and no particle is pinned: adds their stiffness [N/m] to the `bounds` on a strip, and passes on to the `next` row. What the tile
/// leaves to the one beside it.
#[inline(always)]
pub(super) fn add_structural_bounds(
    springs: &TileSprings,
    border: Border,
    tile: &Tile,
    bounds: Option<&mut [f64]>,
    next: &mut [f64],
) -> Border {
    let [across, down] = &springs.stiffnesses()[0];
    let (count, columns) = (tile.len().min(TILE), tile.columns.len());
    let (across, down) = (&across[..count], &down[..count]);
    let last = count - columns;
    if let Some(bounds) = bounds {
        let first = tile.columns.start;
        let bounds = &mut bounds[first..first + count];
        // Both ends are free, and have it twice.
        bounds[0] += 2.0 * (across[0] + down[0]) + border.right - next[0];
        {
            let (left, across, down) = (&across[..columns - 1], &across[1..columns], &down[1..columns]);
            let (bounds, next) = (&mut bounds[1..columns], &next[1..columns]);
            for i in 0..bounds.len() {
                bounds[i] += 2.0 * (across[i] + down[i] + left[i]) - next[i];
            }
        }
        let (left, across, above) = (&across[columns - 1..][..last], &across[columns..], &down[..last]);
        let (bounds, down) = (&mut bounds[columns..], &down[columns..]);
        for i in 0..bounds.len() {
            bounds[i] += 2.0 * (across[i] + down[i] + left[i] + above[i]);
        }
    }
    for (next, down) in next.iter_mut().zip(&down[last..]) {
        *next = -(2.0 * down);
    }
    Border { right: 2.0 * across[count - 1], ..Border::default() }
}

/// Adds all forces [N] along one axis on a row of particles, and passes on.
#[inline(always)]
fn add_to_row(
    pulls: &Pulls,
    far: &FarPulls,
    first: usize,
    forces: &mut [f64],
    next: &mut [f64],
    after: &mut [f64],
) {
    let count = forces.len();
    let (first, below) = (PAD + first, ABOVE + first);
    let (own, right) = (&pulls.own[first..][..count], &pulls.right[first - 1..][..count]);
    let far_right = &far.right[first - 2..][..count];
    let (down, down_right) = (&pulls.down[below..][..count], &pulls.down_right[below - 1..][..count]);
    let far_down = &far.down[below..][..count];
    let (next, after) = (&mut next[..count], &mut after[..count]);
    for i in 0..count {
        forces[i] += own[i] + right[i] - far_right[i] - next[i];
        next[i] = after[i] + down[i] + down_right[i];
        after[i] = far_down[i];
    }
}

/// Passes on what the springs of a row of particles do to later rows.
#[inline(always)]
fn pass_down(pulls: &Pulls, far: &FarPulls, first: usize, next: &mut [f64], after: &mut [f64]) {
    let count = next.len();
    let first = ABOVE + first;
    let (down, down_right) = (&pulls.down[first..][..count], &pulls.down_right[first - 1..][..count]);
    let far_down = &far.down[first..][..count];
    let after = &mut after[..count];
    for i in 0..count {
        next[i] = after[i] + down[i] + down_right[i];
        after[i] = far_down[i];
    }
}

/// What [`add_to_row`] does row by row, with the same bits, for rows of `columns` from the particle `first` on; the two rows above
/// it are of the same tile, or there are none.
#[inline(always)]
fn add_within(pulls: &Pulls, far: &FarPulls, [first, columns]: [usize; 2], forces: &mut [f64]) {
    let count = forces.len();
    let (above, far_above) = (ABOVE + first - columns, ABOVE + first - 2 * columns);
    let first = PAD + first;
    let (own, right) = (&pulls.own[first..][..count], &pulls.right[first - 1..][..count]);
    let far_right = &far.right[first - 2..][..count];
    let (down, down_right) = (&pulls.down[above..][..count], &pulls.down_right[above - 1..][..count]);
    let far_down = &far.down[far_above..][..count];
    for i in 0..count {
        forces[i] += own[i] + right[i] - far_right[i] - (far_down[i] + down[i] + down_right[i]);
    }
}
