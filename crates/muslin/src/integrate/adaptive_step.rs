//! The self-adaptive time step.

use crate::state::{Motion, StepMemory};

/// Share of the guaranteed stable step [1] that is taken where the stiffness can change.
const STABLE_SHARE: f64 = 0.8;

/// The same where it cannot.
const CONSTANT_STABLE_SHARE: f64 = 0.95;

/// Share of the stable step [1] at the end of a step above which the step is taken back.
const REJECTED_SHARE: f64 = 0.95;

/// Growth of the fastest frequency in one step [1] above which the step is taken back.
const REJECTED_GROWTH: f64 = 3.0;

/// Largest product of the step and the frequency at which the motion's energy oscillates [1]. The energy of central
/// differences is then kept to a sixth of its square, 6e-4 of the kinetic energy.
const ENERGY_ACCURACY: f64 = 0.06;

/// Steps of one span of memory. A motion of the very frequency that limits the step turns by [`ENERGY_ACCURACY`] in each, so
/// that this is more than half of its period, after which it is as fast again.
const SPAN_STEPS: u32 = 64;

/// Share before the first step [1], when nothing is known of the motion to come, and the steps for which it is remembered.
const INITIAL_SHARE: f64 = 1.0;
const INITIAL_STEPS: u32 = 24;

/// Of so many steps the motion is measured in the first two, unless energy rules the step.
const MEASURED_EVERY: u32 = 8;

/// How far one step may depart from the one that stability asks for, so that steps before and after can balance [1].
const BALANCE: f64 = 0.8;

/// Growth and shrinkage of the step at once at most where a tolerance rules it [1].
const TOLERANCE_CHANGE: [f64; 2] = [0.3, 1.5];

impl Default for StepMemory {
    /// Before the first step.
    fn default() -> Self {
        Self {
            ideal_step: 0.0,
            tolerated_step: 0.0,
            energetic_shares: [0.0, INITIAL_SHARE],
            span_steps: SPAN_STEPS - INITIAL_STEPS,
            peak_kinetic_energy: 0.0,
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

    fn energetic_share(&self) -> f64 {
        self.energetic_shares[0].max(self.energetic_shares[1])
    }
}

/// The rule for an adaptive step.
///
/// With the fastest frequency ω at the present positions (at most, by the bound of
/// [`Force::add_stiffness_bounds`](crate::force::Force::add_stiffness_bounds)) it asks for
///
/// ```text
/// H = min(0.8 · 2/ω, 0.06 / ω_E, longest step that any force or drag allows)
/// ```
///
/// **Stability.** 2/ω is the limit of central differences. Where the bound cannot change (Hooke's law) the share is 0.95.
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
/// springs it is what makes the motion accurate. The rule remembers the largest ω_E / ω for more than half a period, so that the step
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
/// around H would only shake them.
///
/// **Guard.** A step after which the fastest frequency has grown too much (2/ω < h / 0.95, or threefold) is taken back and
/// tried again at half its length: a spring that stiffens without bound is met with ever shorter steps. However much it has
/// grown, a step that resolves it (h ω ≤ 0.06) stands: what begins without any stiffness or damping, and what a limit
/// changes at once, grows by the same in the shortest step.
///
/// **Frames** are hit exactly: the rest of the frame is divided by the number of steps that it needs.
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
    /// Largest error [m] of any position that the steps of a frame may add up to, if there is a limit.
    pub tolerance: Option<f64>,
}

impl AdaptiveStep {
    /// The step [s] that the rule asks for after `memory`, where `stable_step` [s] is guaranteed to be stable.
    ///
    /// It is the same whether a frame is near or not; see [`fit`](Self::fit).
    #[must_use]
    pub fn ideal_step(&self, memory: &StepMemory, stable_step: f64) -> f64 {
        let stable = self.largest_step(stable_step);
        let accurate = 0.5 * ENERGY_ACCURACY / memory.energetic_share() * stable_step;
        let mut target = stable.min(accurate);
        if self.tolerance.is_some() && 0.0 < memory.tolerated_step {
            target = target.min(memory.tolerated_step);
        }
        if memory.ideal_step == 0.0 || target < accurate || self.is_stiffness_constant {
            return target;
        }
        let balanced = 1.0 / (2.0 / target - 1.0 / memory.ideal_step);
        // A negative one, too, means that the step has to grow.
        if balanced > 0.0 { balanced.clamp(BALANCE * target, target / BALANCE) } else { target / BALANCE }
    }

    /// The step [s] at which cloth moves once its energy is in slow motion, where `stable_step` [s] is guaranteed to be
    /// stable.
    #[must_use]
    pub fn largest_step(&self, stable_step: f64) -> f64 {
        let share = if self.is_stiffness_constant { CONSTANT_STABLE_SHARE } else { STABLE_SHARE };
        (share * stable_step).min(self.longest)
    }

    /// A step [s] of at most `ideal_step` [s] of which a whole number makes up `rest` [s], and whether that number is one.
    #[must_use]
    pub fn fit(ideal_step: f64, rest: f64) -> (f64, bool) {
        // One part in 10⁹ longer is better than a further step.
        let count = (rest / ideal_step * (1.0 - 1e-9)).ceil().max(1.0);
        (rest / count, count == 1.0)
    }

    /// Whether a step of `step` [s] may stand, between states with these guaranteed stable steps [s].
    #[must_use]
    pub fn accepts(&self, step: f64, stable_before: f64, stable_after: f64) -> bool {
        // Written so that what is not a number is refused.
        self.is_stiffness_constant
            || (step <= REJECTED_SHARE * stable_after && stable_before <= REJECTED_GROWTH * stable_after)
            || step <= 0.5 * ENERGY_ACCURACY * stable_after
    }

    /// Takes note of an accepted step of `step` [s], which was to be `ideal_step` [s].
    ///
    /// `motion` is that of the step if it was measured, `last_step` [s] the step before it and `stable_step` [s] guaranteed where it began.
    pub fn remember(
        &self,
        memory: &mut StepMemory,
        ideal_step: f64,
        motion: Option<Motion>,
        last_step: f64,
        stable_step: f64,
    ) {
        let energy = memory.peak_kinetic_energy;
        let mut share = 0.0;
        if let (Some(before), Some(motion)) = (memory.motion, motion)
            && 0.0 < energy
            && stable_step.is_finite()
        {
            // v · (F_before − F_after) over the last step, with the velocity of that step.
            let lost_power = (before.power_after - motion.power_before).max(0.0);
            share = (0.5 * stable_step * (lost_power / (2.0 * energy * last_step)).sqrt()).min(1.0);
        }
        if memory.span_steps == SPAN_STEPS {
            memory.energetic_shares = [0.0, memory.energetic_shares[0]];
            memory.span_steps = 0;
        }
        memory.span_steps += 1;
        memory.energetic_shares[0] = memory.energetic_shares[0].max(share);
        if let Some(motion) = motion {
            memory.peak_kinetic_energy = memory.peak_kinetic_energy.max(motion.kinetic_energy);
        }
        memory.motion = motion;
        // A longer one is never taken, and a state that is written down holds no infinity.
        memory.ideal_step = ideal_step.min(self.frame_interval);
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

    const RULE: AdaptiveStep = AdaptiveStep {
        frame_interval: 0.1,
        longest: f64::INFINITY,
        shortest: 1e-9,
        is_stiffness_constant: false,
        tolerance: None,
    };

    #[test]
    fn steps_fit_what_is_left_of_a_frame() {
        assert_eq!(AdaptiveStep::fit(0.03, 0.1), (0.025, false));
        assert_eq!(AdaptiveStep::fit(0.2, 0.1), (0.1, true));
        assert_eq!(AdaptiveStep::fit(0.1 * (1.0 - 1e-12), 0.1), (0.1, true));
        assert_eq!(AdaptiveStep::fit(f64::INFINITY, 0.1), (0.1, true));
    }

    /// The rule is the same backwards: from h⁺ and the same H it gives h⁻.
    #[test]
    fn the_rule_is_reversible_where_it_is_not_clamped() {
        let memory = StepMemory { ideal_step: 3.1e-4, energetic_shares: [1.0, 0.0], ..StepMemory::default() };
        let next = RULE.ideal_step(&memory, 0.01);
        assert!((next - 1.0 / (2.0 / 3e-4 - 1.0 / 3.1e-4)).abs() < 1e-18, "{next}");
        let back = RULE.ideal_step(&StepMemory { ideal_step: next, ..memory }, 0.01);
        assert!((back - memory.ideal_step).abs() < 1e-18, "{back}");
    }

    #[test]
    fn a_step_that_ends_too_stiff_is_refused() {
        assert!(RULE.accepts(1e-3, 2e-3, 1.1e-3));
        assert!(!RULE.accepts(1e-3, 2e-3, 1.0e-3));
        assert!(!RULE.accepts(1e-4, 4e-3, 1.0e-3));
        assert!(!RULE.accepts(1e-5, 4e-3, f64::NAN));
    }

    /// Growth that no shorter step would lessen is no reason to refuse a step that resolves what has grown.
    #[test]
    fn a_step_that_resolves_the_growth_stands() {
        assert!(RULE.accepts(1e-5, 4e-3, 1.0e-3));
        assert!(RULE.accepts(1e-5, f64::INFINITY, 1.0e-3));
        assert!(!RULE.accepts(1e-4, f64::INFINITY, 1.0e-3));
        assert!(RULE.accepts(1e-1, 1.0e-3, f64::INFINITY));
        assert!(RULE.accepts(1e-1, f64::INFINITY, f64::INFINITY));
    }

    /// JSON, in which checkpoints are, has no infinity.
    #[test]
    fn memory_is_finite_where_nothing_is_stiff() {
        let mut memory = StepMemory::default();
        let ideal = RULE.ideal_step(&memory, f64::INFINITY);
        assert_eq!(ideal, f64::INFINITY);
        RULE.remember(&mut memory, ideal, Some(Motion::default()), 0.0, f64::INFINITY);
        let text = serde_json::to_string(&memory).expect("JSON");
        assert_eq!(serde_json::from_str::<StepMemory>(&text).expect("what was written"), memory);
        assert_eq!(RULE.ideal_step(&memory, f64::INFINITY), f64::INFINITY);
    }

    /// A lone oscillator, of which the energy is all in its one and fastest mode, is resolved by 2π / 0.06 steps.
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
            RULE.remember(&mut memory, step, Some(motion(f64::from(n))), step, 2.0 / omega);
        }
        assert!((memory.energetic_share() - 1.0).abs() < 2e-3, "{}", memory.energetic_share());
        let ideal = RULE.ideal_step(&StepMemory { ideal_step: 0.0, ..memory }, 2.0 / omega);
        assert!((ideal * omega - ENERGY_ACCURACY).abs() < 1e-4, "{}", ideal * omega);
    }
}
