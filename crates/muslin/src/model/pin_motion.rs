//! Paths along which pins move.

use std::f64::consts::TAU;

use glam::DVec3;

use crate::Points;
use crate::scene::PinMotionSettings;

/// Displacement of a pin over time.
#[derive(Clone, Debug, PartialEq)]
pub enum PinMotion {
    /// `kind = "sine"`
    Sine(SinePath),
}

impl PinMotion {
    /// The motion of `settings`.
    #[must_use]
    pub fn new(settings: &PinMotionSettings) -> Self {
        match *settings {
            PinMotionSettings::Sine { axis, amplitude, frequency, phase } => Self::Sine(SinePath {
                amplitude: axis * amplitude,
                angular_frequency: TAU * frequency,
                phase,
            }),
        }
    }

    /// Displacement [m] at `time` [s] from where the cloth was placed.
    #[must_use]
    pub fn displacement(&self, time: f64) -> DVec3 {
        match self {
            Self::Sine(path) => path.displacement(time),
        }
    }

    /// Velocity [m/s] at `time` [s]: the derivative of the displacement.
    #[must_use]
    pub fn velocity(&self, time: f64) -> DVec3 {
        match self {
            Self::Sine(path) => path.velocity(time),
        }
    }
}

/// A path to and fro.
///
/// ```text
/// d(t) = A sin(ω t + φ) [m]
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SinePath {
    /// Amplitude A [m] along each axis.
    pub amplitude: DVec3,
    /// Angular frequency ω [rad/s].
    pub angular_frequency: f64,
    /// Phase φ [rad].
    pub phase: f64,
}

impl SinePath {
    /// Displacement d [m] at `time` t [s].
    #[must_use]
    pub fn displacement(&self, time: f64) -> DVec3 {
        self.amplitude * libm::sin(self.angular_frequency * time + self.phase)
    }

    /// Velocity dd/dt [m/s] at `time` t [s].
    #[must_use]
    pub fn velocity(&self, time: f64) -> DVec3 {
        self.amplitude * (self.angular_frequency * libm::cos(self.angular_frequency * time + self.phase))
    }
}

/// The pins of a model that move.
///
/// Invariant: no particle is listed twice.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MovingPins {
    groups: Vec<PinGroup>,
}

/// Pins that move alike.
#[derive(Clone, Debug, PartialEq)]
struct PinGroup {
    motion: PinMotion,
    /// Particles, and their positions [m] where the displacement is zero.
    pins: Vec<(usize, DVec3)>,
}

impl MovingPins {
    /// Whether no pin moves.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.groups.is_empty()
    }

    /// The particles, each once, in the order of the scene.
    pub fn particles(&self) -> impl Iterator<Item = usize> + '_ {
        self.groups.iter().flat_map(|group| group.pins.iter().map(|(particle, _)| *particle))
    }

    /// The particles, each once, and their positions [m] at `time` [s].
    pub fn positions(&self, time: f64) -> impl Iterator<Item = (usize, DVec3)> + '_ {
        self.groups.iter().flat_map(move |group| {
            let displacement = group.motion.displacement(time);
            group.pins.iter().map(move |(particle, start)| (*particle, *start + displacement))
        })
    }

    /// Overwrites the `velocities` [m/s] of these pins with those at `time` [s].
    pub fn eval_velocities(&self, time: f64, velocities: &mut Points) {
        for group in &self.groups {
            let velocity = group.motion.velocity(time);
            for (particle, _) in &group.pins {
                velocities.set(*particle, velocity);
            }
        }
    }

    /// Adds the pin `particle`, which is at `start` [m] where its displacement is zero.
    pub(crate) fn add(&mut self, particle: usize, start: DVec3, motion: &PinMotion) {
        match self.groups.last_mut().filter(|group| group.motion == *motion) {
            Some(group) => group.pins.push((particle, start)),
            None => self.groups.push(PinGroup { motion: motion.clone(), pins: vec![(particle, start)] }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Velocities are the derivatives of displacements; a difference over 2 δ is wrong by δ² ω³ A / 6 and ε A / δ.
    #[test]
    fn velocity_is_the_derivative_of_the_displacement() {
        let amplitude = DVec3::new(0.1, 0.0, -0.2);
        let path = PinMotion::Sine(SinePath { amplitude, angular_frequency: 7.0, phase: 0.4 });
        let delta = 1e-5;
        for time in [0.0, 0.1, 1.7, 30.0] {
            let difference =
                (path.displacement(time + delta) - path.displacement(time - delta)) / (2.0 * delta);
            let error = (difference - path.velocity(time)).length();
            assert!(error < 1e-8 * amplitude.length(), "{error:e} m/s at {time} s");
        }
    }
}
