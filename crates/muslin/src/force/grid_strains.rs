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
        springs.for_each_spring_row(|family, pair, rest_length| {
            let max = &mut max_strains[family.family as usize];
            *max = max.max(strain(max_length_squared(positions, &pair), rest_length));
        });
    }
}

/// The largest squared length [m²] of the springs between `own` and `other` particles.
#[inline(always)]
fn max_length_squared(positions: &Points, pair: &RowPair) -> f64 {
    let count = pair.own.len();
    let Points { x, y, z } = positions;
    let [x, y, z] = [x, y, z].map(|values| &values[pair.own.clone()][..count]);
    let Points { x: other_x, y: other_y, z: other_z } = positions;
    let [other_x, other_y, other_z] =
        [other_x, other_y, other_z].map(|values| &values[pair.other.clone()][..count]);
    let length_squared = |i: usize| {
        let [dx, dy, dz] = [other_x[i] - x[i], other_y[i] - y[i], other_z[i] - z[i]];
        dx * dx + dy * dy + dz * dz
    };
    let mut maxima = [0.0_f64; LANES];
    let mut raise = |start: usize| {
        for (lane, max) in maxima.iter_mut().enumerate() {
            let value = length_squared(start + lane);
            *max = if value > *max { value } else { *max };
        }
    };
    if count < LANES {
        return (0..count).map(length_squared).fold(0.0, f64::max);
    }
    for start in (0..count).step_by(LANES) {
        // In the end some springs again, which costs less than the last ones one by one.
        raise(start.min(count - LANES));
    }
    maxima.into_iter().fold(0.0, |max, value| if value > max { value } else { max })
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
