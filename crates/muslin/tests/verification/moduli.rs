//! Elastic moduli of a grid, and its extension at 45° to the yarns.
//!
//! Structural, shear and bend springs of stiffness k, k_d and b on cells h_x × h_y with diagonals l are, for small
//! strain inside of a large sheet, an orthotropic membrane:
//!
//! ```text
//! C₁₁ = k h_x/h_y + 4 b h_x/h_y + 2 k_d h_x³ / (h_y l²)    C₁₂ = C₆₆ = 2 k_d h_x h_y / l²
//! C₂₂ as C₁₁ with x and y exchanged
//!
//! 1/E₄₅ = ¼ (1/E₁ + 1/E₂ − 2 ν/E₁) + 1/(4 G)
//! E₁ = C₁₁ − C₁₂²/C₂₂    ν/E₁ = C₁₂ / (C₁₁ C₂₂ − C₁₂²)    G = C₆₆
//! ```
//!
//! Stress is measured by −Σ F_i ⊗ x_i over all particles of a grid that is deformed by hand, which is linear in the
//! numbers of its springs. Of n × n cells these are polynomials of second degree in n, with terms of the edges in
//! first, so that half the second difference in n is that of a cell inside.

use std::f64::consts::FRAC_PI_4;
use std::sync::LazyLock;

use glam::{DMat3, DVec3};

use crate::common::setup::{forces, grid_points};
use crate::common::{ClothNumbers, SceneNumbers, model_and_state};
use crate::report::{Problem, Row};

const STRUCTURAL: f64 = 800.0;
const SHEAR: f64 = 45.0;
const BEND: f64 = 30.0;

/// Σ −F ⊗ x [J] as (along, across, mixed) in axes turned by `angle`, of n × n cells of `spacing` strained by the
/// strains (along, across, mixed) in the same axes.
fn virial(n: usize, spacing: [f64; 2], angle: f64, strains: DVec3) -> DVec3 {
    let cloth = ClothNumbers {
        columns: n + 1,
        rows: n + 1,
        width: n as f64 * spacing[0],
        height: n as f64 * spacing[1],
        pins: vec![],
        stiffnesses: [STRUCTURAL, SHEAR, BEND],
        ..ClothNumbers::default()
    };
    let (model, _) =
        model_and_state(&SceneNumbers { gravity: [0.0; 3], cloths: vec![cloth], ..SceneNumbers::default() });
    let (sine, cosine) = libm::sincos(angle);
    let (along, across) = (DVec3::new(cosine, sine, 0.0), DVec3::new(-sine, cosine, 0.0));
    let positions = grid_points(n + 1, n + 1, |i, j| {
        let rest = DVec3::new(i as f64 * spacing[0], j as f64 * spacing[1], 0.0);
        let (a, c) = (rest.dot(along), rest.dot(across));
        rest + along * (strains.x * a + 0.5 * strains.z * c) + across * (strains.y * c + 0.5 * strains.z * a)
    });
    let forces = forces(&model, &positions);
    positions.iter().zip(forces.iter()).fold(DVec3::ZERO, |sum, (x, f)| {
        let (xa, xc, fa, fc) = (x.dot(along), x.dot(across), f.dot(along), f.dot(across));
        sum - DVec3::new(fa * xa, fc * xc, 0.5 * (fa * xc + fc * xa))
    })
}

/// Matrix of the moduli [N/m] from strains to stresses per width, in axes turned by `angle`.
fn moduli(spacing: [f64; 2], angle: f64) -> DMat3 {
    let stress = |strains: DVec3| {
        let [small, middle, large] = [4, 5, 6].map(|n| virial(n, spacing, angle, strains));
        (small - 2.0 * middle + large) / (2.0 * spacing[0] * spacing[1])
    };
    let tangent = |axis: DVec3| (stress(axis * STRAIN) - stress(-axis * STRAIN)) / (2.0 * STRAIN);
    DMat3::from_cols(tangent(DVec3::X), tangent(DVec3::Y), tangent(DVec3::Z))
}

/// Strain of the central differences: their error is its square, 1e-10.
const STRAIN: f64 = 1e-5;

/// Rounding of lengths, ε over the strain, is 2e-11 in a tension, and tens of times that in a second difference of sums
/// of about 30 cells. Moduli of shear springs are found beside those of structural ones, which are twenty times as
/// large.
const TOLERANCE: f64 = 3e-8;

pub(crate) static PROBLEM: LazyLock<Problem> = LazyLock::new(|| {
    let mut rows = Vec::new();
    for spacing @ [hx, hy] in [[0.01, 0.01], [0.012, 0.008]] {
        let square = hx * hx + hy * hy;
        let along = |h: f64, other: f64| {
            (STRUCTURAL + 4.0 * BEND) * h / other + 2.0 * SHEAR * h * h * h / (other * square)
        };
        let (c11, c22, c12) = (along(hx, hy), along(hy, hx), 2.0 * SHEAR * hx * hy / square);
        let determinant = c11 * c22 - c12 * c12;
        let [e1, e2] = [determinant / c22, determinant / c11];
        let compliance = 0.25 * (1.0 / e1 + 1.0 / e2 - 2.0 * c12 / determinant) + 0.25 / c12;
        let found = moduli(spacing, 0.0);
        let bias = moduli(spacing, FRAC_PI_4).inverse().x_axis.x;
        let cells = format!("cells {} x {} mm", 1e3 * hx, 1e3 * hy);
        for (what, exact, found) in [
            ("C₁₁", c11, found.x_axis.x),
            ("C₂₂", c22, found.y_axis.y),
            ("C₁₂", c12, found.y_axis.x),
            ("C₆₆", c12, found.z_axis.z),
            ("E₁", e1, 1.0 / found.inverse().x_axis.x),
            ("E₄₅", 1.0 / compliance, 1.0 / bias),
        ] {
            rows.push(Row::new(format!("{cells}: {what} [N/m]"), exact, found, TOLERANCE));
        }
    }
    Problem {
        title: "Moduli of a grid, and bias extension",
        text: "Membrane moduli inside of a grid with structural, shear and bend springs of 800, 45 and 30 N/m, from \
               the forces on all particles of grids strained by ± 1e-5 by hand. Exact are the sums over the springs of \
               a cell; the modulus at 45° to the yarns is 1/E₄₅ = ¼ (1/E₁ + 1/E₂ − 2ν/E₁) + 1/(4G).",
        rows,
    }
});

#[test]
fn moduli_are_those_of_the_springs() {
    PROBLEM.assert();
}
