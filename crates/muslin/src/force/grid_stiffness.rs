//! The stiffness tensors of a grid's springs, row by row as their [forces](super::row_sweep).

use std::ops::Range;

use super::Configuration;
use super::grid_springs::{GridSprings, columns};
use super::row_sums::{ABOVE, Border, FarPulls, PAD, Pending, Pulls};
use super::row_sweep::{Sweep, Swept, TileMemory, strips};
use super::stiffness_tensors::{StiffnessTensors, StiffnessTensorsMut};
use super::tile::{Coordinates, Ends, TILE, Tile};
use super::tile_springs::TileSprings;
use crate::instructions::Vectorise;

/// Adds the stiffness tensors w (k_a⁺ n nᵀ + c⁺ (1 − n nᵀ)) of all `springs` to those of a block of `rows`.
///
/// Where both ends coincide there is no direction n, and the larger stiffness counts in all of them.
pub(super) struct TensorSweep<'a, 'b> {
    pub(super) springs: &'a GridSprings,
    pub(super) at: Configuration<'a>,
    pub(super) rows: Range<usize>,
    pub(super) tensors: &'a mut StiffnessTensorsMut<'b>,
    pub(super) sweep: &'a mut Sweep,
}

impl Vectorise for TensorSweep<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { springs, at, rows, tensors, sweep } = self;
        let starts = !sweep.goes_on(&springs.grid, &rows, Swept::Tensors);
        let swept = springs.swept();
        let Sweep { tile, kept_tensors, .. } = sweep;
        let tile = tile.get_or_insert_with(TileMemory::new);
        if starts {
            start(springs, &mut tile.far, kept_tensors);
        }
        for (strip, own) in strips(&springs.grid, &rows, starts) {
            let mut borders = [[Border::default(); 3]; 2];
            for part in Tile::of(&springs.grid, &strip) {
                let TileMemory { springs: tile_springs, tensor_pulls, far, end_copies, weights, .. } =
                    &mut **tile;
                let has_bend_springs = springs.has_bend_springs();
                let coordinates = end_copies.coordinates(&part, &springs.grid, at.positions);
                let (weights, are_free) = weights.eval(&part, &springs.grid, at.particles);
                tile_springs.eval_lengths(coordinates, has_bend_springs, &part);
                // Springs between free particles weigh the same at both ends.
                let weight = if are_free { columns(false) } else { 1.0 };
                let families = if has_bend_springs { 3 } else { 2 };
                for (index, directions) in swept.into_iter().enumerate().take(families) {
                    for (direction, group) in directions.into_iter().enumerate() {
                        tile_springs.eval_tensors([index, direction], (group, weight), &part, &springs.grid);
                    }
                }
                let [next, after] = &mut *kept_tensors;
                let (next, after) = (next.rows_mut(), after.rows_mut());
                let mut sums = tensors.rows_mut();
                for (row, borders) in borders.iter_mut().enumerate() {
                    for ((pulls, far), border) in tensor_pulls.iter_mut().zip(&mut *far).zip(&*borders) {
                        pulls.begin(far, *border);
                    }
                    eval_row(
                        row == 1,
                        (tensor_pulls, far),
                        tile_springs,
                        coordinates,
                        (weights, are_free),
                        has_bend_springs,
                        &part,
                    );
                    let all_pulls = tensor_pulls.iter().zip(&*far).zip(borders);
                    for (entry, ((pulls, far), border)) in all_pulls.enumerate() {
                        *border = pulls.border(far, part.columns.len());
                        let pending = Pending {
                            next: &mut next[row][entry][part.columns.clone()],
                            after: &mut after[row][entry][part.columns.clone()],
                        };
                        let sums = own.clone().map(|own| &mut sums[row][entry][own]);
                        pulls.add_to_tile(far, &part, &springs.grid, sums, pending);
                    }
                }
            }
        }
    }
}

/// Makes room, and begins with nothing from earlier rows.
fn start(springs: &GridSprings, far: &mut [FarPulls; 3], kept: &mut [StiffnessTensors; 2]) {
    let columns = springs.grid.columns;
    if !springs.has_bend_springs() {
        far.fill(FarPulls::ZERO);
    }
    for tensors in kept {
        // Another grid may have had longer rows.
        if tensors.diagonal.len() < columns {
            *tensors = StiffnessTensors::zeros(columns);
        }
        tensors.as_mut().clear();
    }
}

/// Finds the entries [N/m] of a row of the upper triangle of the tensors of all springs in place of pulls: xx, xy and xz, or
/// yy, yz and zz if it is the `second`. `weights` of particles that `are_free` are in the coefficients of the springs.
///
/// Both ends have them with the same sign, and what pulls hold of springs from above or from the left is the opposite.
#[inline(always)]
fn eval_row(
    second: bool,
    pulls: (&mut [Pulls; 3], &mut [FarPulls; 3]),
    springs: &TileSprings,
    coordinates: [Coordinates<'_>; 3],
    (weights, are_free): (Coordinates<'_>, bool),
    has_bend_springs: bool,
    tile: &Tile,
) {
    match (second, are_free, has_bend_springs) {
        (false, false, false) => eval::<false, true, false>(pulls, springs, coordinates, weights, tile),
        (false, false, true) => eval::<false, true, true>(pulls, springs, coordinates, weights, tile),
        (false, true, false) => eval::<false, false, false>(pulls, springs, coordinates, weights, tile),
        (false, true, true) => eval::<false, false, true>(pulls, springs, coordinates, weights, tile),
        (true, false, false) => eval::<true, true, false>(pulls, springs, coordinates, weights, tile),
        (true, false, true) => eval::<true, true, true>(pulls, springs, coordinates, weights, tile),
        (true, true, false) => eval::<true, false, false>(pulls, springs, coordinates, weights, tile),
        (true, true, true) => eval::<true, false, true>(pulls, springs, coordinates, weights, tile),
    }
}

/// The same, `WEIGHTED` or not, with or without `BEND` springs.
#[inline(always)]
fn eval<const SECOND: bool, const WEIGHTED: bool, const BEND: bool>(
    (pulls, far): (&mut [Pulls; 3], &mut [FarPulls; 3]),
    springs: &TileSprings,
    coordinates: [Coordinates<'_>; 3],
    weights: Coordinates<'_>,
    tile: &Tile,
) {
    let count = tile.padded_len().min(TILE);
    let [x, y, z] = coordinates;
    let (x, y, z) = (Ends::of(x, count), Ends::of(y, count), Ends::of(z, count));
    let weights = Ends::of(weights, count);
    let [[across, down], [diagonal, other_diagonal], [far_across, far_down]] = &springs.coefficients;
    let [[across_k, down_k], [diagonal_k, other_diagonal_k], [far_across_k, far_down_k]] =
        springs.stiffnesses();
    let [first, middle, last] = pulls;
    let [far_first, far_middle, far_last] = far;
    for i in 0..count {
        let weight = |weight: f64| if WEIGHTED { weight } else { 1.0 };
        let own = [x.own[i], y.own[i], z.own[i]];
        let right = [x.right[i], y.right[i], z.right[i]];
        let below = [x.down[i], y.down[i], z.down[i]];
        let below_right = [x.down_right[i], y.down_right[i], z.down_right[i]];
        let (of_own, of_right) = (weight(weights.own[i]), weight(weights.right[i]));
        let (of_below, of_below_right) = (weight(weights.down[i]), weight(weights.down_right[i]));
        let across = entries::<SECOND>(across[i], across_k[i], own, right);
        let down = entries::<SECOND>(down[i], down_k[i], own, below);
        let diagonal = entries::<SECOND>(diagonal[i], diagonal_k[i], own, below_right);
        let other_diagonal = entries::<SECOND>(other_diagonal[i], other_diagonal_k[i], right, below);
        let mut sums = [0.0; 3];
        for entry in 0..3 {
            sums[entry] =
                of_right * across[entry] + of_below * down[entry] + of_below_right * diagonal[entry];
        }
        if BEND {
            let far_right = [x.far_right[i], y.far_right[i], z.far_right[i]];
            let far_below = [x.far_down[i], y.far_down[i], z.far_down[i]];
            let far_across = entries::<SECOND>(far_across[i], far_across_k[i], own, far_right);
            let far_down = entries::<SECOND>(far_down[i], far_down_k[i], own, far_below);
            let (of_far_right, of_far_below) = (weight(weights.far_right[i]), weight(weights.far_down[i]));
            for entry in 0..3 {
                sums[entry] += of_far_right * far_across[entry] + of_far_below * far_down[entry];
            }
            far_first.right[PAD + i] = -(of_own * far_across[0]);
            far_middle.right[PAD + i] = -(of_own * far_across[1]);
            far_last.right[PAD + i] = -(of_own * far_across[2]);
            far_first.down[ABOVE + i] = -(of_own * far_down[0]);
            far_middle.down[ABOVE + i] = -(of_own * far_down[1]);
            far_last.down[ABOVE + i] = -(of_own * far_down[2]);
        }
        (first.own[PAD + i], middle.own[PAD + i], last.own[PAD + i]) = (sums[0], sums[1], sums[2]);
        first.right[PAD + i] = of_own * across[0] + of_below * other_diagonal[0];
        middle.right[PAD + i] = of_own * across[1] + of_below * other_diagonal[1];
        last.right[PAD + i] = of_own * across[2] + of_below * other_diagonal[2];
        first.down[ABOVE + i] = -(of_own * down[0] + of_right * other_diagonal[0]);
        middle.down[ABOVE + i] = -(of_own * down[1] + of_right * other_diagonal[1]);
        last.down[ABOVE + i] = -(of_own * down[2] + of_right * other_diagonal[2]);
        first.down_right[ABOVE + i] = -(of_own * diagonal[0]);
        middle.down_right[ABOVE + i] = -(of_own * diagonal[1]);
        last.down_right[ABOVE + i] = -(of_own * diagonal[2]);
    }
}

/// Entries of the tensor `coefficient` d dᵀ + `stiffness` of a spring with the vector d from one end to the other.
#[inline(always)]
fn entries<const SECOND: bool>(coefficient: f64, stiffness: f64, from: [f64; 3], to: [f64; 3]) -> [f64; 3] {
    let [dx, dy, dz] = [to[0] - from[0], to[1] - from[1], to[2] - from[2]];
    if SECOND {
        let along = coefficient * dy;
        [stiffness + along * dy, along * dz, stiffness + coefficient * dz * dz]
    } else {
        let along = coefficient * dx;
        [stiffness + along * dx, along * dy, along * dz]
    }
}
