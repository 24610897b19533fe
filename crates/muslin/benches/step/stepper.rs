//! The library's step: the one place that names what it is made of.

use std::time::Duration;

use muslin::integrate::{CentralDifference, Integrator, StepTo, Workers};
use muslin::{Model, Scene, State};

use super::clock::{Clock, Stopwatch};
use super::cloth::Cloth;
use super::instruction_set::InstructionSet;

/// Instruction sets that the library's step can use here.
pub(crate) fn instruction_sets() -> Vec<InstructionSet> {
    let has =
        |set: &InstructionSet| muslin::InstructionSet::available().any(|other| other.name() == set.name());
    InstructionSet::available().filter(has).collect()
}

/// The model of `scene` whose forces use `instructions`.
pub(crate) fn model(scene: &Scene, instructions: InstructionSet) -> Model {
    let same = muslin::InstructionSet::available().find(|set| set.name() == instructions.name());
    Model::with_instructions(scene, same.unwrap_or_else(|| panic!("{} is not here", instructions.name())))
}

/// Finds the forces at `state`, and moves it by `step` [s].
fn advance(method: &mut CentralDifference, model: &Model, state: &mut State, step: f64) {
    let to = StepTo { step, time: state.time + step, is_measured: false };
    method.step_to(model, state, None, to).unwrap_or_else(|error| panic!("{error}"));
    method.accept(model, state);
}

/// A model, and what moves a state of it.
pub(crate) struct Stepper {
    model: Model,
    method: CentralDifference,
    step: f64,
}

impl Stepper {
    /// For `cloth` in `scene` on `workers`.
    pub(crate) fn new(cloth: &Cloth, scene: &Scene, instructions: InstructionSet, workers: &Workers) -> Self {
        let model = model(scene, instructions);
        let step = cloth.step(&model, &model.initial_state(scene));
        Self { model, method: CentralDifference::new(workers.clone()), step }
    }

    /// What is constant.
    pub(crate) fn model(&self) -> &Model {
        &self.model
    }

    /// The step [s].
    pub(crate) fn step(&self) -> f64 {
        self.step
    }

    /// Takes `count` steps from `start` in the memory of `state`, and the time by `clock` that they took.
    pub(crate) fn run(&mut self, clock: Clock, start: &State, state: &mut State, count: u64) -> Duration {
        let Self { model, method, step } = self;
        // Every turn has the same work, and several steppers can share the memory of a large state.
        state.positions.clone_from(&start.positions);
        state.velocities.clone_from(&start.velocities);
        (state.time, state.last_step) = (start.time, start.last_step);
        state.memory.clear();
        state.memory.resize(model.memory_layers() * model.particles().len(), 0.0);
        let workers = method.workers().clone();
        let start = Stopwatch::start(clock);
        workers.install(|| {
            for _ in 0..count {
                advance(method, model, state, *step);
            }
        });
        start.elapsed()
    }
}
