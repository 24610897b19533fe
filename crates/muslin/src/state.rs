//! What changes during a run.

use serde::{Deserialize, Serialize};

use crate::Points;

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
    /// What forces remember, as [`Configuration::memory`](crate::force::Configuration::memory) has it; empty if none does.
    pub memory: Vec<f64>,
    /// Energy [J] that friction lost in that step.
    pub friction_loss: f64,
}

/// What the rule for the step remembers of the steps before; a part of the state, since the next step depends on it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepMemory {
    /// The latest step [s], had no frame been near, up to the frame interval; zero before the first.
    pub(crate) ideal_step: f64,
    /// What is left of it [s] behind a frame that cut it in two; zero if nothing is.
    pub(crate) rest_of_step: f64,
    /// The longest step [s] that keeps the tolerance; zero if there is no tolerance or no step yet.
    pub(crate) tolerated_step: f64,
    /// Largest frequency at which the motion's energy oscillates, relative to the fastest of any motion [1], over this span
    /// of steps and the span before.
    pub(crate) energetic_shares: [f64; 2],
    /// Steps of this span so far.
    pub(crate) span_steps: u32,
    /// Largest kinetic energy [J] so far.
    pub(crate) peak_kinetic_energy: f64,
    /// Bound on the fastest frequency [rad/s] when it was evaluated last; none before the first time.
    pub(crate) fastest: Option<f64>,
    /// Steps since then, and steps after which it is evaluated again.
    pub(crate) fastest_age: u32,
    pub(crate) fastest_lasts: u32,
    /// Whether stiffness changed by much in any step of this span of steps, and of the span before.
    pub(crate) is_unsteady: [bool; 2],
    /// What was measured in the latest step, if anything was.
    pub(crate) motion: Option<Motion>,
}

impl StepMemory {
    /// The latest step [s], had no frame been near; zero before the first, and where nothing limits it.
    #[must_use]
    pub fn ideal_step(&self) -> f64 {
        self.ideal_step
    }
}

/// Energies of the motion in one step, of the free particles alone.
///
/// F are the forces where the step begins, v⁻ and v⁺ the velocities in the middle of the step before and of this one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    /// ½ Σ m v⁺² [J].
    pub kinetic_energy: f64,
    /// Σ F · v⁻ [W].
    pub power_before: f64,
    /// Σ F · v⁺ [W].
    pub power_after: f64,
}

impl Motion {
    pub(crate) fn add(self, other: Self) -> Self {
        Self {
            kinetic_energy: self.kinetic_energy + other.kinetic_energy,
            power_before: self.power_before + other.power_before,
            power_after: self.power_after + other.power_after,
        }
    }
}

/// What was found on the way through some steps, where it costs least.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepSummary {
    /// Largest strain [1] of any spring after any of the steps, per family in the order of
    /// [`Family::ALL`](crate::force::Family::ALL); −∞ where there are none. The state that the first of them began with may count, too.
    pub max_strains: [f64; 3],
    /// Energy [J] that drag took from free particles.
    pub drag_loss: f64,
}

impl Default for StepSummary {
    /// Of no steps.
    fn default() -> Self {
        Self { max_strains: [f64::NEG_INFINITY; 3], drag_loss: 0.0 }
    }
}

impl StepSummary {
    /// Of these steps and of later ones.
    #[must_use]
    pub fn and(self, later: Self) -> Self {
        let mut both = Self { drag_loss: self.drag_loss + later.drag_loss, ..self };
        both.raise_strains(later.max_strains);
        both
    }

    /// Raises the largest strains [1] to `max_strains` [1].
    pub(crate) fn raise_strains(&mut self, max_strains: [f64; 3]) {
        for (max, strain) in self.max_strains.iter_mut().zip(max_strains) {
            *max = max.max(strain);
        }
    }
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
    /// Particles at rest at time zero at `positions` [m], with nothing to remember.
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
            memory: Vec::new(),
            friction_loss: 0.0,
        }
    }

    /// Leaves all that it is in `before`, and keeps it but for positions and velocities, which are to be overwritten;
    /// cheaper than a copy, and without new memory if both have as many particles.
    pub(crate) fn leave_in(&mut self, before: &mut Self) {
        if before.positions.len() != self.positions.len() {
            before.copy_from(self);
        }
        std::mem::swap(&mut self.positions, &mut before.positions);
        std::mem::swap(&mut self.velocities, &mut before.velocities);
        before.copy_rest_from(self);
    }

    /// Overwrites it with `other`, without new memory if both have as many particles.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.positions.clone_from(&other.positions);
        self.velocities.clone_from(&other.velocities);
        self.copy_rest_from(other);
    }

    /// Overwrites all but positions and velocities.
    fn copy_rest_from(&mut self, other: &Self) {
        self.time = other.time;
        self.last_step = other.last_step;
        self.step_memory = other.step_memory;
        self.limit_work = other.limit_work;
        self.memory.clone_from(&other.memory);
        self.friction_loss = other.friction_loss;
    }
}
