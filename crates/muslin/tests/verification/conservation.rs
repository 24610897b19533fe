//! Momentum of a cloth on which nothing acts from outside.
//!
//! ```text
//! P = Σ m v        L = Σ m x × v
//! ```
//!
//! With v in the middle of the step that led to x, both are conserved exactly by central differences with steps of any
//! sizes: the springs' forces are opposite and central, and x₊ × v₊ = (x + h v₊) × v₊ = x × v₊.

use std::sync::LazyLock;

use glam::DVec3;
use muslin::integrate::{CentralDifference, Integrator, Workers};
use muslin::{Model, State};

use crate::common::{ClothNumbers, Random, SceneNumbers, larger, model_and_state};
use crate::report::{Problem, Row};

const STEPS: u32 = 1000;

/// A stretched and crumpled cloth of 8 x 6 that moves every way at once.
fn thrown_cloth(rest_length_direction: bool) -> (Model, State) {
    thrown_cloth_with(rest_length_direction, None)
}

/// The same under a limit.
fn thrown_cloth_with(rest_length_direction: bool, limit: Option<&'static str>) -> (Model, State) {
    let numbers = SceneNumbers {
        gravity: [0.0; 3],
        cloths: vec![ClothNumbers {
            columns: 8,
            rows: 6,
            pins: vec![],
            drag: 0.0,
            rest_length_direction,
            limit,
            ..ClothNumbers::default()
        }],
        ..SceneNumbers::default()
    };
    let (model, mut state) = model_and_state(&numbers);
    let mut random = Random::new(5);
    let offsets = random.points(48, 0.05);
    state.velocities = random.points(48, 1.0);
    for particle in 0..48 {
        let spin = DVec3::new(0.0, 0.5, 1.0).cross(state.positions.get(particle));
        state.positions.set(particle, state.positions.get(particle) + offsets.get(particle));
        state.velocities.set(particle, state.velocities.get(particle) + spin);
    }
    (model, state)
}

fn momenta(model: &Model, state: &State) -> [DVec3; 2] {
    let mut momenta = [DVec3::ZERO; 2];
    let moving = state.positions.iter().zip(state.velocities.iter());
    for ((x, v), mass) in moving.zip(model.particles().masses()) {
        momenta[0] += *mass * v;
        momenta[1] += x.cross(*mass * v);
    }
    momenta
}

/// Σ m |v| and Σ m |x| |v|: what the momenta would be if nothing cancelled.
fn scales(model: &Model, state: &State) -> [f64; 2] {
    let moving = state.positions.iter().zip(state.velocities.iter());
    moving.zip(model.particles().masses()).fold([0.0; 2], |[linear, angular], ((x, v), mass)| {
        [linear + mass * v.length(), angular + mass * x.length() * v.length()]
    })
}

/// Each step adds a few roundings of the size of the momenta: at worst they add up to 4 ε n, 1e-12 here.
const TOLERANCE: f64 = 4.0 * f64::EPSILON * STEPS as f64;

/// The largest changes of the momenta over all steps, relative to what they would be if nothing cancelled.
fn changes(rest_length_direction: bool, varied: bool) -> [f64; 2] {
    let (model, mut state) = thrown_cloth(rest_length_direction);
    let before = momenta(&model, &state);
    let mut scales = scales(&model, &state);
    let mut method = CentralDifference::new(Workers::single());
    let mut random = Random::new(6);
    let mut max_error = [0.0_f64; 2];
    for _ in 0..STEPS {
        let step = if varied { random.between(2e-4, 8e-4) } else { 5e-4 };
        method.step(&model, &mut state, step).unwrap_or_else(|error| panic!("{error}"));
        let now = self::scales(&model, &state);
        for i in 0..2 {
            scales[i] = scales[i].max(now[i]);
            let error = (momenta(&model, &state)[i] - before[i]).length() / scales[i];
            max_error[i] = larger(max_error[i], error);
        }
    }
    max_error
}

pub(crate) static PROBLEM: LazyLock<Problem> = LazyLock::new(|| {
    let mut rows = Vec::new();
    for (rest_length_direction, direction) in [(false, "current-length"), (true, "rest-length")] {
        for (varied, steps) in [(false, "equal steps"), (true, "random steps of 4 : 1")] {
            let names = ["linear", "angular"].into_iter();
            rows.extend(names.zip(changes(rest_length_direction, varied)).map(|(name, change)| {
                Row::vanishing(format!("{name} momentum, `{direction}`, {steps}"), change, TOLERANCE)
            }));
        }
    }
    Problem {
        title: "Conservation of momentum",
        text: "The largest change over 1000 steps of a free, crumpled cloth of 8 x 6 that is thrown and spun, relative \
               to the sum of the momenta's sizes.",
        rows,
    }
});

#[test]
fn momenta_are_kept() {
    PROBLEM.assert();
}

/// Limits move the ends of a spring in inverse proportion to their masses: linear momentum stays. (Angular momentum does
/// not: a spring turns in the step at whose end it is shortened.)
#[test]
fn linear_momentum_is_kept_by_limits() {
    for limit in [
        "{ kind = \"arctangent-projection\" }",
        "{ kind = \"cut-off\", strain = 0.05, shear_strain = 0.05, passes = 4 }",
    ] {
        let (model, mut state) = thrown_cloth_with(false, Some(limit));
        let ([before, _], [mut scale, _]) = (momenta(&model, &state), scales(&model, &state));
        let mut method = CentralDifference::new(Workers::single());
        let (mut max_error, mut work) = (0.0_f64, 0.0);
        for _ in 0..STEPS {
            method.step(&model, &mut state, 5e-4).unwrap();
            work += state.limit_work.on_free.abs();
            scale = scale.max(scales(&model, &state)[0]);
            max_error = larger(max_error, (momenta(&model, &state)[0] - before).length() / scale);
        }
        assert!(work > 0.0, "the limit acts");
        assert!(max_error < TOLERANCE, "{max_error:e}");
    }
}

/// Drag takes momentum and nothing else: P_n = P_0 (1 − c) / (1 + c) … as every particle's velocity alone would fall.
#[test]
fn drag_takes_momentum_as_from_one_particle() {
    let numbers = SceneNumbers {
        gravity: [0.0; 3],
        cloths: vec![ClothNumbers { pins: vec![], drag: 0.02, ..ClothNumbers::default() }],
        ..SceneNumbers::default()
    };
    let (model, mut state) = model_and_state(&numbers);
    state.velocities = Random::new(7).points(100, 1.0);
    let [before, _] = momenta(&model, &state);
    let [scale, _] = scales(&model, &state);
    let step = 5e-4;
    let c = numbers.cloths[0].drag * step / (2.0 * numbers.cloths[0].mass);
    let mut method = CentralDifference::new(Workers::single());
    for n in 1..=STEPS {
        method.step(&model, &mut state, step).unwrap();
        // The first half-step is explicit: v = v₀ (1 − c).
        let left = (1.0 - c) * ((1.0 - c) / (1.0 + c)).powi(n as i32 - 1);
        let error = (momenta(&model, &state)[0] - before * left).length() / scale;
        assert!(error < TOLERANCE, "{error:e} after {n} steps");
    }
}
