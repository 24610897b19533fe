//! What the strength of a wind does over time.

use glam::DVec3;

use super::Noise;

/// Steps at least in one period of a gust: the error of its impulse is then below 1 %.
const STEPS_PER_PERIOD: f64 = 20.0;

/// A vector along one direction whose size swings and varies at random; its unit is the owner's.
///
/// ```text
/// [A sin(ω t + φ) + ε(t)] d
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Gust {
    /// Amplitude A.
    pub amplitude: f64,
    /// Angular frequency ω [rad/s].
    pub angular_frequency: f64,
    /// Phase φ [rad].
    pub phase: f64,
    /// Direction d [1], of unit length.
    pub direction: DVec3,
    /// Random part ε, if there is one.
    pub noise: Option<Noise>,
}

impl Gust {
    /// The vector at `time` [s], which must not be negative.
    #[must_use]
    pub fn value(&self, time: f64) -> DVec3 {
        let sine = self.amplitude * libm::sin(self.angular_frequency * time + self.phase);
        self.direction * (sine + self.noise.as_ref().map_or(0.0, |noise| noise.value(time)))
    }

    /// The longest step [s] that follows how the gust changes; +∞ if it does not.
    #[must_use]
    pub fn longest_step(&self) -> f64 {
        let period = std::f64::consts::TAU / self.angular_frequency;
        let sine = if self.amplitude == 0.0 { f64::INFINITY } else { period / STEPS_PER_PERIOD };
        sine.min(self.noise.as_ref().map_or(f64::INFINITY, Noise::longest_step))
    }
}
