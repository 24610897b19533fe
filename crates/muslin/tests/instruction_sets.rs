//! Loops in vectors give what plain ones give: the same bits for every set of instructions, for every division of a grid into
//! blocks, and the forces of springs one by one.

mod common;

use std::ops::Range;

use common::{CURVE, ClothNumbers, SceneNumbers, SineNumbers, StepNumbers};
use muslin::force::{Configuration, Sweep};
use muslin::integrate::{CentralDifference, Integrator, StepTo, Workers, block_stable_step};
use muslin::observe::StateHash;
use muslin::{InstructionSet, Model, Points, Scene};

/// Grids whose rows are shorter than a vector, fill some, and are longer than what is worked on at a time.
const SIZES: [(usize, usize); 9] =
    [(1, 9), (9, 1), (2, 2), (7, 5), (10, 30), (33, 12), (129, 4), (140, 9), (300, 5)];

const LAWS: [[&str; 3]; 5] = [
    ["law = \"linear\"", "law = \"linear\"", "law = \"linear\""],
    ["law = \"tangent\", strain_scale = 0.06", "law = \"linear\"", "law = \"arctangent-force\""],
    ["law = \"linear\"", "law = \"tangent\", strain_scale = 0.3", "law = \"tangent\", strain_scale = 0.5"],
    [CURVE, "law = \"linear\"", CURVE],
    ["law = \"arctangent-force\"", CURVE, "law = \"linear\""],
];

/// Two cloths side by side, of which the second has springs of other families and another size.
fn scene(case: usize, (columns, rows): (usize, usize)) -> SceneNumbers {
    let cloth = ClothNumbers {
        columns,
        rows,
        width: if columns > 1 { 0.02 * columns as f64 } else { 1.0 },
        height: if rows > 1 { 0.03 * rows as f64 } else { 1.0 },
        pins: vec![(0, 0), (columns - 1, 0)],
        laws: LAWS[case % LAWS.len()],
        rest_length_direction: case % 3 == 2,
        // Its rows bend by second differences, and are wider than those of the other cloth.
        is_measured: case % 4 == 3,
        ..ClothNumbers::default()
    };
    let mut stiffnesses = cloth.stiffnesses;
    let is_measured = case % 2 == 1;
    if !is_measured {
        stiffnesses[case % 3] = 0.0;
    }
    let other = ClothNumbers {
        columns: rows + 1,
        rows: columns.min(40) + 1,
        width: 0.025 * rows as f64,
        height: 0.025 * columns.min(40) as f64,
        origin: [9.0, 0.0, 0.0],
        pins: vec![(rows, 0)],
        stiffnesses,
        laws: LAWS[(case + 1) % LAWS.len()],
        is_measured,
        ..ClothNumbers::default()
    };
    SceneNumbers { cloths: vec![cloth, other], step_rule: StepNumbers::Adaptive, ..SceneNumbers::default() }
}

/// Positions [m] of `model` some way from rest: smooth waves, so that springs are stretched and turned.
fn bent(model: &Model, scene: &Scene) -> Points {
    let positions = model.initial_state(scene).positions;
    positions
        .iter()
        .map(|at| {
            let wave = |x: f64, y: f64| libm::sin(7.0 * x + 3.0 * y);
            at * 1.02
                + 0.01 * muslin::glam::DVec3::new(wave(at.x, at.z), wave(at.z, at.x), wave(at.x + 1.0, at.y))
        })
        .collect()
}

fn at<'a>(model: &'a Model, positions: &'a Points) -> Configuration<'a> {
    Configuration { time: 0.0, particles: model.particles(), positions, velocities: positions, memory: &[] }
}

/// Forces [N] and varying stiffness bounds [N/m] with one sweep over `blocks`.
fn swept(model: &Model, positions: &Points, blocks: &[Range<usize>]) -> (Points, Vec<f64>) {
    let mut forces = Points::zeros(positions.len());
    let mut bounds = vec![0.0; positions.len()];
    let mut sweep = Sweep::default();
    for block in blocks {
        for force in model.forces() {
            let mut own = forces.slice_mut(block);
            let at = at(model, positions);
            force.add_forces_and_varying_bounds(at, block, &mut own, &mut bounds[block.clone()], &mut sweep);
        }
    }
    (forces, bounds)
}

/// Whether all bits are the same; zeros of both signs count as one.
fn assert_same(a: &Points, b: &Points, what: &str) {
    for (index, (a, b)) in a.iter().zip(b.iter()).enumerate() {
        assert!(a == b, "{what}: particle {index}: {a} and {b}");
    }
}

#[test]
fn every_set_of_instructions_gives_the_same_bits() {
    for (case, size) in SIZES.into_iter().enumerate() {
        let mut hashes: Vec<(&str, StateHash)> = Vec::new();
        for instructions in InstructionSet::available() {
            let scene = scene(case, size).scene();
            let model = Model::with_instructions(&scene, instructions);
            let mut state = model.initial_state(&scene);
            state.positions = bent(&model, &scene);
            let step = 0.3 * block_stable_step(&model, &state).min(1e-3);
            let mut method = CentralDifference::new(Workers::single());
            method.eval_forces(&model, &state);
            for count in 1..=40 {
                let to = StepTo { step, time: f64::from(count) * step, is_measured: count % 2 == 0 };
                let (moved, _) = method.step_to_and_bound(&model, &mut state, None, to, 0.0);
                moved.unwrap_or_else(|error| panic!("{size:?}: {error}"));
            }
            hashes.push((instructions.name(), StateHash::new(&state.positions, &state.velocities)));
        }
        assert!(hashes.windows(2).all(|pair| pair[0].1 == pair[1].1), "{size:?}: {hashes:?}");
    }
}

/// Blocks one by one with a new sweep each, and from the last to the first, give what they give in turn.
#[test]
fn a_sweep_changes_no_bit() {
    for (case, size) in SIZES.into_iter().enumerate() {
        let scene = scene(case, size).scene();
        let model = Model::new(&scene);
        let positions = bent(&model, &scene);
        let (forces, bounds) = swept(&model, &positions, model.blocks());
        let mut rows = Vec::new();
        for cloth in model.cloths() {
            let grid = cloth.grid;
            rows.extend((0..grid.rows).map(|row| grid.particle(0, row)..grid.particle(0, row + 1)));
        }
        let backwards: Vec<Range<usize>> = rows.iter().rev().cloned().collect();
        for (blocks, what) in [(&rows, "row by row"), (&backwards, "backwards")] {
            let (other_forces, other_bounds) = swept(&model, &positions, blocks);
            assert_same(&forces, &other_forces, &format!("{size:?} {what}"));
            assert_eq!(bounds, other_bounds, "{size:?} {what}");
        }
    }
}

/// The sum over all springs as a textbook has it, by square roots and divisions: to rounding.
#[test]
fn sweeps_add_up_the_springs_one_by_one() {
    for size in SIZES {
        let mut numbers = scene(0, size);
        numbers.gravity = [0.0; 3];
        numbers.cloths[1].laws = LAWS[0];
        let stiffnesses: Vec<[f64; 3]> = numbers.cloths.iter().map(|cloth| cloth.stiffnesses).collect();
        let scene = numbers.scene();
        let model = Model::new(&scene);
        let positions = bent(&model, &scene);
        let (forces, _) = swept(&model, &positions, model.blocks());
        let mut expected = Points::zeros(positions.len());
        let mut largest = 0.0_f64;
        for (force, stiffnesses) in model.forces().iter().zip(stiffnesses) {
            force.visit_springs(&mut |spring| {
                let [i, j] = spring.particles;
                let d = positions.get(j) - positions.get(i);
                let tension = stiffnesses[spring.family as usize] * (d.length() - spring.rest_length);
                let force = d / d.length() * tension;
                largest = largest.max(force.length());
                expected.set(i, expected.get(i) + force);
                expected.set(j, expected.get(j) - force);
            });
        }
        assert!(largest > 0.0, "{size:?} has no spring under tension");
        for (index, (force, expected)) in forces.iter().zip(expected.iter()).enumerate() {
            let error = (force - expected).length();
            assert!(error <= 1e-12 * largest, "{size:?}: particle {index}: {force} and {expected}");
        }
    }
}

/// Pins that move and limits come between motion and forces, and threads take both apart: neither changes a bit.
#[test]
fn one_pass_gives_the_bits_of_two() {
    let mut moving = SceneNumbers::default();
    moving.cloths[0].motion =
        Some(SineNumbers { axis: [0.0, 1.0, 0.0], amplitude: 0.0, frequency: 1.0, phase: 0.0 });
    for numbers in [SceneNumbers::default(), scene(1, (40, 30)), scene(3, (140, 20)), moving] {
        let scene = numbers.scene();
        let model = Model::new(&scene);
        let start = model.initial_state(&scene);
        let step = 0.2 * block_stable_step(&model, &start).min(1e-3);
        let ends = [1, 2, 3].map(|threads| {
            let mut state = start.clone();
            let mut method = CentralDifference::new(common::workers(threads));
            method.eval_forces(&model, &state);
            let mut motions = Vec::new();
            for count in 1..=20 {
                let to = StepTo { step, time: f64::from(count) * step, is_measured: count % 3 == 0 };
                let motion = method.step_to(&model, &mut state, None, to);
                motions.push(motion.unwrap_or_else(|error| panic!("{error}")));
            }
            (StateHash::new(&state.positions, &state.velocities), motions)
        });
        assert_eq!(ends[0], ends[1]);
        assert_eq!(ends[0], ends[2]);
    }
}
