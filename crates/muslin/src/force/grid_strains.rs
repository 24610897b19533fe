//! Strains of a grid's springs.

use super::grid_springs::{GridSprings, RowPair};
use super::{Family, StrainSums};
use crate::Points;
use crate::instructions::Vectorise;

/// Maxima that are kept side by side.
const LANES: usize = 8;

/// Raises `max_strains` [1], per family, to the largest strain of any of the `springs` at `positions` [m].
///
/// Of all springs of one rest length the longest is found by its squared length.
pub(super) struct RaiseMaxStrains<'a> {
    pub(super) springs: &'a GridSprings,
    pub(super) positions: &'a Points,
    pub(super) max_strains: &'a mut [f64; 3],
}

impl Vectorise for RaiseMaxStrains<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { springs, positions, max_strains } = self;
        // No closures, which would not be compiled for the same instructions.
        for group in &springs.families {
            let ahead = || group.neighbours.iter().filter(|neighbour| neighbour.is_ahead());
            // Of the springs in both directions of a family.
            let mut longest = [[0.0; LANES]; 2];
            for row in 0..springs.grid.rows {
                for (longest, neighbour) in longest.iter_mut().zip(ahead()) {
                    for pair in neighbour.row_pairs(&springs.grid, row, group.lines) {
                        raise_squared_lengths(longest, positions, &pair);
                    }
                }
            }
            let max = &mut max_strains[group.family as usize];
            for (longest, neighbour) in longest.iter().zip(ahead()) {
                let longest = longest.iter().fold(0.0, |max, &value| if value > max { value } else { max });
                *max = max.max(strain(longest, neighbour.rest_length));
            }
        }
    }
}

/// Raises `longest` to the squared lengths [m²] of the springs between `own` and `other` particles.
#[inline(always)]
fn raise_squared_lengths(longest: &mut [f64; LANES], positions: &Points, RowPair { own, other }: &RowPair) {
    let Points { x, y, z } = positions;
    let (own_x, own_y, own_z) = (&x[own.clone()], &y[own.clone()], &z[own.clone()]);
    let (other_x, other_y, other_z) = (&x[other.clone()], &y[other.clone()], &z[other.clone()]);
    let count = own_x.len();
    if count < LANES {
        for i in 0..count {
            let [dx, dy, dz] = [other_x[i] - own_x[i], other_y[i] - own_y[i], other_z[i] - own_z[i]];
            let value = dx * dx + dy * dy + dz * dz;
            longest[i] = if value > longest[i] { value } else { longest[i] };
        }
        return;
    }
    for start in (0..count).step_by(LANES) {
        // In the end some springs again, which costs less than the last ones one by one.
        let start = start.min(count - LANES);
        let (own_x, other_x) = (&own_x[start..][..LANES], &other_x[start..][..LANES]);
        let (own_y, other_y) = (&own_y[start..][..LANES], &other_y[start..][..LANES]);
        let (own_z, other_z) = (&own_z[start..][..LANES], &other_z[start..][..LANES]);
        for i in 0..LANES {
            let [dx, dy, dz] = [other_x[i] - own_x[i], other_y[i] - own_y[i], other_z[i] - own_z[i]];
            let value = dx * dx + dy * dy + dz * dz;
            longest[i] = if value > longest[i] { value } else { longest[i] };
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
