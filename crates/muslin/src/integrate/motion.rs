//! The second half of a step of central differences: motion under forces that are known.

use std::ops::Range;

use crate::instructions::Vectorise;
use crate::model::{OtherParticle, ParticleStretch, Particles};
use crate::points::dots_in_lanes;
use crate::{Motion, PointsMut, State};

/// The sizes of the step that led here and of the next one [s].
#[derive(Clone, Copy, Debug)]
pub(super) struct Steps {
    pub(super) last: f64,
    pub(super) next: f64,
}

/// What turns velocity and force of a particle into its next velocity.
#[derive(Clone, Copy, Default)]
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

/// A particle that moves in another way than most of its stretch.
#[derive(Clone, Copy, Default)]
struct Other {
    /// Its place in the block.
    at: usize,
    is_pinned: bool,
    factors: Factors,
    /// One coordinate of its position and velocity before most have moved.
    before: [f64; 2],
}

impl Other {
    /// In a block that begins with particle `first`.
    fn new(other: &OtherParticle, first: usize, steps: Steps) -> Self {
        let OtherParticle { particle, mass, drag, is_pinned } = *other;
        Self { at: particle - first, is_pinned, factors: Factors::new(mass, drag, steps), before: [0.0; 2] }
    }
}

/// What came of moving some particles.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Moved {
    /// Whether all positions stay finite.
    pub(super) is_finite: bool,
    pub(super) motion: Motion,
    /// Σ k_d v² [W] over free particles, with their velocities over the step.
    pub(super) drag_power: f64,
}

impl Moved {
    pub(super) fn add(self, other: Self) -> Self {
        Self {
            is_finite: self.is_finite && other.is_finite,
            motion: self.motion.add(other.motion),
            drag_power: self.drag_power + other.drag_power,
        }
    }
}

/// What is to be found of a motion, beside the motion; zero if it is not.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Wanted {
    pub(super) energies: bool,
    pub(super) drag_power: bool,
}

/// Moves the particles of `block`, and finds what is `wanted` of their motion.
pub(super) struct MoveBlock<'a, 'b> {
    /// The state of all particles from which they move, where it is not the one that is overwritten.
    pub(super) from: Option<&'a State>,
    pub(super) particles: &'a Particles,
    pub(super) steps: Steps,
    pub(super) block: &'a Range<usize>,
    /// Of the block.
    pub(super) positions: PointsMut<'b>,
    /// Of the block.
    pub(super) velocities: PointsMut<'b>,
    /// Forces [N] on the block along x, y and z.
    pub(super) forces: [&'a [f64]; 3],
    pub(super) wanted: Wanted,
}

impl Vectorise for MoveBlock<'_, '_> {
    type Output = Moved;

    #[inline(always)]
    fn run(self) -> Moved {
        let Self { from, particles, steps, block, positions, velocities, forces, wanted } = self;
        let [from_x, from_y, from_z] = match from {
            Some(from) => {
                let [[x, y, z], [u, v, w]] =
                    [&from.positions, &from.velocities].map(|points| points.slice(block));
                [Some((x, u)), Some((y, v)), Some((z, w))]
            }
            None => [None; 3],
        };
        let [force_x, force_y, force_z] = forces;
        let mut axes = [
            Axis { from: from_x, positions: positions.x, velocities: velocities.x, forces: force_x },
            Axis { from: from_y, positions: positions.y, velocities: velocities.y, forces: force_y },
            Axis { from: from_z, positions: positions.z, velocities: velocities.z, forces: force_z },
        ];
        let mut moved = Moved { is_finite: true, ..Moved::default() };
        if wanted.energies {
            moved.motion.power_before = power(particles, block, &axes, false);
        }
        let mut others = [Other::default(); ParticleStretch::MAX_OTHERS];
        for stretch in particles.stretches(block) {
            let others = &mut others[..stretch.others.len()];
            for (other, particle) in others.iter_mut().zip(stretch.others) {
                *other = Other::new(particle, block.start, steps);
            }
            let most = Factors::new(stretch.mass, stretch.drag, steps);
            for axis in &mut axes {
                moved.is_finite &= axis.move_stretch(&stretch, block.start, (most, others), steps.next);
            }
        }
        if wanted.drag_power {
            moved.drag_power = drag_power(particles, block, &axes);
        }
        if wanted.energies {
            moved.motion.power_after = power(particles, block, &axes, true);
            moved.motion.kinetic_energy = kinetic_energy(particles, block, &axes);
        }
        moved
    }
}

/// One coordinate of the particles of a block.
struct Axis<'a> {
    /// Positions and velocities from which they move, where these are not overwritten.
    from: Option<(&'a [f64], &'a [f64])>,
    positions: &'a mut [f64],
    velocities: &'a mut [f64],
    forces: &'a [f64],
}

impl Axis<'_> {
    /// Velocities before anything moves.
    fn velocities_before(&self) -> &[f64] {
        self.from.map_or(&*self.velocities, |(_, velocities)| velocities)
    }

    /// Moves the particles of a `stretch` by `step` [s], in a block that begins with particle `first`; whether all
    /// positions stay finite. `most` are the factors of all but the `others`.
    #[inline(always)]
    fn move_stretch(
        &mut self,
        stretch: &ParticleStretch<'_>,
        first: usize,
        (most, others): (Factors, &mut [Other]),
        step: f64,
    ) -> bool {
        let own = stretch.particles.start - first..stretch.particles.end - first;
        for other in &mut *others {
            other.before = match self.from {
                Some((positions, velocities)) => [positions[other.at], velocities[other.at]],
                None => [self.positions[other.at], self.velocities[other.at]],
            };
        }
        let mut is_finite = if stretch.is_pinned {
            self.rest(own.clone());
            true
        } else {
            let (positions, velocities) =
                (&mut self.positions[own.clone()], &mut self.velocities[own.clone()]);
            let forces = &self.forces[own.clone()];
            match self.from {
                Some((from, from_velocities)) => {
                    let from = (&from[own.clone()], &from_velocities[own.clone()]);
                    move_from(from, positions, velocities, forces, most, step)
                }
                None => move_in_place(positions, velocities, forces, most, step),
            }
        };
        // They have been moved as if they were like most.
        for &mut Other { at, is_pinned, factors, before: [position, velocity] } in others {
            (self.positions[at], self.velocities[at]) = if is_pinned {
                (position, 0.0)
            } else {
                let velocity = factors.velocity * velocity + factors.force * self.forces[at];
                (position + step * velocity, velocity)
            };
            is_finite &= self.positions[at].is_finite();
        }
        is_finite || self.positions[own].iter().all(|position| position.is_finite())
    }

    /// Leaves the pins of a range where they are.
    fn rest(&mut self, own: Range<usize>) {
        self.velocities[own.clone()].fill(0.0);
        if let Some((positions, _)) = self.from {
            self.positions[own.clone()].copy_from_slice(&positions[own]);
        }
    }
}

/// Σ F · v [W] over the free particles of a block, with their velocities before they move or, if `is_after`, after that.
#[inline(always)]
fn power(particles: &Particles, block: &Range<usize>, axes: &[Axis<'_>; 3], is_after: bool) -> f64 {
    let mut power = 0.0;
    for run in particles.runs(block).filter(|run| !run.is_pinned) {
        let own = run.particles.start - block.start..run.particles.end - block.start;
        let [x, y, z] = axes;
        let forces = [&x.forces[own.clone()], &y.forces[own.clone()], &z.forces[own.clone()]];
        let velocities =
            [x, y, z].map(|axis| if is_after { &*axis.velocities } else { axis.velocities_before() });
        let [u, v, w] = velocities;
        power += dots_in_lanes(forces, [&u[own.clone()], &v[own.clone()], &w[own]]);
    }
    power
}

/// ½ Σ m v² [J] over the free particles of a block.
#[inline(always)]
fn kinetic_energy(particles: &Particles, block: &Range<usize>, axes: &[Axis<'_>; 3]) -> f64 {
    let mut energy = 0.0;
    for run in particles.runs(block).filter(|run| !run.is_pinned) {
        let own = run.particles.start - block.start..run.particles.end - block.start;
        let [x, y, z] = axes;
        let velocities = [&x.velocities[own.clone()], &y.velocities[own.clone()], &z.velocities[own]];
        energy += 0.5 * run.mass * dots_in_lanes(velocities, velocities);
    }
    energy
}

/// Σ k_d v² [W] over the free particles of a block: pins have no velocity until they are placed.
#[inline(always)]
fn drag_power(particles: &Particles, block: &Range<usize>, axes: &[Axis<'_>; 3]) -> f64 {
    let mut power = 0.0;
    for stretch in particles.stretches(block) {
        let own = stretch.particles.start - block.start..stretch.particles.end - block.start;
        let [x, y, z] = axes;
        let drag = if stretch.is_pinned { 0.0 } else { stretch.drag };
        if 0.0 < drag {
            let velocities = [&x.velocities[own.clone()], &y.velocities[own.clone()], &z.velocities[own]];
            power += drag * dots_in_lanes(velocities, velocities);
        }
        for other in stretch.others {
            // It counted as most do.
            let more = other.drag - drag;
            if more != 0.0 {
                let at = other.particle - block.start;
                let [x, y, z] = [x.velocities[at], y.velocities[at], z.velocities[at]];
                power += more * (x * x + y * y + z * z);
            }
        }
    }
    power
}

/// Moves equal particles along one axis by `step` [s]; whether all positions stay finite.
#[inline(always)]
fn move_in_place(
    positions: &mut [f64],
    velocities: &mut [f64],
    forces: &[f64],
    factors: Factors,
    step: f64,
) -> bool {
    let count = positions.len();
    let (velocities, forces) = (&mut velocities[..count], &forces[..count]);
    let mut finite = u64::MAX;
    for i in 0..count {
        velocities[i] = factors.velocity * velocities[i] + factors.force * forces[i];
        positions[i] += step * velocities[i];
        finite &= mask(positions[i].is_finite());
    }
    finite == u64::MAX
}

/// The same with the same bits, from other positions and velocities.
#[inline(always)]
fn move_from(
    (from, from_velocities): (&[f64], &[f64]),
    positions: &mut [f64],
    velocities: &mut [f64],
    forces: &[f64],
    factors: Factors,
    step: f64,
) -> bool {
    let count = positions.len();
    let (from, from_velocities) = (&from[..count], &from_velocities[..count]);
    let (velocities, forces) = (&mut velocities[..count], &forces[..count]);
    let mut finite = u64::MAX;
    for i in 0..count {
        velocities[i] = factors.velocity * from_velocities[i] + factors.force * forces[i];
        positions[i] = from[i] + step * velocities[i];
        finite &= mask(positions[i].is_finite());
    }
    finite == u64::MAX
}

/// A truth as wide as a number, so that vectors of both have as many.
#[inline(always)]
fn mask(is_true: bool) -> u64 {
    if is_true { u64::MAX } else { 0 }
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

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::{InstructionSet, Points};

    const STEPS: Steps = Steps { last: 2e-3, next: 3e-3 };

    /// Particles of two kinds, some of them pinned, in long and short runs; `count` of them.
    fn particles(count: usize) -> Particles {
        let mut particles = Particles::default();
        for index in 0..count {
            let (mass, drag) = if index % 37 < 3 { (2e-3, 0.0) } else { (1e-3, 0.2) };
            particles.extend(1, mass, drag);
        }
        // One is free within a run of pins.
        let is_pin = |index: usize| index.is_multiple_of(41) || ((100..130).contains(&index) && index != 110);
        (0..count).filter(|&index| is_pin(index)).for_each(|index| {
            particles.pin(index);
        });
        particles.find_runs();
        particles
    }

    /// A wave of points of about `size`.
    fn wave(count: usize, size: f64) -> Points {
        (0..count)
            .map(|index| {
                let angle = 0.7 * index as f64;
                size * DVec3::new(libm::sin(angle), libm::cos(1.3 * angle), libm::sin(0.1 * angle))
            })
            .collect()
    }

    /// What comes of `state` with blocks of `size` particles: in its own place, or if `is_apart` in that of another state.
    fn moved(
        particles: &Particles,
        (state, forces): (&State, &Points),
        size: usize,
        is_apart: bool,
        instructions: InstructionSet,
    ) -> (State, Moved) {
        let count = particles.len();
        let (from, mut to) =
            if is_apart { (Some(state), State::at_rest(wave(count, 9.0))) } else { (None, state.clone()) };
        let mut results = Vec::new();
        for start in (0..count).step_by(size) {
            let block = &(start..(start + size).min(count));
            let (positions, velocities) = (to.positions.slice_mut(block), to.velocities.slice_mut(block));
            results.push(instructions.run(MoveBlock {
                from,
                particles,
                steps: STEPS,
                block,
                positions,
                velocities,
                forces: forces.slice(block),
                wanted: Wanted { energies: true, drag_power: true },
            }));
        }
        (to, combined(&results).expect("a block"))
    }

    /// Particle by particle with constants of its own, and the energies of the free ones.
    fn expected(particles: &Particles, state: &State, forces: &Points) -> (State, Moved) {
        let (mut to, mut moved) = (state.clone(), Moved::default());
        for index in 0..particles.len() {
            if particles.pinned()[index] {
                to.velocities.set(index, DVec3::ZERO);
                continue;
            }
            let (mass, drag) = (particles.masses()[index], particles.drags()[index]);
            let Factors { velocity, force } = Factors::new(mass, drag, STEPS);
            let before = state.velocities.get(index);
            let after = velocity * before + force * forces.get(index);
            to.velocities.set(index, after);
            to.positions.set(index, state.positions.get(index) + STEPS.next * after);
            moved.drag_power += drag * after.length_squared();
            moved.motion = moved.motion.add(Motion {
                kinetic_energy: 0.5 * mass * after.length_squared(),
                power_before: forces.get(index).dot(before),
                power_after: forces.get(index).dot(after),
            });
        }
        (to, moved)
    }

    /// With the same bits; energies and powers, which are summed in another order, to rounding.
    #[test]
    fn blocks_move_as_their_particles_do() {
        for count in [1, 7, 500] {
            let particles = particles(count);
            let mut state = State::at_rest(wave(count, 1.0));
            state.velocities = wave(count, 3.0);
            let forces = wave(count, 0.5);
            let (end, expected) = expected(&particles, &state, &forces);
            for instructions in InstructionSet::available() {
                for (size, is_apart) in [(1, false), (1, true), (97, false), (97, true), (500, true)] {
                    let (found, moved) = moved(&particles, (&state, &forces), size, is_apart, instructions);
                    let case = format!("{count} by {size} with {}, apart: {is_apart}", instructions.name());
                    assert_eq!(found.positions, end.positions, "{case}");
                    assert_eq!(found.velocities, end.velocities, "{case}");
                    assert!(moved.is_finite, "{case}");
                    for (found, expected) in [
                        (moved.motion.kinetic_energy, expected.motion.kinetic_energy),
                        (moved.motion.power_before, expected.motion.power_before),
                        (moved.motion.power_after, expected.motion.power_after),
                        (moved.drag_power, expected.drag_power),
                    ] {
                        // Of numbers below 2e-2 J and 3 W each.
                        assert!(
                            (found - expected).abs() <= 1e-14 * count as f64,
                            "{case}: {found}, {expected}"
                        );
                    }
                }
            }
        }
    }

    /// What overflows on a pin moves nothing, alone in its run or in a long one; on any free particle it is reported.
    #[test]
    fn only_free_particles_leave_the_range_of_numbers() {
        let particles = particles(300);
        let mut state = State::at_rest(wave(300, 1.0));
        state.velocities = wave(300, 3.0);
        for overflowing in [f64::MAX, f64::INFINITY, f64::NAN] {
            for (index, axis) in (0..300).flat_map(|index| DVec3::AXES.map(|axis| (index, axis))) {
                let mut forces = wave(300, 0.5);
                let force = DVec3::select(axis.cmpgt(DVec3::ZERO), DVec3::splat(overflowing), DVec3::ZERO);
                forces.set(index, force);
                let is_pinned = particles.pinned()[index];
                for is_apart in [false, true] {
                    let best = InstructionSet::best();
                    let (end, moved) = moved(&particles, (&state, &forces), 120, is_apart, best);
                    assert_eq!(moved.is_finite, is_pinned, "{force} N on particle {index}");
                    assert_eq!(end.positions.is_finite(), is_pinned, "{force} N on particle {index}");
                }
            }
        }
    }
}
