//! Hooke's law.

use super::TensionLaw;

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
    #[inline(always)]
    fn tension(&self, extension: f64, _rest_length: f64) -> f64 {
        self.stiffness * extension
    }

    fn tangent(&self, _extension: f64, _rest_length: f64) -> f64 {
        self.stiffness
    }

    fn energy(&self, extension: f64, _rest_length: f64) -> f64 {
        0.5 * self.stiffness * extension * extension
    }

    fn energy_moment(&self, extension: f64, _rest_length: f64) -> f64 {
        self.stiffness * extension * extension * extension / 3.0
    }
}
