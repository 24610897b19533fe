//! The paper's arctangent taken literally as a force.

use std::f64::consts::PI;

use super::TensionLaw;

/// The strain that multiplies the arctangent [1], as printed.
const SCALE: f64 = 0.06;

/// The factor of the strain inside it [1], as printed.
const FACTOR: f64 = 5.0 * PI;

/// A softening law: the paper's curve y = 0.06 L arctan(5π x / L) as the extension that Hooke's law is given.
///
/// With u = 5π x / L:
///
/// ```text
/// f = 0.06 k L arctan u    k_t = 0.3π k / (1 + u²)
/// E = 0.06 k L² / 5π · [u arctan u − ½ ln(1 + u²)]
/// M = 0.06 k L³ / (5π)² · ½ [(u² + 1) arctan u − u]
/// ```
///
/// The tension never exceeds 0.0942 k L: under a larger load there is no equilibrium and the cloth runs away. It is the
/// opposite of a limit to extension and is here to show that; the law that the paper's curve must mean is
/// [`TangentLaw`](super::TangentLaw).
///
/// Source: Luo, Miyaki, Yamasaki, Aizawa, "Dynamic 3D Simulation of Fabric Based on Improved Mass-Spring Model",
/// section 4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArctangentLaw {
    /// Stiffness k [N/m].
    pub stiffness: f64,
}

impl TensionLaw for ArctangentLaw {
    fn tension(&self, extension: f64, rest_length: f64) -> f64 {
        SCALE * self.stiffness * rest_length * libm::atan(FACTOR * extension / rest_length)
    }

    fn tangent(&self, extension: f64, rest_length: f64) -> f64 {
        let u = FACTOR * extension / rest_length;
        SCALE * FACTOR * self.stiffness / (1.0 + u * u)
    }

    fn energy(&self, extension: f64, rest_length: f64) -> f64 {
        let u = FACTOR * extension / rest_length;
        let scale = SCALE * self.stiffness * rest_length * rest_length / FACTOR;
        scale * (u * libm::atan(u) - 0.5 * libm::log1p(u * u))
    }

    fn energy_moment(&self, extension: f64, rest_length: f64) -> f64 {
        let u = FACTOR * extension / rest_length;
        let scale = SCALE * self.stiffness * rest_length * rest_length * rest_length / (FACTOR * FACTOR);
        scale * 0.5 * ((u * u + 1.0) * libm::atan(u) - u)
    }
}
