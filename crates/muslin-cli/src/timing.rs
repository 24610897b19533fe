//! How long the steps take.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use muslin::integrate::{Integrator, StepError, Workers};
use muslin::{Model, Points, State};

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

impl Integrator for TimedIntegrator {
    fn step(&mut self, model: &Model, state: &mut State, step: f64) -> Result<(), StepError> {
        let start = Instant::now();
        let result = self.inner.step(model, state, step);
        self.time.0.fetch_add(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
        result
    }

    fn eval_velocities(&mut self, model: &Model, state: &State, velocities: &mut Points) {
        self.inner.eval_velocities(model, state, velocities);
    }

    fn workers(&self) -> &Workers {
        self.inner.workers()
    }
}
