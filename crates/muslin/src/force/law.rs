//! Laws of tension against extension, and the spring that gives a law its direction in space.

use glam::DVec3;

use crate::scene::{ForceDirection, SpringLawSettings, SpringSettings};

/// Tension of a spring against its extension.
///
/// With extension `x = ℓ − L` [m] and rest length `L` [m]:
///
/// ```text
/// f(x) [N]    k_t = df/dx [N/m]    E = ∫₀ˣ f(s) ds [J]    M = ∫₀ˣ f(s) s ds [J m]
/// ```
pub trait TensionLaw: Copy + Send + Sync {
    /// Tension f [N], positive when it pulls the ends together.
    fn tension(self, extension: f64, rest_length: f64) -> f64;

    /// Tangent k_t [N/m].
    fn tangent(self, extension: f64, rest_length: f64) -> f64;

    /// Energy E [J].
    fn energy(self, extension: f64, rest_length: f64) -> f64;

    /// First moment M [J m] of the tension, which the as-printed force direction needs for its energy.
    fn energy_moment(self, extension: f64, rest_length: f64) -> f64;
}

/// Hooke's law.
///
/// ```text
/// f = k x    k_t = k    E = ½ k x²    M = ⅓ k x³
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearLaw {
    /// Stiffness k [N/m].
    pub stiffness: f64,
}

impl TensionLaw for LinearLaw {
    fn tension(self, extension: f64, _rest_length: f64) -> f64 {
        self.stiffness * extension
    }

    fn tangent(self, _extension: f64, _rest_length: f64) -> f64 {
        self.stiffness
    }

    fn energy(self, extension: f64, _rest_length: f64) -> f64 {
        0.5 * self.stiffness * extension * extension
    }

    fn energy_moment(self, extension: f64, _rest_length: f64) -> f64 {
        self.stiffness * extension * extension * extension / 3.0
    }
}

/// Any law that a scene can name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SpringLaw {
    /// `"linear"`
    Linear(LinearLaw),
}

impl SpringLaw {
    /// The law of `settings`.
    #[must_use]
    pub fn new(settings: SpringSettings) -> Self {
        match settings.law {
            SpringLawSettings::Linear => Self::Linear(LinearLaw { stiffness: settings.stiffness }),
        }
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

impl<L: TensionLaw> Spring<L> {
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
    use super::*;

    const DIRECTIONS: [ForceDirection; 2] = [ForceDirection::CurrentLength, ForceDirection::RestLength];
    const VECTORS: [DVec3; 3] = [
        DVec3::new(0.7, -0.5, 0.6),  // stretched
        DVec3::new(0.1, 0.2, -0.25), // compressed below half of its length
        DVec3::new(0.0, 0.8, 0.0),   // at rest
    ];

    fn spring(direction: ForceDirection) -> Spring<LinearLaw> {
        Spring { law: LinearLaw { stiffness: 250.0 }, rest_length: 0.8, direction }
    }

    /// F = −dE/dx_i, and x_i = x_j − d, so F = ∂E/∂d.
    #[test]
    fn force_is_the_gradient_of_the_energy() {
        let h = 1e-6; // truncation h² and cancellation ε/h both stay below 1e-9
        for direction in DIRECTIONS {
            let spring = spring(direction);
            for vector in VECTORS {
                for axis in DVec3::AXES {
                    let energy = |d: DVec3| spring.energy(d.length());
                    let difference = (energy(vector + axis * h) - energy(vector - axis * h)) / (2.0 * h);
                    let error = (spring.force(vector).dot(axis) - difference).abs() / spring.law.stiffness;
                    assert!(error < 1e-9, "{direction:?} at {vector}: {error:e} of the stiffness");
                }
            }
        }
    }

    #[test]
    fn tangent_is_the_derivative_of_the_force() {
        let h = 1e-6; // as above
        for direction in DIRECTIONS {
            let spring = spring(direction);
            for vector in VECTORS {
                for axis in DVec3::AXES {
                    let exact = spring.tangent_product(vector, axis);
                    let difference =
                        (spring.force(vector + axis * h) - spring.force(vector - axis * h)) / (2.0 * h);
                    let error = (exact - difference).length() / spring.law.stiffness;
                    assert!(error < 1e-8, "{direction:?} at {vector}: {error:e} of the stiffness");
                }
            }
        }
    }

    #[test]
    fn coincident_ends_feel_no_force() {
        for direction in DIRECTIONS {
            assert_eq!(spring(direction).force(DVec3::ZERO), DVec3::ZERO);
        }
        let product = spring(ForceDirection::CurrentLength).tangent_product(DVec3::ZERO, DVec3::X);
        assert_eq!(product, DVec3::ZERO);
    }

    /// The paper divides by the rest length: the force is larger by ℓ / L.
    #[test]
    fn as_printed_force_is_larger_by_the_stretch() {
        let vector = DVec3::X * 0.88;
        let ratio = spring(ForceDirection::RestLength).force(vector).x
            / spring(ForceDirection::CurrentLength).force(vector).x;
        assert!((ratio - 1.1).abs() < 1e-15 * 4.0, "{ratio}");
    }
}
