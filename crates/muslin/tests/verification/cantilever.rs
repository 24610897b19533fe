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

use muslin::integrate::guaranteed_stable_step;
use muslin::{Model, Scene};

use crate::common::setup::{GRAVITY, settle, table};
use crate::report::{Problem, Row, order};

const LENGTH: f64 = 0.1;
const AREAL_DENSITY: f64 = 0.15;

/// So stiff that the tension ρ g L of a strip that hangs down stretches it by 3e-4.
const MODULUS: f64 = 500.0;

/// H / W of a strip of `cells` for Γ = `load`, at rest.
fn drop_over_distance(load: f64, cells: usize) -> f64 {
    let rigidity = AREAL_DENSITY * GRAVITY * LENGTH * LENGTH * LENGTH / load;
    let spacing = LENGTH / cells as f64;
    // The slowest swing is no slower than the first bending mode; drag is critical for it.
    let slowest = 3.516 * (rigidity / AREAL_DENSITY).sqrt() / (LENGTH * LENGTH);
    let text = format!(
        "title = \"strip\"\nrun = {{ duration = 1.0 }}\nenvironment = {{ gravity = [0.0, {:?}, 0.0] }}\n\
         [fabric.strip]\nkind = \"measured\"\nareal_density = {AREAL_DENSITY:?}\ndrag = {:?}\n\
         warp = {{ modulus = {MODULUS:?} }}\nweft = {{ modulus = {MODULUS:?} }}\nshear = {{ modulus = 30.0 }}\n\
         bend = {{ warp = {rigidity:?}, weft = {rigidity:?} }}\n\
         [[cloth]]\nname = \"strip\"\nfabric = \"strip\"\n\
         grid = {{ columns = {}, rows = 2, width = {:?}, height = 0.005 }}\n\
         place = {{ origin = [{:?}, 0.0, 0.0], width_axis = [1, 0, 0], height_axis = [0, 0, 1] }}\n\
         pins = [{{ column = 0 }}, {{ column = 1 }}]\n",
        -GRAVITY,
        2.0 * slowest * AREAL_DENSITY,
        cells + 2,
        LENGTH + spacing,
        -spacing,
    );
    let scene = Scene::parse(&text).unwrap_or_else(|error| panic!("{}", error.render("strip", &text)));
    let model = Model::new(&scene);
    let mut state = model.initial_state(&scene);
    let step = 0.9 * guaranteed_stable_step(&model, &state);
    // What is left of the way is of the size of the acceleration by ω²: 1e-6 of the length. Rounding of positions is felt
    // as 1e-6 m/s², which is less.
    settle(&model, &mut state, step, 1e-6 * LENGTH * slowest * slowest);
    let tip = state.positions.get(model.particles().len() - 1);
    -tip.y / tip.x
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
    Problem {
        title: "Strip bent by its own weight",
        text: "The drop H of the tip over its distance W from the clamp, after drag has brought a strip of measured fabric to \
               rest, by the load Γ = ρ g L³ / B. At Γ = 8.004 the chord is 41.5° below the horizontal, as in the cantilever \
               test. Exact is the heavy elastica, which does not stretch; the strip stretches by up to 3e-4. The order is \
               that of the differences from 10 to 20 and 40 cells.",
        rows,
    }
});

#[test]
fn strips_bend_as_heavy_elastica() {
    PROBLEM.assert();
}
