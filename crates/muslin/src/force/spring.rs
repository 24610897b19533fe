//! The spring that gives a law of tension its direction in space.

use glam::DVec3;

use super::law::TensionLaw;
use crate::scene::ForceDirection;

/// The length of a spring and its inverse.
///
/// Both come from the squared length s by operations that are rounded the same way everywhere and that every set of vector
/// instructions does at its full width, which divisions and square roots of `f64` are not: on common processors the two
/// together take as long in vectors as one by one. A root in `f32` gives 1/√s to seven digits, and one step of the third
/// order all others:
///
/// ```text
/// y₀ = √s / s  in f32    e = 1 − s y₀²    1/ℓ = y₀ + y₀ e (½ + ⅜ e)    ℓ = s · 1/ℓ
/// ```
///
/// Both are within two units of the last place of the exact ones.
///
/// Ends that are closer than 1.1e-19 m count as coincident, with length and inverse zero. Where s is beyond the range of
/// `f32`, at 1.8e19 m, both are NaN: a motion that has run away ends there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringLength {
    /// ℓ [m].
    pub length: f64,
    /// 1/ℓ [1/m]; zero where ℓ is.
    pub inverse: f64,
}

/// Smallest squared length [m²] of which `f32` has a root of full precision.
const LEAST_SQUARE: f64 = f32::MIN_POSITIVE as f64;

impl SpringLength {
    /// Of a `squared` length [m²].
    #[inline(always)]
    #[must_use]
    pub fn from_squared(squared: f64) -> Self {
        Self::from_guess(squared, Self::guess_inverse(squared))
    }

    /// y₀ [1/m] of a `squared` length [m²].
    #[inline(always)]
    #[must_use]
    pub fn guess_inverse(squared: f64) -> f64 {
        let single = squared as f32;
        f64::from(single.sqrt() / single)
    }

    /// Of a `squared` length [m²] with its `guess` y₀ [1/m] from [`guess_inverse`](Self::guess_inverse).
    #[inline(always)]
    #[must_use]
    pub fn from_guess(squared: f64, guess: f64) -> Self {
        let error = 1.0 - squared * guess * guess;
        let inverse = guess + guess * error * (0.5 + 0.375 * error);
        let inverse = if squared < LEAST_SQUARE { 0.0 } else { inverse };
        Self { length: squared * inverse, inverse }
    }

    /// Of the `vector` [m] from end to end.
    #[inline(always)]
    #[must_use]
    pub fn of(vector: DVec3) -> Self {
        // In the order in which loops over rows of springs add them.
        Self::from_squared(vector.x * vector.x + vector.y * vector.y + vector.z * vector.z)
    }
}

/// A spring of rest length `L` under a law `f`.
///
/// ```text
/// d = x_j − x_i [m]    ℓ = |d|    n = d / ℓ    F_i = c d = −F_j [N]
///
/// current length:  c = f(ℓ − L) / ℓ    E as the law's
/// rest length:     c = f(ℓ − L) / L    E = E_law + M_law / L
/// ```
///
/// Where both ends coincide there is no direction `n`: with the current length, force and tangent are zero there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spring<L> {
    /// Tension against extension.
    pub law: L,
    /// Rest length L [m], positive.
    pub rest_length: f64,
    /// What the spring's vector is divided by.
    pub direction: ForceDirection,
}

impl<L> Spring<L> {
    /// The same spring under another law.
    #[inline(always)]
    #[must_use]
    pub fn with_law<M>(&self, law: M) -> Spring<M> {
        Spring { law, rest_length: self.rest_length, direction: self.direction }
    }
}

impl<L: TensionLaw> Spring<L> {
    /// Coefficient c [N/m] of the force at a length; also the stiffness across the spring.
    #[inline(always)]
    #[must_use]
    pub fn coefficient(&self, at: SpringLength) -> f64 {
        let tension = self.law.tension(at.length - self.rest_length, self.rest_length);
        match self.direction {
            ForceDirection::CurrentLength => self.law.tension_by_length(tension, at, self.rest_length),
            ForceDirection::RestLength => tension * (1.0 / self.rest_length),
        }
    }

    /// Stiffness dF/dℓ [N/m] along the spring at `length` ℓ [m].
    #[must_use]
    pub fn axial_tangent(&self, length: f64) -> f64 {
        let extension = length - self.rest_length;
        let tangent = self.law.tangent(extension, self.rest_length);
        match self.direction {
            ForceDirection::CurrentLength => tangent,
            ForceDirection::RestLength => {
                let tension = self.law.tension(extension, self.rest_length);
                (tangent * length + tension) / self.rest_length
            }
        }
    }

    /// Stiffnesses [N/m] along and across the spring at a length, zero where negative; the larger one in both places where
    /// its ends coincide.
    #[inline(always)]
    #[must_use]
    pub fn stiffnesses(&self, at: SpringLength) -> [f64; 2] {
        let (tension, tangent) = self.law.tension_and_tangent(at.length - self.rest_length, self.rest_length);
        let [along, across] = match self.direction {
            ForceDirection::CurrentLength => [tangent, tension * at.inverse],
            ForceDirection::RestLength => {
                let inverse = 1.0 / self.rest_length;
                [(tangent * at.length + tension) * inverse, tension * inverse]
            }
        };
        if self.law.only_stiffens() && self.direction == ForceDirection::CurrentLength {
            let across = if across < 0.0 { 0.0 } else { across };
            return [along, if at.inverse == 0.0 { along } else { across }];
        }
        // Comparisons in place of `max`, which would pass over what is not a number.
        let [along, across] = [along, across].map(|stiffness| if stiffness < 0.0 { 0.0 } else { stiffness });
        let larger = if along < across { across } else { along };
        [along, if at.inverse == 0.0 { larger } else { across }]
    }

    /// Coefficient c [N/m] of the force at a length, and the largest stiffness [N/m] in any direction, zero if all are
    /// negative: `max(k_a, c, 0)` with the axial tangent k_a.
    #[inline(always)]
    #[must_use]
    pub fn coefficient_and_stiffness(&self, at: SpringLength) -> (f64, f64) {
        let (tension, tangent) = self.law.tension_and_tangent(at.length - self.rest_length, self.rest_length);
        let (coefficient, axial) = match self.direction {
            ForceDirection::CurrentLength => {
                let coefficient = self.law.tension_by_length(tension, at, self.rest_length);
                if self.law.only_stiffens() {
                    return (coefficient, tangent);
                }
                (coefficient, tangent)
            }
            ForceDirection::RestLength => {
                let inverse = 1.0 / self.rest_length;
                (tension * inverse, (tangent * at.length + tension) * inverse)
            }
        };
        // Comparisons in place of `max`, which would pass over what is not a number.
        let larger = if axial < coefficient { coefficient } else { axial };
        (coefficient, if larger < 0.0 { 0.0 } else { larger })
    }

    /// Force [N] on the end that `vector` d [m] starts from.
    #[must_use]
    pub fn force(&self, vector: DVec3) -> DVec3 {
        vector * self.coefficient(SpringLength::of(vector))
    }

    /// `K u` [N]: what the force loses when the other end moves by −u, that is `−∂F/∂d · u`, negated for `u = u_i − u_j`.
    ///
    /// ```text
    /// K u = k_a n (n · u) + c (u − n (n · u))
    /// ```
    #[must_use]
    pub fn tangent_product(&self, vector: DVec3, displacement: DVec3) -> DVec3 {
        let at = SpringLength::of(vector);
        if at.inverse == 0.0 && self.direction == ForceDirection::CurrentLength {
            return DVec3::ZERO;
        }
        let normal = vector * at.inverse;
        // Without a direction along the spring there is only the stiffness across it.
        let along = normal * normal.dot(displacement);
        along * self.axial_tangent(at.length) + (displacement - along) * self.coefficient(at)
    }

    /// Energy E [J] at `length` ℓ [m].
    #[must_use]
    pub fn energy(&self, length: f64) -> f64 {
        let extension = length - self.rest_length;
        let energy = self.law.energy(extension, self.rest_length);
        match self.direction {
            ForceDirection::CurrentLength => energy,
            ForceDirection::RestLength => {
                energy + self.law.energy_moment(extension, self.rest_length) / self.rest_length
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::law::{
        ArctangentLaw, BucklingLaw, CurveLaw, LinearLaw, ReducedLaw, SpringLaw, TangentLaw,
    };
    use super::*;
    use crate::scene::TensionCurve;

    const DIRECTIONS: [ForceDirection; 2] = [ForceDirection::CurrentLength, ForceDirection::RestLength];
    const REST_LENGTH: f64 = 0.8;

    /// Every law; a new one belongs here.
    fn laws() -> [SpringLaw; 9] {
        [
            SpringLaw::Linear(LinearLaw { stiffness: 250.0 }),
            SpringLaw::Tangent(TangentLaw::new(250.0, 0.06)),
            SpringLaw::Tangent(TangentLaw::new(250.0, 0.6)),
            SpringLaw::Arctangent(ArctangentLaw { stiffness: 250.0 }),
            curve(&[[0.01, 1.0], [0.03, 6.0], [0.07, 18.0], [0.08, 18.0], [0.2, 60.0]]),
            curve(&[[-0.5, -40.0], [-0.1, -20.0], [0.0, 0.0], [0.05, 9.0], [0.1, 40.0]]),
            SpringLaw::ReducedTangent(ReducedLaw {
                whole: TangentLaw::with_initial_stiffness(250.0, 0.06),
                carried: 90.0,
            }),
            SpringLaw::Buckling(BucklingLaw::new(0.3, 50.0, REST_LENGTH)),
            SpringLaw::Buckling(BucklingLaw::new(9.0, 250.0, REST_LENGTH)),
        ]
    }

    fn curve(points: &[[f64; 2]]) -> SpringLaw {
        SpringLaw::Curve(CurveLaw::new(&TensionCurve::new(points).expect("a curve")))
    }

    /// Springs of every law and direction, with vectors from far compressed to beyond the cap of the tangent law.
    fn cases() -> Vec<(Spring<SpringLaw>, DVec3)> {
        let unit = DVec3::new(0.48, -0.6, 0.64);
        let strains = [-0.7, -0.2, 1e-4, 0.02, 0.06, 0.09, 0.0936, 0.095, 0.3];
        let vectors = strains.map(|strain| unit * (REST_LENGTH * (1.0 + strain)));
        let mut cases = Vec::new();
        for law in laws() {
            for direction in DIRECTIONS {
                let spring = Spring { law: law.clone(), rest_length: REST_LENGTH, direction };
                cases.extend(vectors.map(|vector| (spring.clone(), vector)));
            }
        }
        cases
    }

    /// Relative step of the differences below. The tangent law varies over (½π a − e) L ≥ 5e-4 L near its cap, where
    /// truncation is below (1e-6 / 5e-4)² = 4e-6 of the value; elsewhere rounding, below 1e-8, is larger.
    const DIFFERENCE: f64 = 1e-6 * REST_LENGTH;

    /// F = −dE/dx_i, and x_i = x_j − d, so F = ∂E/∂d.
    #[test]
    fn force_is_the_gradient_of_the_energy() {
        for (spring, vector) in cases() {
            let energy = |d: DVec3| spring.energy(d.length());
            let force = spring.force(vector);
            // A difference of energies cannot show less than their own rounding.
            let rounding = 1e-15 * energy(vector) / DIFFERENCE;
            for axis in DVec3::AXES {
                let difference = (energy(vector + axis * DIFFERENCE) - energy(vector - axis * DIFFERENCE))
                    / (2.0 * DIFFERENCE);
                let error = (force.dot(axis) - difference).abs();
                let scale = force.length() + 250.0 * REST_LENGTH * 1e-4;
                assert!(
                    error < 4e-6 * scale + rounding,
                    "{spring:?} at {vector}: {error:e} N of {scale:e} N"
                );
            }
        }
    }

    #[test]
    fn tangent_is_the_derivative_of_the_force() {
        for (spring, vector) in cases() {
            let scale = spring.axial_tangent(vector.length()).abs().max(250.0);
            for axis in DVec3::AXES {
                let exact = spring.tangent_product(vector, axis);
                let [after, before] =
                    [1.0, -1.0].map(|sign| spring.force(vector + axis * (sign * DIFFERENCE)));
                let error = (exact - (after - before) / (2.0 * DIFFERENCE)).length() / scale;
                assert!(error < 1e-5, "{spring:?} at {vector}: {error:e}");
            }
        }
    }

    /// What a law is known for saves comparisons, and changes no bit.
    #[test]
    fn stiffness_is_the_largest_in_any_direction() {
        let lengths = cases().into_iter().map(|(spring, vector)| (spring, SpringLength::of(vector)));
        let coincident = cases().into_iter().map(|(spring, _)| (spring, SpringLength::of(DVec3::ZERO)));
        for (spring, at) in lengths.chain(coincident) {
            let (found, stiffnesses) = match &spring.law {
                SpringLaw::Linear(law) => of(&spring.with_law(law), at),
                SpringLaw::Tangent(law) => of(&spring.with_law(law), at),
                law => of(&spring.with_law(law), at),
            };
            let (axial, coefficient) = (spring.axial_tangent(at.length), spring.coefficient(at));
            let scale = axial.abs().max(coefficient.abs());
            assert!((found - axial.max(coefficient).max(0.0)).abs() <= 1e-15 * scale, "{spring:?} at {at:?}");
            let across = if at.inverse == 0.0 { found } else { coefficient.max(0.0) };
            let errors = [stiffnesses[0] - axial.max(0.0), stiffnesses[1] - across];
            assert!(
                errors.iter().all(|error| error.abs() <= 1e-15 * scale),
                "{spring:?} at {at:?}: {errors:?}"
            );
        }
    }

    /// The largest stiffness, and those along and across.
    fn of(spring: &Spring<impl TensionLaw>, at: SpringLength) -> (f64, [f64; 2]) {
        (spring.coefficient_and_stiffness(at).1, spring.stiffnesses(at))
    }

    /// Over all magnitudes that lengths can have, within two units of the last place.
    #[test]
    fn length_and_inverse_are_nearly_exact() {
        let ulp = f64::EPSILON;
        let mut squared = 1.2e-38;
        while squared < 3.0e38 {
            let at = SpringLength::from_squared(squared);
            let exact = squared.sqrt();
            let errors = [at.length / exact - 1.0, at.inverse * exact - 1.0];
            assert!(errors.iter().all(|error| error.abs() <= 2.0 * ulp), "{squared:e}: {errors:?}");
            squared *= 1.000_371;
        }
    }

    /// Too short to have a direction, or beyond all sense.
    #[test]
    fn lengths_out_of_range_are_zero_or_no_number() {
        for squared in [0.0, 1e-300, 1e-39] {
            assert_eq!(SpringLength::from_squared(squared), SpringLength { length: 0.0, inverse: 0.0 });
        }
        for squared in [1e39, 1e300, f64::INFINITY, f64::NAN] {
            let at = SpringLength::from_squared(squared);
            assert!(at.length.is_nan() && at.inverse.is_nan(), "{squared:e}: {at:?}");
        }
    }

    #[test]
    fn coincident_ends_feel_no_force() {
        for (spring, _) in cases() {
            assert_eq!(spring.force(DVec3::ZERO), DVec3::ZERO);
        }
        let spring =
            Spring { law: &laws()[0], rest_length: REST_LENGTH, direction: ForceDirection::CurrentLength };
        assert_eq!(spring.tangent_product(DVec3::ZERO, DVec3::X), DVec3::ZERO);
    }

    /// The paper divides by the rest length: the force is larger by ℓ / L.
    #[test]
    fn as_printed_force_is_larger_by_the_stretch() {
        for law in laws() {
            let [current, printed] = DIRECTIONS.map(|direction| {
                Spring { law: &law, rest_length: REST_LENGTH, direction }.force(DVec3::X * 0.88).x
            });
            let error = (printed - 1.1 * current).abs();
            assert!(error <= 4e-15 * printed.abs(), "{law:?}: {printed} to {current}");
        }
    }
}
