//! Shear in a picture frame, and homogeneous small strain: forces and energies of a deformation that is imposed by
//! hand.
//!
//! A frame of four rigid sides L is pulled at two opposite corners until its right angles have changed by γ. With
//! square cells and shear springs of stiffness k_d, the energy per area and the force at the corners are
//!
//! ```text
//! W = 4 k_d (1 − cos ½ γ)        F = 2 k_d L sin ½ γ / sin(¼ π − ½ γ)        dW/dγ = 2 k_d sin ½ γ → k_d γ
//! ```
//!
//! so that k_d is the shear modulus. Everything is homogeneous: inside the forces cancel, and the force at the corners
//! is by virtual work Σ F_i · ∂x_i/∂γ over the edges, for a distance of the corners of 2 L cos(¼ π − ½ γ).

use std::f64::consts::PI;
use std::sync::LazyLock;

use glam::DVec3;
use muslin::{Model, Points};

use crate::common::setup::{elastic_energy, forces, grid_points};
use crate::common::{ClothNumbers, SceneNumbers, larger, model_and_state};
use crate::report::{Problem, Row};

/// Cells along each side.
const CELLS: usize = 10;

/// Side L of the frame [m].
const SIDE: f64 = 0.2;

const SHEAR_STIFFNESS: f64 = 37.0;

fn model() -> Model {
    let cloth = ClothNumbers {
        columns: CELLS + 1,
        rows: CELLS + 1,
        width: SIDE,
        height: SIDE,
        pins: vec![],
        stiffnesses: [900.0, SHEAR_STIFFNESS, 50.0],
        ..ClothNumbers::default()
    };
    model_and_state(&SceneNumbers { gravity: [0.0; 3], cloths: vec![cloth], ..SceneNumbers::default() }).0
}

/// Places in a frame sheared by `angle` γ, or their derivatives by it. Sides stay as long as they are; the diagonal
/// stays put.
fn frame(angle: f64, derivative: bool) -> Points {
    let (sine, cosine) = libm::sincos(0.5 * angle);
    let (along, across) = if derivative { (-0.5 * sine, 0.5 * cosine) } else { (cosine, sine) };
    let spacing = SIDE / CELLS as f64;
    grid_points(CELLS + 1, CELLS + 1, |i, j| {
        let (x, y) = (i as f64 * spacing, j as f64 * spacing);
        DVec3::new(x * along + y * across, x * across + y * along, 0.0)
    })
}

/// Force at the corners [N], and the largest net force on a particle inside [N].
fn corner_force(model: &Model, angle: f64) -> [f64; 2] {
    let forces = forces(model, &frame(angle, false));
    let rates = frame(angle, true);
    let (mut power, mut inside) = (0.0, 0.0);
    for j in 0..=CELLS {
        for i in 0..=CELLS {
            let particle = j * (CELLS + 1) + i;
            if [i, j].iter().any(|place| place % CELLS == 0) {
                power -= forces.get(particle).dot(rates.get(particle));
            } else if [i, j].iter().all(|place| (2..=CELLS - 2).contains(place)) {
                inside = larger(inside, forces.get(particle).length());
            }
        }
    }
    [power / (SIDE * libm::sin(0.25 * PI - 0.5 * angle)), inside]
}

/// Springs take their extensions from lengths: rounding of ε against extensions of ½ γ of the length, and with the
/// stiffness of the other springs over k_d, 25, against forces. At the smallest γ of 0.0017 that is 6e-12.
const TOLERANCE: f64 = 2e-11;

pub(crate) static PROBLEM: LazyLock<Problem> = LazyLock::new(|| {
    let model = model();
    let mut rows = Vec::new();
    for degrees in [0.1_f64, 1.0, 10.0, 30.0, 60.0, 80.0] {
        let angle = degrees.to_radians();
        let half_sine = libm::sin(0.5 * angle);
        let [force, inside] = corner_force(&model, angle);
        let exact = 2.0 * SHEAR_STIFFNESS * SIDE * half_sine / libm::sin(0.25 * PI - 0.5 * angle);
        rows.push(Row::new(format!("force F [N], γ = {degrees}°"), exact, force, TOLERANCE));
        // 4 (1 − cos ½ γ) = 8 sin² ¼ γ, without cancellation.
        let quarter_sine = libm::sin(0.25 * angle);
        let exact = 8.0 * SHEAR_STIFFNESS * quarter_sine * quarter_sine * SIDE * SIDE;
        let energy = elastic_energy(&model, &frame(angle, false));
        rows.push(Row::new(format!("energy [J], γ = {degrees}°"), exact, energy, TOLERANCE));
        assert!(inside < 1e-12 * SHEAR_STIFFNESS * SIDE, "{inside:e} N inside");
    }
    // F dd = G γ L² dγ for small γ, with dd = L sin(¼ π − ½ γ) dγ.
    let angle = 1e-3;
    let [force, _] = corner_force(&model, angle);
    let modulus = force * libm::sin(0.25 * PI - 0.5 * angle) / (SIDE * angle);
    rows.push(Row::new("shear modulus G [N/m], γ = 0.001", SHEAR_STIFFNESS, modulus, 1e-7));
    Problem {
        title: "Picture frame",
        text: "A grid of 10 x 10 square cells in a frame of rigid sides L = 0.2 m, sheared by γ as a whole, with a \
               stiffness of the shear springs of k_d = 37 N/m: force at the corners from the forces on the edges by \
               virtual work, and energy. Exact are F = 2 k_d L sin ½γ / sin(¼π − ½γ) and W = 4 k_d L² (1 − cos ½γ); \
               the modulus for small shear is k_d, less γ² / 24 of it.",
        rows,
    }
});

#[test]
fn picture_frame_pulls_as_it_must() {
    PROBLEM.assert();
}
