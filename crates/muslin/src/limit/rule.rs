//! How long a spring may be.

use std::f64::consts::PI;

/// What length a spring is given if it is too long.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LimitRule {
    /// At most (1 + `strain`) L: the earlier method of the paper's Fig. 4 (a), known from Provot, "Deformation Constraints
    /// in a Mass-Spring Model to Describe Rigid Cloth Behavior", Graphics Interface 1995.
    CutOff {
        /// Largest strain [1], not negative.
        strain: f64,
    },
    /// L + y(x) in place of L + x, with
    ///
    /// ```text
    /// y(x) = 0.06 L arctan(5π x / L)
    /// ```
    ///
    /// the paper's smooth curve taken as a length. Since y < x for every x > 0, a spring is shortened after every step,
    /// and the more often the smaller the step is.
    ArctangentProjection,
}

impl LimitRule {
    /// The length [m] that a spring of `length` ℓ [m] and `rest_length` L [m] is to have, if that is less than ℓ.
    #[must_use]
    pub fn shortened(self, length: f64, rest_length: f64) -> Option<f64> {
        let longest = match self {
            Self::CutOff { strain } => (1.0 + strain) * rest_length,
            Self::ArctangentProjection if length <= rest_length => return None,
            Self::ArctangentProjection => {
                let strain = (length - rest_length) / rest_length;
                rest_length * (1.0 + 0.06 * libm::atan(5.0 * PI * strain))
            }
        };
        (longest < length).then_some(longest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Strains x and y of the curve, computed apart from this program with NumPy.
    const CURVE: [(f64, f64); 6] = [
        (0.001, 0.0009424002919),
        (0.01, 0.009348389998),
        (0.05, 0.039946425),
        (0.1, 0.06023308931),
        (1.0, 0.09043320871),
        (10.0, 0.0938658129),
    ];

    #[test]
    fn projection_follows_its_curve() {
        for (x, y) in CURVE {
            let length = LimitRule::ArctangentProjection.shortened(2.0 * (1.0 + x), 2.0);
            // Ten digits are given.
            assert!(length.is_some_and(|length| (length / 2.0 - 1.0 - y).abs() < 1e-11), "{length:?} at {x}");
        }
    }

    #[test]
    fn short_springs_stay_as_they_are() {
        for length in [0.0, 1.9, 2.0, f64::NAN] {
            assert_eq!(LimitRule::ArctangentProjection.shortened(length, 2.0), None);
            assert_eq!(LimitRule::CutOff { strain: 0.1 }.shortened(length, 2.0), None);
        }
        assert_eq!(LimitRule::CutOff { strain: 0.1 }.shortened(2.2, 2.0), None);
        assert_eq!(LimitRule::CutOff { strain: 0.1 }.shortened(2.3, 2.0), Some(2.2));
    }
}
