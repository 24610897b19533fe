//! What the laws of tension do to a cloth.

use muslin::force::{LinearLaw, TangentLaw};
use muslin::observe::StrainMonitor;

use super::common::{CURVE, CURVE_POINTS, ClothNumbers, LINEAR, SceneNumbers, finish};

const TANGENT: &str = "law = \"tangent\", strain_scale = 0.06";
const ARCTANGENT: &str = "law = \"arctangent-force\"";

/// A weight on a spring of 1 m and 60 N/m, brought to rest by drag: its extension [m] after 20 s.
fn extension(law: &'static str, weight: f64) -> f64 {
    let (mass, stiffness) = (0.01, 60.0);
    let cloth = ClothNumbers {
        columns: 1,
        rows: 2,
        origin: [0.0; 3],
        height_axis: [0.0, -1.0, 0.0],
        pins: vec![(0, 0)],
        mass,
        // Half of critical for the linear spring: what is left of the motion after 20 s is e^(−15 · 20 / 2).
        drag: 0.5 * (mass * stiffness).sqrt(),
        stiffnesses: [stiffness, 0.0, 0.0],
        laws: [law; 3],
        ..ClothNumbers::default()
    };
    let numbers = SceneNumbers {
        frame_intervals: 1000,
        steps_per_frame: 60,
        gravity: [0.0, -weight / mass, 0.0],
        cloths: vec![cloth],
        ..SceneNumbers::default()
    };
    let mut simulation = numbers.simulation();
    finish(&mut simulation, &mut StrainMonitor::default());
    -simulation.frame().state.positions.y[1] - 1.0
}

/// Uniaxial tension: at rest the extension is the law's under the weight, x = F / k and x = a L arctan(F / (K₀ a L)).
///
/// The slowest motion decays by e^(−k/k_d · t) or faster, so only the rounding of positions near 1 m is left.
#[test]
fn a_weight_at_rest_extends_a_spring_as_its_law_says() {
    let tangent = TangentLaw::new(60.0, 0.06);
    for weight in [0.06, 1.2, 6.0, 12.0] {
        let linear = LinearLaw { stiffness: 60.0 };
        assert!((extension(LINEAR, weight) - weight / linear.stiffness).abs() < 1e-13);
        let (found, exact) = (extension(TANGENT, weight), tangent.extension(weight, 1.0));
        assert!((found - exact).abs() < 1e-13, "{weight} N: {found} m for {exact} m");
        assert!(found < tangent.asymptote());
    }
}

/// Under a tabulated tension a spring has the tabulated strain, and beyond the table that of the last tangent.
#[test]
fn a_weight_at_rest_extends_a_spring_as_its_table_says() {
    for [strain, tension] in CURVE_POINTS {
        let found = extension(CURVE, 60.0 * tension);
        assert!((found - strain).abs() < 1e-13, "{tension} k L: {found} m for {strain} m");
    }
    // The tangent at the end: of the parabola through the points at 0.2, 0.4 and 0.8.
    let (near, far) = (1.0 / 0.4, 0.43 / 0.2);
    let tangent = ((2.0 * 0.4 + 0.2) * near - 0.4 * far) / (0.4 + 0.2);
    let (found, exact) = (extension(CURVE, 60.0 * 2.0), 0.8 + 0.3 / tangent);
    assert!((found - exact).abs() < 1e-13, "{found} m for {exact} m");
}

/// The arctangent as a force softens: it holds 0.09 k L at tan(0.09 / 0.06) / 5π = 0.898 m, but never 0.0942 k L or more.
#[test]
fn the_literal_arctangent_force_lets_a_heavy_weight_fall() {
    let exact = (0.09_f64 / 0.06).tan() / (5.0 * std::f64::consts::PI);
    let found = extension(ARCTANGENT, 0.09 * 60.0);
    // Near its limit the tangent is 0.3π k / (1 + u²) = k / 212, and the slowest motion e^(−k / 212 k_d · 20 s) is 3e-4.
    assert!((found - exact).abs() < 1e-3, "{found} m for {exact} m");
    // Without equilibrium it falls on, at last with (0.0958 − 0.0942) k L / k_d = 0.25 m/s.
    let found = extension(ARCTANGENT, 0.0958 * 60.0);
    assert!(2.0 < found, "{found} m");
}

/// The paper's sheet dropped from the horizontal: with Hooke's law its springs stretch by more than 20 %, with the tangent
/// law never to the asymptote of ½π 0.06 = 9.42 %.
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
