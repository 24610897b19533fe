//! The run of a scene: its schedule of frames, and the steps between them.

use crate::integrate::{
    AdaptiveStep, CentralDifference, IdealStep, Integrator, StableStep, StableSteps, StepError, StepTo,
    Workers, block_stable_step, guaranteed_stable_step, largest_stable_step,
};
use crate::observe::{Frame, Observer};
use crate::scene::{MAX_STEPS_PER_FRAME, Method, RunSettings, StepRule};
use crate::{Model, Points, Scene, State, StepSummary};

/// Part of a cloth's extent [1] that it has to move in a frame's time at least, all of it alike, to count as in motion:
/// roundings of positions move it by about 1e-14.
const LEAST_MOTION: f64 = 1e-11;

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
/// Time is counted, not summed: frame `n` is at `n / frame_rate`, and the constant step `k` of `N` after it at
/// `(n + k / N) / frame_rate`. Adaptive steps are summed within a frame; the last one ends at the frame's own time.
pub struct Simulation {
    model: Model,
    state: State,
    velocities: Points,
    integrator: Box<dyn Integrator>,
    settings: RunSettings,
    steps: Steps,
    frame_index: u64,
    failure: Option<StepError>,
}

/// How the steps of a run are chosen.
enum Steps {
    Constant {
        step: f64,
        per_frame: u64,
    },
    Adaptive {
        rule: AdaptiveStep,
        stable: StableSteps,
        /// The state before a step that may be taken back; empty before the first.
        before: Box<State>,
    },
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
        let first_step = match settings.step {
            StepRule::Constant { .. } => {
                if !settings.allow_unstable {
                    check_step(&settings, &model, &state, integrator.workers())?;
                }
                constant_step(&settings)
            }
            StepRule::Adaptive { tolerance } => {
                let stable = StableStep {
                    by_norms: guaranteed_stable_step(&model, &state),
                    by_blocks: block_stable_step(&model, &state),
                };
                let rule = adaptive_step(scene, &model, tolerance);
                rule.ideal_step(&state.step_memory, stable).fit(rule.frame_interval).0
            }
        };
        CentralDifference::start(settings.start, &mut state, first_step);
        Ok(Self::at_frame(scene, model, state, integrator, 0))
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
        let remembered = model.memory_layers() * particles;
        if state.memory.len() != remembered {
            return wrong(format!(
                "it remembers {} values, but the scene has forces that remember {remembered}",
                state.memory.len()
            ));
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
        Ok(Self::at_frame(scene, model, state, integrator, frame_index))
    }

    fn at_frame(
        scene: &Scene,
        model: Model,
        mut state: State,
        mut integrator: Box<dyn Integrator>,
        frame_index: u64,
    ) -> Self {
        let settings = scene.run().clone();
        let mut velocities = Points::zeros(state.positions.len());
        let steps = match settings.step {
            StepRule::Constant { steps_per_frame } => {
                integrator.eval_forces(&model, &state);
                Steps::Constant { step: constant_step(&settings), per_frame: steps_per_frame }
            }
            StepRule::Adaptive { tolerance } => {
                let rule = adaptive_step(scene, &model, tolerance);
                let is_constant = rule.is_stiffness_constant;
                let stable = StableSteps::begin(&mut *integrator, &model, &mut state, is_constant);
                Steps::Adaptive { rule, stable, before: Box::new(State::at_rest(Points::default())) }
            }
        };
        integrator.velocities(&model, &state, &mut velocities);
        Self { model, state, velocities, integrator, settings, steps, frame_index, failure: None }
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
        self.integrator.summarise(observers.iter().any(|observer| observer.wants_summary()));
        // What somebody else left there is of no step of this run.
        self.integrator.take_summary();
        let result = workers.install(|| self.step_to_next_frame(observers));
        self.failure = result.as_ref().err().cloned();
        result
    }

    fn step_to_next_frame(&mut self, observers: &mut [&mut dyn Observer]) -> Result<(), StepError> {
        let mut summary = StepSummary::default();
        let result = self.take_steps(observers, &mut summary);
        // After the velocities: they need the forces at the last state, with which its strains are known.
        summary = summary.and(self.integrator.take_summary());
        for observer in observers.iter_mut().filter(|observer| observer.wants_summary()) {
            observer.summary(&summary);
        }
        result?;
        // Forces overflow earlier than positions do; a frame must not show it.
        if !self.velocities.is_finite() {
            let particle = self.velocities.iter().position(|velocity| !velocity.is_finite());
            let (particle, time) = (particle.unwrap_or_default(), self.state.time);
            return Err(StepError::NotFinite { particle, time });
        }
        self.frame_index += 1;
        self.observe(observers);
        Ok(())
    }

    /// Takes the steps to the next frame, and adds to their `summary`; finds the velocities there.
    fn take_steps(
        &mut self,
        observers: &mut [&mut dyn Observer],
        summary: &mut StepSummary,
    ) -> Result<(), StepError> {
        let end = (self.frame_index + 1) as f64 / self.settings.frame_rate;
        match &mut self.steps {
            Steps::Constant { step, per_frame } => {
                let (step, per_frame) = (*step, *per_frame);
                for count in 1..=per_frame {
                    let passed = self.frame_index as f64 + count as f64 / per_frame as f64;
                    let time = passed / self.settings.frame_rate;
                    let to = StepTo { step, time, is_measured: false };
                    self.integrator.step_to(&self.model, &mut self.state, None, to)?;
                    self.integrator.accept(&self.model, &mut self.state);
                    show_step(observers, &self.model, &self.state);
                }
            }
            Steps::Adaptive { .. } => while !self.adaptive_step(end, observers, summary)? {},
        }
        self.integrator.velocities(&self.model, &self.state, &mut self.velocities);
        Ok(())
    }

    /// Takes one adaptive step towards the time `end` [s] of a frame, and adds to the `summary`; whether it arrived.
    fn adaptive_step(
        &mut self,
        end: f64,
        observers: &mut [&mut dyn Observer],
        summary: &mut StepSummary,
    ) -> Result<bool, StepError> {
        let Self { model, state, integrator, steps, .. } = self;
        let integrator = &mut **integrator;
        let Steps::Adaptive { rule, stable, before } = steps else { return Ok(true) };
        let may_be_refused = !rule.is_stiffness_constant || rule.tolerance.is_some();
        let (start, last_step) = (state.time, state.last_step);
        let mut ideal_step = rule.ideal_step(&state.step_memory, stable.current());
        loop {
            let (step, is_last) = ideal_step.fit(end - start);
            // Written so that what is not a number stops the run.
            if !(rule.shortest <= step && (is_last || start < start + step)) {
                return Err(StepError::TooShort { time: start, shortest: rule.shortest });
            }
            let time = if is_last { end } else { start + step };
            let to = StepTo { step, time, is_measured: state.step_memory.is_due() };
            let stable_before = stable.current();
            let (moved, mut stable_after) = stable.step_to(
                integrator,
                model,
                state,
                may_be_refused.then_some(&mut **before),
                to,
                is_last,
            );
            let is_finite = moved.is_ok();
            let motion = match moved {
                Ok(motion) => to.is_measured.then_some(motion),
                Err(_) if may_be_refused => None,
                Err(error) => return Err(error),
            };
            if is_finite && !rule.accepts(step, stable_before, stable_after) {
                // An estimate may be too careful.
                stable_after = StableSteps::evaluated(integrator, model, state, stable_after);
            }
            let is_tolerated = rule.tolerance.is_none() || {
                let error = integrator.eval_error(model, before, state);
                rule.tolerates(&mut state.step_memory, error, step)
            };
            if is_finite && rule.accepts(step, stable_before, stable_after) && is_tolerated {
                rule.remember(
                    &mut state.step_memory,
                    (ideal_step, step),
                    motion,
                    last_step,
                    [stable_before.by_norms, stable_after.by_norms],
                );
                stable.accept(stable_after);
                integrator.accept(model, state);
                *summary = summary.and(integrator.take_summary());
                show_step(observers, model, state);
                return Ok(is_last);
            }
            let tolerated_step = state.step_memory.tolerated_step;
            std::mem::swap(state, &mut **before);
            if !is_finite {
                // The next step moves from one to the other, and what it overwrites must be finite.
                before.copy_from(state);
            }
            // Strains where the step began are found again.
            integrator.take_summary();
            stable.return_to(integrator, model, state);
            let longest = if is_tolerated { step } else { tolerated_step };
            ideal_step = IdealStep::after_refusal(step, longest);
            for observer in observers.iter_mut() {
                observer.refused_step(model, state);
            }
        }
    }
}

fn show_step(observers: &mut [&mut dyn Observer], model: &Model, state: &State) {
    for observer in observers {
        observer.step(model, state);
    }
}

/// The rule for the adaptive steps of a run.
fn adaptive_step(scene: &Scene, model: &Model, tolerance: Option<f64>) -> AdaptiveStep {
    let settings = scene.run();
    let frame_interval = 1.0 / settings.frame_rate;
    let forces = model.forces();
    let particles = model.particles();
    // Above m / k_d drag would turn a velocity around within half a step.
    let constants = particles.masses().iter().zip(particles.drags());
    let by_drag = constants.map(|(mass, drag)| mass / drag).fold(f64::INFINITY, f64::min);
    let by_forces = forces.iter().map(|force| force.longest_step()).fold(f64::INFINITY, f64::min);
    let extents = model.cloths().iter().map(|cloth| cloth.grid.extent());
    let least_speed = LEAST_MOTION * extents.fold(0.0, f64::max) / frame_interval;
    let mass: f64 = particles.masses().iter().sum();
    AdaptiveStep {
        least_kinetic_energy: 0.5 * mass * least_speed * least_speed,
        frame_interval,
        longest: by_drag.min(by_forces).min(model.moving_pins().longest_step()),
        shortest: frame_interval / MAX_STEPS_PER_FRAME as f64,
        is_stiffness_constant: !forces.iter().any(|force| force.has_varying_bounds()),
        flat_stable_step: guaranteed_stable_step(model, &model.initial_state(scene)),
        tolerance,
    }
}

/// The constant step [s] of `settings`; the frame interval if it is adaptive.
fn constant_step(settings: &RunSettings) -> f64 {
    let steps_per_frame = match settings.step {
        StepRule::Constant { steps_per_frame } => steps_per_frame,
        StepRule::Adaptive { .. } => 1,
    };
    1.0 / (settings.frame_rate * steps_per_frame as f64)
}

/// The step [s] of a run of `scene`: the constant one, or the adaptive one of the initial `state` when the cloth's energy is
/// in slow motion.
#[must_use]
pub fn initial_step(scene: &Scene, model: &Model, state: &State) -> f64 {
    let settings = scene.run();
    match settings.step {
        StepRule::Constant { .. } => constant_step(settings),
        StepRule::Adaptive { tolerance } => {
            let rule = adaptive_step(scene, model, tolerance);
            IdealStep::dividing(rule.largest_step(block_stable_step(model, state))).fit(rule.frame_interval).0
        }
    }
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
