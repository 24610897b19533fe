//! The spring that gives a law of tension its direction in space.

use glam::DVec3;

use super::law::TensionLaw;
use crate::scene::ForceDirection;

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

impl<L: TensionLaw> Spring<L> {
    /// The same spring under another law.
    #[must_use]
    pub fn with_law<M: TensionLaw>(&self, law: M) -> Spring<M> {
        Spring { law, rest_length: self.rest_length, direction: self.direction }
    }

    /// Coefficient c [N/m] of the force at `length` ℓ [m]; also the stiffness across the spring.
    #[inline(always)]
    #[must_use]
    pub fn coefficient(&self, length: f64) -> f64 {
        let tension = self.law.tension(length - self.rest_length, self.rest_length);
        match self.direction {
            ForceDirection::CurrentLength => {
                let quotient = tension / length;
                if length > 0.0 { quotient } else { 0.0 }
            }
            ForceDirection::RestLength => tension / self.rest_length,
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

    /// Coefficient c [N/m] of the force at `length` ℓ [m], and the largest stiffness [N/m] in any direction, zero if all
    /// are negative: `max(k_a, c, 0)` with the axial tangent k_a.
    #[inline(always)]
    #[must_use]
    pub fn coefficient_and_stiffness(&self, length: f64) -> (f64, f64) {
        let (tension, tangent) = self.law.tension_and_tangent(length - self.rest_length, self.rest_length);
        let (coefficient, axial) = match self.direction {
            ForceDirection::CurrentLength => {
                let quotient = tension / length;
                (if length > 0.0 { quotient } else { 0.0 }, tangent)
            }
            ForceDirection::RestLength => {
                (tension / self.rest_length, (tangent * length + tension) / self.rest_length)
            }
        };
        // Comparisons in place of `max`, which would pass over what is not a number.
        let larger = if axial < coefficient { coefficient } else { axial };
        (coefficient, if larger < 0.0 { 0.0 } else { larger })
    }

    /// Force [N] on the end that `vector` d [m] starts from.
    #[must_use]
    pub fn force(&self, vector: DVec3) -> DVec3 {
        vector * self.coefficient(vector.length())
    }

    /// `K u` [N]: what the force loses when the other end moves by −u, that is `−∂F/∂d · u`, negated for `u = u_i − u_j`.
    ///
    /// ```text
    /// K u = k_a n (n · u) + c (u − n (n · u))
    /// ```
    #[must_use]
    pub fn tangent_product(&self, vector: DVec3, displacement: DVec3) -> DVec3 {
        let length = vector.length();
        if length == 0.0 {
            // No direction along the spring; across it only the as-printed direction has a stiffness.
            return displacement * self.coefficient(length);
        }
        let normal = vector / length;
        let along = normal * normal.dot(displacement);
        along * self.axial_tangent(length) + (displacement - along) * self.coefficient(length)
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
    use super::super::law::{ArctangentLaw, CurveLaw, LinearLaw, ReducedLaw, SpringLaw, TangentLaw};
    use super::*;
    use crate::scene::TensionCurve;

    const DIRECTIONS: [ForceDirection; 2] = [ForceDirection::CurrentLength, ForceDirection::RestLength];
    const REST_LENGTH: f64 = 0.8;

    /// Every law; a new one belongs here.
    fn laws() -> [SpringLaw; 7] {
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
            assert!((printed / current - 1.1).abs() < 4e-15, "{law:?}: {printed} to {current}");
        }
    }
}
