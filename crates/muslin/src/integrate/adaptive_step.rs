//! The self-adaptive time step.

use super::{StableStep, StableSteps};
use crate::state::{Motion, StepMemory};

/// Share of the guaranteed stable step [1] that is taken where the stiffness can change.
const STABLE_SHARE: f64 = 0.8;

/// The same where it cannot.
const CONSTANT_STABLE_SHARE: f64 = 0.95;

/// Share of the stable step [1] at the end of a step above which the step is taken back.
const REJECTED_SHARE: f64 = 0.95;

/// Growth of the fastest frequency in one step [1] above which the step is taken back.
const REJECTED_GROWTH: f64 = 3.0;

/// Growth of the fastest frequency in one step [1] from which on stiffness counts as unsteady, and the share of the stable
/// step at its end that such a step may be [1].
const UNSTEADY_GROWTH: f64 = 1.15;
const UNSTEADY_SHARE: f64 = 0.4;

/// Largest product of the step and the frequency at which the motion's energy oscillates [1]. The energy of central
/// differences is then kept to a sixth of its square, 5e-4 of the kinetic energy.
const ENERGY_ACCURACY: f64 = 0.055;

/// Steps of one span of memory. A motion of the very frequency that limits the step turns by [`ENERGY_ACCURACY`] in each, so
/// that this is more than its period: however a spring stiffens on the way, its fastest motion is never forgotten.
const SPAN_STEPS: u32 = 128;

/// Share before the first step [1], when nothing is known of the motion to come, and the steps for which it is remembered.
const INITIAL_SHARE: f64 = 1.0;
const INITIAL_STEPS: u32 = 24;

/// Of so many steps the motion is measured in the first two, unless energy rules the step.
const MEASURED_EVERY: u32 = 8;

/// How far one step may depart from the one that stability asks for, so that steps before and after can balance [1].
const BALANCE: f64 = 0.8;

/// Share of the step that stability asks for [1] above which steps do not balance: steps that grow and shrink by turns shake
/// the fastest modes, even if each of them is stable.
const BALANCED_SHARE: f64 = 0.7;

/// Growth and shrinkage of the step at once at most where a tolerance rules it [1].
const TOLERANCE_CHANGE: [f64; 2] = [0.3, 1.5];

impl Default for StepMemory {
    /// Before the first step.
    fn default() -> Self {
        Self {
            ideal_step: 0.0,
            rest_of_step: 0.0,
            tolerated_step: 0.0,
            energetic_shares: [0.0, INITIAL_SHARE],
            span_steps: SPAN_STEPS - INITIAL_STEPS,
            peak_kinetic_energy: 0.0,
            fastest: None,
            fastest_age: 0,
            fastest_lasts: StableSteps::LASTS[0],
            is_unsteady: [false; 2],
            motion: None,
        }
    }
}

impl StepMemory {
    /// Whether the motion is to be measured in the next step.
    pub(crate) fn is_due(&self) -> bool {
        let rules = 0.5 * ENERGY_ACCURACY < STABLE_SHARE * self.energetic_share();
        rules || self.span_steps % MEASURED_EVERY < 2
    }

    /// Whether stiffness changed by much a short while ago.
    fn is_unsteady(&self) -> bool {
        self.is_unsteady[0] || self.is_unsteady[1]
    }

    fn energetic_share(&self) -> f64 {
        self.energetic_shares[0].max(self.energetic_shares[1])
    }
}

/// A step that the rule asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IdealStep {
    /// The step [s], had no frame been near.
    pub whole: f64,
    /// What is to be done of it [s]: less than the whole one if a frame cut it in two.
    pub rest: f64,
    /// Whether a frame that is near cuts it in two, in place of dividing what leads there evenly.
    pub is_cut: bool,
}

impl IdealStep {
    /// A step of at most `whole` [s], so that a whole number of them meets the next frame.
    #[must_use]
    pub fn dividing(whole: f64) -> Self {
        Self { whole, rest: whole, is_cut: false }
    }

    /// A step [s] towards a frame that is `distance` [s] away, and whether it arrives.
    #[must_use]
    pub fn fit(self, distance: f64) -> (f64, bool) {
        // One part in 10⁹ longer is better than a further step.
        let count = (distance / self.rest * (1.0 - 1e-9)).ceil().max(1.0);
        if self.is_cut && 1.0 < count { (self.rest, false) } else { (distance / count, count == 1.0) }
    }

    /// The step in place of one of `step` [s] that was refused, of at most `longest` [s].
    #[must_use]
    pub fn after_refusal(step: f64, longest: f64) -> Self {
        Self::dividing((0.5 * step).min(longest))
    }
}

/// The rule for an adaptive step.
///
/// With the fastest frequency ω at the present positions (at most, by the block bound that [`StableSteps`](super::StableSteps)
/// follows) it asks for
///
/// ```text
/// H = min(0.8 · 2/ω, 0.055 / ω_E, longest step that any force or drag allows)
/// ```
///
/// **Stability.** 2/ω is the limit of central differences. Where no spring can stiffen (Hooke's law) the share is 0.95.
/// After a step in which stiffness changed by 15 % the share is 0.8 (ω₀/ω)^¼ for one to two spans of steps, with ω, and ω₀ of the
/// flat cloth, by norms ([`Force::add_stiffness_bounds`](crate::force::Force::add_stiffness_bounds)): close to the asymptote of
/// its springs a cloth stiffens many times over a small part of their length, and a step that is merely stable would gain
/// energy from each such impact.
///
/// **Energy.** ω_E is the frequency at which kinetic energy turns into elastic, the Rayleigh quotient of the motion, taken
/// with the largest kinetic energy T so far:
///
/// ```text
/// ω_E² = vᵀK v / 2T = −v · ΔF / (2 T h)
/// ```
///
/// Central differences conserve a neighbouring energy, which differs from the true one by about (h ω_E)² / 6 of T. In a
/// cloth ω_E is far below ω: the stiffest motion carries next to no energy, and this term rests. For a few masses on
/// springs it is what makes the motion accurate. The rule remembers the largest ω_E / ω, by norms, for more than a period, so that the step
/// follows ω through a swing and not the swing itself.
///
/// **Balance.** A step chosen from the state before it alone, with nothing from the state after it, lets the energy drift,
/// since the rule then runs differently backwards in time. While energy rules the step, the step h⁺ after the step h⁻
/// therefore obeys
///
/// ```text
/// ½ (1/h⁻ + 1/h⁺) = 1/H        (within 0.8 H ≤ h⁺ ≤ H / 0.8)
/// ```
///
/// which is the same in both directions. Where stability rules, motions near ω are not resolved anyway; steps that swing
/// around H would only shake them: it balances up to 0.7 of what stability asks for.
///
/// **Guard.** A step after which the fastest frequency by norms has grown too much (threefold, or 2/ω < h / 0.95 by blocks) is taken back and
/// tried again at half its length: a spring that stiffens without bound is met with ever shorter steps. So is one in which it
/// has grown by 15 %, if it is longer than 0.4 · 2/ω; steps stay as short for a while. However much it has
/// grown, a step that resolves it (h ω ≤ 0.055) stands: what begins without any stiffness or damping, and what a limit
/// changes at once, grows by the same in the shortest step.
///
/// **Frames** are hit exactly. Where stability rules, the rest of the frame is divided by the number of steps that it needs.
/// Where energy rules, a frame cuts the step that meets it in two, and the second part follows the frame: the steps are
/// then what they are without frames. Divisions that change in every frame let the energy of a stiffening spring drift by
/// 2 % in 1000 periods.
///
/// The paper names a "self-adaptive" step without saying what it is; this one is ours. That a step chosen from the past
/// alone destroys the symmetry in time, and with it the long-term energy, is what Hairer and Söderlind, "Explicit, time
/// reversible, adaptive step size control", 2005, say in their abstract.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdaptiveStep {
    /// Time from frame to frame [s].
    pub frame_interval: f64,
    /// The longest step [s] that forces and drag allow, whatever the state.
    pub longest: f64,
    /// The shortest step [s] that is tried before the run is given up.
    pub shortest: f64,
    /// Whether the bound on the fastest frequency is the same in all states.
    pub is_stiffness_constant: bool,
    /// The stable step [s] of the flat cloth by norms.
    pub flat_stable_step: f64,
    /// Kinetic energy [J] below which there is no motion but that of rounding.
    pub least_kinetic_energy: f64,
    /// Largest error [m] of any position that the steps of a frame may add up to, if there is a limit.
    pub tolerance: Option<f64>,
}

impl AdaptiveStep {
    /// The step that the rule asks for after `memory`, at a state with these stable steps.
    #[must_use]
    pub fn ideal_step(&self, memory: &StepMemory, stable: StableStep) -> IdealStep {
        let mut longest = self.largest_step(stable.by_blocks);
        if memory.is_unsteady() && !self.is_stiffness_constant {
            longest = longest.min(self.unsteady_share(stable.by_norms) * stable.by_norms);
        }
        if self.tolerance.is_some() && 0.0 < memory.tolerated_step {
            longest = longest.min(memory.tolerated_step);
        }
        if 0.0 < memory.rest_of_step && memory.rest_of_step <= longest {
            return IdealStep { whole: memory.ideal_step, rest: memory.rest_of_step, is_cut: true };
        }
        let accurate = 0.5 * ENERGY_ACCURACY / memory.energetic_share() * stable.by_norms;
        let is_balanced = accurate <= longest
            && accurate <= BALANCED_SHARE * self.largest_step(stable.by_blocks)
            && !self.is_stiffness_constant;
        if memory.ideal_step == 0.0 || !is_balanced {
            return IdealStep::dividing(longest.min(accurate));
        }
        let balanced = 1.0 / (2.0 / accurate - 1.0 / memory.ideal_step);
        // A negative one, too, means that the step has to grow.
        let step = if balanced > 0.0 {
            balanced.clamp(BALANCE * accurate, accurate / BALANCE)
        } else {
            accurate / BALANCE
        };
        IdealStep { whole: step, rest: step, is_cut: true }
    }

    /// The step [s] at which cloth moves once its energy is in slow motion, where `stable_step` [s] is stable by blocks.
    #[must_use]
    pub fn largest_step(&self, stable_step: f64) -> f64 {
        let share = if self.is_stiffness_constant { CONSTANT_STABLE_SHARE } else { STABLE_SHARE };
        (share * stable_step).min(self.longest)
    }

    /// Share [1] of the stable step by norms that is taken for a while after stiffness changed by much.
    fn unsteady_share(&self, by_norms: f64) -> f64 {
        if by_norms < self.flat_stable_step && self.flat_stable_step.is_finite() {
            STABLE_SHARE * (by_norms / self.flat_stable_step).sqrt().sqrt()
        } else {
            STABLE_SHARE
        }
    }

    /// Whether a step of `step` [s] may stand, between states with these stable steps.
    #[must_use]
    pub fn accepts(&self, step: f64, before: StableStep, after: StableStep) -> bool {
        // Written so that what is not a number is refused.
        let has_grown_by_less = |growth: f64| before.by_norms <= growth * after.by_norms;
        let is_steady = has_grown_by_less(UNSTEADY_GROWTH);
        let largest =
            if is_steady { REJECTED_SHARE * after.by_blocks } else { UNSTEADY_SHARE * after.by_norms };
        self.is_stiffness_constant
            || (step <= largest && has_grown_by_less(REJECTED_GROWTH))
            || step <= 0.5 * ENERGY_ACCURACY * after.by_norms
    }

    /// Takes note of an accepted step of `step` [s], which was to be `ideal_step`.
    ///
    /// `motion` is that of the step if it was measured, `last_step` [s] the step before it; `stable_before` and `stable_after`
    /// [s] are guaranteed by norms where it began and ended.
    pub fn remember(
        &self,
        memory: &mut StepMemory,
        (ideal_step, step): (IdealStep, f64),
        motion: Option<Motion>,
        last_step: f64,
        [stable_before, stable_after]: [f64; 2],
    ) {
        let energy = memory.peak_kinetic_energy;
        let (mut share, mut is_unsteady) = (0.0, false);
        if let (Some(before), Some(motion)) = (memory.motion, motion)
            && self.least_kinetic_energy < energy
            && stable_before.is_finite()
        {
            // v · (F_before − F_after) over the last step, with the velocity of that step.
            let lost_power = (before.power_after - motion.power_before).max(0.0);
            share = (0.5 * stable_before * (lost_power / (2.0 * energy * last_step)).sqrt()).min(1.0);
        }
        let has_changed = |from: f64, to: f64| UNSTEADY_GROWTH * to < from;
        if has_changed(stable_before, stable_after) || has_changed(stable_after, stable_before) {
            share = share.max(0.5 * ENERGY_ACCURACY / UNSTEADY_SHARE);
            is_unsteady = true;
        }
        // The second part of a step is none of its own: a high frame rate must not shorten the memory.
        if ideal_step.rest == ideal_step.whole {
            if memory.span_steps == SPAN_STEPS {
                memory.energetic_shares = [0.0, memory.energetic_shares[0]];
                memory.is_unsteady = [false, memory.is_unsteady[0]];
                memory.span_steps = 0;
            }
            memory.span_steps += 1;
        }
        memory.energetic_shares[0] = memory.energetic_shares[0].max(share);
        memory.is_unsteady[0] |= is_unsteady;
        if let Some(motion) = motion {
            memory.peak_kinetic_energy = memory.peak_kinetic_energy.max(motion.kinetic_energy);
        }
        memory.motion = motion;
        // A state that is written down holds no infinity.
        memory.ideal_step = if ideal_step.whole.is_finite() { ideal_step.whole } else { 0.0 };
        let rest = ideal_step.rest - step;
        memory.rest_of_step = if ideal_step.is_cut && 1e-9 * ideal_step.whole < rest { rest } else { 0.0 };
    }

    /// Whether the `error` [m] of a step of `step` [s] is within its part of the tolerance; how long the next step may be is
    /// noted in `memory`.
    ///
    /// The part of a step is in proportion to its length, so that the errors of a frame's steps add up to the tolerance.
    pub fn tolerates(&self, memory: &mut StepMemory, error: f64, step: f64) -> bool {
        let Some(tolerance) = self.tolerance else { return true };
        let allowed = tolerance * step / self.frame_interval;
        let [shrink, grow] = TOLERANCE_CHANGE;
        // The error of a step falls with the third power of its length, its part with the first.
        let factor = (0.8 * allowed / error).sqrt();
        memory.tolerated_step = step * if factor.is_nan() { shrink } else { factor.clamp(shrink, grow) };
        error <= allowed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A state of which both bounds are the same, as those of a lone mass on a spring are.
    fn stable(step: f64) -> StableStep {
        StableStep { by_norms: step, by_blocks: step }
    }

    const RULE: AdaptiveStep = AdaptiveStep {
        frame_interval: 0.1,
        longest: f64::INFINITY,
        shortest: 1e-9,
        is_stiffness_constant: false,
        flat_stable_step: f64::INFINITY,
        least_kinetic_energy: 0.0,
        tolerance: None,
    };

    #[test]
    fn steps_fit_what_is_left_of_a_frame() {
        for (step, divided, cut) in [
            (0.03, (0.025, false), (0.03, false)),
            (0.2, (0.1, true), (0.1, true)),
            (0.1 * (1.0 - 1e-12), (0.1, true), (0.1, true)),
            (f64::INFINITY, (0.1, true), (0.1, true)),
        ] {
            let dividing = IdealStep::dividing(step);
            assert_eq!(dividing.fit(0.1), divided);
            assert_eq!(IdealStep { is_cut: true, ..dividing }.fit(0.1), cut);
        }
    }

    /// The rule is the same backwards: from h⁺ and the same H it gives h⁻.
    #[test]
    fn the_rule_is_reversible_where_it_is_not_clamped() {
        let memory = StepMemory { ideal_step: 2.8e-4, energetic_shares: [1.0, 0.0], ..StepMemory::default() };
        let next = RULE.ideal_step(&memory, stable(0.01)).whole;
        let target = 0.5 * ENERGY_ACCURACY * 0.01;
        assert!((next - 1.0 / (2.0 / target - 1.0 / memory.ideal_step)).abs() < 1e-18, "{next}");
        let back = RULE.ideal_step(&StepMemory { ideal_step: next, ..memory }, stable(0.01)).whole;
        assert!((back - memory.ideal_step).abs() < 1e-18, "{back}");
    }

    #[test]
    fn a_step_that_ends_too_stiff_is_refused() {
        assert!(RULE.accepts(1e-3, stable(1.2e-3), stable(1.1e-3)));
        assert!(!RULE.accepts(1e-3, stable(1.1e-3), stable(1.0e-3)));
        assert!(RULE.accepts(4e-4, stable(2e-3), stable(1.1e-3)));
        assert!(!RULE.accepts(5e-4, stable(2e-3), stable(1.1e-3)));
        assert!(!RULE.accepts(1e-4, stable(4e-3), stable(1.0e-3)));
        assert!(!RULE.accepts(1e-5, stable(4e-3), stable(f64::NAN)));
    }

    /// Growth that no shorter step would lessen is no reason to refuse a step that resolves what has grown.
    #[test]
    fn a_step_that_resolves_the_growth_stands() {
        assert!(RULE.accepts(1e-5, stable(4e-3), stable(1.0e-3)));
        assert!(RULE.accepts(1e-5, stable(f64::INFINITY), stable(1.0e-3)));
        assert!(!RULE.accepts(1e-4, stable(f64::INFINITY), stable(1.0e-3)));
        assert!(RULE.accepts(1e-1, stable(1.0e-3), stable(f64::INFINITY)));
        assert!(RULE.accepts(1e-1, stable(f64::INFINITY), stable(f64::INFINITY)));
    }

    /// JSON, in which checkpoints are, has no infinity.
    #[test]
    fn memory_is_finite_where_nothing_is_stiff() {
        let mut memory = StepMemory::default();
        let ideal = RULE.ideal_step(&memory, stable(f64::INFINITY));
        assert_eq!(ideal.whole, f64::INFINITY);
        RULE.remember(&mut memory, (ideal, 0.1), Some(Motion::default()), 0.0, [f64::INFINITY; 2]);
        let text = serde_json::to_string(&memory).expect("JSON");
        assert_eq!(serde_json::from_str::<StepMemory>(&text).expect("what was written"), memory);
        assert_eq!(RULE.ideal_step(&memory, stable(f64::INFINITY)).whole, f64::INFINITY);
    }

    /// A step that a frame cuts in two goes on behind it, and counts once.
    #[test]
    fn the_rest_of_a_step_follows_the_frame() {
        let mut memory =
            StepMemory { ideal_step: 2.75e-4, energetic_shares: [1.0, 0.0], ..StepMemory::default() };
        let counted = memory.span_steps;
        let whole = RULE.ideal_step(&memory, stable(0.01));
        assert!(whole.is_cut && whole.rest == whole.whole, "{whole:?}");
        let (first, arrives) = whole.fit(1e-4);
        assert_eq!((first, arrives), (1e-4, true));
        RULE.remember(&mut memory, (whole, first), Some(Motion::default()), 0.0, [0.01; 2]);
        let rest = RULE.ideal_step(&memory, stable(0.01));
        assert_eq!(rest, IdealStep { whole: whole.whole, rest: whole.whole - 1e-4, is_cut: true });
        assert_eq!(rest.fit(0.1), (rest.rest, false));
        RULE.remember(&mut memory, (rest, rest.rest), Some(Motion::default()), 1e-4, [0.01; 2]);
        assert_eq!((memory.rest_of_step, memory.span_steps), (0.0, counted + 1));
        // Where the cloth has stiffened so that the rest is not stable, it is forgotten.
        memory.rest_of_step = 1e-4;
        assert!(RULE.ideal_step(&memory, stable(1e-4)).whole < 1e-5);
    }

    /// A lone oscillator, of which the energy is all in its one and fastest mode, is resolved by 2π / 0.055 steps.
    #[test]
    fn a_motion_of_the_fastest_mode_is_resolved() {
        let mut memory = StepMemory::default();
        let (omega, step) = (50.0_f64, 1.2e-3);
        let motion = |n: f64| {
            // v = cos ωt in the middle of step n, F = −ω sin ωt at its ends, m = 1.
            let v = (omega * (n + 0.5) * step).cos();
            let v_before = (omega * (n - 0.5) * step).cos();
            let force = -omega * (omega * n * step).sin();
            Motion { kinetic_energy: 0.5 * v * v, power_before: v_before * force, power_after: v * force }
        };
        for n in 0..500 {
            RULE.remember(
                &mut memory,
                (IdealStep::dividing(step), step),
                Some(motion(f64::from(n))),
                step,
                [2.0 / omega; 2],
            );
        }
        assert!((memory.energetic_share() - 1.0).abs() < 2e-3, "{}", memory.energetic_share());
        let ideal = RULE.ideal_step(&StepMemory { ideal_step: 0.0, ..memory }, stable(2.0 / omega)).whole;
        assert!((ideal * omega - ENERGY_ACCURACY).abs() < 1e-4, "{}", ideal * omega);
    }
}
