//! A law less a linear part that other springs carry.

use super::TensionLaw;

/// What a law `g` leaves for a spring beside others which carry `r x` of its tension.
///
/// ```text
/// f = g(x) − r x    k_t = g'(x) − r    E = E_g − ½ r x²    M = M_g − ⅓ r x³
/// ```
///
/// So stretch and shear of a grid may be given apart although shear springs resist stretch, too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReducedLaw<L> {
    /// The whole tension g.
    pub whole: L,
    /// The part r [N/m] of the stiffness that others carry, not above the least tangent of the whole.
    pub carried: f64,
}

impl<L: TensionLaw> TensionLaw for ReducedLaw<L> {
    #[inline(always)]
    fn tension(&self, extension: f64, rest_length: f64) -> f64 {
        self.whole.tension(extension, rest_length) - self.carried * extension
    }

    #[inline(always)]
    fn tangent(&self, extension: f64, rest_length: f64) -> f64 {
        self.whole.tangent(extension, rest_length) - self.carried
    }

    #[inline(always)]
    fn tension_and_tangent(&self, extension: f64, rest_length: f64) -> (f64, f64) {
        let (tension, tangent) = self.whole.tension_and_tangent(extension, rest_length);
        (tension - self.carried * extension, tangent - self.carried)
    }

    fn energy(&self, extension: f64, rest_length: f64) -> f64 {
        self.whole.energy(extension, rest_length) - 0.5 * self.carried * extension * extension
    }

    fn energy_moment(&self, extension: f64, rest_length: f64) -> f64 {
        let moment = self.whole.energy_moment(extension, rest_length);
        moment - self.carried * extension * extension * extension / 3.0
    }
}
