//! A strip whose links bend as Choi and Ko have it, laid along the arc of a circle.
//!
//! With arcs of length h from particle to particle, links that skip one have the chord of 2h, and their energy is that of
//! the arc whatever its curvature:
//!
//! ```text
//! E = ½ B κ² w (n − 1) h
//! ```
//!
//! for n cells, as no link lies around the ends. Second differences have it times s⁴ (1 + (κh)² s⁴ / 12), s = sin(κh/2) / (κh/2).

use std::sync::LazyLock;

use glam::DVec3;
use muslin::force::{Configuration, Family, PotentialEnergies};
use muslin::integrate::guaranteed_stable_step;
use muslin::{Model, Points, Scene};

use crate::common::setup::{GRAVITY, settle};
use crate::report::{Problem, Row};

const CELLS: usize = 40;
const SPACING: f64 = 0.005;
const WIDTH: f64 = 0.01;
const RIGIDITY: f64 = 8e-6;

fn strip(model: &str) -> Model {
    let text = format!(
        "title = \"strip\"\nrun = {{ duration = 1.0 }}\nenvironment = {{ gravity = [0.0, 0.0, 0.0] }}\n\
         [fabric.strip]\nkind = \"measured\"\nareal_density = 0.15\ndrag = 0.0\n\
         warp = {{ modulus = 4000.0 }}\nweft = {{ modulus = 4000.0 }}\nshear = {{ modulus = 30.0 }}\n\
         bend = {{ warp = 3e-6, weft = {RIGIDITY:?}, model = \"{model}\" }}\n\
         [[cloth]]\nname = \"strip\"\nfabric = \"strip\"\n\
         grid = {{ columns = {}, rows = 3, width = {:?}, height = {WIDTH:?} }}\n\
         place = {{ origin = [0, 0, 0], width_axis = [1, 0, 0], height_axis = [0, 0, 1] }}\n",
        CELLS + 1,
        CELLS as f64 * SPACING,
    );
    let scene = Scene::parse(&text).unwrap_or_else(|error| panic!("{}", error.render("strip", &text)));
    Model::new(&scene)
}

/// Energy [J] of bending of a strip along an arc that turns by `turn` [rad] from column to column.
fn energy(model: &Model, turn: f64) -> f64 {
    let radius = SPACING / turn;
    let positions: Points = (0..3 * (CELLS + 1))
        .map(|particle| {
            let (column, row) = (particle % (CELLS + 1), particle / (CELLS + 1));
            let (sine, cosine) = libm::sincos(turn * column as f64);
            DVec3::new(radius * sine, radius * (1.0 - cosine), 0.5 * WIDTH * row as f64)
        })
        .collect();
    let particles = model.particles();
    let at =
        Configuration { time: 0.0, particles, positions: &positions, velocities: &positions, memory: &[] };
    let mut energies = PotentialEnergies::default();
    model.forces().iter().for_each(|force| force.add_energies(at, &mut energies));
    energies.elastic[Family::Bend as usize]
}

pub(crate) static PROBLEM: LazyLock<Problem> = LazyLock::new(|| {
    let [links, differences] = ["choi-ko", "second-differences"].map(strip);
    let mut rows = Vec::new();
    for degrees in [5.0_f64, 15.0, 30.0, 60.0, 90.0] {
        let turn = degrees.to_radians();
        let curvature = turn / SPACING;
        let exact = 0.5 * RIGIDITY * curvature * curvature * WIDTH * (CELLS - 1) as f64 * SPACING;
        // Their force is c x down to x = −6 b / (c L²), which takes ½ c x² from the energy ¼ b κ² L of an arc; the knee lies
        // lower by 1e-4, as arcs resist more the more they are bent.
        let knee = 6.0 * RIGIDITY / (0.5 * 4000.0 / SPACING * (2.0 * SPACING).powi(3));
        let tolerance = 3.001 * knee / (turn * turn);
        let what = format!("{degrees}° from column to column: E of links [J]");
        rows.push(Row::new(what, exact, energy(&links, turn), tolerance));
        let half = 0.5 * turn;
        let square = (libm::sin(half) / half).powi(4);
        let factor = square * (1.0 + turn * turn * square / 12.0);
        let what = format!("{degrees}° from column to column: E of second differences [J]");
        rows.push(Row::new(what, factor * exact, energy(&differences, turn), 1e-10));
    }
    Problem {
        title: "Strip along an arc",
        text: "The energy of bending of a strip that lies along the arc of a circle, by links that buckle at once (Choi and \
               Ko 2002) and by second differences. Exact for links is ½ B κ² per area at every curvature, but for what they \
               lack where they are hardly bent; for second differences that times s⁴ (1 + θ² s⁴ / 12) with the turn θ from \
               column to column and s = sin(θ/2) / (θ/2), as chords are shorter than arcs here.",
        rows,
    }
});

#[test]
fn links_along_an_arc_have_its_energy() {
    PROBLEM.assert();
}

/// H / W of a clamped strip at rest under its own weight, of `cells`, at Peirce's load: the elastica has 0.885.
fn drop_over_distance(cells: usize) -> f64 {
    const LENGTH: f64 = 0.1;
    let areal_density = 0.15;
    let rigidity = areal_density * GRAVITY * LENGTH.powi(3) / 8.004;
    let spacing = LENGTH / cells as f64;
    let slowest = 3.516 * (rigidity / areal_density).sqrt() / (LENGTH * LENGTH);
    let text = format!(
        "title = \"strip\"\nrun = {{ duration = 1.0 }}\nenvironment = {{ gravity = [0.0, {:?}, 0.0] }}\n\
         [fabric.strip]\nkind = \"measured\"\nareal_density = {areal_density:?}\ndrag = {:?}\n\
         warp = {{ modulus = 4000.0 }}\nweft = {{ modulus = 4000.0 }}\nshear = {{ modulus = 30.0 }}\n\
         bend = {{ warp = {rigidity:?}, weft = {rigidity:?}, model = \"choi-ko\" }}\n\
         [[cloth]]\nname = \"strip\"\nfabric = \"strip\"\n\
         grid = {{ columns = {}, rows = 2, width = {:?}, height = 0.005 }}\n\
         place = {{ origin = [{:?}, 0.0, 0.0], width_axis = [1, 0, 0], height_axis = [0, 0, 1] }}\n\
         pins = [{{ column = 0 }}, {{ column = 1 }}]\n",
        -GRAVITY,
        2.0 * slowest * areal_density,
        cells + 2,
        LENGTH + spacing,
        -spacing,
    );
    let scene = Scene::parse(&text).unwrap_or_else(|error| panic!("{}", error.render("strip", &text)));
    let model = Model::new(&scene);
    let mut state = model.initial_state(&scene);
    let step = 0.7 * guaranteed_stable_step(&model, &state);
    settle(&model, &mut state, step, 1e-4 * LENGTH * slowest * slowest);
    let tip = state.positions.get(model.particles().len() - 1);
    -tip.y / tip.x
}

/// What links take for granted, and cloth does not give: the springs that they push against stretch, and up to a curvature of
/// √(18 B / K) / h² they are slack. The finer the grid, the less such a strip bears: 1.51 and 2.71 in place of 0.885.
#[test]
fn a_strip_of_links_hangs_lower_the_finer_it_is() {
    let [coarse, fine] = [10, 20].map(drop_over_distance);
    assert!((1.4..1.6).contains(&coarse) && (2.5..2.9).contains(&fine), "H / W is {coarse} and {fine}");
}
