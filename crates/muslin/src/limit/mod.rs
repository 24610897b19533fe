//! Limits against super-elongation: positions that are corrected after each step.
//!
//! A [`Limit`] shortens springs that are too long by moving their ends, whatever forces act. It is no force and has no
//! tangent, so it leaves the stable step alone; but what it does depends on the step, and with it the motion.

mod grid;
mod rule;

use std::fmt;

pub use grid::GridLimit;
pub use rule::LimitRule;

use crate::Points;
use crate::model::Particles;

/// A correction of positions after each step.
///
/// A spring that is too long is shortened along its direction, its ends moved in inverse proportion to their masses, or a
/// free end alone if the other is pinned:
///
/// ```text
/// p = μ d (1 − ℓ' / ℓ) [kg m]    x_i += p / m_i    x_j −= p / m_j    1/μ = 1/m_i + 1/m_j, without that of a pin
/// ```
///
/// So linear momentum of free particles stays. Angular momentum stays but for the angle by which a spring turns in a
/// step: p is along the spring at the end of the step, and acts from its beginning on. The order is fixed, whatever the
/// number of threads.
pub trait Limit: fmt::Debug + Send + Sync {
    /// Corrects `positions` [m], and adds every p [kg m] to the `impulses` of both ends, those that are pinned included.
    fn correct(&self, particles: &Particles, positions: &mut Points, impulses: &mut Points);
}
