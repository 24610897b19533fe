//! The stiffness that each particle feels, direction by direction.

use crate::instructions::Vectorise;
use crate::{InstructionSet, Points, PointsMut};

/// Part of a tensor's eigenvalue [1] that is added to it, so that rounding never makes it too small: r below has errors of
/// about 1e-15, and where two eigenvalues meet s has the root of that.
const ROUNDING: f64 = 1e-6;

/// Anisotropy p / m [1] below which the invariants of a tensor are rounding.
const LEAST_ANISOTROPY: f64 = 1e-12;

/// Coefficients of a polynomial in s that is up to 2e-7 from cos(⅔ arccos s), for 0 ≤ s ≤ 1.
const COSINE: [f64; 7] = [
    0.500_000_163_201,
    0.577_333_460_045,
    -0.110_823_040_238,
    0.051_547_910_136,
    -0.026_538_217_927,
    0.010_623_049_589,
    -0.002_143_448_159,
];

/// Symmetric 3 x 3 tensors [N/m], one per particle, as a structure of arrays.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StiffnessTensors {
    /// Entries xx, yy and zz.
    pub diagonal: Points,
    /// Entries yz, xz and xy.
    pub off_diagonal: Points,
}

impl StiffnessTensors {
    /// `count` tensors without stiffness.
    #[must_use]
    pub fn zeros(count: usize) -> Self {
        Self { diagonal: Points::zeros(count), off_diagonal: Points::zeros(count) }
    }

    /// Exclusive access to all tensors.
    pub fn as_mut(&mut self) -> StiffnessTensorsMut<'_> {
        StiffnessTensorsMut { diagonal: self.diagonal.as_mut(), off_diagonal: self.off_diagonal.as_mut() }
    }

    /// Exclusive access to the first `count` tensors.
    ///
    /// # Panics
    /// If there are fewer.
    pub fn first_mut(&mut self, count: usize) -> StiffnessTensorsMut<'_> {
        StiffnessTensorsMut {
            diagonal: self.diagonal.slice_mut(&(0..count)),
            off_diagonal: self.off_diagonal.slice_mut(&(0..count)),
        }
    }

    /// The arrays of the entries xx, xy and xz, and of yy, yz and zz.
    pub(super) fn rows_mut(&mut self) -> [[&mut [f64]; 3]; 2] {
        let Self { diagonal, off_diagonal } = self;
        [
            [&mut diagonal.x, &mut off_diagonal.z, &mut off_diagonal.y],
            [&mut diagonal.y, &mut off_diagonal.x, &mut diagonal.z],
        ]
    }
}

/// Exclusive access to the [`StiffnessTensors`] of consecutive particles.
#[derive(Debug, Default)]
pub struct StiffnessTensorsMut<'a> {
    /// Entries xx, yy and zz.
    pub diagonal: PointsMut<'a>,
    /// Entries yz, xz and xy.
    pub off_diagonal: PointsMut<'a>,
}

impl StiffnessTensorsMut<'_> {
    /// The arrays of the entries xx, xy and xz, and of yy, yz and zz.
    pub(super) fn rows_mut(&mut self) -> [[&mut [f64]; 3]; 2] {
        let Self { diagonal, off_diagonal } = self;
        [[diagonal.x, off_diagonal.z, off_diagonal.y], [diagonal.y, off_diagonal.x, diagonal.z]]
    }

    /// Makes every entry zero.
    pub fn clear(&mut self) {
        self.diagonal.fill(0.0);
        self.off_diagonal.fill(0.0);
    }

    /// Overwrites `eigenvalues` with at least the largest eigenvalue [N/m] of each tensor, by at most 2e-6 of it more; NaN
    /// if an entry is.
    ///
    /// With the mean eigenvalue m = ⅓ tr A, B = A − m and p² = ⅙ tr B², the eigenvalues are m + 2p cos φ where
    ///
    /// ```text
    /// cos 3φ = r = ½ det(B / p)    cos φ = cos(⅓ arccos r) = cos(⅔ arccos s)    s = √(½ (1 + r))
    /// ```
    ///
    /// The last is smooth in s, even where two eigenvalues meet, as they do in a flat cloth (s = 0): a polynomial is faster
    /// than two functions. Negative eigenvalues must be smaller in size than the largest one.
    pub fn eval_largest_eigenvalues(&self, instructions: InstructionSet, eigenvalues: &mut [f64]) {
        instructions.run(LargestEigenvalues { tensors: self, eigenvalues });
    }
}

struct LargestEigenvalues<'a, 'b> {
    tensors: &'a StiffnessTensorsMut<'b>,
    eigenvalues: &'a mut [f64],
}

impl Vectorise for LargestEigenvalues<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { tensors: StiffnessTensorsMut { diagonal, off_diagonal }, eigenvalues } = self;
        let count = eigenvalues.len();
        let [xx, yy, zz] = [&diagonal.x, &diagonal.y, &diagonal.z].map(|values| &values[..count]);
        let [yz, xz, xy] = [&off_diagonal.x, &off_diagonal.y, &off_diagonal.z].map(|values| &values[..count]);
        for i in 0..count {
            eigenvalues[i] = largest_eigenvalue([xx[i], yy[i], zz[i]], [yz[i], xz[i], xy[i]]);
        }
    }
}

#[inline(always)]
fn largest_eigenvalue([xx, yy, zz]: [f64; 3], [yz, xz, xy]: [f64; 3]) -> f64 {
    let mean = (xx + yy + zz) * (1.0 / 3.0);
    let inverse = 1.0 / mean;
    let scale = if mean == 0.0 { 0.0 } else { inverse };
    let [a, b, c] = [(xx - mean) * scale, (yy - mean) * scale, (zz - mean) * scale];
    let [d, e, f] = [yz * scale, xz * scale, xy * scale];
    let squares = a * a + b * b + c * c + 2.0 * (d * d + e * e + f * f);
    let p = (squares * (1.0 / 6.0)).sqrt();
    let determinant = a * (b * c - d * d) - f * (f * c - d * e) + e * (f * d - b * e);
    let r = determinant / (2.0 * p * p * p);
    // Comparisons that let through what is not a number.
    let half = 0.5 * (1.0 + r);
    let half = if half < 0.0 { 0.0 } else { half };
    let s = (if half > 1.0 { 1.0 } else { half }).sqrt();
    let mut cosine = COSINE[6];
    for k in (0..6).rev() {
        cosine = cosine * s + COSINE[k];
    }
    let cosine = if p < LEAST_ANISOTROPY { 1.0 } else { cosine };
    mean * (1.0 + 2.0 * p * cosine) * (1.0 + ROUNDING)
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DVec3};

    use super::*;

    /// Of the tensor with these `eigenvalues`, turned about no axis of symmetry.
    fn largest(eigenvalues: [f64; 3]) -> f64 {
        let turn = DMat3::from_axis_angle(DVec3::new(0.36, 0.48, 0.8), 0.7);
        let tensor = turn * DMat3::from_diagonal(eigenvalues.into()) * turn.transpose();
        let [x, y, z] = tensor.to_cols_array_2d();
        of_entries([x[0], y[1], z[2]], [y[2], x[2], x[1]])
    }

    fn of_entries(diagonal: [f64; 3], off_diagonal: [f64; 3]) -> f64 {
        let mut tensors = StiffnessTensors {
            diagonal: [DVec3::from(diagonal)].into_iter().collect(),
            off_diagonal: [DVec3::from(off_diagonal)].into_iter().collect(),
        };
        let mut eigenvalues = [0.0];
        tensors.as_mut().eval_largest_eigenvalues(InstructionSet::best(), &mut eigenvalues);
        eigenvalues[0]
    }

    /// From no stiffness in two directions to the same in all, with pairs that are equal, or nearly so.
    #[test]
    fn eigenvalue_is_not_below_the_largest_and_hardly_above() {
        let shares = [0.0, 1e-12, 1e-6, 0.1, 1.0 / 3.0, 0.5, 0.9, 1.0 - 1e-5, 1.0 - 1e-9, 1.0 - 1e-14, 1.0];
        for scale in [1e-25, 1.0, 3e28] {
            for second in shares {
                for third in shares {
                    let eigenvalues = [scale * third, scale, scale * second];
                    let excess = largest(eigenvalues) / scale - 1.0;
                    assert!((0.0..2e-6).contains(&excess), "{excess:e} at {eigenvalues:?}");
                }
            }
        }
    }

    #[test]
    fn polynomial_is_the_cosine() {
        for i in 0..=10_000 {
            let s = f64::from(i) / 10_000.0;
            let found = COSINE.iter().rev().fold(0.0, |sum, coefficient| sum * s + coefficient);
            let error = found - libm::cos(libm::acos(s) * 2.0 / 3.0);
            assert!(error.abs() < 2e-7, "{error:e} at {s}");
        }
    }

    #[test]
    fn no_stiffness_is_zero_and_no_number_stays_none() {
        assert_eq!(of_entries([0.0; 3], [0.0; 3]), 0.0);
        for place in 0..6 {
            for value in [f64::NAN, f64::INFINITY] {
                let mut entries = [1.0, 2.0, 3.0, 0.1, 0.2, 0.3];
                entries[place] = value;
                let [a, b, c, d, e, f] = entries;
                let found = of_entries([a, b, c], [d, e, f]);
                assert!(!found.is_finite(), "{found} from {entries:?}");
            }
        }
    }
}
