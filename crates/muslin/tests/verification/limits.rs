//! Limits against super-elongation: what they hold, what they cost, and how they depend on the step.

use std::f64::consts::PI;

use muslin::observe::{EnergyTerms, Recorder, relative_residual};

use crate::common::{ClothNumbers, SceneNumbers, SineNumbers, finish, max_distance};

const GRAVITY: f64 = 9.81;
const PROJECTION: &str = "{ kind = \"arctangent-projection\" }";

/// Masses of 1 kg one below the other, `rest_length` [m] apart; the first of `count` is held.
fn hanging_chain(
    count: usize,
    [rest_length, stiffness, drag]: [f64; 3],
    limit: Option<&'static str>,
) -> SceneNumbers {
    SceneNumbers {
        gravity: [0.0, -GRAVITY, 0.0],
        cloths: vec![ClothNumbers {
            columns: 1,
            rows: count,
            width: 0.0,
            height: rest_length * (count - 1) as f64,
            origin: [0.0; 3],
            height_axis: [0.0, -1.0, 0.0],
            pins: vec![(0, 0)],
            mass: 1.0,
            drag,
            stiffnesses: [stiffness, 0.0, 0.0],
            limit,
            ..ClothNumbers::default()
        }],
        ..SceneNumbers::default()
    }
}

fn recorded(numbers: &SceneNumbers) -> Recorder {
    let mut recorder = Recorder::default();
    finish(&mut numbers.simulation(), &mut recorder);
    recorder
}

/// The largest structural strain in the last frame.
fn last_strain(numbers: &SceneNumbers) -> f64 {
    let recorder = recorded(numbers);
    let last = recorder.frames()[recorder.frames().len() - 1].strains[0];
    last.expect("structural springs").max
}

/// Half of the drag of the projected mass, relative to its mass [1/s].
const DECAY: f64 = 15.0;

/// A mass under a spring of 10 mm that gives way by 9.81 % to it, for two seconds: its swing decays by e⁻³⁰.
fn projected(steps_per_frame: u32) -> SceneNumbers {
    let chain = hanging_chain(2, [0.01, 1e4, 2.0 * DECAY], Some(PROJECTION));
    SceneNumbers { frame_intervals: 200, frame_rate: 100.0, steps_per_frame, ..chain }
}

/// Strain [1] at which that mass rests, for steps per hundredth of a second: 5 ms to 50 µs.
///
/// From direct integration of equation (5) with the same mass, spring and drag and the same correction, in NumPy.
const PROJECTED: [(u32, f64); 7] = [
    (2, 0.04331820343),
    (5, 0.02386759158),
    (10, 0.01149709224),
    (20, 0.003750836352),
    (50, 0.0006364347452),
    (100, 0.0001602233543),
    (200, 4.01365628e-05),
];

/// Ten digits are given.
#[test]
fn a_projected_spring_rests_where_direct_integration_says() {
    for (steps_per_frame, strain) in PROJECTED {
        let found = last_strain(&projected(steps_per_frame));
        assert!((found / strain - 1.0).abs() < 2e-9, "{found} for {strain}, {steps_per_frame} steps");
    }
}

/// For small strains y = 0.3π x, so that at rest each step lets the mass fall by as much as the correction lifts it:
///
/// ```text
/// x = 0.3π (x + h² (g − k x / m) / (1 + c))        c = k_d h / 2m
/// x = g / (k/m + (1 + c) (1 / 0.3π − 1) / h²)
/// ```
///
/// The next term of the arctangent, (5πe)² / 3 of y, counts 1 / (1 − 0.3π) times.
#[test]
fn a_projected_spring_follows_its_law_of_small_strains() {
    for (steps_per_frame, _) in &PROJECTED[4..] {
        let numbers = projected(*steps_per_frame);
        let h = numbers.step();
        let stiffening = (1.0 + DECAY * h) * (1.0 / (0.3 * PI) - 1.0) / (h * h);
        let expected = GRAVITY / (1e4 + stiffening) / 0.01;
        let found = last_strain(&numbers);
        let higher = (5.0 * PI * expected).powi(2) / 3.0 / (1.0 - 0.3 * PI);
        assert!((found / expected - 1.0).abs() < 2.0 * higher, "{found} for {expected}");
    }
}

/// The same load gives any strain at all: a tenth or less with each tenth of the step.
#[test]
fn projection_depends_on_the_step() {
    let strains = [2, 20, 200].map(|steps_per_frame| last_strain(&projected(steps_per_frame)));
    assert!(strains.windows(2).all(|pair| pair[1] < 0.1 * pair[0]), "{strains:?}");
    assert_eq!(projected(2).scene().warnings().len(), 1);
}

/// Ten masses whose springs would stretch by up to 90 %, held to 10 %.
fn cut_chain(passes: u32, steps_per_frame: u32) -> SceneNumbers {
    let limit = match passes {
        1 => "{ kind = \"cut-off\", strain = 0.1, passes = 1 }",
        _ => "{ kind = \"cut-off\", strain = 0.1 }",
    };
    let chain = hanging_chain(11, [0.1, 1e3, 20.0], Some(limit));
    SceneNumbers { frame_intervals: 100, frame_rate: 25.0, steps_per_frame, ..chain }
}

/// At rest each step lets every mass fall by g h² less what its springs hold, and the passes lift it again. What they
/// shorten a spring by, in all, is 2 n g h² at most, with n masses below it: half of that moves the mass above down, the
/// rest of what this one's spring lifts. By so much a spring may be too long in the end, since after it the springs beside it
/// lengthen it by half of what they are shortened.
#[test]
fn a_cut_off_holds_a_chain_at_its_strain() {
    for passes in [1, 8] {
        for steps_per_frame in [40, 80] {
            let numbers = cut_chain(passes, steps_per_frame);
            let excess = last_strain(&numbers) - 0.1;
            let bound = 2.0 * 10.0 * GRAVITY * numbers.step().powi(2) / 0.1;
            assert!((-1e-12..bound).contains(&excess), "{excess:e} of {bound:e} with {passes} passes");
            if passes == 8 {
                assert!(excess < 0.2 * bound, "more passes leave less: {excess:e} of {bound:e}");
            }
        }
    }
}

/// What is too long falls as the step squared: where it is at rest, a cut-off converges.
#[test]
fn excess_of_a_cut_off_falls_as_the_step_squared() {
    let [coarse, fine] = [40, 80].map(|steps| last_strain(&cut_chain(1, steps)) - 0.1);
    assert!(((coarse / fine).log2() - 2.0).abs() < 0.1, "{coarse:e} and {fine:e}");
}

/// The cloth of Fig. 3, whose structural springs stretch by more than a fifth without a limit.
fn hanging(steps_per_frame: u32, limit: Option<&'static str>) -> SceneNumbers {
    let cloth = ClothNumbers { limit, ..ClothNumbers::default() };
    SceneNumbers {
        frame_intervals: 60,
        frame_rate: 60.0,
        steps_per_frame,
        cloths: vec![cloth],
        ..SceneNumbers::default()
    }
}

fn last_positions(numbers: &SceneNumbers) -> muslin::Points {
    let mut simulation = numbers.simulation();
    finish(&mut simulation, &mut Recorder::default());
    simulation.frame().state.positions.clone()
}

/// A limit that is never reached changes no bit.
#[test]
fn an_idle_cut_off_changes_nothing() {
    let idle = last_positions(&hanging(16, Some("{ kind = \"cut-off\", strain = 0.5, shear_strain = 0.9 }")));
    assert_eq!(idle, last_positions(&hanging(16, None)));
}

/// The largest strain over all steps, after the limit: within a fifth of it, where there is none it is twice as large.
#[test]
fn a_cut_off_holds_a_falling_sheet() {
    let limit = Some("{ kind = \"cut-off\", strain = 0.1, shear_strain = 0.3 }");
    let free = recorded(&hanging(16, None)).max_strains()[0].unwrap();
    let cut = recorded(&hanging(16, limit)).max_strains()[0].unwrap();
    assert!(free > 0.2, "{free}");
    assert!(cut < 0.12, "{cut}");
}

/// Where a cut-off acts, the method is of first order only: a spring meets its limit somewhere within a step, and from
/// there on it is wrong by the rest of that step.
#[test]
fn a_cut_off_that_acts_makes_the_method_first_order() {
    let cut_off = Some("{ kind = \"cut-off\", strain = 0.1 }");
    for (limit, order) in [(None, 2.0), (cut_off, 1.0)] {
        let [a, b, c] = [32, 64, 128].map(|steps| last_positions(&hanging(steps, limit)));
        let [coarse, fine] = [(&a, &b), (&b, &c)].map(|(a, b)| max_distance(a, b));
        let found = (coarse / fine).log2();
        // One sequence of steps meets the limit earlier or later than another.
        let tolerance = if order < 2.0 { 0.3 } else { 0.02 };
        assert!((found - order).abs() < tolerance, "{found} of {limit:?}, from {coarse:e} m and {fine:e} m");
    }
}

/// Residuals of the ledger with steps halved twice, and the smallest loss [J] to limits.
fn residuals(limit: &'static str, drag: f64, motion: Option<SineNumbers>) -> ([f64; 3], f64) {
    let mut least = f64::INFINITY;
    let residuals = [20, 40, 80].map(|steps| {
        let mut numbers = hanging(steps, Some(limit));
        (numbers.cloths[0].drag, numbers.cloths[0].motion) = (drag, motion);
        let recorder = recorded(&numbers);
        let energies: Vec<EnergyTerms> = recorder.frames().iter().map(|frame| frame.energies).collect();
        least = least.min(energies[energies.len() - 1].limit_loss);
        relative_residual(&energies)
    });
    (residuals, least)
}

/// What limits take is counted: the residual falls as the step squared, as without them. With the projection the motion
/// itself changes with the step, and the size of the terms with it.
#[test]
fn the_ledger_accounts_for_limits() {
    let cut_off = "{ kind = \"cut-off\", strain = 0.1, shear_strain = 0.3 }";
    let sine = SineNumbers { axis: [0.0, 1.0, 1.0], amplitude: 0.05, frequency: 3.0, phase: 0.0 };
    for (limit, tolerance) in [(cut_off, 0.05), (PROJECTION, 0.6)] {
        for drag in [0.0, 0.002] {
            for motion in [None, Some(sine)] {
                let (residuals, loss) = residuals(limit, drag, motion);
                assert!(loss > 0.0, "{loss} J taken by {limit}");
                assert!(residuals[0] < 1e-3, "{residuals:?}");
                let orders = residuals.windows(2).map(|pair| (pair[0] / pair[1]).log2());
                let orders: Vec<f64> = orders.collect();
                assert!(orders.iter().all(|order| (order - 2.0).abs() < tolerance), "{orders:?} of {limit}");
            }
        }
    }
}
