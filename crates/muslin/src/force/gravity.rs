//! Gravity.

use std::ops::Range;

use glam::DVec3;

use super::{Configuration, Force, PotentialEnergies, Sweep};
use crate::instructions::Vectorise;
use crate::model::Particles;
use crate::points::set_all;
use crate::{InstructionSet, PointsMut};

/// Uniform gravity.
///
/// ```text
/// F = m g [N]    E = −m g · x [J]
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gravity {
    acceleration: DVec3,
    instructions: InstructionSet,
}

impl Gravity {
    /// Of the `acceleration` g [m/s²], evaluated with `instructions`.
    #[must_use]
    pub const fn new(acceleration: DVec3, instructions: InstructionSet) -> Self {
        Self { acceleration, instructions }
    }
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
        let (acceleration, particles) = (self.acceleration, at.particles);
        self.instructions.run(SetWeights { acceleration, particles, block, forces });
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

/// Overwrites `forces` [N] on a block with weights.
struct SetWeights<'a, 'b> {
    acceleration: DVec3,
    particles: &'a Particles,
    block: &'a Range<usize>,
    forces: &'a mut PointsMut<'b>,
}

impl Vectorise for SetWeights<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { acceleration, particles, block, forces } = self;
        for stretch in particles.stretches(block) {
            let own = stretch.particles.start - block.start..stretch.particles.end - block.start;
            let weight = stretch.mass * acceleration;
            set_all(&mut forces.x[own.clone()], weight.x);
            set_all(&mut forces.y[own.clone()], weight.y);
            set_all(&mut forces.z[own], weight.z);
            for other in stretch.others {
                forces.set(other.particle - block.start, other.mass * acceleration);
            }
        }
    }
}
