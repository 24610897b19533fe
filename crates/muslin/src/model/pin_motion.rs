//! Paths along which pins move.

use std::f64::consts::TAU;

use glam::DVec3;

use crate::Points;
use crate::scene::{Keyframe, Keyframes, PinMotionSettings};

/// Displacement of a pin over time.
#[derive(Clone, Debug, PartialEq)]
pub enum PinMotion {
    /// `kind = "sine"`
    Sine(SinePath),
    /// `kind = "keyframes"`
    Keyframes(KeyframePath),
}

impl PinMotion {
    /// The motion of `settings`.
    #[must_use]
    pub fn new(settings: &PinMotionSettings) -> Self {
        match settings {
            PinMotionSettings::Keyframes(keyframes) => Self::Keyframes(KeyframePath::new(keyframes)),
            &PinMotionSettings::Sine { axis, amplitude, frequency, phase } => Self::Sine(SinePath {
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
            Self::Keyframes(path) => path.displacement(time),
        }
    }

    /// Velocity [m/s] at `time` [s]: the derivative of the displacement.
    #[must_use]
    pub fn velocity(&self, time: f64) -> DVec3 {
        match self {
            Self::Sine(path) => path.velocity(time),
            Self::Keyframes(path) => path.velocity(time),
        }
    }

    /// The longest step [s] that follows the path: a twentieth of a period, or the shortest time between two keys that
    /// differ; +∞ if the pin stays where it is.
    #[must_use]
    pub fn longest_step(&self) -> f64 {
        match self {
            Self::Sine(path) if path.amplitude == DVec3::ZERO => f64::INFINITY,
            Self::Sine(path) => TAU / (path.angular_frequency.abs() * STEPS_PER_PERIOD),
            Self::Keyframes(path) => {
                let pairs = path.keyframes.keys().windows(2);
                let moving = pairs.filter(|keys| keys[0].displacement != keys[1].displacement);
                moving.map(|keys| keys[1].time - keys[0].time).fold(f64::INFINITY, f64::min)
            }
        }
    }
}

/// Steps at least in one period of a sine.
const STEPS_PER_PERIOD: f64 = 20.0;

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

/// A path through keys, of piecewise cubics with a continuous velocity.
///
/// ```text
/// d = dᵢ + (dᵢ₊₁ − dᵢ) s² (3 − 2s) + wᵢ [vᵢ s (1 − s)² − vᵢ₊₁ s² (1 − s)] [m]        s = (t − tᵢ) / wᵢ
/// vᵢ = (wᵢ uᵢ₋₁ + wᵢ₋₁ uᵢ) / (wᵢ₋₁ + wᵢ)        wᵢ = tᵢ₊₁ − tᵢ    uᵢ = (dᵢ₊₁ − dᵢ) / wᵢ
/// ```
///
/// The velocity vᵢ at a key is that of the parabola through it and its neighbours, and zero at the first and the last key
/// and beside two equal ones. So a path begins and ends at rest, is held where it is after the last key, and stays put
/// between equal keys; and turned keys have the turned path, which a monotone interpolation of each coordinate would not
/// give. A continuous velocity keeps the method at second order: where acceleration jumps within a step, that step has an
/// error of h² in position, once per key and not once per step.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyframePath {
    keyframes: Keyframes,
    /// Velocities vᵢ [m/s], one per key.
    velocities: Vec<DVec3>,
}

impl KeyframePath {
    /// The path through `keyframes`.
    #[must_use]
    pub fn new(keyframes: &Keyframes) -> Self {
        let keys = keyframes.keys();
        let mut velocities = vec![DVec3::ZERO; keys.len()];
        for (velocity, keys) in velocities.iter_mut().skip(1).zip(keys.windows(3)) {
            let [before, at, after] = keys else { continue };
            let [left, right] = [at.time - before.time, after.time - at.time];
            let arriving = (at.displacement - before.displacement) / left;
            let leaving = (after.displacement - at.displacement) / right;
            if arriving != DVec3::ZERO && leaving != DVec3::ZERO {
                *velocity = (arriving * right + leaving * left) / (left + right);
            }
        }
        Self { keyframes: keyframes.clone(), velocities }
    }

    /// Displacement d [m] at `time` t [s].
    #[must_use]
    pub fn displacement(&self, time: f64) -> DVec3 {
        match self.piece(time) {
            Err(key) => key.displacement,
            Ok(([before, after], velocities, s)) => {
                let width = after.time - before.time;
                let tangents =
                    velocities[0] * (s * (1.0 - s) * (1.0 - s)) - velocities[1] * (s * s * (1.0 - s));
                let chord = after.displacement - before.displacement;
                before.displacement + chord * (s * s * (3.0 - 2.0 * s)) + tangents * width
            }
        }
    }

    /// Velocity dd/dt [m/s] at `time` t [s].
    #[must_use]
    pub fn velocity(&self, time: f64) -> DVec3 {
        match self.piece(time) {
            Err(_) => DVec3::ZERO,
            Ok(([before, after], velocities, s)) => {
                let chord = (after.displacement - before.displacement) / (after.time - before.time);
                let tangents =
                    velocities[0] * ((1.0 - s) * (1.0 - 3.0 * s)) - velocities[1] * (s * (2.0 - 3.0 * s));
                chord * (6.0 * s * (1.0 - s)) + tangents
            }
        }
    }

    /// The keys around `time` [s], their velocities [m/s] and the share s of the time between them; outside, the nearest key.
    fn piece(&self, time: f64) -> Result<([Keyframe; 2], [DVec3; 2], f64), Keyframe> {
        let keys = self.keyframes.keys();
        let next = keys.partition_point(|key| key.time <= time);
        let (Some(last), Some(&after)) = (next.checked_sub(1), keys.get(next)) else {
            return Err(keys[next.min(keys.len() - 1)]);
        };
        let share = (time - keys[last].time) / (after.time - keys[last].time);
        Ok(([keys[last], after], [self.velocities[last], self.velocities[next]], share))
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

    /// The longest step [s] that follows all paths; +∞ if no pin moves.
    #[must_use]
    pub fn longest_step(&self) -> f64 {
        self.groups.iter().map(|group| group.motion.longest_step()).fold(f64::INFINITY, f64::min)
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

    /// A hand that goes up, waits from 0.5 s to 0.8 s, and comes down on another way.
    fn keyframes() -> KeyframePath {
        let rows = [
            [0.0, 0.0, 0.0, 0.0],
            [0.2, 0.1, 0.3, 0.0],
            [0.5, 0.1, 0.5, -0.1],
            [0.8, 0.1, 0.5, -0.1],
            [0.9, 0.2, 0.3, 0.0],
            [1.4, 0.4, 0.1, 0.2],
        ];
        KeyframePath::new(&Keyframes::new(&rows).expect("good keys"))
    }

    /// A difference over 2 δ is wrong by δ²/6 of the third derivative, below 12 · 0.5 m / (0.1 s)³, and by ε |d| / δ.
    #[test]
    fn velocities_are_the_derivatives_of_displacements() {
        let sine = SinePath { amplitude: DVec3::new(0.1, 0.0, -0.2), angular_frequency: 7.0, phase: 0.4 };
        let delta = 1e-6;
        for path in [PinMotion::Sine(sine), PinMotion::Keyframes(keyframes())] {
            for time in [0.03, 0.1, 0.33, 0.49, 0.6, 0.83, 1.0, 1.39, 1.5, 30.0] {
                let ends = [time - delta, time + delta].map(|time| path.displacement(time));
                let error = ((ends[1] - ends[0]) / (2.0 * delta) - path.velocity(time)).length();
                assert!(error < 1e-8, "{error:e} m/s at {time} s of {path:?}");
            }
        }
    }

    #[test]
    fn a_pin_that_stays_allows_any_step() {
        let sine = |amplitude: f64, angular_frequency: f64| {
            PinMotion::Sine(SinePath { amplitude: DVec3::X * amplitude, angular_frequency, phase: 0.4 })
        };
        assert_eq!(sine(0.0, 1e6).longest_step(), f64::INFINITY);
        assert_eq!(sine(0.1, 0.0).longest_step(), f64::INFINITY);
        assert!((sine(0.1, 1e3).longest_step() / (TAU / 2e4) - 1.0).abs() < 1e-15);
        let held = [[0.0; 4], [1e-6, 0.0, 0.0, 0.0], [0.5, 0.1, 0.0, 0.0], [0.500001, 0.1, 0.0, 0.0]];
        let keyframes = |count: usize| {
            let keyframes = Keyframes::new(&held[..count]).expect("good keys");
            PinMotion::Keyframes(KeyframePath::new(&keyframes)).longest_step()
        };
        assert_eq!(keyframes(2), f64::INFINITY);
        assert!((keyframes(4) - 0.499999).abs() < 1e-15, "{}", keyframes(4));
    }

    #[test]
    fn keys_are_met_smoothly_and_held() {
        let path = keyframes();
        for key in path.keyframes.keys() {
            let at = |offset: f64| (path.displacement(key.time + offset), path.velocity(key.time + offset));
            assert_eq!(at(0.0).0, key.displacement);
            for side in [-1e-12, 1e-12] {
                let (displacement, velocity) = at(side);
                // Velocities are below 5 m/s, accelerations below 200 m/s².
                assert!((displacement - key.displacement).length() < 1e-11, "at {} s", key.time);
                assert!((velocity - at(0.0).1).length() < 1e-9, "at {} s", key.time);
            }
        }
        for (times, place) in [([0.5, 0.6, 0.77], [0.1, 0.5, -0.1]), ([1.4, 2.0, 1e9], [0.4, 0.1, 0.2])] {
            for time in times {
                assert_eq!(path.displacement(time), DVec3::from_array(place));
                assert_eq!(path.velocity(time), DVec3::ZERO);
            }
        }
        assert_eq!((path.displacement(0.0), path.velocity(0.0)), (DVec3::ZERO, DVec3::ZERO));
    }

    /// Away from rests a path through points of a parabola is that parabola.
    #[test]
    fn a_parabola_is_met_exactly() {
        let parabola = |t: f64| DVec3::new(0.3, -0.1, 0.2) * t + DVec3::new(0.0, 0.5, -0.4) * t * t;
        let times = [0.0, 0.3, 0.4, 0.9, 1.0, 1.7];
        let rows = times.map(|t| [t, parabola(t).x, parabola(t).y, parabola(t).z]);
        let path = KeyframePath::new(&Keyframes::new(&rows).expect("good keys"));
        for time in [0.31, 0.38, 0.5, 0.77, 0.95] {
            assert!((path.displacement(time) - parabola(time)).length() < 1e-15, "at {time} s");
        }
    }
}
