//! The paper's method: explicit central differences.

use std::ops::Range;

use super::block_bound::BlockBound;
use super::block_forces::{eval_block, eval_block_and_bounds, larger_rates};
use super::limits::Limiter;
use super::motion::{MoveBlock, Moved, Steps};
use super::one_pass::{BandMemory, OnePass};
use super::pins::place_pins;
use super::running_summary::RunningSummary;
use super::stability::{configuration, larger, stable_step};
use super::synchronous::Synchronise;
use super::velocity_forces::VelocityForces;
use super::workers::for_each_block;
use super::{Integrator, StableStep, StepError, StepTo, Workers};
use crate::force::{Configuration, Sweep};
use crate::model::Particles;
use crate::scene::Start;
use crate::{Model, Motion, Points, PointsMut, State, StepSummary};

/// Explicit central differences in half-step velocities, for steps of any size in any order.
///
/// With the step h⁻ that led to the positions S, the next step h⁺ and v⁻, v⁺ the velocities in the middle of each:
///
/// ```text
/// v  = (v⁻ + h⁻/2m F) / (1 + k_d h⁻/2m)         velocity at S, with F = F(S, t)
/// v⁺ = v + h⁺/2m (F − k_d v)
/// S⁺ = S + h⁺ v⁺
/// ```
///
/// For h⁻ = h⁺ = h this is v⁺ = [(2m − k_d h) v⁻ + 2h F] / (2m + k_d h), the paper's equation (5) in exact arithmetic:
/// (B + C) S⁺ = 2B S − (B − C) S⁻ + F with B = m/h², C = k_d/2h. It is of second order in the step, and stable as long
/// as ω h < 2 for the fastest mode ω, whatever the drag; but above k_d h = 2m velocities change sign from step to step.
///
/// # Forces that depend on velocities
/// They need v at S, which in turn needs them. A first v comes from the forces with v⁻ in place of v; forces with that v are
/// then those of the step. They are wrong by O(h²), as the first v is, so the method stays of second order. Only models
/// with such forces pay for it. With damping −c v it is stable for c h ≤ 2m, like the midpoint rule.
///
/// # Start
/// h⁻ = 0 with v⁻ the initial velocity is the consistent start, S₁ = S₀ + h v₀ + h²/2m (F₀ − k_d v₀). The paper's
/// equation (6), S₋₁ = S₀, is h⁻ = h with v⁻ = 0: the first displacement comes out twice as large as it should, and the
/// method is of first order. See [`start`](Self::start).
///
/// Source: Luo, Miyaki, Yamasaki, Aizawa, "Dynamic 3D Simulation of Fabric Based on Improved Mass-Spring Model",
/// equations (3) to (6); the paper keeps three positions, which for a changing step would be wrong.
#[derive(Debug)]
pub struct CentralDifference {
    workers: Workers,
    /// One per thread.
    bands: Vec<BandMemory>,
    pass: OnePass,
    forces: Points,
    /// Whether `forces` are those at the state that was looked at last: a step that finds them on its way leaves none.
    has_forces: bool,
    /// Where threads leave the state that a step begins with.
    spare: State,
    /// Of the evaluation before, once errors are asked for.
    earlier_forces: Option<Points>,
    stiffness_bounds: Vec<f64>,
    block_bound: BlockBound,
    limiter: Limiter,
    velocity_forces: VelocityForces,
    summary: RunningSummary,
}

impl CentralDifference {
    /// The method for any model, on `workers`.
    #[must_use]
    pub fn new(workers: Workers) -> Self {
        Self {
            bands: (0..workers.count()).map(|_| BandMemory::default()).collect(),
            pass: OnePass::default(),
            workers,
            forces: Points::default(),
            has_forces: false,
            spare: State::at_rest(Points::default()),
            earlier_forces: None,
            stiffness_bounds: Vec::new(),
            block_bound: BlockBound::default(),
            limiter: Limiter::default(),
            velocity_forces: VelocityForces::default(),
            summary: RunningSummary::default(),
        }
    }

    /// Prepares a `state` at its initial time, positions and velocities for a first step of `step` [s].
    pub fn start(start: Start, state: &mut State, step: f64) {
        match start {
            Start::Consistent => state.last_step = 0.0,
            Start::AsPrinted => {
                state.last_step = step;
                state.velocities.fill(0.0);
            }
        }
    }

    /// Makes room for the forces on `count` particles, and keeps those of the evaluation before if errors are asked for.
    fn next_forces(&mut self, count: usize) {
        if let Some(earlier) = &mut self.earlier_forces {
            std::mem::swap(earlier, &mut self.forces);
        }
        if self.forces.len() != count {
            self.forces = Points::zeros(count);
        }
    }

    /// Moves all particles of `state` under forces that are known, and leaves what it was in `before` if there is one.
    fn move_all(
        &mut self,
        model: &Model,
        state: &mut State,
        before: Option<&mut State>,
        StepTo { step, time, is_measured }: StepTo,
    ) -> Result<Motion, StepError> {
        let from = left_behind(state, before);
        let steps = Steps { last: state.last_step, next: step };
        let wanted = self.summary.wanted(is_measured);
        let forces = &self.forces;
        let move_block = |block: &Range<usize>, (positions, velocities): (PointsMut<'_>, PointsMut<'_>)| {
            let (particles, forces) = (model.particles(), forces.slice(block));
            let task = MoveBlock { from, particles, steps, block, positions, velocities, forces, wanted };
            model.instructions().run(task)
        };
        let arrays = (state.positions.as_mut(), state.velocities.as_mut());
        let moved = self.workers.for_blocks(model.blocks(), arrays, &move_block, &Moved::add);
        self.has_forces = false;
        arrive(model, state, StepTo { step, time, is_measured });
        let limited = self.limiter.apply(model, &self.forces, step, state);
        let moved = measured(model, state, moved)?.add(limited);
        self.summary.add_drag(step, &moved);
        Ok(if is_measured { moved.motion } else { Motion::default() })
    }
}

impl CentralDifference {
    /// Evaluates the forces at `state`; the caller says whether its strains count.
    fn eval_all_forces(&mut self, model: &Model, state: &State) {
        self.next_forces(state.positions.len());
        let at = configuration(model, state);
        let eval_band =
            |blocks: &[Range<usize>], forces: PointsMut<'_>, BandMemory { sweep, .. }: &mut BandMemory| {
                sweep.restart();
                let eval_block =
                    |block: &Range<usize>, forces: PointsMut<'_>| eval_block(model, at, block, forces, sweep);
                for_each_block(blocks, forces, eval_block, |(), ()| ());
            };
        let bands = &mut self.bands;
        self.workers.for_bands(model.blocks(), self.forces.as_mut(), bands, &eval_band, &|(), ()| ());
        self.has_forces = true;
        if model.depends_on_velocity() {
            self.add_velocity_forces(model, state);
        }
    }

    /// The same, and the stable step.
    fn eval_all_forces_and_bounds(
        &mut self,
        model: &Model,
        state: &State,
        constant_stiffness: f64,
    ) -> StableStep {
        self.next_forces(state.positions.len());
        self.stiffness_bounds.resize(state.positions.len(), 0.0);
        let at = configuration(model, state);
        let block_bound = &self.block_bound;
        let eval_band = |blocks: &[Range<usize>],
                         arrays: (PointsMut<'_>, &mut [f64]),
                         BandMemory { sweep, .. }: &mut BandMemory| {
            sweep.restart();
            let eval_block = |block: &Range<usize>, (forces, bounds): (PointsMut<'_>, &mut [f64])| {
                eval_block_and_bounds(model, at, block, (forces, &mut *bounds), sweep);
                block_bound.rates(model, block, bounds)
            };
            for_each_block(blocks, arrays, eval_block, larger_rates)
        };
        let arrays = (self.forces.as_mut(), self.stiffness_bounds.as_mut_slice());
        let bands = &mut self.bands;
        let largest = self.workers.for_bands(model.blocks(), arrays, bands, &eval_band, &larger_rates);
        self.has_forces = true;
        self.finish_with_bounds(model, state, constant_stiffness, largest.unwrap_or_default())
    }

    /// Adds the forces that depend on velocities; the stable step at `state`, where the `largest` rates [1/s²] of varying
    /// stiffness are known.
    fn finish_with_bounds(
        &mut self,
        model: &Model,
        state: &State,
        constant_stiffness: f64,
        [uncorrected, corrected]: [f64; 2],
    ) -> StableStep {
        let mut damping = 0.0;
        if model.depends_on_velocity() {
            self.add_velocity_forces(model, state);
            damping = self.velocity_forces.largest_damping_rate(&self.workers, model, state);
        }
        StableStep {
            by_norms: stable_step(constant_stiffness + uncorrected, damping),
            by_blocks: stable_step(corrected, damping),
        }
    }

    /// Adds the forces that depend on velocities at `state` to all others, which are there already.
    fn add_velocity_forces(&mut self, model: &Model, state: &State) {
        self.velocity_forces.add(&self.workers, model, state, &mut self.forces);
    }

    /// Evaluates the forces at `state` unless they are known.
    fn need_forces(&mut self, model: &Model, state: &State) {
        if !self.has_forces {
            self.eval_forces(model, state);
        }
    }

    /// Whether a step can find the forces where it begins on its way: nobody asks for all of them at once.
    fn can_find_forces(&self, model: &Model) -> bool {
        !model.depends_on_velocity() && model.limits().is_empty() && self.earlier_forces.is_none()
    }

    /// Evaluates the forces at `state` and moves it.
    fn eval_and_move(
        &mut self,
        model: &Model,
        state: &mut State,
        before: Option<&mut State>,
        to: StepTo,
    ) -> Result<Motion, StepError> {
        let wanted = self.summary.wanted(to.is_measured);
        let Self { workers, bands, pass, spare, .. } = self;
        let is_shared = 1 < workers.count() && 1 < model.blocks().len();
        let moved = match before {
            Some(from) => {
                state.leave_in(from);
                pass.step_from((model, workers), state, from, (to, wanted), bands)
            }
            None if is_shared => {
                // What forces remember stays as it is, and need not be copied.
                let memory = std::mem::take(&mut state.memory);
                state.leave_in(spare);
                spare.memory = memory;
                let moved = pass.step_from((model, workers), state, spare, (to, wanted), bands);
                state.memory = std::mem::take(&mut spare.memory);
                moved
            }
            None => pass.step_in_place(model, state, (to, wanted), &mut bands[0]),
        };
        // Of the state that it left, whatever came of it.
        self.summary.add_strains(&mut self.bands, true);
        arrive(model, state, to);
        let moved = measured(model, state, moved)?;
        self.summary.add_drag(to.step, &moved);
        Ok(moved.motion)
    }

    /// Moves `state` and evaluates the forces where it arrives.
    fn move_and_eval(
        &mut self,
        model: &Model,
        state: &mut State,
        before: Option<&mut State>,
        to: StepTo,
    ) -> Result<Motion, StepError> {
        self.need_forces(model, state);
        if !self.can_go_on_to_forces(model) {
            let motion = self.move_all(model, state, before, to);
            self.eval_all_forces(model, state);
            self.summary.add_strains(&mut self.bands, motion.is_ok());
            return motion;
        }
        let from = left_behind(state, before);
        let wanted = self.summary.wanted(to.is_measured);
        let Self { bands, pass, forces, .. } = self;
        let eval = |at: Configuration<'_>, block: &Range<usize>, forces: PointsMut<'_>, sweep: &mut Sweep| {
            eval_block(model, at, block, forces, sweep);
        };
        let moved = pass.move_and_eval(model, (state, from), (to, wanted), forces, &mut bands[0], eval);
        if model.depends_on_velocity() {
            self.add_velocity_forces(model, state);
        }
        self.sum_up(measured(model, state, moved), to)
    }

    /// Adds what came of a step that went on to the forces where it ends to the summary, if it did not fail.
    fn sum_up(&mut self, moved: Result<Moved, StepError>, to: StepTo) -> Result<Motion, StepError> {
        self.summary.add_strains(&mut self.bands, moved.is_ok());
        let moved = moved?;
        self.summary.add_drag(to.step, &moved);
        Ok(moved.motion)
    }

    /// Whether nothing comes between motion and the forces after it, and one thread does both: the only one, or the one that
    /// gets the only block.
    fn can_go_on_to_forces(&self, model: &Model) -> bool {
        (self.workers.count() == 1 || model.blocks().len() == 1)
            && model.limits().is_empty()
            && model.moving_pins().is_empty()
            && self.earlier_forces.is_none()
    }
}

/// Takes note of the end of a step, and places the pins that move.
fn arrive(model: &Model, state: &mut State, StepTo { step, time, .. }: StepTo) {
    (state.time, state.last_step) = (time, step);
    place_pins(model, time, step, state);
}

/// What came of moving all particles, at the end of the step.
fn measured(model: &Model, state: &State, moved: Option<Moved>) -> Result<Moved, StepError> {
    match moved {
        Some(Moved { is_finite: false, .. }) => Err(not_finite(model.particles(), state)),
        moved => Ok(moved.unwrap_or_default()),
    }
}

/// Leaves `state` in `before`, from which its particles are then to be moved.
fn left_behind<'a>(state: &mut State, before: Option<&'a mut State>) -> Option<&'a State> {
    before.map(|before| {
        state.leave_in(before);
        &*before
    })
}

impl Integrator for CentralDifference {
    fn eval_forces(&mut self, model: &Model, state: &State) {
        self.eval_all_forces(model, state);
        self.summary.add_strains(&mut self.bands, true);
    }

    fn eval_forces_and_stable_step(
        &mut self,
        model: &Model,
        state: &State,
        constant_stiffness: f64,
    ) -> StableStep {
        let stable = self.eval_all_forces_and_bounds(model, state, constant_stiffness);
        self.summary.add_strains(&mut self.bands, true);
        stable
    }

    fn eval_stable_step(&mut self, model: &Model, state: &State) -> f64 {
        let stiffness = self.block_bound.eval(&self.workers, model, state, &self.stiffness_bounds);
        let mut damping = 0.0;
        if model.depends_on_velocity() {
            // Velocities come with them.
            self.need_forces(model, state);
            damping = self.velocity_forces.largest_damping_rate(&self.workers, model, state);
        }
        stable_step(stiffness, damping)
    }

    fn step_to(
        &mut self,
        model: &Model,
        state: &mut State,
        before: Option<&mut State>,
        to: StepTo,
    ) -> Result<Motion, StepError> {
        if !self.can_find_forces(model) {
            return self.move_and_eval(model, state, before, to);
        }
        if self.has_forces {
            return self.move_all(model, state, before, to);
        }
        self.eval_and_move(model, state, before, to)
    }

    fn step_to_and_bound(
        &mut self,
        model: &Model,
        state: &mut State,
        before: Option<&mut State>,
        to: StepTo,
        constant_stiffness: f64,
    ) -> (Result<Motion, StepError>, StableStep) {
        self.need_forces(model, state);
        if !self.can_go_on_to_forces(model) {
            let motion = self.move_all(model, state, before, to);
            let stable = self.eval_all_forces_and_bounds(model, state, constant_stiffness);
            self.summary.add_strains(&mut self.bands, motion.is_ok());
            return (motion, stable);
        }
        let from = left_behind(state, before);
        let wanted = self.summary.wanted(to.is_measured);
        let Self { bands, pass, forces, stiffness_bounds, block_bound, .. } = self;
        stiffness_bounds.resize(state.positions.len(), 0.0);
        let mut largest = [0.0; 2];
        let eval = |at: Configuration<'_>, block: &Range<usize>, forces: PointsMut<'_>, sweep: &mut Sweep| {
            let bounds = &mut stiffness_bounds[block.clone()];
            eval_block_and_bounds(model, at, block, (forces, &mut *bounds), sweep);
            largest = larger_rates(largest, block_bound.rates(model, block, bounds));
        };
        let moved = pass.move_and_eval(model, (state, from), (to, wanted), forces, &mut bands[0], eval);
        let motion = self.sum_up(measured(model, state, moved), to);
        (motion, self.finish_with_bounds(model, state, constant_stiffness, largest))
    }

    fn move_by(&mut self, model: &Model, state: &mut State, step: f64, time: f64) -> Result<(), StepError> {
        self.need_forces(model, state);
        self.move_all(model, state, None, StepTo { step, time, is_measured: false }).map(|_| ())
    }

    fn move_and_measure(
        &mut self,
        model: &Model,
        state: &mut State,
        step: f64,
        time: f64,
    ) -> Result<Motion, StepError> {
        self.need_forces(model, state);
        self.move_all(model, state, None, StepTo { step, time, is_measured: true })
    }

    fn eval_error(&mut self, model: &Model, before: &State, after: &State) -> f64 {
        let are_known = |earlier: &Points| self.has_forces && earlier.len() == before.positions.len();
        if !self.earlier_forces.as_ref().is_some_and(are_known) {
            self.eval_forces(model, before);
            self.earlier_forces = Some(Points::default());
            self.eval_forces(model, after);
        }
        let Some(earlier) = &self.earlier_forces else { return 0.0 };
        let (particles, step) = (model.particles(), after.last_step);
        let mut largest = 0.0;
        for particle in (0..particles.len()).filter(|&particle| !particles.pinned()[particle]) {
            let force_change = self.forces.get(particle) - earlier.get(particle);
            let velocity_change = after.velocities.get(particle) - before.velocities.get(particle);
            let change = force_change - velocity_change * particles.drags()[particle];
            largest = larger(
                largest,
                change.length_squared() / (particles.masses()[particle] * particles.masses()[particle]),
            );
        }
        step * step / 6.0 * largest.sqrt()
    }

    fn summarise(&mut self, is_wanted: bool) {
        self.summary.want(is_wanted, &mut self.bands);
    }

    fn take_summary(&mut self) -> StepSummary {
        self.summary.take()
    }

    fn velocities(&mut self, model: &Model, state: &State, velocities: &mut Points) {
        self.need_forces(model, state);
        velocities.clone_from(&self.forces);
        let synchronise_block = |block: &Range<usize>, values: PointsMut<'_>| {
            let (particles, last_step) = (model.particles(), state.last_step);
            let older = state.velocities.slice(block);
            model.instructions().run(Synchronise { particles, block, last_step, older, values });
        };
        self.workers.for_blocks(model.blocks(), velocities.as_mut(), &synchronise_block, &|(), ()| ());
        model.moving_pins().eval_velocities(state.time, velocities);
    }

    fn workers(&self) -> &Workers {
        &self.workers
    }
}

/// The error of a state that has a non-finite value.
///
/// It names a free particle if there is one: a limit may have moved a pin along.
fn not_finite(particles: &Particles, state: &State) -> StepError {
    let is_finite = |particle: usize| {
        state.positions.get(particle).is_finite() && state.velocities.get(particle).is_finite()
    };
    let failed = || (0..particles.len()).filter(|&particle| !is_finite(particle));
    let free = failed().find(|&particle| !particles.pinned()[particle]);
    let particle = free.or_else(|| failed().next()).unwrap_or_default();
    StepError::NotFinite { particle, time: state.time }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scene;

    /// A column of two, pinned at the top, with a step 1000 times too large: the spring's force on the pin overflows, too.
    #[test]
    fn a_failed_step_names_a_free_particle() {
        let text = "
            title = ''\n[run]\nduration = 1.0\nstep = { constant = 0.05 }\nframe_rate = 10.0
            [environment]\ngravity = [0, -9.81, 0]
            [fabric.f]\nkind = 'springs'\nparticle_mass = 1e-3\ndrag = 0
            structural = { stiffness = 1e6, law = 'linear' }\nshear = { stiffness = 0, law = 'linear' }
            bend = { stiffness = 0, law = 'linear' }
            [[cloth]]\nname = 'c'\nfabric = 'f'\ngrid = { columns = 1, rows = 2, height = 1.0 }
            place = { origin = [0, 0, 0], width_axis = [1, 0, 0], height_axis = [0, -1, 0] }\npins = [{ row = 0 }]
        ";
        let scene = Scene::parse(text).unwrap_or_else(|error| panic!("{}", error.render("test", text)));
        let model = Model::new(&scene);
        let mut state = model.initial_state(&scene);
        let mut method = CentralDifference::new(Workers::single());
        let error = (0..1000).find_map(|_| method.step(&model, &mut state, 0.05).err()).unwrap();
        assert!(state.positions.get(0).is_finite(), "a pin stays where it is");
        assert!(matches!(error, StepError::NotFinite { particle: 1, .. }), "{error}");
    }
}
