//! The second half of a step of central differences: motion under forces that are known.

use std::ops::Range;

use crate::instructions::Vectorise;
use crate::model::Particles;
use crate::points::dot_in_lanes;
use crate::{Motion, Points, PointsMut};

/// The sizes of the step that led here and of the next one [s].
#[derive(Clone, Copy, Debug)]
pub(super) struct Steps {
    pub(super) last: f64,
    pub(super) next: f64,
}

/// What turns velocity and force of a particle into its next velocity.
#[derive(Clone, Copy)]
struct Factors {
    velocity: f64,
    force: f64,
}

impl Factors {
    /// Of a free particle of `mass` [kg] and `drag` [kg/s].
    fn new(mass: f64, drag: f64, steps: Steps) -> Self {
        let twice_mass = 2.0 * mass;
        let denominator = twice_mass + drag * steps.last;
        // The second is h⁻/2m · velocity factor + h⁺/2m, without its cancellation.
        Self {
            velocity: (twice_mass - drag * steps.next) / denominator,
            force: (steps.last + steps.next) / denominator,
        }
    }
}

/// What came of moving some particles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moved {
    /// Whether all positions stay finite.
    pub(super) is_finite: bool,
    pub(super) motion: Motion,
}

impl Moved {
    pub(super) fn add(self, other: Self) -> Self {
        Self { is_finite: self.is_finite && other.is_finite, motion: self.motion.add(other.motion) }
    }
}

/// Moves the particles of `block`, and measures their motion if asked to.
pub(super) struct MoveBlock<'a, 'b> {
    pub(super) particles: &'a Particles,
    pub(super) steps: Steps,
    pub(super) block: &'a Range<usize>,
    /// Of the block.
    pub(super) positions: PointsMut<'b>,
    /// Of the block.
    pub(super) velocities: PointsMut<'b>,
    /// Forces [N] on all particles.
    pub(super) forces: &'a Points,
    pub(super) is_measured: bool,
}

impl Vectorise for MoveBlock<'_, '_> {
    type Output = Moved;

    #[inline(always)]
    fn run(self) -> Moved {
        let Self { particles, steps, block, positions, velocities, forces, is_measured } = self;
        let mut moved = Moved { is_finite: true, motion: Motion::default() };
        for run in particles.runs(block) {
            let own = run.particles.start - block.start..run.particles.end - block.start;
            let [x, y, z] = [&mut *velocities.x, &mut *velocities.y, &mut *velocities.z]
                .map(|velocities| &mut velocities[own.clone()]);
            if run.is_pinned {
                [x, y, z].into_iter().for_each(|velocities| velocities.fill(0.0));
                continue;
            }
            let factors = Factors::new(run.mass, run.drag, steps);
            let [force_x, force_y, force_z] =
                [&forces.x, &forces.y, &forces.z].map(|forces| &forces[run.particles.clone()]);
            if is_measured {
                moved.motion.power_before +=
                    dot_in_lanes(force_x, x) + dot_in_lanes(force_y, y) + dot_in_lanes(force_z, z);
            }
            moved.is_finite &= move_run(
                (&mut positions.x[own.clone()], &mut positions.y[own.clone()], &mut positions.z[own]),
                (&mut *x, &mut *y, &mut *z),
                (force_x, force_y, force_z),
                factors,
                steps.next,
            );
            if is_measured {
                moved.motion.power_after +=
                    dot_in_lanes(force_x, x) + dot_in_lanes(force_y, y) + dot_in_lanes(force_z, z);
                moved.motion.kinetic_energy +=
                    0.5 * run.mass * (dot_in_lanes(x, x) + dot_in_lanes(y, y) + dot_in_lanes(z, z));
            }
        }
        moved
    }
}

/// Moves equal particles by `step` [s]; whether all positions stay finite.
#[inline(always)]
fn move_run(
    (x, y, z): (&mut [f64], &mut [f64], &mut [f64]),
    (velocity_x, velocity_y, velocity_z): (&mut [f64], &mut [f64], &mut [f64]),
    (force_x, force_y, force_z): (&[f64], &[f64], &[f64]),
    factors: Factors,
    step: f64,
) -> bool {
    let count = x.len();
    let (y, z) = (&mut y[..count], &mut z[..count]);
    let (velocity_x, velocity_y) = (&mut velocity_x[..count], &mut velocity_y[..count]);
    let velocity_z = &mut velocity_z[..count];
    let (force_x, force_y, force_z) = (&force_x[..count], &force_y[..count], &force_z[..count]);
    let mut finite = true;
    for i in 0..count {
        velocity_x[i] = factors.velocity * velocity_x[i] + factors.force * force_x[i];
        velocity_y[i] = factors.velocity * velocity_y[i] + factors.force * force_y[i];
        velocity_z[i] = factors.velocity * velocity_z[i] + factors.force * force_z[i];
        x[i] += step * velocity_x[i];
        y[i] += step * velocity_y[i];
        z[i] += step * velocity_z[i];
        // Finite unless one of them is not, or close to overflow.
        finite &= (x[i] + y[i] + z[i]).is_finite();
    }
    finite
}

/// All motions together, by twos as [`Workers::for_blocks`](super::Workers::for_blocks) combines them.
pub(super) fn combined(moved: &[Moved]) -> Option<Moved> {
    match moved {
        [] => None,
        [moved] => Some(*moved),
        _ => {
            let (first, second) = moved.split_at(moved.len() / 2);
            combined(first).zip(combined(second)).map(|(first, second)| first.add(second))
        }
    }
}
