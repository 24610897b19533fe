//! What changes during a run.

use crate::Points;
use crate::integrate::StepMemory;

/// Time, positions and velocities of all particles: what a method needs to go on, and nothing else.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Simulated time [s].
    pub time: f64,
    /// Positions [m] at [`time`](Self::time), one per particle.
    pub positions: Points,
    /// Velocities [m/s] half of [`last_step`](Self::last_step) before [`time`](Self::time), one per particle.
    pub velocities: Points,
    /// The step that led here [s]; zero if the velocities are those at [`time`](Self::time) itself.
    pub last_step: f64,
    /// What the rule for an adaptive step remembers; unused where the step is constant.
    pub step_memory: StepMemory,
    /// What [limits](crate::limit) did in that step.
    pub limit_work: LimitWork,
}

/// Work [J] of limits on the particles in one step; zero where there are none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LimitWork {
    /// On free particles.
    pub on_free: f64,
    /// On pins that move.
    pub on_pins: f64,
}

impl State {
    /// Particles at rest at time zero at `positions` [m].
    #[must_use]
    pub fn at_rest(positions: Points) -> Self {
        let velocities = Points::zeros(positions.len());
        Self {
            time: 0.0,
            positions,
            velocities,
            last_step: 0.0,
            step_memory: StepMemory::default(),
            limit_work: LimitWork::default(),
        }
    }

    /// Overwrites it with `other`, without new memory if both have as many particles.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.positions.clone_from(&other.positions);
        self.velocities.clone_from(&other.velocities);
        self.time = other.time;
        self.last_step = other.last_step;
        self.step_memory = other.step_memory;
        self.limit_work = other.limit_work;
    }
}
