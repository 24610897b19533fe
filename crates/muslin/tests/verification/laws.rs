//! What the laws of tension do to a cloth.

use std::sync::LazyLock;

use glam::DVec3;
use muslin::force::TangentLaw;
use muslin::observe::StrainMonitor;

use super::common::setup::{chain, elastic_energy, forces, grid_points, settle, table};
use super::common::{CURVE, CURVE_POINTS, ClothNumbers, LINEAR, SceneNumbers, finish, model_and_state};
use crate::report::{Problem, Row};

const TANGENT: &str = "law = \"tangent\", strain_scale = 0.06";
const ARCTANGENT: &str = "law = \"arctangent-force\"";

const STIFFNESS: f64 = 60.0;
const MASS: f64 = 0.01;

/// A weight [N] on a spring of 1 m and 60 N/m, with drag.
fn weight_on_spring(law: &'static str, weight: f64, drag: f64) -> SceneNumbers {
    let mut numbers = chain(1, 1.0, MASS, STIFFNESS);
    numbers.gravity = [0.0, -weight / MASS, 0.0];
    numbers.cloths[0].laws = [law; 3];
    numbers.cloths[0].drag = drag;
    numbers
}

/// A tenth of the largest stable step of the linear spring [s]; the springs here stiffen by less than a hundred times.
const STEP: f64 = 2.5e-3;

/// Extension [m] at rest under `weight` [N]: drag brings the forces down to 32 ε k, some roundings of the stiffened
/// spring's.
fn extension(law: &'static str, weight: f64) -> f64 {
    // A twentieth of critical for the linear spring, and still 0.3 of it where the arctangent has softened it to k /
    // 212.
    let drag = 0.1 * (MASS * STIFFNESS).sqrt();
    let (model, mut state) = model_and_state(&weight_on_spring(law, weight, drag));
    let bound = 32.0 * f64::EPSILON * STIFFNESS / MASS;
    settle(&model, &mut state, STEP / 10.0, bound);
    -state.positions.y[1] - 1.0
}

/// What each law holds: the extensions [m] of a spring of 1 m under loads [N], in closed form.
fn loaded(name: &str, law: &'static str, loads: [f64; 4], exact: impl Fn(f64) -> f64) -> [Row; 4] {
    loads.map(|load| {
        Row::new(format!("`{name}`, {load} N: extension [m]"), exact(load), extension(law, load), TOLERANCE)
    })
}

/// Of the extension: 32 ε k, where the motion ends, over the stiffness there. That is k or nearly so at an extension of
/// 1e-3 m and up, and k / 212 at the last load of the softening law, whose extension is 0.9 m.
const TOLERANCE: f64 = 1e-11;

/// Linearity of the tensile curve, LT = W / (½ F e), of a strip that is stretched to e = u a by hand: energy over that
/// of a straight line to the same force.
fn linearity(u: f64) -> f64 {
    let (columns, rows, spacing) = (4, 7, 0.05);
    let cloth = ClothNumbers {
        columns,
        rows,
        width: spacing * (columns - 1) as f64,
        height: spacing * (rows - 1) as f64,
        pins: vec![],
        stiffnesses: [STIFFNESS, 0.0, 0.0],
        laws: [TANGENT; 3],
        ..ClothNumbers::default()
    };
    let numbers = SceneNumbers { gravity: [0.0; 3], cloths: vec![cloth], ..SceneNumbers::default() };
    let (model, _) = model_and_state(&numbers);
    let stretched = |strain: f64| {
        grid_points(columns, rows, |i, j| DVec3::new(i as f64, j as f64 * (1.0 + strain), 0.0) * spacing)
    };
    let positions = stretched(0.06 * u);
    let forces = forces(&model, &positions);
    let pull: f64 = (0..columns).map(|column| forces.y[column]).sum();
    let extension = 0.06 * u * spacing * (rows - 1) as f64;
    elastic_energy(&model, &positions) / (0.5 * pull * extension)
}

pub(crate) static PROBLEM: LazyLock<Problem> = LazyLock::new(|| {
    let five_pi = 5.0 * std::f64::consts::PI;
    let mut rows = Vec::new();
    rows.extend(loaded("linear", LINEAR, [0.06, 1.2, 6.0, 12.0], |load| load / STIFFNESS));
    rows.extend(loaded("tangent", TANGENT, [0.06, 1.2, 6.0, 12.0], |load| {
        0.06 * libm::atan(five_pi * load / STIFFNESS)
    }));
    rows.extend(loaded("arctangent-force", ARCTANGENT, [0.06, 1.2, 3.6, 5.4], |load| {
        libm::tan(load / (0.06 * STIFFNESS)) / five_pi
    }));
    let row = |strain: f64, load: f64| {
        Row::new(format!("`curve`, {load} N: extension [m]"), strain, extension(CURVE, load), TOLERANCE)
    };
    rows.extend(CURVE_POINTS.map(|[strain, tension]| row(strain, STIFFNESS * tension)));
    // Beyond the table the tangent at its end: of the parabola through the points at 0.2, 0.4 and 0.8.
    let (near, far) = (1.0 / 0.4, 0.43 / 0.2);
    let tangent = ((2.0 * 0.4 + 0.2) * near - 0.4 * far) / (0.4 + 0.2);
    rows.push(row(0.8 + 0.3 / tangent, STIFFNESS * 2.0));
    for exact in table(include_str!("reference/linearity.csv")) {
        // The reference has eight digits.
        rows.push(Row::new(
            format!("linearity LT of `tangent` at e = {} a", exact[0]),
            exact[1],
            linearity(exact[0]),
            1e-7,
        ));
    }
    Problem {
        title: "Uniaxial tension",
        text: "A weight on a spring of 1 m and k = 60 N/m, after drag has brought it to rest, under every law. Exact \
               are the laws' inverses: x = F / k, x = 0.06 L arctan(5π F / k L), and x = L tan(F / 0.06 k L) / 5π, \
               which has no value from 0.0942 k L = 5.65 N on. `curve` must give \
               the strains of its table at its tensions, and go straight on beyond. The linearity of a textile's tensile test, LT = W / (½ \
               F e), is that of a strip stretched by hand, from forces on its edge and its energy: exact −2 ln cos u / \
               (u tan u) with u = e / a.",
        rows,
    }
});

#[test]
fn springs_extend_as_their_laws_say() {
    PROBLEM.assert();
}

/// The arctangent as a force never holds 0.0942 k L or more: the weight falls on, at last with
/// (0.0958 − 0.0942) k L / k_d = 0.25 m/s.
#[test]
fn the_literal_arctangent_force_lets_a_heavy_weight_fall() {
    let drag = 0.5 * (MASS * STIFFNESS).sqrt();
    let mut numbers = weight_on_spring(ARCTANGENT, 0.0958 * STIFFNESS, drag);
    (numbers.frame_intervals, numbers.steps_per_frame) = (1000, 8);
    let mut simulation = numbers.simulation();
    finish(&mut simulation, &mut StrainMonitor::default());
    let extension = -simulation.frame().state.positions.y[1] - 1.0;
    assert!(2.0 < extension, "{extension} m");
}

/// The paper's sheet dropped from the horizontal: with Hooke's law its springs stretch by more than 20 %, with the
/// tangent law never to the asymptote of ½π 0.06 = 9.42 %.
#[test]
fn the_tangent_law_limits_the_strain_of_a_falling_sheet() {
    let largest_strain = |law: &'static str, steps_per_frame: u32| {
        let laws = [law, LINEAR, LINEAR];
        let numbers = SceneNumbers {
            steps_per_frame,
            cloths: vec![ClothNumbers { laws, ..ClothNumbers::default() }],
            ..SceneNumbers::default()
        };
        let mut strains = StrainMonitor::default();
        finish(&mut numbers.simulation(), &mut strains);
        strains.maxima()[0].unwrap_or(f64::NAN)
    };
    let linear = largest_strain(LINEAR, 20);
    assert!(0.2 < linear, "{linear}");
    let tangent = largest_strain(TANGENT, 400);
    assert!((0.05..TangentLaw::new(60.0, 0.06).asymptote()).contains(&tangent), "{tangent}");
}
