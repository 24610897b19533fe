//! Gravity.

use std::ops::Range;

use glam::DVec3;

use super::{Configuration, Force, PotentialEnergies, Sweep};
use crate::PointsMut;

/// Uniform gravity.
///
/// ```text
/// F = m g [N]    E = −m g · x [J]
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gravity {
    /// Gravitational acceleration g [m/s²].
    pub acceleration: DVec3,
}

impl Force for Gravity {
    fn add_forces(
        &self,
        at: Configuration<'_>,
        block: &Range<usize>,
        forces: &mut PointsMut<'_>,
        _sweep: &mut Sweep,
    ) {
        let masses = &at.particles.masses()[block.clone()];
        let g = self.acceleration;
        for (force, mass) in forces.x.iter_mut().zip(masses) {
            *force += mass * g.x;
        }
        for (force, mass) in forces.y.iter_mut().zip(masses) {
            *force += mass * g.y;
        }
        for (force, mass) in forces.z.iter_mut().zip(masses) {
            *force += mass * g.z;
        }
    }

    fn set_forces(
        &self,
        at: Configuration<'_>,
        block: &Range<usize>,
        forces: &mut PointsMut<'_>,
        _sweep: &mut Sweep,
    ) {
        for stretch in at.particles.stretches(block) {
            let own = stretch.particles.start - block.start..stretch.particles.end - block.start;
            let weight = stretch.mass * self.acceleration;
            forces.x[own.clone()].fill(weight.x);
            forces.y[own.clone()].fill(weight.y);
            forces.z[own].fill(weight.z);
            for other in stretch.others {
                forces.set(other.particle - block.start, other.mass * self.acceleration);
            }
        }
    }

    fn add_energies(&self, at: Configuration<'_>, energies: &mut PotentialEnergies) {
        for (position, mass) in at.positions.iter().zip(at.particles.masses()) {
            energies.gravitational -= mass * self.acceleration.dot(position);
        }
    }

    fn has_varying_bounds(&self) -> bool {
        false
    }
}
