//! How long the steps take.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use muslin::integrate::{Integrator, StableStep, StepError, StepTo, Workers};
use muslin::{Model, Motion, Points, State, StepSummary};

/// Time spent in steps, shared with the integrator that measures it.
#[derive(Clone, Default)]
pub(crate) struct SteppingTime(Arc<AtomicU64>);

impl SteppingTime {
    /// Seconds.
    pub(crate) fn seconds(&self) -> f64 {
        self.0.load(Ordering::Relaxed) as f64 * 1e-9
    }
}

/// An integrator that measures the time spent in its steps.
pub(crate) struct TimedIntegrator {
    inner: Box<dyn Integrator>,
    time: SteppingTime,
}

impl TimedIntegrator {
    pub(crate) fn new(inner: Box<dyn Integrator>, time: SteppingTime) -> Self {
        Self { inner, time }
    }
}

impl TimedIntegrator {
    fn timed<T>(&mut self, work: impl FnOnce(&mut dyn Integrator) -> T) -> T {
        let start = Instant::now();
        let result = work(&mut *self.inner);
        self.time.0.fetch_add(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
        result
    }
}

impl Integrator for TimedIntegrator {
    fn eval_forces(&mut self, model: &Model, state: &State) {
        self.timed(|inner| inner.eval_forces(model, state));
    }

    fn eval_forces_and_stable_step(
        &mut self,
        model: &Model,
        state: &State,
        constant_stiffness: f64,
    ) -> StableStep {
        self.timed(|inner| inner.eval_forces_and_stable_step(model, state, constant_stiffness))
    }

    fn eval_stable_step(&mut self, model: &Model, state: &State) -> f64 {
        self.timed(|inner| inner.eval_stable_step(model, state))
    }

    fn move_by(&mut self, model: &Model, state: &mut State, step: f64, time: f64) -> Result<(), StepError> {
        self.timed(|inner| inner.move_by(model, state, step, time))
    }

    fn move_and_measure(
        &mut self,
        model: &Model,
        state: &mut State,
        step: f64,
        time: f64,
    ) -> Result<Motion, StepError> {
        self.timed(|inner| inner.move_and_measure(model, state, step, time))
    }

    fn step_to(
        &mut self,
        model: &Model,
        state: &mut State,
        before: Option<&mut State>,
        to: StepTo,
    ) -> Result<Motion, StepError> {
        self.timed(|inner| inner.step_to(model, state, before, to))
    }

    fn step_to_and_bound(
        &mut self,
        model: &Model,
        state: &mut State,
        before: Option<&mut State>,
        to: StepTo,
        constant_stiffness: f64,
    ) -> (Result<Motion, StepError>, StableStep) {
        self.timed(|inner| inner.step_to_and_bound(model, state, before, to, constant_stiffness))
    }

    fn eval_error(&mut self, model: &Model, before: &State, after: &State) -> f64 {
        self.timed(|inner| inner.eval_error(model, before, after))
    }

    fn velocities(&mut self, model: &Model, state: &State, velocities: &mut Points) {
        self.timed(|inner| inner.velocities(model, state, velocities));
    }

    fn summarise(&mut self, is_wanted: bool) {
        self.inner.summarise(is_wanted);
    }

    fn take_summary(&mut self) -> StepSummary {
        self.inner.take_summary()
    }

    fn workers(&self) -> &Workers {
        self.inner.workers()
    }
}
