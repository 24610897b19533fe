//! Dashpots inside of the cloth: Kelvin and Voigt.

use std::sync::LazyLock;

use glam::DVec3;
use muslin::force::{Configuration, Sweep};
use muslin::integrate::{CentralDifference, Integrator, Workers};
use muslin::observe::{Recorder, relative_residual};
use muslin::{Model, Points, Scene};

use crate::common::{
    ClothNumbers, SceneNumbers, SineNumbers, finish, for_each_step, larger, model_and_state,
};
use crate::report::{Problem, Row, order};

const MASS: f64 = 0.2;
const STIFFNESS: f64 = 5.0;
const DAMPING: f64 = 0.4;

/// A mass at the end of a damped spring along x, moved by gravity along it.
fn oscillator(steps_per_frame: u32) -> SceneNumbers {
    SceneNumbers {
        frame_intervals: 1,
        frame_rate: 0.5,
        steps_per_frame,
        gravity: [2.5, 0.0, 0.0],
        cloths: vec![ClothNumbers {
            columns: 2,
            rows: 1,
            width: 1.0,
            origin: [0.0; 3],
            pins: vec![(0, 0)],
            mass: MASS,
            drag: 0.0,
            stiffnesses: [STIFFNESS, 0.0, 0.0],
            dampings: [DAMPING, 0.0, 0.0],
            ..ClothNumbers::default()
        }],
        ..SceneNumbers::default()
    }
}

/// x(t) [m] from rest at 1 m about the equilibrium at 1.1 m: ü = −ω² u − 2γ u̇ with 2γ = c/m.
fn exact_position(time: f64) -> f64 {
    let gamma = DAMPING / (2.0 * MASS);
    let omega = (STIFFNESS / MASS - gamma * gamma).sqrt();
    let (sine, cosine) = libm::sincos(omega * time);
    1.1 - 0.1 * libm::exp(-gamma * time) * (cosine + gamma / omega * sine)
}

fn oscillator_error(steps_per_frame: u32) -> f64 {
    let mut error = 0.0_f64;
    for_each_step(&oscillator(steps_per_frame), |_, state| {
        error = larger(error, (state.positions.x[1] - exact_position(state.time)).abs());
    });
    error
}

/// Steps of 3 : 1 by turns.
fn alternating_error(count: u32) -> f64 {
    let (model, mut state) = model_and_state(&oscillator(200));
    let mut method = CentralDifference::new(Workers::single());
    let mut error = 0.0_f64;
    for k in 0..count {
        let step = if k % 2 == 0 { 3.0 } else { 1.0 } / f64::from(count);
        method.step(&model, &mut state, step).unwrap_or_else(|error| panic!("{error}"));
        error = larger(error, (state.positions.x[1] - exact_position(state.time)).abs());
    }
    error
}

/// A sheet in a frame, pulled up and down by two corners, with damping in all families or of all kinds.
fn shaken(steps_per_frame: u32, is_measured: bool) -> SceneNumbers {
    SceneNumbers {
        frame_intervals: 10,
        frame_rate: 20.0,
        steps_per_frame,
        cloths: vec![ClothNumbers {
            columns: 6,
            rows: 5,
            width: 0.5,
            height: 0.4,
            pins: vec![(0, 0), (5, 0)],
            motion: Some(SineNumbers { axis: [0.0, 1.0, 1.0], amplitude: 0.03, frequency: 2.0, phase: 0.3 }),
            drag: 0.0,
            dampings: [0.03, 0.02, 0.01],
            is_measured,
            ..ClothNumbers::default()
        }],
        ..SceneNumbers::default()
    }
}

/// The order of the residual between neighbours of halved steps that is farthest from two.
fn residual_order(is_measured: bool) -> f64 {
    let residuals = [50, 100, 200, 400].map(|steps_per_frame| {
        let mut recorder = Recorder::default();
        finish(&mut shaken(steps_per_frame, is_measured).simulation(), &mut recorder);
        let last = recorder.frames().last().unwrap_or_else(|| panic!("no frames")).energies;
        assert!(0.0 < last.damping_loss && last.friction_loss == 0.0);
        relative_residual(recorder.frames().iter().map(|frame| &frame.energies))
    });
    assert!(residuals[0] < 1e-3, "{residuals:?}");
    let orders = residuals.windows(2).map(|pair| order(pair[0], pair[1], 2.0));
    orders.fold(2.0, |a: f64, b| if (b - 2.0).abs() <= (a - 2.0).abs() { a } else { b })
}

const SPACINGS: [f64; 2] = [0.02, 0.015];
const CELLS: [usize; 2] = [10, 8];

/// A flat sheet whose moduli are 1000, 800 and 40 N/m and whose rigidities are 9 and 6 µN m, with times of 2, 3, 4 and 5 ms.
fn measured() -> Model {
    let [width, height] = [0, 1].map(|i| CELLS[i] as f64 * SPACINGS[i]);
    let text = format!(
        "title = \"sheet\"\nrun = {{ duration = 1.0 }}\nenvironment = {{ gravity = [0, 0, 0] }}\n\
         [fabric.cloth]\nkind = \"measured\"\nareal_density = 0.2\ndrag = 0.0\n\
         warp = {{ modulus = 1000.0, damping_time = 2e-3 }}\nweft = {{ modulus = 800.0, damping_time = 3e-3 }}\n\
         shear = {{ modulus = 40.0, damping_time = 4e-3 }}\n\
         bend = {{ warp = 9e-6, weft = 6e-6, damping_time = 5e-3 }}\n\
         [[cloth]]\nname = \"sheet\"\nfabric = \"cloth\"\n\
         grid = {{ columns = {}, rows = {}, width = {width:?}, height = {height:?} }}\n\
         place = {{ origin = [0, 0, 0], width_axis = [1, 0, 0], height_axis = [0, 1, 0] }}\n",
        CELLS[0] + 1,
        CELLS[1] + 1,
    );
    Model::new(&Scene::parse(&text).unwrap_or_else(|error| panic!("{}", error.render("test", &text))))
}

fn points(shape: impl Fn([f64; 2]) -> DVec3) -> Points {
    let places = (0..=CELLS[1]).flat_map(|j| (0..=CELLS[0]).map(move |i| [i, j]));
    places.map(|[i, j]| shape([i as f64 * SPACINGS[0], j as f64 * SPACINGS[1]])).collect()
}

/// The power per area [W/m²] of dashpots in a flat sheet that moves with `velocities`, of `share` of its area: from forces, and as
/// the force itself has it.
fn power(model: &Model, velocities: &Points, share: f64) -> [f64; 2] {
    let positions = points(|[x, y]| DVec3::new(x, y, 0.0));
    let none = &[];
    let at = Configuration {
        time: 0.0,
        particles: model.particles(),
        positions: &positions,
        velocities,
        memory: none,
    };
    let area = share * (0..2).map(|i| CELLS[i] as f64 * SPACINGS[i]).product::<f64>();
    let mut forces = Points::zeros(positions.len());
    let mut own = 0.0;
    let [block] = model.blocks() else { panic!("one block") };
    for force in model.forces().iter().filter(|force| force.depends_on_velocity()) {
        force.add_forces(at, block, &mut forces.as_mut(), &mut Sweep::default());
        own += force.damping_power(at);
    }
    let work: f64 = forces.iter().zip(velocities.iter()).map(|(force, velocity)| force.dot(velocity)).sum();
    [-work / area, own / area]
}

pub(crate) static PROBLEM: LazyLock<Problem> = LazyLock::new(|| {
    let mut rows = Vec::new();
    let errors = [200, 400, 800, 1600].map(oscillator_error);
    let amplitude = 0.1;
    rows.push(
        Row::vanishing("oscillator, 1600 steps: largest error by the amplitude", errors[3] / amplitude, 1e-5)
            .with_order(order(errors[0], errors[3], 8.0), 2.0, 0.02),
    );
    let errors = [400, 3200].map(alternating_error);
    let found = order(errors[0], errors[1], 8.0);
    rows.push(Row::of_order("oscillator, steps of 3 : 1 by turns", 2.0, found, 0.02));
    rows.push(Row::of_order("residual, springs and pins that move", 2.0, residual_order(false), 0.05));
    rows.push(Row::of_order("residual, measured fabric and pins that move", 2.0, residual_order(true), 0.05));
    let model = measured();
    let rate = 0.5;
    let cases: [(&str, Points, f64, f64); 5] = [
        ("along warp", points(|[_, y]| DVec3::Y * (rate * y)), 1.0, 1000.0 * 2e-3),
        ("along weft", points(|[x, _]| DVec3::X * (rate * x)), 1.0, 800.0 * 3e-3),
        ("in shear", points(|[_, y]| DVec3::X * (rate * y)), 1.0, 40.0 * 4e-3),
        // All but one of the cells in a line are around its particles that bend.
        ("in bending along warp", points(|[_, y]| DVec3::Z * (0.5 * rate * y * y)), 7.0 / 8.0, 9e-6 * 5e-3),
        ("in bending along weft", points(|[x, _]| DVec3::Z * (0.5 * rate * x * x)), 9.0 / 10.0, 6e-6 * 5e-3),
    ];
    for (name, velocities, share, coefficient) in cases {
        let [power, own] = power(&model, &velocities, share);
        assert!((power / own - 1.0).abs() < 1e-12, "{power} and {own} W/m²");
        rows.push(Row::new(format!("power τ K ė² {name} [W/m²]"), coefficient * rate * rate, power, 1e-12));
    }
    Problem {
        title: "Internal damping",
        text: "A mass on a spring and a dashpot against its differential equation, what the energy ledger cannot account for \
               where pins pull at damped cloth, and the power of the dashpots of a measured fabric at a rate of strain, shear or \
               curvature of 0.5/s, 0.5 rad/s or 0.5/(m s).",
        rows,
    }
});

#[test]
fn dashpots_damp_as_they_must() {
    PROBLEM.assert();
}

/// A bent sheet that turns as a whole is not damped: a power of nothing but rounding, against that of bending at 1/(m s).
#[test]
fn rigid_motion_is_not_damped() {
    let model = measured();
    let positions = points(|[x, y]| DVec3::new(x, y, 3.0 * x * x + 2.0 * x * y));
    let velocities: Points =
        positions.iter().map(|x| DVec3::new(2.0, -1.0, 3.0).cross(x) + DVec3::new(1.0, 2.0, 3.0)).collect();
    let none = &[];
    let at = Configuration {
        time: 0.0,
        particles: model.particles(),
        positions: &positions,
        velocities: &velocities,
        memory: none,
    };
    let power: f64 = model.forces().iter().map(|force| force.damping_power(at)).sum();
    // Rates of roundings: 1e-16 · 5 m/s by 2 cm.
    assert!(power < 1e-20, "{power:e} W");
}
