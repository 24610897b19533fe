//! A strip of measured fabric, clamped level at one end and bent by its own weight.
//!
//! Inextensible and of rigidity B per width, its angle t(s) below the horizontal obeys
//!
//! ```text
//! t'' = −Γ (1 − s) cos t    t(0) = t'(1) = 0    Γ = ρ g L³ / B
//! ```
//!
//! of which a table has the tip's drop H over its distance W from the clamp. Two rows of pins are the clamp, and the strip
//! begins at the second.

use std::sync::LazyLock;

use glam::DVec3;
use muslin::force::Configuration;
use muslin::integrate::guaranteed_stable_step;
use muslin::{Model, Points, Scene};

use crate::common::setup::{GRAVITY, settle, table};
use crate::report::{Problem, Row, order};

const LENGTH: f64 = 0.1;
const AREAL_DENSITY: f64 = 0.15;

/// So stiff that the tension ρ g L of a strip that hangs down stretches it by 3e-4.
const MODULUS: f64 = 500.0;

/// The strip of `cells` with `rigidity` [N m] per width and `drag` per area [kg/(s m²)], along the columns; its width does not
/// matter.
fn strip(rigidity: f64, drag: f64, cells: usize) -> Scene {
    let spacing = LENGTH / cells as f64;
    let text = format!(
        "title = \"strip\"\nrun = {{ duration = 1.0 }}\nenvironment = {{ gravity = [0.0, {:?}, 0.0] }}\n\
         [fabric.strip]\nkind = \"measured\"\nareal_density = {AREAL_DENSITY:?}\ndrag = {drag:?}\n\
         warp = {{ modulus = {MODULUS:?} }}\nweft = {{ modulus = {MODULUS:?} }}\nshear = {{ modulus = 30.0 }}\n\
         bend = {{ warp = {rigidity:?}, weft = {rigidity:?} }}\n\
         [[cloth]]\nname = \"strip\"\nfabric = \"strip\"\n\
         grid = {{ columns = {}, rows = 2, width = {:?}, height = 0.005 }}\n\
         place = {{ origin = [{:?}, 0.0, 0.0], width_axis = [1, 0, 0], height_axis = [0, 0, 1] }}\n\
         pins = [{{ column = 0 }}, {{ column = 1 }}]\n",
        -GRAVITY,
        cells + 2,
        LENGTH + spacing,
        -spacing,
    );
    Scene::parse(&text).unwrap_or_else(|error| panic!("{}", error.render("strip", &text)))
}

/// H / W of a strip of `cells` for Γ = `load`, at rest.
fn drop_over_distance(load: f64, cells: usize) -> f64 {
    let rigidity = AREAL_DENSITY * GRAVITY * LENGTH * LENGTH * LENGTH / load;
    // The slowest swing is no slower than the first bending mode; drag is critical for it.
    let slowest = 3.516 * (rigidity / AREAL_DENSITY).sqrt() / (LENGTH * LENGTH);
    let scene = strip(rigidity, 2.0 * slowest * AREAL_DENSITY, cells);
    let model = Model::new(&scene);
    let mut state = model.initial_state(&scene);
    let step = 0.9 * guaranteed_stable_step(&model, &state);
    // What is left of the way is of the size of the acceleration by ω²: 1e-6 of the length. Rounding of positions is felt
    // as 1e-6 m/s², which is less.
    settle(&model, &mut state, step, 1e-6 * LENGTH * slowest * slowest);
    let tip = state.positions.get(model.particles().len() - 1);
    -tip.y / tip.x
}

/// Squares of the two lowest frequencies of the level strip out of its plane, in units of B / ρ L⁴.
///
/// Both rows move alike, so that a column is one unknown; by inverse iteration, the first mode taken out of the second.
fn squared_frequencies(cells: usize) -> [f64; 2] {
    let rigidity = 1e-5;
    let scene = strip(rigidity, 0.0, cells);
    let model = Model::new(&scene);
    let positions = model.initial_state(&scene).positions;
    let columns = cells + 2;
    let both = |column: usize| [column, column + columns];
    let stiffness: Vec<Vec<f64>> = (2..columns)
        .map(|column| {
            let mut displacements = Points::zeros(positions.len());
            both(column).into_iter().for_each(|particle| displacements.set(particle, DVec3::Y));
            let products = tangent_products(&model, &positions, &displacements);
            (2..columns)
                .map(|column| both(column).map(|particle| products.y[particle]).iter().sum())
                .collect()
        })
        .collect();
    let masses: Vec<f64> = (2..columns)
        .map(|column| both(column).map(|particle| model.particles().masses()[particle]).iter().sum())
        .collect();
    let product = |u: &[f64], v: &[f64]| -> f64 {
        u.iter().zip(v).zip(&masses).map(|((u, v), mass)| mass * u * v).sum()
    };
    let mut modes: Vec<Vec<f64>> = Vec::new();
    let unit = rigidity / (AREAL_DENSITY * LENGTH * LENGTH * LENGTH * LENGTH);
    [0, 1].map(|_| {
        let mut mode: Vec<f64> = (0..cells).map(|i| 1.0 + i as f64).collect();
        let mut square = 0.0;
        // Frequencies are a factor of 6 and 3 apart: an iteration leaves a ninth of what is wrong, at most.
        for _ in 0..40 {
            for lower in &modes {
                let share = product(&mode, lower);
                mode.iter_mut().zip(lower).for_each(|(value, lower)| *value -= share * lower);
            }
            let forces = mode.iter().zip(&masses).map(|(value, mass)| value * mass).collect();
            let next = solved(stiffness.clone(), forces);
            square = product(&mode, &next) / product(&next, &next);
            let length = product(&next, &next).sqrt();
            mode = next.iter().map(|value| value / length).collect();
        }
        modes.push(mode);
        square / unit
    })
}

/// K u [N] of all particles.
fn tangent_products(model: &Model, positions: &Points, displacements: &Points) -> Points {
    let mut products = Points::zeros(positions.len());
    let at = Configuration {
        time: 0.0,
        particles: model.particles(),
        positions,
        velocities: positions,
        memory: &[],
    };
    for force in model.forces() {
        // So small a model is one block.
        force.add_tangent_products(at, displacements, &model.blocks()[0], &mut products.as_mut());
    }
    products
}

/// The solution of a positive definite system, by elimination.
fn solved(mut matrix: Vec<Vec<f64>>, mut right: Vec<f64>) -> Vec<f64> {
    let count = right.len();
    for pivot in 0..count {
        let pivot_row = matrix[pivot].clone();
        for row in pivot + 1..count {
            let factor = matrix[row][pivot] / pivot_row[pivot];
            matrix[row].iter_mut().zip(&pivot_row).for_each(|(value, pivot)| *value -= factor * pivot);
            right[row] -= factor * right[pivot];
        }
    }
    for row in (0..count).rev() {
        let known: f64 = (row + 1..count).map(|column| matrix[row][column] * right[column]).sum();
        right[row] = (right[row] - known) / matrix[row][row];
    }
    right
}

const CELLS: [usize; 3] = [10, 20, 40];

pub(crate) static PROBLEM: LazyLock<Problem> = LazyLock::new(|| {
    let mut rows = Vec::new();
    for reference in table(include_str!("reference/heavy_elastica.csv")) {
        let [load, exact] = reference[..] else { panic!("two columns") };
        let found = CELLS.map(|cells| drop_over_distance(load, cells));
        let order = order(found[0] - found[1], found[1] - found[2], 2.0);
        for (cells, found) in CELLS.into_iter().zip(found) {
            let tolerance = 0.01 * (40.0 / cells as f64).powi(2);
            let row = Row::new(format!("Γ = {load:.3}: H / W, {cells} cells"), exact, found, tolerance);
            rows.push(if cells == 40 { row.with_order(order, 2.0, 0.3) } else { row });
        }
    }
    let found = CELLS.map(squared_frequencies);
    for (mode, exact) in [3.516_015_268_5, 22.034_491_564_7].into_iter().enumerate() {
        let frequencies = found.map(|squares| squares[mode].sqrt());
        let order = order(frequencies[0] - exact, frequencies[2] - exact, 4.0);
        for (cells, found) in CELLS.into_iter().zip(frequencies) {
            let tolerance = 0.01 * (40.0 / cells as f64).powi(2);
            let what = format!("mode {}: ω √(ρ L⁴ / B), {cells} cells", mode + 1);
            let row = Row::new(what, exact, found, tolerance);
            rows.push(if cells == 40 { row.with_order(order, 2.0, 0.1) } else { row });
        }
    }
    Problem {
        title: "Strip bent by its own weight",
        text: "The drop H of the tip over its distance W from the clamp, after drag has brought a strip of measured fabric to \
               rest, by the load Γ = ρ g L³ / B. At Γ = 8.004 the chord is 41.5° below the horizontal, as in the cantilever \
               test. Exact is the heavy elastica, which does not stretch; the strip stretches by up to 3e-4. The order is \
               that of the differences from 10 to 20 and 40 cells. Below are the two lowest frequencies of the level strip, \
               from its masses and its tangent: β² = 3.516 and 22.034.",
        rows,
    }
});

#[test]
fn strips_bend_as_heavy_elastica() {
    PROBLEM.assert();
}
