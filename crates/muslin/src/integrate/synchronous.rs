//! Velocities at the time of the positions, from those half a step before.

use std::ops::Range;

use crate::PointsMut;
use crate::instructions::Vectorise;
use crate::model::{ParticleStretch, Particles};

/// Finds the velocities [m/s] of a block's particles at the state's time; pins keep theirs.
///
/// ```text
/// v = (v⁻ + h⁻/2m F) / (1 + k_d h⁻/2m)
/// ```
pub(super) struct Synchronise<'a, 'b> {
    pub(super) particles: &'a Particles,
    pub(super) block: &'a Range<usize>,
    /// The step h⁻ [s] that led here.
    pub(super) last_step: f64,
    /// Velocities v⁻ [m/s] of the block along x, y and z, half of that step older.
    pub(super) older: [&'a [f64]; 3],
    /// Forces F [N] on the block at the state's time, which its velocities take the place of.
    pub(super) values: PointsMut<'b>,
}

impl Vectorise for Synchronise<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { particles, block, last_step, older, values } = self;
        for (values, older) in [values.x, values.y, values.z].into_iter().zip(older) {
            for stretch in particles.stretches(block) {
                let own = stretch.particles.start - block.start..stretch.particles.end - block.start;
                let mut forces = [0.0; ParticleStretch::MAX_OTHERS];
                for (force, other) in forces.iter_mut().zip(stretch.others) {
                    *force = values[other.particle - block.start];
                }
                if stretch.is_pinned {
                    values[own.clone()].copy_from_slice(&older[own]);
                } else {
                    synchronise(
                        &mut values[own.clone()],
                        &older[own],
                        (stretch.mass, stretch.drag),
                        last_step,
                    );
                }
                // They have been taken for most.
                for (force, other) in forces.into_iter().zip(stretch.others) {
                    let at = other.particle - block.start;
                    values[at] = if other.is_pinned {
                        older[at]
                    } else {
                        synchronous(force, older[at], (other.mass, other.drag), last_step)
                    };
                }
            }
        }
    }
}

/// Equal particles.
#[inline(always)]
fn synchronise(values: &mut [f64], older: &[f64], constants: (f64, f64), last_step: f64) {
    let older = &older[..values.len()];
    for i in 0..values.len() {
        values[i] = synchronous(values[i], older[i], constants, last_step);
    }
}

/// One coordinate of the velocity [m/s] of a free particle of `mass` [kg] and `drag` [kg/s].
#[inline(always)]
fn synchronous(force: f64, older: f64, (mass, drag): (f64, f64), last_step: f64) -> f64 {
    let twice_mass = 2.0 * mass;
    (twice_mass * older + last_step * force) / (twice_mass + drag * last_step)
}
