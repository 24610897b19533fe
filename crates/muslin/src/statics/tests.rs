//! What is at rest, how it gets there from afar, and what never does.

use glam::DVec3;

use super::{EQUILIBRIUM_TOLERANCE, LONGEST_WAY, MOST_STEPS, Rest, StaticSolver, eval_forces, eval_products};
use crate::lab::LabError;
use crate::points::dot_in_lanes;
use crate::{Model, Points, Scene, State};

/// Bending rigidity [N m] of a strip, and modulus [N/m].
const RIGIDITY: f64 = 2e-3;
const MODULUS: f64 = 4000.0;

/// Cells of a strip, and their length [m].
const CELLS: usize = 20;
const SPACING: f64 = 5e-3;

const LENGTH: f64 = CELLS as f64 * SPACING;

/// A strip along x whose width, of two cells, is along z, in a `gravity` [m/s²] along −y; the rows in `pins` are held.
fn strip(gravity: f64, pins: &[usize]) -> (Model, State) {
    let pins: Vec<String> = pins.iter().map(|row| format!("{{ row = {row} }}")).collect();
    let text = format!(
        "title = \"strip\"\nrun = {{ duration = 1.0 }}\nenvironment = {{ gravity = [0, {:?}, 0] }}\n\
         [fabric.f]\nkind = \"measured\"\nareal_density = 0.2\ndrag = 0.0\n\
         warp = {{ modulus = {MODULUS:?} }}\nweft = {{ modulus = {MODULUS:?} }}\nshear = {{ modulus = 40.0 }}\n\
         bend = {{ warp = {RIGIDITY:?}, weft = {RIGIDITY:?} }}\n\
         [[cloth]]\nname = \"strip\"\nfabric = \"f\"\n\
         grid = {{ columns = 3, rows = {}, width = 0.01, height = {LENGTH:?} }}\n\
         place = {{ origin = [0, 0, 0], width_axis = [0, 0, 1], height_axis = [1, 0, 0] }}\npins = [{}]\n",
        -gravity,
        CELLS + 1,
        pins.join(", "),
    );
    let scene = Scene::parse(&text).unwrap_or_else(|error| panic!("{}", error.render("test", &text)));
    let model = Model::new(&scene);
    let state = model.initial_state(&scene);
    (model, state)
}

/// Moves every particle of `state` to where `place` says, by its distance s [m] from the first row.
fn move_to(model: &Model, state: &mut State, place: impl Fn(f64, DVec3) -> DVec3) {
    let grid = model.cloths()[0].grid;
    for particle in 0..state.positions.len() {
        let (_, row) = grid.cell(particle).expect("a particle of the strip");
        let moved = place(row as f64 * SPACING, state.positions.get(particle));
        state.positions.set(particle, moved);
    }
}

fn settle(model: &Model, state: &mut State) -> Result<Rest, Rest> {
    StaticSolver::new(model).settle(model, state, &[])
}

/// The middle particle of a row.
fn middle(model: &Model, state: &State, row: usize) -> DVec3 {
    state.positions.get(model.cloths()[0].grid.particle(1, row))
}

/// Euler's elastica with hinged ends whose tangents there are at 60° to the chord: p = sin 30°, K(p) = 1.685750355,
/// E(p) = 1.467462209 (Legendre's integrals),
///
/// ```text
/// chord / L = 2 E / K − 1        rise / L = p / K        κ L = 4 p K in the middle
/// ```
///
/// Pushed from its ends a straight strip is at rest too, but not as a minimum of its energy: its tangent is indefinite. A strip that
/// is a hundredth of a cell off must get to the elastica, but for what a polygon departs from it that turns by κ h at its corners.
#[test]
fn a_strip_pushed_at_its_ends_buckles() {
    const K: f64 = 1.685_750_355;
    const E: f64 = 1.467_462_209;
    let (model, mut state) = strip(0.0, &[0, CELLS]);
    move_to(&model, &mut state, |s, place| {
        place.with_y(0.01 * SPACING * libm::sin(std::f64::consts::PI * s / LENGTH))
    });
    let chord = 2.0 * E / K - 1.0;
    let mut ratio = 1.0;
    // The first push is eight times as far as a straight strip bears.
    for push in 1..=8 {
        let next = 1.0 + (chord - 1.0) * f64::from(push * push) / 64.0;
        move_to(&model, &mut state, |_, place| place.with_x(place.x * next / ratio));
        ratio = next;
        settle(&model, &mut state).unwrap_or_else(|rest| panic!("{rest:?} at {ratio}"));
    }
    let rise = middle(&model, &state, CELLS / 2).y / LENGTH;
    let error = rise / (0.5 / K) - 1.0;
    let angle = 4.0 * 0.5 * K / CELLS as f64;
    assert!(error.abs() < angle * angle / 24.0, "{error:e} of the rise");
    // The force P = 4 B K² / L² pushes it together, and second differences draw it with B κ², which is P in the middle.
    let length: f64 =
        (0..CELLS).map(|row| middle(&model, &state, row).distance(middle(&model, &state, row + 1))).sum();
    let strain = 4.0 * RIGIDITY * K * K / (LENGTH * LENGTH) / MODULUS;
    let shortening = (1.0 - length / LENGTH) / strain;
    assert!(0.0 < shortening && shortening < 2.0, "{length} m");
}

/// A strip that is pushed together by a fiftieth and lies level, forty times as far as it bears, must give way to its weight: in an arc
/// below its ends that is the same from left and right. That is no arc of least energy without the weight.
#[test]
fn a_compressed_strip_hangs_down() {
    let (model, mut state) = strip(9.81, &[0, CELLS]);
    move_to(&model, &mut state, |_, place| place.with_x(0.98 * place.x));
    let rest = settle(&model, &mut state).unwrap_or_else(|rest| panic!("{rest:?}"));
    assert!(rest.residual <= EQUILIBRIUM_TOLERANCE * rest.reference + rest.rounding);
    let heights: Vec<f64> = (0..=CELLS).map(|row| middle(&model, &state, row).y).collect();
    assert!(heights[1..CELLS].iter().all(|height| *height < 0.0), "{heights:?}");
    assert!(heights.windows(3).all(|arc| 0.0 < arc[0] - 2.0 * arc[1] + arc[2]), "{heights:?}");
    for (left, right) in heights.iter().zip(heights.iter().rev()) {
        assert!((left - right).abs() < 1e-6 * SPACING, "{heights:?}");
    }
}

/// Conjugate gradients solve for a stretched strip, and not for one that is pushed together: across, it pushes back less than nothing.
#[test]
fn what_is_not_definite_is_seen() {
    for (ratio, is_definite) in [(1.02, true), (0.98, false)] {
        let (model, mut state) = strip(9.81, &[0, CELLS]);
        move_to(&model, &mut state, |_, place| place.with_x(ratio * place.x));
        let mut solver = StaticSolver::new(&model);
        let matrix = solver.unknowns.matrix(|ways, products| eval_products(&model, &state, ways, products));
        assert_eq!(matrix.factor(0.0).is_some(), is_definite);
        // Factors of an earlier state serve all the same.
        solver.factor = matrix.factor(matrix.largest_diagonal());
        let (mut residuals, mut way) = (Vec::new(), Vec::new());
        eval_forces(&model, &state, &mut solver.forces);
        solver.rest(&model, &state, &[], 0, &mut residuals);
        solver.tolerance = 0.5;
        let products = solver.descend(&model, &state, &[], &residuals, &mut way);
        assert_eq!(products.is_some(), is_definite, "{products:?}");
    }
}

/// No particle goes farther than two spacings in a step: from 30 spacings aside it takes 15 steps at least, and 200 are not
/// enough from 800.
#[test]
fn a_start_far_away_takes_its_steps() {
    for (spacings, is_reached) in [(30.0, true), (800.0, false)] {
        let (model, mut state) = strip(9.81, &[0, 1]);
        move_to(&model, &mut state, |s, place| {
            if s < 1.5 * SPACING { place } else { place + DVec3::new(spacings * SPACING, 0.0, 0.0) }
        });
        let settled = settle(&model, &mut state);
        assert_eq!(settled.is_ok(), is_reached, "{settled:?}");
        let (Ok(rest) | Err(rest)) = settled;
        assert!(spacings / LONGEST_WAY <= rest.steps as f64 || !is_reached, "{rest:?}");
        assert!(is_reached || rest.steps == MOST_STEPS, "{rest:?}");
    }
}

/// What nothing holds falls: forces inside of it add up to nothing, so that one particle at least is left with the mean of the weights.
#[test]
fn what_nothing_holds_is_not_at_rest() {
    let (model, mut state) = strip(9.81, &[]);
    let rest = settle(&model, &mut state).expect_err("it falls");
    let masses = model.particles().masses();
    let mean = 9.81 * masses.iter().sum::<f64>() / masses.len() as f64;
    assert_eq!((rest.steps, rest.reference), (MOST_STEPS, 0.0));
    assert!((1.0 - 1e-12) * mean <= rest.residual, "{rest:?}");
    let error = LabError::NotAtRest {
        place: "an overhang of 3 mm".to_owned(),
        rest: Rest { residual: 0.5, reference: 2.0, rounding: 0.0, steps: 60 },
    };
    assert_eq!(
        error.to_string(),
        "the specimen does not come to rest at an overhang of 3 mm: after 60 steps a force of 5e-1 N is left, but must be \
         below 2e-8 N"
    );
}

/// Places that are no numbers have no state at rest near them, and no step is taken.
#[test]
fn what_is_not_a_number_ends_at_once() {
    let (model, mut state) = strip(9.81, &[0, 1]);
    state.positions.set(30, DVec3::new(f64::NAN, 0.0, 0.0));
    let rest = settle(&model, &mut state).expect_err("no number");
    assert!(rest.residual.is_nan() && rest.steps == 0, "{rest:?}");
}

/// A step of three times the way to rest is cut to a third where force falls in a straight line with the way.
#[test]
fn a_step_beyond_rest_is_cut() {
    let (model, mut state) = strip(0.0, &[0, CELLS]);
    // Stretched by a tenth, all but evenly: the rest of the strip pulls the tenth row back.
    move_to(&model, &mut state, |_, place| place.with_x(1.1 * place.x));
    let even = state.positions.clone();
    let offset = DVec3::X * (0.01 * SPACING);
    move_to(
        &model,
        &mut state,
        |s, place| if (s / SPACING).round() == 10.0 { place + offset } else { place },
    );
    let mut solver = StaticSolver::new(&model);
    solver.displacements =
        state.positions.iter().zip(even.iter()).map(|(now, even)| (even - now) * 3.0).collect();
    let (mut residuals, mut way, start) = (Vec::new(), Vec::new(), state.positions.clone());
    solver.unknowns.gather(&solver.displacements, &[], &mut way);
    eval_forces(&model, &state, &mut solver.forces);
    solver.rest(&model, &state, &[], 0, &mut residuals);
    let power = dot_in_lanes(&residuals, &way);
    assert!(0.0 < power);
    solver.go(&model, &mut state, &[], (&start, &way), (1.0, power), &mut residuals);
    let error = largest_distance(&state.positions, &even);
    // Shear springs along the diagonals bend the line by the square of the offset.
    assert!(error < offset.length_squared() / SPACING, "{error:e} m from where it is at rest");
}

fn largest_distance(points: &Points, others: &Points) -> f64 {
    points.iter().zip(others.iter()).map(|(point, other)| point.distance(other)).fold(0.0, f64::max)
}
