//! Sheets of measured fabric: the moduli that went in, whatever the grid.
//!
//! ```text
//! E₁ = C₁₁ − C₁₂² / C₂₂    C₁₂ = C₆₆ = G    u = ρ g H² / 2K
//! ```
//!
//! Half springs and half masses along edges make both exact on any grid: a strip under uniaxial stress is strained alike
//! everywhere and no particle of its free edges feels a force.

use std::sync::LazyLock;

use glam::DVec3;
use muslin::{Model, Points, Scene};

use crate::common::larger;
use crate::common::setup::{GRAVITY, forces, settle};
use crate::report::{Problem, Row};

/// Moduli along weft and warp, and of shear [N/m]: far from negligible shear, so that C₁₂ matters.
const WEFT: f64 = 400.0;
const WARP: f64 = 1000.0;
const SHEAR: f64 = 150.0;

/// A scene of one measured fabric in the plane x, y, whose rows hang below each other.
fn scene(fabric: &str, cells: [usize; 2], size: [f64; 2], pins: &str) -> Scene {
    let text = format!(
        "title = \"sheet\"\nrun = {{ duration = 1.0 }}\nenvironment = {{ gravity = [0.0, {:?}, 0.0] }}\n\
         [fabric.f]\nkind = \"measured\"\n{fabric}\n\
         [[cloth]]\nname = \"sheet\"\nfabric = \"f\"\n\
         grid = {{ columns = {}, rows = {}, width = {:?}, height = {:?} }}\n\
         place = {{ origin = [0, 0, 0], width_axis = [1, 0, 0], height_axis = [0, -1, 0] }}\npins = [{pins}]\n",
        -GRAVITY,
        cells[0] + 1,
        cells[1] + 1,
        size[0],
        size[1],
    );
    Scene::parse(&text).unwrap_or_else(|error| panic!("{}", error.render("sheet", &text)))
}

/// Without mass that matters: weight is below 1e-12 of what strains of 1e-6 give.
const WEIGHTLESS: &str = "areal_density = 1e-18\ndrag = 0.0";

/// The first row's tension per width [N/m] of a strip strained by `strains` along weft and warp, and the largest force [N]
/// per width on a particle below a row of its own.
fn tension(fabric: &str, cells: usize, [across, along]: [f64; 2]) -> (f64, f64) {
    let (width, height) = (0.06, 0.2);
    let columns = cells.div_ceil(4) + 1;
    let scene = scene(fabric, [columns - 1, cells], [width, height], "");
    let model = Model::new(&scene);
    let rest = model.initial_state(&scene).positions;
    let strained: Points =
        rest.iter().map(|x| DVec3::new(x.x * (1.0 + across), x.y * (1.0 + along), 0.0)).collect();
    let forces = forces(&model, &strained);
    let held: f64 = forces.iter().take(columns).map(|force| -force.y).sum();
    let inner = forces.iter().skip(columns).take(columns * (cells - 1));
    let free = inner.map(DVec3::length).fold(0.0, larger);
    (held / width, free / width)
}

/// Displacement of the lowest row of a sheet that hangs from its first, in units of ρ g H² / K.
fn own_weight(rows: usize) -> f64 {
    let (density, height): (f64, f64) = (0.2, 1.0);
    let spacing = height / rows as f64;
    // Critical for the slowest swing, ω = ½π √(K / ρ) / H or a little less.
    let drag = std::f64::consts::PI * (density * WARP).sqrt() / height;
    let fabric = format!(
        "areal_density = {density:?}\ndrag = {drag:?}\nwarp = {{ modulus = {WARP:?} }}\nweft = {{ modulus = {WEFT:?} }}\n\
         shear = {{ modulus = 0.0 }}\nbend = {{ warp = 0, weft = 0 }}"
    );
    let scene = scene(&fabric, [2, rows], [0.3, height], "{ row = 0 }");
    let model = Model::new(&scene);
    let mut state = model.initial_state(&scene);
    let bound = 16.0 * f64::EPSILON * height * WARP / (density * spacing * spacing);
    settle(&model, &mut state, 0.5 * spacing * (density / WARP).sqrt(), bound);
    let lowest = state.positions.get(model.particles().len() - 1);
    (-lowest.y - height) * WARP / (density * GRAVITY * height * height)
}

/// Strain at which moduli are measured: what is of second order is 1e-6 of them, and rounding 1e-10.
const STRAIN: f64 = 1e-6;

pub(crate) static PROBLEM: LazyLock<Problem> = LazyLock::new(|| {
    let mut rows = Vec::new();
    let linear = format!(
        "{WEIGHTLESS}\nwarp = {{ modulus = {WARP:?} }}\nweft = {{ modulus = {WEFT:?} }}\n\
         shear = {{ modulus = {SHEAR:?} }}\nbend = {{ warp = 0, weft = 0 }}"
    );
    let modulus = WARP - SHEAR * SHEAR / WEFT;
    for cells in [10, 20, 40] {
        let (held, free) = tension(&linear, cells, [-SHEAR / WEFT * STRAIN, STRAIN]);
        rows.push(Row::new(format!("E₁ [N/m], {cells} cells"), modulus, held / STRAIN, 5e-6));
        rows.push(Row::vanishing(
            format!("… force on free edges, of E₁ e, {cells} cells"),
            free / (modulus * STRAIN),
            5e-6,
        ));
    }
    // EMT and LT of suiting: at EMT the tension is that of the test, and what shear springs carry beyond their share.
    let kes = format!(
        "{WEIGHTLESS}\nwarp = {{ emt_percent = 4.7, lt = 0.55, force_gf_per_cm = 500 }}\n\
         weft = {{ emt_percent = 12.75, lt = 0.55, force_gf_per_cm = 500 }}\n\
         shear = {{ g_gf_per_cm_deg = 0.57 }}\nbend = {{ warp = 0, weft = 0 }}"
    );
    for cells in [10, 20, 40] {
        let (held, _) = tension(&kes, cells, [0.0, 0.047]);
        rows.push(Row::new(format!("tension at EMT [N/m], {cells} cells"), 490.3325, held, 5e-4));
    }
    for count in [1, 2, 5, 10, 25] {
        rows.push(Row::new(format!("u K / ρ g H², n = {count}"), 0.5, own_weight(count), 1e-9));
    }
    Problem {
        title: "Sheets of measured fabric",
        text: "Tension per width of a strip of measured fabric with moduli of 1000 and 400 N/m and a shear modulus of 150 \
               N/m, strained uniaxially by 1e-6, and forces on all particles between its ends; tension at EMT of a suiting \
               with EMT 4.7 % at 490.3325 N/m; and the stretch u of a sheet under its own weight. All are met on every grid, \
               since springs and particles along edges stand for half a cell.",
        rows,
    }
});

#[test]
fn sheets_have_the_measured_moduli() {
    PROBLEM.assert();
}
