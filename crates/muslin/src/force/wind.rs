//! The paper's wind.

use std::ops::Range;

use super::{Configuration, Force, Gust, Sweep};
use crate::PointsMut;

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
    /// Force [N] on every particle.
    pub force: Gust,
}

impl Force for ParticleWind {
    fn add_forces(
        &self,
        at: Configuration<'_>,
        _block: &Range<usize>,
        forces: &mut PointsMut<'_>,
        _sweep: &mut Sweep,
    ) {
        let force = self.force.value(at.time);
        forces.x.iter_mut().for_each(|value| *value += force.x);
        forces.y.iter_mut().for_each(|value| *value += force.y);
        forces.z.iter_mut().for_each(|value| *value += force.z);
    }

    fn is_external(&self) -> bool {
        true
    }

    fn has_varying_bounds(&self) -> bool {
        false
    }

    fn longest_step(&self) -> f64 {
        self.force.longest_step()
    }
}
