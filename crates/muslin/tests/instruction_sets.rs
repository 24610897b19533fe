//! Loops in vectors give what plain ones give: the same bits for every set of instructions, for every division of a grid into
//! blocks, and the forces of springs one by one.

mod common;

use std::ops::Range;

use common::{CURVE, ClothNumbers, SceneNumbers, SineNumbers, StepNumbers};
use muslin::force::{Configuration, StiffnessTensors, StiffnessTensorsMut, Sweep};
use muslin::glam::{DMat3, DVec3};
use muslin::integrate::{CentralDifference, Integrator, StepTo, Workers, block_stable_step};
use muslin::observe::StateHash;
use muslin::{InstructionSet, LimitWork, Model, Motion, Points, Scene, State};

/// Grids whose rows are shorter than a vector, fill some, and are longer than what is worked on at a time.
const SIZES: [(usize, usize); 12] = [
    (1, 9),
    (9, 1),
    (2, 2),
    (7, 5),
    (10, 30),
    (33, 12),
    (129, 4),
    (140, 9),
    (300, 5),
    (400, 6),
    (3, 3),
    (2, 40),
];

const LAWS: [[&str; 3]; 6] = [
    ["law = \"linear\"", "law = \"linear\"", "law = \"linear\""],
    ["law = \"tangent\", strain_scale = 0.06", "law = \"linear\"", "law = \"arctangent-force\""],
    ["law = \"linear\"", "law = \"tangent\", strain_scale = 0.3", "law = \"tangent\", strain_scale = 0.5"],
    [CURVE, "law = \"linear\"", CURVE],
    ["law = \"arctangent-force\"", CURVE, "law = \"linear\""],
    ["law = \"tangent\", strain_scale = 0.06", "law = \"linear\"", "law = \"linear\""],
];

/// Two cloths side by side, of which one has springs of other families and another size; the one of `columns` and `rows` is the
/// first, or in odd cases the last, behind which there are no more particles.
fn scene(case: usize, (columns, rows): (usize, usize)) -> SceneNumbers {
    let cloth = ClothNumbers {
        columns,
        rows,
        width: if columns > 1 { 0.02 * columns as f64 } else { 1.0 },
        height: if rows > 1 { 0.03 * rows as f64 } else { 1.0 },
        pins: vec![(0, 0), (columns - 1, 0), (columns / 2, rows / 2), (columns - 1, rows - 1)],
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
    let cloths = if case.is_multiple_of(2) { vec![cloth, other] } else { vec![other, cloth] };
    SceneNumbers { cloths, step_rule: StepNumbers::Adaptive, ..SceneNumbers::default() }
}

/// Positions [m] of `model` some way from rest: smooth waves, so that springs are stretched and turned.
fn bent(model: &Model, scene: &Scene) -> Points {
    let positions = model.initial_state(scene).positions;
    positions
        .iter()
        .map(|at| {
            let wave = |x: f64, y: f64| libm::sin(7.0 * x + 3.0 * y);
            at * 1.02 + 0.01 * DVec3::new(wave(at.x, at.z), wave(at.z, at.x), wave(at.x + 1.0, at.y))
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

/// Stiffness tensors [N/m] of all springs, `blocks` by blocks with one sweep, or if `is_new` with a new one each.
fn tensors(model: &Model, positions: &Points, blocks: &[Range<usize>], is_new: bool) -> StiffnessTensors {
    let mut tensors = StiffnessTensors::zeros(positions.len());
    let mut sweep = Sweep::default();
    for block in blocks {
        if is_new {
            sweep = Sweep::default();
        }
        add_tensors(model, positions, block, &mut tensors, &mut sweep);
    }
    tensors
}

/// The same with one sweep that goes over all blocks twice, from forces to tensors and back.
fn tensors_by_turns(model: &Model, positions: &Points, blocks: &[Range<usize>]) -> StiffnessTensors {
    let mut tensors = StiffnessTensors::zeros(positions.len());
    let mut forces = Points::zeros(positions.len());
    let mut sweep = Sweep::default();
    for (index, block) in [0_usize, 1].into_iter().flat_map(|first| (first..).zip(blocks)) {
        if index.is_multiple_of(2) {
            add_tensors(model, positions, block, &mut tensors, &mut sweep);
        } else {
            for force in model.forces() {
                force.add_forces(at(model, positions), block, &mut forces.slice_mut(block), &mut sweep);
            }
        }
    }
    tensors
}

fn add_tensors(
    model: &Model,
    positions: &Points,
    block: &Range<usize>,
    StiffnessTensors { diagonal, off_diagonal }: &mut StiffnessTensors,
    sweep: &mut Sweep,
) {
    let (diagonal, off_diagonal) = (diagonal.slice_mut(block), off_diagonal.slice_mut(block));
    let mut own = StiffnessTensorsMut { diagonal, off_diagonal };
    for force in model.forces() {
        force.add_stiffness_tensors(at(model, positions), block, &mut own, sweep);
    }
}

/// The rows of all cloths.
fn rows(model: &Model) -> Vec<Range<usize>> {
    let grids = model.cloths().iter().map(|cloth| cloth.grid);
    grids
        .flat_map(|grid| (0..grid.rows).map(move |row| grid.particle(0, row)..grid.particle(0, row + 1)))
        .collect()
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
        let rows = rows(&model);
        let backwards: Vec<Range<usize>> = rows.iter().rev().cloned().collect();
        for (blocks, what) in [(&rows, "row by row"), (&backwards, "backwards")] {
            let (other_forces, other_bounds) = swept(&model, &positions, blocks);
            assert_same(&forces, &other_forces, &format!("{size:?} {what}"));
            assert_eq!(bounds, other_bounds, "{size:?} {what}");
        }
    }
}

/// So do the stiffness tensors, and where the sweep is one of forces by turns.
#[test]
fn a_sweep_changes_no_bit_of_stiffness() {
    for (case, size) in SIZES.into_iter().enumerate() {
        let scene = scene(case, size).scene();
        let model = Model::new(&scene);
        let positions = bent(&model, &scene);
        let expected = tensors(&model, &positions, model.blocks(), false);
        let rows = rows(&model);
        let backwards: Vec<Range<usize>> = rows.iter().rev().cloned().collect();
        for (blocks, what) in [(model.blocks(), "blocks"), (&rows, "rows"), (&backwards, "backwards")] {
            for (found, how) in [
                (tensors(&model, &positions, blocks, false), "with one sweep"),
                (tensors(&model, &positions, blocks, true), "with new sweeps"),
                (tensors_by_turns(&model, &positions, blocks), "by turns"),
            ] {
                let what = format!("{size:?} {what} {how}");
                assert_same(&found.diagonal, &expected.diagonal, &what);
                assert_same(&found.off_diagonal, &expected.off_diagonal, &what);
            }
        }
    }
}

#[test]
fn every_set_of_instructions_gives_the_same_stiffness() {
    for (case, size) in SIZES.into_iter().enumerate() {
        let scene = scene(case, size).scene();
        let mut found = InstructionSet::available().map(|instructions| {
            let model = Model::with_instructions(&scene, instructions);
            let positions = bent(&model, &scene);
            let (_, bounds) = swept(&model, &positions, model.blocks());
            (tensors(&model, &positions, model.blocks(), false), bounds)
        });
        let first = found.next();
        assert!(found.all(|other| Some(&other) == first.as_ref()), "{size:?}");
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

/// Both ends have w (k_a n nᵀ + c (1 − n nᵀ)) of each linear spring, as far as k_a and c are positive, with w = 1 if the other
/// end is pinned and 2 if it is free: to rounding.
#[test]
fn stiffness_tensors_add_up_the_springs_one_by_one() {
    for (size, is_rest_length) in SIZES.into_iter().flat_map(|size| [(size, false), (size, true)]) {
        for is_last in [false, true] {
            let mut numbers = scene(0, size);
            numbers.gravity = [0.0; 3];
            for cloth in &mut numbers.cloths {
                (cloth.laws, cloth.rest_length_direction) = (LAWS[0], is_rest_length);
            }
            if is_last {
                numbers.cloths.reverse();
            }
            let stiffnesses: Vec<[f64; 3]> = numbers.cloths.iter().map(|cloth| cloth.stiffnesses).collect();
            let scene = numbers.scene();
            let model = Model::new(&scene);
            let positions = bent(&model, &scene);
            let found = tensors(&model, &positions, model.blocks(), false);
            let mut expected = vec![DMat3::ZERO; positions.len()];
            let mut largest = 0.0_f64;
            for (force, stiffnesses) in model.forces().iter().zip(stiffnesses) {
                force.visit_springs(&mut |spring| {
                    let d = positions.get(spring.particles[1]) - positions.get(spring.particles[0]);
                    let stiffness = stiffnesses[spring.family as usize];
                    let tensor = spring_tensor(stiffness, spring.rest_length, d, is_rest_length);
                    largest = largest.max(tensor.x_axis.length());
                    for [own, other] in [[0, 1], [1, 0]].map(|ends| ends.map(|end| spring.particles[end])) {
                        let weight = if model.particles().pinned()[other] { 1.0 } else { 2.0 };
                        expected[own] += weight * tensor;
                    }
                });
            }
            assert!(largest > 0.0, "{size:?} has no stiff spring");
            for (particle, expected) in expected.into_iter().enumerate() {
                let (diagonal, off_diagonal) =
                    (found.diagonal.get(particle), found.off_diagonal.get(particle));
                let [x, y, z] = expected.to_cols_array_2d();
                let error = (diagonal - DVec3::new(x[0], y[1], z[2])).length()
                    + (off_diagonal - DVec3::new(y[2], x[2], x[1])).length();
                assert!(
                    error <= 1e-12 * largest,
                    "{size:?} {is_rest_length} {is_last}: particle {particle}: {diagonal} {off_diagonal} and {expected}"
                );
            }
        }
    }
}

/// k_a⁺ n nᵀ + c⁺ (1 − n nᵀ) [N/m] of a linear spring of `stiffness` [N/m] and `rest_length` [m] with the vector `d` [m].
fn spring_tensor(stiffness: f64, rest_length: f64, d: DVec3, is_rest_length: bool) -> DMat3 {
    let (length, n) = (d.length(), d / d.length());
    let tension = stiffness * (length - rest_length);
    let [along, across] = if is_rest_length {
        [(stiffness * length + tension) / rest_length, tension / rest_length]
    } else {
        [stiffness, tension / length]
    };
    let normal = DMat3::from_cols(n * n.x, n * n.y, n * n.z);
    normal * along.max(0.0) + (DMat3::IDENTITY - normal) * across.max(0.0)
}

/// The bounds that vary are those of all springs but for those that do not, which loops over neighbours find: to rounding.
#[test]
fn varying_bounds_add_up_the_springs_one_by_one() {
    let mut vary = 0;
    for (case, size) in SIZES
        .into_iter()
        .enumerate()
        .flat_map(|(case, size)| (0..LAWS.len()).map(move |more| (case + more * SIZES.len(), size)))
    {
        let mut numbers = scene(case, size);
        numbers.gravity = [0.0; 3];
        let scene = numbers.scene();
        let model = Model::new(&scene);
        let positions = bent(&model, &scene);
        let at = at(&model, &positions);
        let mut sweep = Sweep::default();
        for force in model.forces().iter().filter(|force| force.has_varying_bounds()) {
            let [mut found, mut all, mut constant] = [(); 3].map(|()| vec![0.0; positions.len()]);
            let mut forces = Points::zeros(positions.len());
            for block in model.blocks() {
                let own = &mut forces.slice_mut(block);
                let bounds = &mut found[block.clone()];
                force.add_forces_and_varying_bounds(at, block, own, bounds, &mut sweep);
                force.add_stiffness_bounds(at, block, &mut all[block.clone()]);
                force.add_constant_bounds(at, block, &mut constant[block.clone()]);
            }
            let largest = all.iter().copied().fold(0.0, f64::max);
            for (particle, bound) in found.into_iter().enumerate() {
                let expected = all[particle] - constant[particle];
                let error = (bound - expected).abs();
                assert!(
                    error <= 1e-12 * largest,
                    "{case} {size:?}: particle {particle}: {bound}, {expected}"
                );
                vary += usize::from(bound > 0.0);
            }
        }
    }
    assert!(vary > 0, "no bound varies");
}

/// Pins that move and limits come between motion and forces, forces and velocities may be asked for between steps, and threads share
/// them: none of it changes a bit. Nor does it whether the state before is kept.
#[test]
fn one_pass_gives_the_bits_of_two() {
    let mut moving = SceneNumbers::default();
    moving.cloths[0].motion =
        Some(SineNumbers { axis: [0.0, 1.0, 0.0], amplitude: 0.02, frequency: 1.0, phase: 0.5 });
    let mut limited = SceneNumbers::default();
    limited.cloths[0].limit = Some("{ kind = \"cut-off\", strain = 1e-5 }");
    limited.cloths[0].height_axis = [0.0, -1.0, 0.0];
    let mut still = scene(0, (30, 40));
    still.cloths[0].pins = (0..1200).map(|particle| (particle % 30, particle / 30)).collect();
    let mut rubbing = scene(3, (140, 20));
    rubbing.cloths[0].has_friction = true;
    let others = [scene(1, (40, 30)), scene(3, (140, 20)), moving, limited, still, rubbing];
    for numbers in [SceneNumbers::default()].into_iter().chain(others) {
        let scene = numbers.scene();
        let model = Model::new(&scene);
        let mut start = model.initial_state(&scene);
        if model.memory_layers() > 0 {
            // So far that it slips.
            start.positions = bent(&model, &scene);
        }
        let step = 0.2 * block_stable_step(&model, &start).min(1e-3);
        let cases =
            [(1, false, 1), (1, false, 100), (1, true, 7), (2, false, 100), (2, false, 3), (3, true, 1)];
        let ends = cases.map(|(threads, is_kept, asked_every)| {
            let mut state = start.clone();
            let mut before = State::at_rest(Points::default());
            let mut method = CentralDifference::new(common::workers(threads));
            let (mut motions, mut velocities) = (Vec::new(), Points::default());
            for count in 1..=20 {
                match count % (2 * asked_every) {
                    0 => method.eval_forces(&model, &state),
                    asked if asked == asked_every => method.velocities(&model, &state, &mut velocities),
                    _ => (),
                }
                let to = StepTo { step, time: f64::from(count) * step, is_measured: count % 3 == 0 };
                let was = state.clone();
                let motion = method.step_to(&model, &mut state, is_kept.then_some(&mut before), to);
                let motion = motion.unwrap_or_else(|error| panic!("{error}"));
                assert!(to.is_measured || motion == Motion::default(), "what is not measured is zero");
                motions.push(motion);
                assert!(!is_kept || before == was, "step {count}");
                method.accept(&model, &mut state);
            }
            assert!(model.limits().is_empty() || state.limit_work != LimitWork::default());
            assert_eq!(model.memory_layers() == 0, state.memory.iter().all(|slip| *slip == 0.0));
            let hash = StateHash::new(&state.positions, &state.velocities);
            (hash, state.limit_work, state.memory, state.friction_loss, motions)
        });
        assert!(ends.iter().all(|end| *end == ends[0]), "{ends:?}");
    }
}

/// Friction, with clamps in the middle of rows that are worked on in two parts of different lengths, beside other cloth.
#[test]
fn friction_has_the_same_bits_by_any_blocks() {
    let clamped =
        |columns: Range<usize>| (0..2).flat_map(move |row| columns.clone().map(move |column| (column, row)));
    for (size, pins) in
        [((140, 9), 66..72), ((300, 6), 90..110), ((9, 5), 0..9), ((2, 40), 0..2), ((3, 3), 0..1)]
    {
        let mut numbers = scene(3, size);
        for (cloth, pins) in numbers.cloths.iter_mut().zip([None, Some(pins)]) {
            cloth.has_friction = true;
            cloth.pins = pins.map_or_else(|| cloth.pins.clone(), |pins| clamped(pins).collect());
        }
        let scene = numbers.scene();
        let model = Model::new(&scene);
        let mut state = model.initial_state(&scene);
        state.positions = bent(&model, &scene);
        CentralDifference::new(Workers::single()).accept(&model, &mut state);
        assert!(state.friction_loss > 0.0);
        let positions =
            state.positions.iter().map(|x| x * 1.01 + 0.003 * DVec3::Y * libm::sin(40.0 * x.x)).collect();
        let at = |model: &Model, blocks: &[Range<usize>]| {
            let mut forces = Points::zeros(state.positions.len());
            let mut sweep = Sweep::default();
            for block in blocks {
                for force in model.forces() {
                    let at = Configuration { memory: &state.memory, ..at(model, &positions) };
                    force.add_forces(at, block, &mut forces.slice_mut(block), &mut sweep);
                }
            }
            forces
        };
        let whole = at(&model, model.blocks());
        let mut rows = rows(&model);
        assert_eq!(at(&model, &rows), whole, "{size:?}");
        rows.reverse();
        assert_eq!(at(&model, &rows), whole, "{size:?} backwards");
        for instructions in InstructionSet::available() {
            let other = Model::with_instructions(&scene, instructions);
            assert_eq!(at(&other, other.blocks()), whole, "{size:?} with {}", instructions.name());
        }
    }
}
