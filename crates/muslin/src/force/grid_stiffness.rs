//! The stiffness tensors of a grid's springs, row by row as their [forces](super::row_sweep).

use std::ops::Range;

use super::Configuration;
use super::grid_springs::GridSprings;
use super::row_sums::{ABOVE, Border, FarPulls, PAD, Pending, Pulls};
use super::row_sweep::{Sweep, Swept, TileMemory, strips};
use super::stiffness_tensors::{StiffnessTensors, StiffnessTensorsMut};
use super::tile::{Coordinates, Ends, TILE, Tile};
use super::tile_springs::TileSprings;
use crate::instructions::Vectorise;

/// Coordinates that each entry of a tensor multiplies, in the order of [`StiffnessTensorsMut::entries_mut`].
const ENTRIES: [[usize; 2]; 6] = [[0, 0], [1, 1], [2, 2], [1, 2], [0, 2], [0, 1]];

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
            let mut borders = [Border::default(); 6];
            for part in Tile::of(&springs.grid, &strip) {
                let TileMemory { springs: tile_springs, pulls, far: [far, ..], end_copies, weights, .. } =
                    &mut **tile;
                let has_bend_springs = springs.has_bend_springs();
                let coordinates = end_copies.coordinates(&part, &springs.grid, at.positions);
                let weights = weights.eval(&part, &springs.grid, at.particles);
                tile_springs.eval_lengths(coordinates, has_bend_springs, &part);
                let families = if has_bend_springs { 3 } else { 2 };
                for (index, directions) in swept.into_iter().enumerate().take(families) {
                    for (direction, group) in directions.into_iter().enumerate() {
                        tile_springs.eval_tensors([index, direction], group, &part, &springs.grid);
                    }
                }
                let [next, after] = &mut *kept_tensors;
                let kept = next.entries_mut().into_iter().zip(after.entries_mut());
                for (entry, (sums, (next, after))) in tensors.entries_mut().into_iter().zip(kept).enumerate()
                {
                    let [a, b] = ENTRIES[entry];
                    let axes = [coordinates[a], coordinates[b]];
                    pulls.begin(far, borders[entry]);
                    match (entry < 3, has_bend_springs) {
                        (true, true) => {
                            eval_entry::<true, true>(pulls, far, tile_springs, axes, weights, &part);
                        }
                        (true, false) => {
                            eval_entry::<true, false>(pulls, far, tile_springs, axes, weights, &part);
                        }
                        (false, true) => {
                            eval_entry::<false, true>(pulls, far, tile_springs, axes, weights, &part);
                        }
                        (false, false) => {
                            eval_entry::<false, false>(pulls, far, tile_springs, axes, weights, &part);
                        }
                    }
                    borders[entry] = pulls.border(far, part.columns.len());
                    let pending = Pending {
                        next: &mut next[part.columns.clone()],
                        after: &mut after[part.columns.clone()],
                    };
                    let sums = own.clone().map(|own| &mut sums[own]);
                    pulls.add_to_tile(far, &part, &springs.grid, sums, pending);
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

/// Finds one entry [N/m] of the tensors of all springs in place of pulls, with the `coordinates` that it multiplies, and the
/// `weights` of particles; `DIAGONAL` if these are the same.
///
/// Both ends have it with the same sign, and what pulls hold of springs from above or from the left is the opposite.
#[inline(always)]
fn eval_entry<const DIAGONAL: bool, const BEND: bool>(
    pulls: &mut Pulls,
    far: &mut FarPulls,
    springs: &TileSprings,
    coordinates: [Coordinates<'_>; 2],
    weights: Coordinates<'_>,
    tile: &Tile,
) {
    let count = tile.padded_len().min(TILE);
    let [a, b] = coordinates.map(|coordinates| Ends::of(coordinates, count));
    let weights = Ends::of(weights, count);
    let [[across, down], [diagonal, other_diagonal], [far_across, far_down]] = &springs.coefficients;
    let [[across_k, down_k], [diagonal_k, other_diagonal_k], [far_across_k, far_down_k]] =
        &springs.stiffnesses;
    let pulls_own = &mut pulls.own[PAD..][..count];
    let pulls_right = &mut pulls.right[PAD..][..count];
    let pulls_down = &mut pulls.down[ABOVE..][..count];
    let pulls_down_right = &mut pulls.down_right[ABOVE..][..count];
    let (pulls_far_right, pulls_far_down) = (&mut far.right[PAD..][..count], &mut far.down[ABOVE..][..count]);
    for i in 0..count {
        let entry = |coefficient: f64, stiffness: f64, da: f64, db: f64| {
            let along = coefficient * da * db;
            if DIAGONAL { stiffness + along } else { along }
        };
        let (own_a, own_b, own) = (a.own[i], b.own[i], weights.own[i]);
        let (right_a, right_b, right) = (a.right[i], b.right[i], weights.right[i]);
        let (down_a, down_b, below) = (a.down[i], b.down[i], weights.down[i]);
        let across = entry(across[i], across_k[i], right_a - own_a, right_b - own_b);
        let down = entry(down[i], down_k[i], down_a - own_a, down_b - own_b);
        let diagonal = entry(diagonal[i], diagonal_k[i], a.down_right[i] - own_a, b.down_right[i] - own_b);
        let other_diagonal =
            entry(other_diagonal[i], other_diagonal_k[i], down_a - right_a, down_b - right_b);
        pulls_own[i] = right * across + below * down + weights.down_right[i] * diagonal;
        pulls_right[i] = own * across + below * other_diagonal;
        pulls_down[i] = -(own * down + right * other_diagonal);
        pulls_down_right[i] = -(own * diagonal);
        if BEND {
            let far_across =
                entry(far_across[i], far_across_k[i], a.far_right[i] - own_a, b.far_right[i] - own_b);
            let far_down = entry(far_down[i], far_down_k[i], a.far_down[i] - own_a, b.far_down[i] - own_b);
            pulls_own[i] += weights.far_right[i] * far_across + weights.far_down[i] * far_down;
            pulls_far_right[i] = -(own * far_across);
            pulls_far_down[i] = -(own * far_down);
        }
    }
}
