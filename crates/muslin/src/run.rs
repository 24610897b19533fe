//! The run of a scene: its schedule of frames, and the steps between them.

use crate::integrate::{
    CentralDifference, Integrator, StepError, Workers, guaranteed_stable_step, largest_stable_step,
};
use crate::observe::{Frame, Observer};
use crate::scene::{Method, RunSettings, StepRule};
use crate::{Model, Points, Scene, State};

/// Share of the largest stable step that is suggested when a scene asks for more.
const SUGGESTED_SHARE: f64 = 0.9;

/// Why a run cannot start.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// The constant step is larger than explicit central differences can be stable with.
    #[error(
        "`run.step.constant` is {step:.6e} s, but the largest stable step of this scene is {largest:.6e} s"
    )]
    UnstableStep {
        /// The step asked for [s].
        step: f64,
        /// The largest stable step [s].
        largest: f64,
        /// A stable step [s] that divides the frame interval.
        suggestion: f64,
    },
    /// A state that a run of the scene cannot have reached.
    #[error("a run cannot go on from this state: {reason}")]
    WrongState {
        /// What is wrong with it.
        reason: String,
    },
}

/// A scene in motion.
///
/// Time is counted, not summed: frame `n` is at `n / frame_rate`, and step `k` of `N` after it at
/// `(n + k / N) / frame_rate`.
pub struct Simulation {
    model: Model,
    state: State,
    velocities: Points,
    integrator: Box<dyn Integrator>,
    settings: RunSettings,
    frame_index: u64,
    failure: Option<StepError>,
}

impl Simulation {
    /// The method that `scene` names, on `workers`.
    #[must_use]
    pub fn integrator(scene: &Scene, workers: Workers) -> Box<dyn Integrator> {
        match scene.run().method {
            Method::CentralDifference => Box::new(CentralDifference::new(workers)),
        }
    }

    /// `scene` at time zero, to be moved by `integrator`.
    ///
    /// # Errors
    /// [`SimulationError::UnstableStep`] unless the scene allows it.
    pub fn new(scene: &Scene, integrator: Box<dyn Integrator>) -> Result<Self, SimulationError> {
        let model = Model::new(scene);
        let mut state = model.initial_state(scene);
        let settings = scene.run().clone();
        if !settings.allow_unstable {
            check_step(&settings, &model, &state, integrator.workers())?;
        }
        CentralDifference::start(settings.start, &mut state, constant_step(&settings));
        Ok(Self::at_frame(model, state, integrator, settings, 0))
    }

    /// `scene` at frame `frame_index`, whose `state` an earlier run reached.
    ///
    /// # Errors
    /// [`SimulationError::WrongState`] if `state` is not one of as many particles at the time of that frame, or the scene
    /// has no such frame.
    pub fn resume(
        scene: &Scene,
        integrator: Box<dyn Integrator>,
        state: State,
        frame_index: u64,
    ) -> Result<Self, SimulationError> {
        let (model, settings) = (Model::new(scene), scene.run().clone());
        let wrong = |reason: String| Err(SimulationError::WrongState { reason });
        let (particles, time) = (model.particles().len(), frame_index as f64 / settings.frame_rate);
        for (name, points) in [("positions", &state.positions), ("velocities", &state.velocities)] {
            if [&points.x, &points.y, &points.z].iter().any(|axis| axis.len() != particles) {
                return wrong(format!(
                    "it has {} {name}, but the scene has {particles} particles",
                    points.len()
                ));
            }
        }
        if settings.frame_intervals < frame_index {
            return wrong(format!(
                "it is of frame {frame_index}, but the last is {}",
                settings.frame_intervals
            ));
        }
        if state.time != time {
            return wrong(format!("it is at {} s, but frame {frame_index} is at {time} s", state.time));
        }
        Ok(Self::at_frame(model, state, integrator, settings, frame_index))
    }

    fn at_frame(
        model: Model,
        state: State,
        mut integrator: Box<dyn Integrator>,
        settings: RunSettings,
        frame_index: u64,
    ) -> Self {
        let mut velocities = Points::zeros(state.positions.len());
        integrator.eval_velocities(&model, &state, &mut velocities);
        Self { model, state, velocities, integrator, settings, frame_index, failure: None }
    }

    /// What is constant.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The current frame; after an error of [`advance`](Self::advance), the broken state of the failed step.
    #[must_use]
    pub fn frame(&self) -> Frame<'_> {
        Frame { index: self.frame_index, state: &self.state, velocities: &self.velocities }
    }

    /// Whether the current frame is the last.
    #[must_use]
    pub fn is_finished(&self) -> bool {
        self.frame_index >= self.settings.frame_intervals
    }

    /// Shows the current frame to `observers`; for the first one, which no step leads to.
    pub fn observe(&self, observers: &mut [&mut dyn Observer]) {
        for observer in observers {
            observer.frame(&self.model, &self.frame());
        }
    }

    /// Moves to the next frame and shows every step and the frame to `observers`, which must have seen the first frame by
    /// [`observe`](Self::observe). After the last frame it does nothing.
    ///
    /// # Errors
    /// If a step fails, or the velocities of the frame are no longer finite numbers. The state is then that of the failed
    /// step, no observer sees the frame, and every further call gives the same error.
    pub fn advance(&mut self, observers: &mut [&mut dyn Observer]) -> Result<(), StepError> {
        if let Some(failure) = &self.failure {
            return Err(failure.clone());
        }
        if self.is_finished() {
            return Ok(());
        }
        let workers = self.integrator.workers().clone();
        let result = workers.install(|| self.step_to_next_frame(observers));
        self.failure = result.as_ref().err().cloned();
        result
    }

    fn step_to_next_frame(&mut self, observers: &mut [&mut dyn Observer]) -> Result<(), StepError> {
        let StepRule::Constant { steps_per_frame } = self.settings.step;
        let step = constant_step(&self.settings);
        for count in 1..=steps_per_frame {
            let result = self.integrator.step(&self.model, &mut self.state, step);
            let passed = self.frame_index as f64 + count as f64 / steps_per_frame as f64;
            self.state.time = passed / self.settings.frame_rate;
            result?;
            for observer in observers.iter_mut() {
                observer.step(&self.model, &self.state);
            }
        }
        self.integrator.eval_velocities(&self.model, &self.state, &mut self.velocities);
        // Forces overflow earlier than positions do; a frame must not show it.
        if let Some(particle) = self.velocities.iter().position(|velocity| !velocity.is_finite()) {
            return Err(StepError::NotFinite { particle, time: self.state.time });
        }
        self.frame_index += 1;
        self.observe(observers);
        Ok(())
    }
}

/// The constant step [s] of `settings`.
fn constant_step(settings: &RunSettings) -> f64 {
    let StepRule::Constant { steps_per_frame } = settings.step;
    1.0 / (settings.frame_rate * steps_per_frame as f64)
}

/// Checks that the constant step is stable where the cloth starts.
fn check_step(
    settings: &RunSettings,
    model: &Model,
    state: &State,
    workers: &Workers,
) -> Result<(), SimulationError> {
    let step = constant_step(settings);
    // At the limit itself the fastest mode grows with every step.
    if step < guaranteed_stable_step(model, state) {
        return Ok(());
    }
    let largest = largest_stable_step(model, state, workers);
    if step < largest {
        return Ok(());
    }
    let suggestion = suggested_step(settings.frame_rate, largest);
    Err(SimulationError::UnstableStep { step, largest, suggestion })
}

/// The largest step [s] up to nine tenths of `largest` [s] that divides the frame interval.
#[must_use]
pub fn suggested_step(frame_rate: f64, largest: f64) -> f64 {
    let steps_per_frame = (1.0 / (frame_rate * SUGGESTED_SHARE * largest)).ceil().max(1.0);
    1.0 / (frame_rate * steps_per_frame)
}
