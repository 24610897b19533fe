//! Hooke's law.

use super::TensionLaw;
use crate::force::SpringLength;

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

    #[inline(always)]
    fn tangent(&self, _extension: f64, _rest_length: f64) -> f64 {
        self.stiffness
    }

    /// `k (ℓ − L) / ℓ = k − k L / ℓ`, the same but for rounding.
    #[inline(always)]
    fn tension_by_length(&self, _tension: f64, at: SpringLength, rest_length: f64) -> f64 {
        self.stiffness - self.stiffness * rest_length * at.inverse
    }

    #[inline(always)]
    fn only_stiffens(&self) -> bool {
        true
    }

    fn energy(&self, extension: f64, _rest_length: f64) -> f64 {
        0.5 * self.stiffness * extension * extension
    }

    fn energy_moment(&self, extension: f64, _rest_length: f64) -> f64 {
        self.stiffness * extension * extension * extension / 3.0
    }
}
