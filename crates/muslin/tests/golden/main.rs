//! The same scene gives the same bits: in every build, on any number of threads, watched or not, resumed or not.
//!
//! `hashes.txt` holds the hash of the last frame of every scene here and of every file in the scenes folder. A change
//! of the method changes them; then look at the motion first, and say in the changelog by how much it changed.

#[path = "../common/mod.rs"]
mod common;

use common::{
    AirNumbers, CURVE, ClothNumbers, SceneNumbers, SineNumbers, StepNumbers, WindNumbers, assert_golden,
    finish, simulation, workers,
};
use muslin::integrate::Workers;
use muslin::observe::{Recorder, StateHash};
use muslin::{Scene, Simulation};

/// The cloth of the paper's Fig. 3 for one second.
fn hanging() -> SceneNumbers {
    SceneNumbers { frame_intervals: 60, frame_rate: 60.0, ..SceneNumbers::default() }
}

/// Held along an edge, in two winds.
fn flag() -> SceneNumbers {
    let wind = |amplitude, angular_frequency, direction| WindNumbers {
        amplitude,
        angular_frequency,
        phase: 0.6,
        direction,
        noise: [0.0; 2],
    };
    SceneNumbers {
        frame_intervals: 60,
        frame_rate: 60.0,
        winds: vec![wind(0.02, 0.4, [1.0, 0.1, 0.2]), wind(0.01, 7.0, [0.0, 0.0, 1.0])],
        cloths: vec![ClothNumbers {
            columns: 13,
            rows: 9,
            width: 1.2,
            height: 0.8,
            height_axis: [0.0, 1.0, 0.0],
            pins: (0..9).map(|row| (0, row)).collect(),
            ..ClothNumbers::default()
        }],
        ..SceneNumbers::default()
    }
}

/// Hung by two corners that move, in wind.
fn shaken() -> SceneNumbers {
    SceneNumbers {
        winds: flag().winds,
        cloths: vec![ClothNumbers {
            height_axis: [0.0, -1.0, 0.0],
            motion: Some(SineNumbers { axis: [0.0, 1.0, 3.0], amplitude: 0.1, frequency: 3.0, phase: 0.2 }),
            ..ClothNumbers::default()
        }],
        ..SceneNumbers::default()
    }
}

/// Falling from the horizontal, its springs held by a limit.
fn limited(limit: &'static str) -> SceneNumbers {
    let mut numbers = hanging();
    numbers.cloths[0].limit = Some(limit);
    numbers
}

const CUT_OFF: &str = "{ kind = \"cut-off\", strain = 0.05, shear_strain = 0.2 }";
const PROJECTION: &str = "{ kind = \"arctangent-projection\" }";

/// The same in air that moves, with gusts of two winds.
fn flutter() -> SceneNumbers {
    let gust = WindNumbers {
        amplitude: 0.5,
        angular_frequency: 7.0,
        phase: 0.6,
        direction: [0.0, 0.1, 1.0],
        noise: [0.3, 0.2],
    };
    let steady = AirNumbers::steady([3.0, 0.0, 0.5], [1.5, 0.05]);
    SceneNumbers {
        winds: Vec::new(),
        airs: vec![AirNumbers { gust, ..steady.clone() }, AirNumbers { velocity: [1.0, 0.0, 0.0], ..steady }],
        ..flag()
    }
}

/// Free, with drag, started as printed.
fn free_fall() -> SceneNumbers {
    SceneNumbers {
        as_printed_start: true,
        cloths: vec![ClothNumbers { columns: 5, rows: 4, pins: vec![], ..ClothNumbers::default() }],
        ..SceneNumbers::default()
    }
}

/// A small sheet of measured cloth with all kinds of internal friction and damping, let go from the horizontal.
fn lossy() -> SceneNumbers {
    let cloth = ClothNumbers {
        columns: 13,
        rows: 11,
        width: 0.24,
        height: 0.22,
        pins: vec![(0, 0), (12, 0)],
        mass: 8e-5,
        drag: 0.0,
        stiffnesses: [60.0, 3.0, 1.0],
        dampings: [2e-3, 3e-4, 1e-4],
        has_friction: true,
        is_measured: true,
        ..ClothNumbers::default()
    };
    SceneNumbers {
        frame_intervals: 30,
        frame_rate: 60.0,
        step_rule: StepNumbers::Adaptive,
        cloths: vec![cloth],
        ..SceneNumbers::default()
    }
}

/// A thread with dashpots.
fn damped() -> SceneNumbers {
    let mut numbers = pendulum();
    numbers.cloths[0].dampings = [1e-3, 0.0, 1e-4];
    numbers
}

/// A thread, with forces divided by the rest length.
fn pendulum() -> SceneNumbers {
    SceneNumbers {
        cloths: vec![ClothNumbers {
            columns: 20,
            rows: 1,
            pins: vec![(0, 0)],
            rest_length_direction: true,
            stiffnesses: [200.0, 0.0, 1.0],
            ..ClothNumbers::default()
        }],
        ..SceneNumbers::default()
    }
}

/// Two cloths; the first has several blocks for threads to share, the last of them shorter than the others.
fn large(airs: Vec<AirNumbers>) -> SceneNumbers {
    let large = ClothNumbers {
        columns: 150,
        rows: 100,
        width: 15.0,
        height: 11.0,
        pins: vec![(0, 0), (149, 0), (70, 50)],
        ..ClothNumbers::default()
    };
    let small = ClothNumbers { pins: vec![(3, 4)], origin: [0.0, 2.0, 0.0], ..ClothNumbers::default() };
    SceneNumbers {
        frame_intervals: 3,
        steps_per_frame: 10,
        winds: flag().winds,
        airs,
        cloths: vec![large, small],
        ..SceneNumbers::default()
    }
}

/// With steps of another rule.
fn with_rule(step_rule: StepNumbers, numbers: SceneNumbers) -> SceneNumbers {
    SceneNumbers { step_rule, ..numbers }
}

/// Structural springs of the tangent law.
fn stiffening(mut numbers: SceneNumbers) -> SceneNumbers {
    numbers.cloths[0].laws[0] = "law = \"tangent\", strain_scale = 0.06";
    numbers
}

/// A mass on a spring that stiffens, without drag, which frames cut steps of in two.
fn cut_steps() -> SceneNumbers {
    let mut numbers = stiffening(pendulum());
    let cloth = &mut numbers.cloths[0];
    (cloth.columns, cloth.drag, cloth.rest_length_direction) = (2, 0.0, false);
    let gravity = [20.0, 0.0, 0.0];
    with_rule(
        StepNumbers::Adaptive,
        SceneNumbers { gravity, frame_rate: 270.0, frame_intervals: 270, ..numbers },
    )
}

/// All rules but the constant one: steps that stability, the energy and a tolerance choose, some of them refused.
fn adaptive() -> [(&'static str, SceneNumbers); 6] {
    let short = |numbers| SceneNumbers { frame_intervals: 40, ..stiffening(numbers) };
    [
        ("inline-adaptive", with_rule(StepNumbers::Adaptive, stiffening(hanging()))),
        ("inline-adaptive-linear", with_rule(StepNumbers::Adaptive, flag())),
        ("inline-adaptive-shaken", with_rule(StepNumbers::Adaptive, stiffening(shaken()))),
        ("inline-adaptive-cut", cut_steps()),
        ("inline-adaptive-limit", with_rule(StepNumbers::Adaptive, stiffening(limited(CUT_OFF)))),
        ("inline-tolerance", with_rule(StepNumbers::Tolerance(1e-5), short(flutter()))),
    ]
}

fn last_hash(simulation: &Simulation) -> StateHash {
    StateHash::new(&simulation.frame().state.positions, simulation.frame().velocities)
}

/// The hash of the last frame of an unobserved run.
fn hash(scene: &Scene, workers: Workers) -> StateHash {
    let mut simulation = simulation(scene, workers);
    while !simulation.is_finished() {
        simulation.advance(&mut []).unwrap_or_else(|error| panic!("{error}"));
    }
    last_hash(&simulation)
}

#[test]
fn hanging_has_the_recorded_bits() {
    assert_golden("inline-hanging", hash(&hanging().scene(), Workers::single()));
}

#[test]
fn flag_has_the_recorded_bits() {
    assert_golden("inline-flag", hash(&flag().scene(), Workers::single()));
}

#[test]
fn shaken_has_the_recorded_bits() {
    assert_golden("inline-shaken", hash(&shaken().scene(), Workers::single()));
}

#[test]
fn limits_have_the_recorded_bits() {
    assert_golden("inline-cut-off", hash(&limited(CUT_OFF).scene(), Workers::single()));
    assert_golden("inline-projection", hash(&limited(PROJECTION).scene(), Workers::single()));
}

#[test]
fn flutter_has_the_recorded_bits() {
    assert_golden("inline-flutter", hash(&flutter().scene(), Workers::single()));
}

#[test]
fn free_fall_has_the_recorded_bits() {
    assert_golden("inline-free-fall", hash(&free_fall().scene(), Workers::single()));
}

#[test]
fn pendulum_has_the_recorded_bits() {
    assert_golden("inline-pendulum", hash(&pendulum().scene(), Workers::single()));
}

#[test]
fn friction_and_damping_have_the_recorded_bits() {
    assert_golden("inline-lossy", hash(&lossy().scene(), Workers::single()));
    assert_golden("inline-damped", hash(&damped().scene(), Workers::single()));
}

#[test]
fn laws_in_closed_form_have_the_recorded_bits() {
    let laws = [
        ("inline-tangent", "law = \"tangent\", strain_scale = 0.2"),
        ("inline-arctangent", "law = \"arctangent-force\""),
    ];
    for (name, law) in laws {
        let mut numbers = hanging();
        numbers.cloths[0].laws = [law; 3];
        assert_golden(name, hash(&numbers.scene(), Workers::single()));
    }
}

#[test]
fn curve_has_the_recorded_bits() {
    let mut numbers = hanging();
    numbers.cloths[0].laws = [CURVE; 3];
    assert_golden("inline-curve", hash(&numbers.scene(), Workers::single()));
}

#[test]
fn adaptive_steps_have_the_recorded_bits() {
    for (name, numbers) in adaptive() {
        assert_golden(name, hash(&numbers.scene(), Workers::single()));
    }
}

/// The scenes above are what they are called.
#[test]
fn steps_are_refused_and_cut() {
    let [.., (_, tolerance)] = adaptive();
    let mut recorder = Recorder::default();
    finish(&mut simulation(&tolerance.scene(), Workers::single()), &mut recorder);
    assert!(0 < recorder.steps().rejected, "{:?}", recorder.steps());
    recorder = Recorder::default();
    finish(&mut simulation(&cut_steps().scene(), Workers::single()), &mut recorder);
    let steps = recorder.steps();
    assert!(steps.smallest.unwrap() < 1e-2 * steps.largest.unwrap(), "{steps:?}");
}

#[test]
fn adaptive_bits_do_not_depend_on_threads() {
    let numbers = stiffening(large(flutter().airs));
    assert_bits_on_threads(
        "inline-adaptive-large",
        &with_rule(StepNumbers::Adaptive, numbers.clone()).scene(),
    );
    assert_bits_on_threads(
        "inline-tolerance-large",
        &with_rule(StepNumbers::Tolerance(1e-5), numbers).scene(),
    );
}

#[test]
fn bits_do_not_depend_on_threads() {
    assert_bits_on_threads("inline-large", &large(Vec::new()).scene());
}

#[test]
fn bits_in_air_do_not_depend_on_threads() {
    assert_bits_on_threads("inline-large-flutter", &large(flutter().airs).scene());
}

/// Bending reaches over two rows, so that rows at the ends of a block have neighbours in the next.
#[test]
fn bits_of_measured_cloth_do_not_depend_on_threads() {
    let mut numbers = large(Vec::new());
    let cloth = &mut numbers.cloths[0];
    (cloth.is_measured, cloth.laws[0]) = (true, "law = \"tangent\", strain_scale = 0.06");
    assert_bits_on_threads("inline-large-measured", &with_rule(StepNumbers::Adaptive, numbers).scene());
}

/// Elements across the border of two blocks are evaluated for both, and their memory is brought up to date by one thread.
#[test]
fn bits_of_friction_do_not_depend_on_threads() {
    let mut numbers = large(Vec::new());
    let cloth = &mut numbers.cloths[0];
    (cloth.is_measured, cloth.has_friction, cloth.dampings) = (true, true, [1e-3, 1e-4, 1e-5]);
    assert_bits_on_threads("inline-large-lossy", &with_rule(StepNumbers::Adaptive, numbers).scene());
}

fn assert_bits_on_threads(name: &str, scene: &Scene) {
    assert!(3 <= simulation(scene, Workers::single()).model().blocks().len(), "blocks to share");
    let mut recorders = [1, 2, 3].map(|threads| {
        let mut recorder = Recorder::default();
        finish(&mut simulation(scene, workers(threads)), &mut recorder);
        recorder
    });
    let [one, two, three] = &mut recorders;
    assert_eq!(one.frames(), two.frames());
    assert_eq!(one.frames(), three.frames());
    assert_eq!(one.max_strains(), two.max_strains());
    let last = one.frames().last().map(|frame| frame.hash);
    assert_golden(name, last.unwrap_or_else(|| panic!("no frames")));
}

#[test]
fn bits_do_not_depend_on_observers() {
    for numbers in [flag()].into_iter().chain(adaptive().map(|(_, numbers)| numbers)) {
        let scene = numbers.scene();
        let mut recorder = Recorder::default();
        finish(&mut simulation(&scene, Workers::single()), &mut recorder);
        let watched = recorder.frames().last().map(|frame| frame.hash);
        assert_eq!(watched, Some(hash(&scene, Workers::single())));
    }
}

/// Stopped at every tenth frame, state and record given to a new simulation each time.
#[test]
fn bits_do_not_depend_on_resuming() {
    let constant = [flag(), flutter(), free_fall(), shaken(), limited(CUT_OFF), damped(), lossy()];
    for numbers in constant.into_iter().chain(adaptive().map(|(_, numbers)| numbers)) {
        let scene = numbers.scene();
        let mut whole = Recorder::default();
        finish(&mut simulation(&scene, Workers::single()), &mut whole);

        let mut resumed = Recorder::default();
        let mut part = simulation(&scene, Workers::single());
        part.observe(&mut [&mut resumed]);
        while !part.is_finished() {
            part.advance(&mut [&mut resumed]).unwrap();
            let frame = part.frame();
            if frame.index.is_multiple_of(10) {
                let (index, state, frames) = (frame.index, frame.state.clone(), resumed.frames().to_vec());
                let (steps, strains) = (*resumed.steps(), resumed.max_strains());
                part = Simulation::resume(
                    &scene,
                    Simulation::integrator(&scene, Workers::single()),
                    state,
                    index,
                )
                .unwrap_or_else(|error| panic!("{error}"));
                resumed = Recorder::resume(part.model(), part.frame().state, steps, strains, frames);
            }
        }
        assert_eq!(whole.frames(), resumed.frames());
        assert_eq!((whole.steps(), whole.max_strains()), (resumed.steps(), resumed.max_strains()));
    }
}
