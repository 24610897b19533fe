//! Forces of all springs of a grid, row by row.
//!
//! Every spring is evaluated once, with the row of its upper end, and kept until both of its ends have been given their
//! part. What a particle gets still has an order of its own: first from the springs that it begins, then from those of its
//! own row that it ends, then from those of rows above. So it does not matter where a block of rows begins.

use std::iter::successors;
use std::ops::Range;

use super::grid_springs::{GridFamily, GridSprings};
use super::grid_strains::LongestSprings;
use super::row_sums::{Border, FarPulls, Pending, Pulls, TileBending, add_structural_bounds};
use super::tile::{EndCopies, TILE, Tile, Weights, has_none_above};
use super::tile_springs::TileSprings;
use super::{Configuration, GridBending, StiffnessTensors};
use crate::instructions::Vectorise;
use crate::model::Grid;
use crate::{Points, PointsMut};

/// What forces keep from one block of particles for the next.
///
/// Whoever asks for the forces or stiffness tensors of blocks in ascending order lends them one, after
/// [`restart`](Self::restart) whenever anything has moved. It has no influence on results.
#[derive(Clone, Debug, Default)]
pub struct Sweep {
    /// First particle of the block for which something is kept, and of what.
    next: Option<(usize, Swept)>,
    pub(super) tile: Option<Box<TileMemory>>,
    /// What springs from earlier rows do to the next row, and to the one after it.
    kept: [KeptRow; 2],
    /// The same, where it is tensors.
    pub(super) kept_tensors: [StiffnessTensors; 2],
    /// Largest strains [1] of the springs whose forces were found with it, per family, if they are watched.
    max_strains: Option<[f64; 3]>,
}

/// Strains of no springs.
pub(super) const NO_STRAINS: [f64; 3] = [f64::NEG_INFINITY; 3];

/// What is added up from the springs of a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Swept {
    Forces,
    ForcesAndBounds,
    Tensors,
}

impl Sweep {
    /// Forgets what it keeps.
    pub fn restart(&mut self) {
        self.next = None;
    }

    /// Whether it is to find the largest strains of all springs whose forces are found with it; forces keep their bits.
    pub fn watch_strains(&mut self, is_watched: bool) {
        self.max_strains = is_watched.then_some(NO_STRAINS);
    }

    /// Raises the largest strains [1] per family, if they are watched.
    pub fn raise_max_strains(&mut self, strains: [f64; 3]) {
        for (max, strain) in self.max_strains.iter_mut().flatten().zip(strains) {
            *max = max.max(strain);
        }
    }

    /// The largest strains [1] since they were taken last, per family in the order of [`Family::ALL`](super::Family::ALL); −∞ where
    /// there are no springs, or they are not watched.
    pub fn take_max_strains(&mut self) -> [f64; 3] {
        self.max_strains.as_mut().map_or(NO_STRAINS, |max_strains| std::mem::replace(max_strains, NO_STRAINS))
    }

    /// Whether what it keeps is `swept` of the rows before `rows`, which are the next to be worked on.
    pub(super) fn goes_on(&mut self, grid: &Grid, rows: &Range<usize>, swept: Swept) -> bool {
        let before = self.next.replace((grid.particle(0, rows.end), swept));
        // Where one grid ends the next begins, but nothing of it goes on there.
        0 < rows.start && before == Some((grid.particle(0, rows.start), swept))
    }
}

/// The strips of a block's `rows`, each with the places of its particles in the block: as many rows as fit into a tile, or
/// one. Where a pass `starts`, first the rows above from which springs reach into the block, one by one, without a place.
pub(super) fn strips(
    grid: &Grid,
    rows: &Range<usize>,
    starts: bool,
) -> impl Iterator<Item = (Range<usize>, Option<Range<usize>>)> + use<> {
    let (start, end, columns) = (rows.start, rows.end, grid.columns);
    let above = if starts { start.saturating_sub(2)..start } else { start..start };
    let rows_per_strip = (TILE / columns).max(1);
    let firsts = successors(Some(start), move |&first| Some(first + rows_per_strip));
    let own = firsts.take_while(move |&first| first < end).map(move |first| {
        let last = (first + rows_per_strip).min(end);
        (first..last, Some((first - start) * columns..(last - start) * columns))
    });
    above.map(|row| (row..row + 1, None)).chain(own)
}

/// All that is computed of a tile, in an order in which no loop writes where, but for multiples of a page, it reads a little later:
/// processors confuse the two.
#[derive(Clone, Debug)]
#[repr(C)]
pub(super) struct TileMemory {
    pub(super) springs: TileSprings,
    pub(super) pulls: Pulls,
    /// Those of a rigidity along each axis, as it is found for all axes at once; else the first is for all.
    pub(super) far: [FarPulls; 3],
    bound_pulls: Pulls,
    far_bounds: FarPulls,
    /// Of three entries of tensors.
    pub(super) tensor_pulls: [Pulls; 3],
    pub(super) end_copies: EndCopies,
    pub(super) weights: Weights,
    longest: LongestSprings,
}

/// The opposite of forces [N] on the particles of a row, and bounds [N/m] on their stiffness.
#[derive(Clone, Debug, Default)]
struct KeptRow {
    forces: Points,
    bounds: Vec<f64>,
}

/// Adds the forces of all `springs` and of their rigidity on a block of `rows`, and the stiffness bounds of the springs if there
/// are any to add to.
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
        let is_bounded = bounds.is_some();
        let swept = if is_bounded { Swept::ForcesAndBounds } else { Swept::Forces };
        let starts = !sweep.goes_on(&springs.grid, &rows, swept);
        let is_watched = sweep.max_strains.is_some();
        let Sweep { tile, kept, .. } = &mut *sweep;
        let tile = tile.get_or_insert_with(TileMemory::new);
        let swept = springs.swept();
        if is_watched {
            tile.longest = LongestSprings::NONE;
        }
        let varies = swept.map(|directions| directions.into_iter().any(varies));
        let (first, end) = (rows.start.saturating_sub(2), rows.end + 2);
        let near = springs.grid.particle(0, first)..springs.grid.particle(0, end);
        let has_pins = is_bounded && at.particles.runs(&near).any(|run| run.is_pinned);
        let mut pass = RowPass { springs, swept, varies, at, tile, kept, is_bounded, has_pins, is_watched };
        if starts {
            pass.start(rows.start);
        }
        for (strip, own) in strips(&springs.grid, &rows, starts) {
            let PointsMut { x, y, z } = &mut *forces;
            let (strip_forces, strip_bounds) = match own {
                Some(own) => (
                    Some([&mut x[own.clone()], &mut y[own.clone()], &mut z[own.clone()]]),
                    bounds.as_mut().map(|bounds| &mut bounds[own]),
                ),
                None => (None, None),
            };
            pass.strip(strip, strip_forces, strip_bounds);
        }
        if is_watched {
            let max_strains = tile.longest.max_strains(springs);
            sweep.raise_max_strains(max_strains);
        }
    }
}

impl TileMemory {
    pub(super) fn new() -> Box<Self> {
        Box::new(Self {
            springs: TileSprings::ZERO,
            pulls: Pulls::ZERO,
            far: [FarPulls::ZERO; 3],
            bound_pulls: Pulls::ZERO,
            far_bounds: FarPulls::ZERO,
            tensor_pulls: [Pulls::ZERO; 3],
            end_copies: EndCopies::ZERO,
            weights: Weights::ZERO,
            longest: LongestSprings::NONE,
        })
    }
}

/// One strip after the other.
struct RowPass<'a> {
    springs: &'a GridSprings,
    swept: [[Option<&'a GridFamily>; 2]; 3],
    /// Whether the stiffness of a family varies.
    varies: [bool; 3],
    at: Configuration<'a>,
    tile: &'a mut TileMemory,
    kept: &'a mut [KeptRow; 2],
    is_bounded: bool,
    /// Whether any particle is pinned that springs of these rows may end at.
    has_pins: bool,
    /// Whether the longest springs are to be found.
    is_watched: bool,
}

impl RowPass<'_> {
    /// Makes room, and begins at `first_row` with nothing from earlier rows.
    fn start(&mut self, first_row: usize) {
        let columns = self.springs.grid.columns;
        self.tile.springs.restart();
        if self.springs.tile_bending() == TileBending::None {
            self.tile.far.fill(FarPulls::ZERO);
        }
        if self.is_bounded {
            self.tile.far_bounds = FarPulls::ZERO;
            self.tile.bound_pulls.down_right.fill(0.0);
        }
        // The first strip of a narrow grid reads nothing of it.
        let is_read = !has_none_above(&self.springs.grid, first_row);
        for KeptRow { forces, bounds } in &mut *self.kept {
            // Another grid may have had longer rows.
            if forces.len() < columns {
                *forces = Points::zeros(columns);
            } else if is_read {
                forces.slice_mut(&(0..columns)).fill(0.0);
            }
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
        let mut borders = [Border::default(); 4];
        for tile in Tile::of(&self.springs.grid, &rows) {
            let TileMemory {
                springs, pulls, far, bound_pulls, far_bounds, end_copies, weights, longest, ..
            } = &mut *self.tile;
            let grid = &self.springs.grid;
            let coordinates = end_copies.coordinates(&tile, grid, self.at.positions);
            let has_bend_springs = self.springs.has_bend_springs();
            match &self.springs.bending {
                Some(bending) => {
                    springs.eval_lengths_and_bends(coordinates, bending, far, &tile, grid);
                }
                None => springs.eval_lengths(coordinates, has_bend_springs, &tile),
            }
            if self.is_watched {
                longest.raise(springs, &self.swept, &tile, grid);
            }
            let twists = self.springs.bending.as_ref().map_or([0.0; 3], GridBending::twists);
            let families = if has_bend_springs { 3 } else { 2 };
            for (index, directions) in self.swept.into_iter().enumerate().take(families) {
                for (direction, group) in directions.into_iter().enumerate() {
                    // Bounds are those of structural springs at least.
                    let bounded = self.is_bounded && (index == 0 || self.varies[index]);
                    springs.eval_coefficients(
                        [index, direction],
                        (group, twists[index]),
                        bounded,
                        &tile,
                        grid,
                    );
                }
            }
            let bending = self.springs.tile_bending();
            let [next, after] = &mut *self.kept;
            let kept = [
                (&mut next.forces.x, &mut after.forces.x),
                (&mut next.forces.y, &mut after.forces.y),
                (&mut next.forces.z, &mut after.forces.z),
            ];
            for (axis, (next, after)) in kept.into_iter().enumerate() {
                let far = &mut far[if bending == TileBending::Rigidity { axis } else { 0 }];
                pulls.eval(far, (springs, bending), coordinates[axis], borders[axis], &tile);
                borders[axis] = pulls.border(far, tile.columns.len());
                let pending = Pending {
                    next: &mut next[tile.columns.clone()],
                    after: &mut after[tile.columns.clone()],
                };
                let forces = forces.as_mut().map(|forces| &mut *forces[axis]);
                pulls.add_to_tile(far, &tile, grid, forces, pending);
            }
            if self.is_bounded {
                let pending = Pending {
                    next: &mut next.bounds[tile.columns.clone()],
                    after: &mut after.bounds[tile.columns.clone()],
                };
                let particles = self.at.particles;
                let is_simple = !self.varies[1] && !self.varies[2];
                if is_simple && (!self.has_pins || tile.is_free(grid, particles)) {
                    let bounds = bounds.as_deref_mut();
                    borders[3] = add_structural_bounds(springs, borders[3], &tile, bounds, pending.next);
                } else {
                    let (weights, _) = weights.eval(&tile, grid, particles);
                    bound_pulls.eval_bounds(far_bounds, springs, self.varies, weights, borders[3], &tile);
                    borders[3] = bound_pulls.border(far_bounds, tile.columns.len());
                    bound_pulls.add_to_tile(far_bounds, &tile, grid, bounds.as_deref_mut(), pending);
                }
            }
        }
    }
}

/// Whether the stiffness of springs varies with their length.
fn varies(group: Option<&GridFamily>) -> bool {
    group.is_some_and(|group| !group.has_constant_stiffness())
}
