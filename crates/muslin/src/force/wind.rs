//! Wind.

use std::ops::Range;

use glam::DVec3;

use super::{Configuration, Force, Noise};
use crate::PointsMut;

/// Steps at least in one period of a gust: the error of its impulse is then below 1 %.
const STEPS_PER_PERIOD: f64 = 20.0;

/// The paper's wind: the same force on every particle, wherever it is and whatever way the cloth faces.
///
/// ```text
/// F = [A sin(ω t + φ) + ε(t)] d [N]
/// ```
///
/// It changes sign, so it blows backwards half of the time, and it acts like a gravity that turns: a pinned sheet swings
/// in it but cannot flutter. Source: Luo, Miyaki, Yamasaki, Aizawa, "Dynamic 3D Simulation of Fabric Based on Improved
/// Mass-Spring Model", section 2, whose ω is called a period but multiplies the time, and whose ε is printed without its correlation.
#[derive(Clone, Debug, PartialEq)]
pub struct ParticleWind {
    /// Amplitude A [N].
    pub amplitude: f64,
    /// Angular frequency ω [rad/s].
    pub angular_frequency: f64,
    /// Phase φ [rad].
    pub phase: f64,
    /// Direction d [1], of unit length.
    pub direction: DVec3,
    /// Random part ε of the strength [N], if there is one.
    pub noise: Option<Noise>,
}

impl ParticleWind {
    /// Force [N] on every particle at `time` [s].
    #[must_use]
    pub fn force(&self, time: f64) -> DVec3 {
        let sine = self.amplitude * libm::sin(self.angular_frequency * time + self.phase);
        self.direction * (sine + self.noise.as_ref().map_or(0.0, |noise| noise.value(time)))
    }
}

impl Force for ParticleWind {
    fn add_forces(&self, at: Configuration<'_>, _block: &Range<usize>, forces: &mut PointsMut<'_>) {
        let force = self.force(at.time);
        forces.x.iter_mut().for_each(|value| *value += force.x);
        forces.y.iter_mut().for_each(|value| *value += force.y);
        forces.z.iter_mut().for_each(|value| *value += force.z);
    }

    fn is_external(&self) -> bool {
        true
    }

    fn has_constant_bounds(&self) -> bool {
        true
    }

    fn longest_step(&self) -> f64 {
        let period = std::f64::consts::TAU / self.angular_frequency;
        let noise = self.noise.as_ref().map_or(f64::INFINITY, Noise::longest_step);
        (period / STEPS_PER_PERIOD).min(noise)
    }
}
