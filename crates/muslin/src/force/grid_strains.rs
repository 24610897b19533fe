//! Strains of a grid's springs.

use super::grid_springs::{GridFamily, GridSprings};
use super::row_sweep::NO_STRAINS;
use super::tile::{SHAPES, Tile};
use super::tile_springs::TileSprings;
use super::{Family, StrainSums};
use crate::Points;
use crate::model::Grid;

/// Maxima that are kept side by side.
const LANES: usize = 8;

/// Squared length [m²] of the longest springs by family and direction, of which all have one rest length.
#[derive(Clone, Debug)]
pub(super) struct LongestSprings([[[f64; LANES]; 2]; 3]);

impl LongestSprings {
    /// No springs.
    pub(super) const NONE: Self = Self([[[0.0; LANES]; 2]; 3]);

    /// Looks at the springs of a `tile` of `grid` whose squared lengths are known, with those groups that are `swept`.
    #[inline(always)]
    pub(super) fn raise(
        &mut self,
        springs: &mut TileSprings,
        swept: &[[Option<&GridFamily>; 2]; 3],
        tile: &Tile,
        grid: &Grid,
    ) {
        // No closures, which would not be compiled for the same instructions.
        for (index, directions) in swept.iter().enumerate() {
            for (direction, group) in directions.iter().enumerate() {
                if group.is_some() {
                    let squares = springs.squares([index, direction], tile, grid);
                    raise(&mut self.0[index][direction], squares);
                }
            }
        }
    }

    /// Strains [1] of the longest of `springs` per family; −∞ where there are none.
    #[inline(always)]
    pub(super) fn max_strains(&self, springs: &GridSprings) -> [f64; 3] {
        let (grid, swept) = (&springs.grid, springs.swept());
        let mut max_strains = NO_STRAINS;
        for (index, max) in max_strains.iter_mut().enumerate() {
            for (direction, group) in swept[index].into_iter().enumerate() {
                let shape = &SHAPES[index][direction];
                let has_springs = shape.reach() < grid.columns && shape.rows < grid.rows;
                let spring = group.and_then(|group| group.spring_of((), direction)).filter(|_| has_springs);
                if let Some(spring) = spring {
                    let longest = self.0[index][direction].into_iter().fold(0.0, f64::max);
                    *max = max.max(strain(longest, spring.rest_length));
                }
            }
        }
        max_strains
    }
}

/// Raises `longest` to `values`, lane by lane.
#[inline(always)]
fn raise(longest: &mut [f64; LANES], values: &[f64]) {
    let (chunks, _) = values.as_chunks::<LANES>();
    for chunk in chunks {
        for lane in 0..LANES {
            longest[lane] = if longest[lane] < chunk[lane] { chunk[lane] } else { longest[lane] };
        }
    }
}

/// Adds the strains of all `springs` at `positions` [m], per family in the order of [`Family::ALL`].
pub(super) fn add_strains(springs: &GridSprings, positions: &Points, strains: &mut [StrainSums; 3]) {
    springs.for_each_spring_row(|family, pair, rest_length| {
        let sums = &mut strains[family.family as usize];
        for (own, other) in pair.own.zip(pair.other) {
            let vector = positions.get(other) - positions.get(own);
            let strain = strain(vector.length_squared(), rest_length);
            sums.count += 1;
            sums.min = sums.min.min(strain);
            sums.max = sums.max.max(strain);
            sums.sum += strain;
        }
    });
}

/// Replaces the strain [1] of each particle that has structural springs by the one farthest from zero among them.
pub(super) fn eval_particle_strains(springs: &GridSprings, positions: &Points, strains: &mut [f32]) {
    let mut raise = |particle: usize, value: f64| {
        if f64::from(strains[particle]).abs() < value.abs() {
            strains[particle] = value as f32;
        }
    };
    springs.for_each_spring_row(|family, pair, rest_length| {
        if family.family == Family::Structural {
            for (own, other) in pair.own.zip(pair.other) {
                let vector = positions.get(other) - positions.get(own);
                let value = strain(vector.length_squared(), rest_length);
                raise(own, value);
                raise(other, value);
            }
        }
    });
}

/// Strain e = ℓ / L − 1 [1] from the squared length [m²] and the rest length [m].
fn strain(length_squared: f64, rest_length: f64) -> f64 {
    (length_squared.sqrt() - rest_length) / rest_length
}
