//! The stable step along a run, whose costlier bound is not evaluated in every step.

use super::{Integrator, StableStep, StepError, StepTo, constant_stiffness};
use crate::{Model, Motion, State};

/// Stable step by an evaluation of the block bound relative to what was followed until then [1], at least and at most, for
/// which the next evaluation can wait twice as long.
const STEADY: [f64; 2] = [0.995, 1.02];

/// Growth of the stable step [1] from which on it is worth an evaluation ahead of time.
const EARLY_GROWTH: f64 = 1.1;

/// The stable step of an adaptive run.
///
/// The block bound ω² ≤ max λ_i of [`Force::add_stiffness_tensors`](crate::force::Force::add_stiffness_tensors) costs about as
/// much as two steps. It is evaluated at the start, every 16 steps, after a refusal and where a step would have to be refused
/// without; every 32 and then every 64 steps as long as it comes out as expected, 2/ω at most 0.5 % shorter and 2 % longer.
/// But not less often than a wave at the speed of the fastest one, a cell in a step, takes to half of √N cells for N particles:
/// in a small cloth all may change in 64 steps. In between, bound_i of [`Force::add_stiffness_bounds`](crate::force::Force::add_stiffness_bounds) follows each stiffening
/// at once:
///
/// ```text
/// m_i λ_i(t) ≈ λ_max(t₀) + (bound_i(t) − bound_i(t₀))        and at least max λ_i(t₀) over all i
/// ```
///
/// That is a bound as long as springs only stiffen along their length, since λ_max(A + B) ≤ λ_max(A) + ‖B‖. Three things it
/// does not see in between: springs that turn, which by a small angle θ changes λ_i by at most Σ w |k_a − c| sin θ;
/// stiffness across springs that grows with their tension; springs that soften beside others that stiffen. The last is why it may
/// not fall between evaluations; where it would by much, the bound is evaluated ahead of time. What is left is for the share
/// of the stable step that is not taken.
///
/// Where a bound varies with the state, it is also evaluated at every frame: a run can then go on from any of them with the
/// same bits, without the λ_i. Where none does, what is remembered is one number, and the step memory holds it.
#[derive(Clone, Copy, Debug)]
pub struct StableSteps {
    /// Whether the bounds of forces are the same in all states; then so is the step by norms.
    is_stiffness_constant: bool,
    /// Stiffness [1/s²] that is the same in all states.
    constant_stiffness: f64,
    /// Most steps from one evaluation of the block bound to the next.
    most_steps: u32,
    current: StableStep,
}

impl StableSteps {
    /// Fewest steps from one evaluation of the block bound to the next, and most of the largest cloth.
    pub(crate) const LASTS: [u32; 2] = [16, 64];

    /// At `state`, where a run begins or goes on.
    pub fn begin(
        integrator: &mut dyn Integrator,
        model: &Model,
        state: &mut State,
        is_stiffness_constant: bool,
    ) -> Self {
        let constant_stiffness = constant_stiffness(model, state);
        let current = integrator.eval_forces_and_stable_step(model, state, constant_stiffness);
        let [fewest_steps, most_steps] = Self::LASTS;
        let half_across = model.particles().len().isqrt() / 2;
        let most_steps = u32::try_from(half_across).unwrap_or(most_steps).clamp(fewest_steps, most_steps);
        let mut steps = Self { is_stiffness_constant, constant_stiffness, most_steps, current };
        match state.step_memory.fastest {
            Some(fastest) if is_stiffness_constant => steps.current.by_blocks = 2.0 / fastest,
            _ => steps.current = Self::evaluated(integrator, model, state, current),
        }
        steps
    }

    /// At the beginning of the step to come.
    #[must_use]
    pub fn current(&self) -> StableStep {
        self.current
    }

    /// Moves `state` to the end of a step that may be refused yet; the motion, and the stable step there.
    ///
    /// `before` is as in [`Integrator::step_to`]; `is_frame` if the end is a frame's.
    pub fn step_to(
        &self,
        integrator: &mut dyn Integrator,
        model: &Model,
        state: &mut State,
        before: Option<&mut State>,
        to: StepTo,
        is_frame: bool,
    ) -> (Result<Motion, StepError>, StableStep) {
        let (motion, mut next) = if self.is_stiffness_constant {
            (integrator.step_to(model, state, before, to), self.current)
        } else {
            integrator.step_to_and_bound(model, state, before, to, self.constant_stiffness)
        };
        let memory = &mut state.step_memory;
        memory.fastest_age = memory.fastest_age.saturating_add(1);
        let evaluated = 2.0 / memory.fastest.unwrap_or(f64::INFINITY);
        let is_old = memory.fastest_lasts <= memory.fastest_age;
        let is_due = is_old
            || (!self.is_stiffness_constant && (is_frame || EARLY_GROWTH * evaluated < next.by_blocks));
        // Written so that what is not a number stays.
        if evaluated < next.by_blocks {
            next.by_blocks = evaluated;
        }
        if is_due {
            let expected = next.by_blocks;
            next = Self::evaluated(integrator, model, state, next);
            if is_old {
                let [least, most] = STEADY.map(|share| share * expected);
                let is_steady = least <= next.by_blocks && next.by_blocks <= most;
                let lasts = &mut state.step_memory.fastest_lasts;
                *lasts = if is_steady { (2 * *lasts).min(self.most_steps) } else { Self::LASTS[0] };
            }
        }
        (motion, next)
    }

    /// `step` at `state`, with the block bound evaluated.
    pub fn evaluated(
        integrator: &mut dyn Integrator,
        model: &Model,
        state: &mut State,
        step: StableStep,
    ) -> StableStep {
        let by_blocks = integrator.eval_stable_step(model, state);
        state.step_memory.fastest = Some(2.0 / by_blocks);
        state.step_memory.fastest_age = 0;
        StableStep { by_blocks, ..step }
    }

    /// Takes the step that ended with `next` as accepted.
    pub fn accept(&mut self, next: StableStep) {
        self.current = next;
    }

    /// Evaluates forces at `state` after a step from there was refused.
    pub fn return_to(&mut self, integrator: &mut dyn Integrator, model: &Model, state: &mut State) {
        if self.is_stiffness_constant {
            integrator.eval_forces(model, state);
        } else {
            let step = integrator.eval_forces_and_stable_step(model, state, self.constant_stiffness);
            self.current = Self::evaluated(integrator, model, state, step);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scene;
    use crate::integrate::{CentralDifference, Workers};

    /// Ever more seldom while nothing changes, up to every 64 steps in a large cloth; soon again once it was stretched.
    #[test]
    fn a_bound_that_comes_as_expected_is_evaluated_less_often() {
        assert_eq!(evaluations(130), [16, 48, 112, 176, 240, 256]);
        assert_eq!(evaluations(50), [16, 41, 66, 91, 116, 141, 166, 191, 216, 241, 257]);
        assert!(evaluations(3).into_iter().eq((1..=16).map(|time| 16 * time)));
    }

    /// The steps of 260 after which the bound of a cloth of `width` x `width` is evaluated, which is stretched before step 240.
    fn evaluations(width: usize) -> Vec<u32> {
        let text = format!(
            "
            title = ''\n[run]\nduration = 1.0\nstep = 'adaptive'\nframe_rate = 10.0
            [environment]\ngravity = [0, 0, 0]
            [fabric.f]\nkind = 'springs'\nparticle_mass = 1e-3\ndrag = 0
            structural = {{ stiffness = 10, law = 'linear' }}\nshear = {{ stiffness = 0, law = 'linear' }}
            bend = {{ stiffness = 0, law = 'linear' }}
            [[cloth]]\nname = 'c'\nfabric = 'f'
            grid = {{ columns = {width}, rows = {width}, width = 1.0, height = 1.0 }}
            place = {{ origin = [0, 0, 0], width_axis = [1, 0, 0], height_axis = [0, -1, 0] }}\npins = [{{ row = 0 }}]
            "
        );
        let scene = Scene::parse(&text).unwrap_or_else(|error| panic!("{}", error.render("test", &text)));
        let model = Model::new(&scene);
        let mut state = model.initial_state(&scene);
        let mut method = CentralDifference::new(Workers::single());
        let mut steps = StableSteps::begin(&mut method, &model, &mut state, true);
        let step = 0.1 * steps.current().by_blocks;
        let mut evaluated = Vec::new();
        for count in 1..=260 {
            if count == 240 {
                state.positions = state.positions.iter().map(|position| 2.0 * position).collect();
                method.eval_forces(&model, &state);
            }
            let to = StepTo { step, time: f64::from(count) * step, is_measured: false };
            let (moved, next) = steps.step_to(&mut method, &model, &mut state, None, to, false);
            moved.unwrap_or_else(|error| panic!("{error}"));
            steps.accept(next);
            if state.step_memory.fastest_age == 0 {
                evaluated.push(count);
            }
        }
        evaluated
    }
}
