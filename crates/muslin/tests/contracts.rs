//! What types and functions promise to whoever calls them from outside.

mod common;

use common::{
    AirNumbers, ClothNumbers, LINEAR, SceneNumbers, SineNumbers, StepNumbers, WindNumbers, finish,
    model_and_state,
};
use muslin::force::{Configuration, StrainSums, Sweep};
use muslin::integrate::StepError;
use muslin::integrate::{CentralDifference, Integrator, StepTo, Workers};
use muslin::observe::{EnergyLedger, Observer, Recorder};
use muslin::{Model, Points, Simulation, SimulationError, State, StepSummary};

/// A cloth of 4 x 3 particles of `mass` [kg] and `drag` [kg/s].
fn small(mass: f64, drag: f64) -> SceneNumbers {
    SceneNumbers {
        cloths: vec![ClothNumbers {
            columns: 4,
            rows: 3,
            pins: vec![(0, 0)],
            mass,
            drag,
            ..ClothNumbers::default()
        }],
        ..SceneNumbers::default()
    }
}

/// What a method says of a state does not depend on how it came there, nor on what it looked at before.
#[test]
fn a_method_answers_for_the_state_that_it_came_to() {
    let airs = vec![AirNumbers::steady([3.0, 0.0, 1.0], [1.0, 0.1])];
    for numbers in [small(0.002, 0.1), SceneNumbers { airs, ..small(0.002, 0.1) }] {
        let (model, mut state) = model_and_state(&numbers);
        let mut method = CentralDifference::new(Workers::single());
        for count in 1..=12 {
            let before = state.clone();
            let (step, time) = (1e-3, f64::from(count) * 1e-3);
            if count % 3 == 0 {
                let to = StepTo { step, time, is_measured: false };
                method.step_to(&model, &mut state, None, to).unwrap();
            } else {
                method.move_by(&model, &mut state, step, time).unwrap();
            }
            let new = || CentralDifference::new(Workers::single());
            assert_eq!(
                method.eval_error(&model, &before, &state),
                new().eval_error(&model, &before, &state),
                "step {count}"
            );
            if count % 4 == 0 {
                method.move_by(&model, &mut state, step, time + 1e-4).unwrap();
            }
            assert_eq!(method.eval_stable_step(&model, &state), new().eval_stable_step(&model, &state));
            let mut found = [Points::default(), Points::default()];
            method.velocities(&model, &state, &mut found[0]);
            new().velocities(&model, &state, &mut found[1]);
            assert_eq!(found[0], found[1], "step {count}");
        }
    }
}

/// A method serves any model: nothing of the last one is left, even if the next has as many particles.
#[test]
fn one_method_can_step_several_models() {
    let (light, heavy) = (model_and_state(&small(0.002, 0.0)), model_and_state(&small(0.2, 0.5)));
    let mut shared = CentralDifference::new(Workers::single());
    let mut light_state = light.1.clone();
    for _ in 0..3 {
        shared.step(&light.0, &mut light_state, 1e-3).unwrap();
    }
    let [mut found, mut expected] = [heavy.1.clone(), heavy.1];
    for _ in 0..3 {
        shared.step(&heavy.0, &mut found, 1e-3).unwrap();
    }
    let mut own = CentralDifference::new(Workers::single());
    for _ in 0..3 {
        own.step(&heavy.0, &mut expected, 1e-3).unwrap();
    }
    assert_eq!(found, expected);
}

fn resumed(state: State, frame_index: u64) -> Result<Simulation, SimulationError> {
    let scene = small(0.002, 0.002).scene();
    Simulation::resume(&scene, Simulation::integrator(&scene, Workers::single()), state, frame_index)
}

#[test]
fn a_run_goes_on_only_from_a_state_that_it_can_have_reached() {
    let reason = |state: State, frame_index: u64| match resumed(state, frame_index) {
        Ok(_) => panic!("accepted"),
        Err(error) => error.to_string(),
    };
    let state = State::at_rest(Points::zeros(12));
    assert!(resumed(state.clone(), 0).is_ok());
    assert_eq!(
        reason(State::at_rest(Points::zeros(9)), 0),
        "a run cannot go on from this state: it has 9 positions, but the scene has 12 particles"
    );
    let mut short = state.clone();
    short.velocities = Points::zeros(13);
    assert_eq!(
        reason(short, 0),
        "a run cannot go on from this state: it has 13 velocities, but the scene has 12 particles"
    );
    assert_eq!(
        reason(state.clone(), 7),
        "a run cannot go on from this state: it is at 0 s, but frame 7 is at 0.14 s"
    );
    assert_eq!(
        reason(state, 99),
        "a run cannot go on from this state: it is of frame 99, but the last is 50"
    );
}

#[test]
fn a_failed_run_stays_failed_and_a_finished_one_finished() {
    let unstable = SceneNumbers {
        frame_intervals: 1000,
        steps_per_frame: 1,
        allow_unstable: true,
        ..small(0.002, 0.002)
    };
    let mut simulation = unstable.simulation();
    let failure =
        (0..1000).find_map(|_| simulation.advance(&mut []).err()).expect("20 ms are beyond the stable step");
    let StepError::NotFinite { time, .. } = failure else { panic!("{failure}") };
    assert_eq!(simulation.advance(&mut []), Err(failure));
    assert!(time <= simulation.frame().state.time);

    let mut simulation = SceneNumbers { frame_intervals: 2, ..small(0.002, 0.002) }.simulation();
    finish(&mut simulation, &mut Recorder::default());
    let last = simulation.frame().state.clone();
    assert_eq!(simulation.advance(&mut []), Ok(()));
    assert_eq!((simulation.frame().index, simulation.frame().state), (2, &last));
}

#[test]
#[should_panic(expected = "call `Simulation::observe`")]
fn a_ledger_must_see_the_first_frame() {
    let wind = WindNumbers {
        amplitude: 0.01,
        angular_frequency: 1.0,
        phase: 0.0,
        direction: [1.0, 0.0, 0.0],
        noise: [0.0; 2],
    };
    let mut simulation = SceneNumbers { winds: vec![wind], ..small(0.002, 0.002) }.simulation();
    let _ = simulation.advance(&mut [&mut EnergyLedger::default() as &mut dyn Observer]);
}

/// Finds after every step what a summary has of all of them.
struct EveryStep {
    largest_strains: [f64; 3],
    drag_loss: f64,
    refused: u32,
}

impl Observer for EveryStep {
    fn step(&mut self, model: &Model, state: &State) {
        let particles = model.particles();
        let (positions, velocities) = (&state.positions, &state.velocities);
        let at = Configuration { time: state.time, particles, positions, velocities, memory: &state.memory };
        let mut sums = [StrainSums::default(); 3];
        for force in model.forces() {
            force.add_strains(at, &mut sums);
        }
        for (largest, sums) in self.largest_strains.iter_mut().zip(sums) {
            *largest = largest.max(sums.max);
        }
        let free = (0..particles.len()).filter(|&particle| !particles.pinned()[particle]);
        let powers = free.map(|free| particles.drags()[free] * velocities.get(free).length_squared());
        self.drag_loss += state.last_step * powers.sum::<f64>();
    }

    fn refused_step(&mut self, _model: &Model, _state: &State) {
        self.refused += 1;
    }
}

/// The summary of all steps.
#[derive(Default)]
struct Total(StepSummary);

impl Observer for Total {
    fn wants_summary(&self) -> bool {
        true
    }

    fn summary(&mut self, summary: &StepSummary) {
        self.0 = self.0.and(*summary);
    }
}

/// Advances `simulation` as far as it goes; how it ended, and how many steps were refused. If it `has_summary`, that must be what every
/// step has.
fn advance_to_end(
    simulation: &mut Simulation,
    has_summary: bool,
    case: &str,
) -> (Result<(), StepError>, u32) {
    let mut total = Total::default();
    let mut every = EveryStep { largest_strains: [f64::NEG_INFINITY; 3], drag_loss: 0.0, refused: 0 };
    let mut result = Ok(());
    while result.is_ok() && !simulation.is_finished() {
        result = if has_summary {
            simulation.advance(&mut [&mut total, &mut every])
        } else {
            simulation.advance(&mut [&mut every])
        };
    }
    if has_summary {
        let Total(StepSummary { max_strains, drag_loss }) = total;
        assert_eq!(max_strains, every.largest_strains, "{case}");
        assert!(0.0 < drag_loss, "{case}");
        // Thousands of terms, all positive, in two orders.
        let is_same = (drag_loss - every.drag_loss).abs() <= 1e-12 * every.drag_loss;
        assert!(is_same, "{case}: {drag_loss} J for {} J", every.drag_loss);
    }
    (result, every.refused)
}

/// A cloth of few `columns`.
fn narrow(columns: usize) -> ClothNumbers {
    ClothNumbers { columns, rows: 6, pins: vec![(0, 0)], ..ClothNumbers::default() }
}

/// Rows shorter and longer than vectors, one cloth at a time, so that no other has longer springs.
#[test]
fn a_summary_is_that_of_rows_of_any_length() {
    for columns in [1, 2, 5, 8, 9, 17, 33, 129] {
        let numbers = SceneNumbers {
            frame_intervals: 5,
            cloths: vec![narrow(columns)],
            step_rule: StepNumbers::Adaptive,
            ..SceneNumbers::default()
        };
        let (result, _) = advance_to_end(&mut numbers.simulation(), true, &format!("{columns} columns"));
        assert_eq!(result, Ok(()));
    }
}

/// Whether a step finds forces where it begins or where it ends, is refused, shared by threads or ends in an error: a summary has
/// the largest strains after any of the steps that were taken, to the bit, and what drag took. Motion has the same bits without.
#[test]
fn a_summary_is_that_of_every_step() {
    let wide = || ClothNumbers { columns: 150, rows: 20, drag: 0.02, ..ClothNumbers::default() };
    let tangent = ["law = \"tangent\", strain_scale = 0.06", LINEAR, LINEAR];
    let stiffening = ClothNumbers { laws: tangent, ..ClothNumbers::default() };
    let measured = ClothNumbers { is_measured: true, has_friction: true, ..ClothNumbers::default() };
    let motion = SineNumbers { axis: [1.0, 0.0, 0.0], amplitude: 0.05, frequency: 3.0, phase: 0.0 };
    let limited = ClothNumbers {
        limit: Some("{ kind = \"cut-off\", strain = 0.01 }"),
        motion: Some(motion),
        ..ClothNumbers::default()
    };
    let cases = [
        ("springs", vec![wide(), narrow(1)], [0.0; 2], false),
        ("springs that stiffen", vec![stiffening, wide()], [0.0; 2], false),
        ("measured, with friction", vec![measured, wide()], [0.0; 2], false),
        ("limits and moving pins", vec![limited, wide()], [0.0; 2], false),
        ("in air", vec![ClothNumbers::default(), wide()], [1.0, 0.1], false),
        ("unstable", vec![wide()], [0.0; 2], true),
        ("unstable in air", vec![wide()], [1.0, 0.1], true),
    ];
    let mut refused = 0;
    for (name, cloths, coefficients, is_unstable) in cases {
        let airs = match coefficients {
            [0.0, 0.0] => Vec::new(),
            _ => vec![AirNumbers::steady([3.0, 0.0, 1.0], coefficients)],
        };
        let rules = [StepNumbers::Constant, StepNumbers::Adaptive, StepNumbers::Tolerance(1e-5)];
        for step_rule in rules.into_iter().filter(|rule| !is_unstable || *rule == StepNumbers::Constant) {
            let numbers = SceneNumbers {
                frame_intervals: if is_unstable { 200 } else { 6 },
                frame_rate: if is_unstable { 15.0 } else { 50.0 },
                steps_per_frame: if is_unstable { 3 } else { 20 },
                allow_unstable: is_unstable,
                step_rule,
                cloths: cloths.clone(),
                airs: airs.clone(),
                ..SceneNumbers::default()
            };
            let mut ends = Vec::new();
            for (threads, has_summary) in [(1, true), (2, true), (1, false)] {
                let mut simulation = common::simulation(&numbers.scene(), common::workers(threads));
                let case = format!("{name}, {step_rule:?}, {threads} threads");
                let (result, refusals) = advance_to_end(&mut simulation, has_summary, &case);
                assert_eq!(result.is_err(), is_unstable, "{case}");
                refused += refusals;
                ends.push(simulation.frame().state.positions.clone());
            }
            assert!(is_unstable || ends.iter().all(|end| *end == ends[0]), "{name}, {step_rule:?}");
        }
    }
    assert!(0 < refused, "some steps are taken back");
}

/// Every spring is shown once: as many as are counted, no pair of particles twice in a family, unstretched in the flat cloth.
#[test]
fn springs_are_shown_as_they_are_counted() {
    let (model, state) = model_and_state(&small(0.002, 0.0));
    let mut springs = Vec::new();
    for force in model.forces() {
        force.visit_springs(&mut |spring| springs.push(spring));
    }
    let mut pairs: Vec<_> = springs.iter().map(|spring| (spring.family as usize, spring.particles)).collect();
    let counts = [0, 1, 2].map(|family| pairs.iter().filter(|pair| pair.0 == family).count() as u64);
    assert_eq!(counts, model.spring_counts());
    assert!(pairs.is_sorted_by_key(|pair| pair.0), "families follow each other");
    pairs.sort_unstable();
    pairs.dedup();
    assert_eq!(pairs.len(), springs.len());
    for spring in springs {
        let [own, other] = spring.particles;
        assert!(own < other);
        let length = state.positions.get(own).distance(state.positions.get(other));
        // Rounding of coordinates up to 1 m.
        assert!((length - spring.rest_length).abs() < 1e-14, "{spring:?}");
    }
}

/// Overwriting is adding to zero, to the bit: also for particles at edges, whose masses are others, and for pins.
#[test]
fn forces_that_are_set_are_those_added_to_zero() {
    let cloth = ClothNumbers { columns: 13, rows: 11, is_measured: true, ..ClothNumbers::default() };
    let (model, state) =
        model_and_state(&SceneNumbers { cloths: vec![cloth.clone(), cloth], ..SceneNumbers::default() });
    let at = Configuration {
        time: 0.0,
        particles: model.particles(),
        positions: &state.positions,
        velocities: &state.velocities,
        memory: &state.memory,
    };
    let count = state.positions.len();
    for force in model.forces() {
        let (mut set, mut added) = (Points::zeros(count), Points::zeros(count));
        set.fill(f64::NAN);
        for block in model.blocks() {
            force.set_forces(at, block, &mut set.slice_mut(block), &mut Sweep::default());
            force.add_forces(at, block, &mut added.slice_mut(block), &mut Sweep::default());
        }
        assert_eq!(set, added, "{force:?}");
    }
}
