//! Internal friction of measured cloth: closed loops in shear, along yarns and in bending give back the hysteresis that the
//! fabric was given.
//!
//! A sheet is deformed by hand as a whole, increment by increment; at each the forces are evaluated and then take note of it. By
//! virtual work the force along the parameter s of the deformation is −Σ F · ∂x/∂s, per area
//!
//! ```text
//! shear force per width at γ    tension per width at e    moment per width at κ
//! ```

use std::sync::LazyLock;

use glam::DVec3;
use muslin::force::{Configuration, Sweep};
use muslin::integrate::{CentralDifference, Integrator, Workers, advance_memory, guaranteed_stable_step};
use muslin::observe::{Observer, Recorder, relative_residual};
use muslin::scene::Fabric;
use muslin::{Model, Points, Scene, State};

use crate::common::{ClothNumbers, SceneNumbers, StepNumbers, finish, larger, max_distance};
use crate::report::{Problem, Row};

/// Values of the instruments of a made-up fabric that has them all: G [gf/(cm deg)], 2HG and 2HG5 [gf/cm], RT, 2HB [gf cm/cm].
const MODULUS: f64 = 0.6;
const HYSTERESIS: f64 = 0.9;
const HYSTERESIS_5: f64 = 1.8;
const RESILIENCE: f64 = 0.65;
const BENDING_HYSTERESIS: f64 = 0.06;

/// gf/cm and gf/(cm deg) in N/m, gf cm/cm in N.
const GF_PER_CM: f64 = 0.980_665;
const PER_DEGREE: f64 = GF_PER_CM * 180.0 / std::f64::consts::PI;
const GF_CM_PER_CM: f64 = 9.806_65e-3;

/// EMT of warp and weft, and their LT.
const EXTENSIONS: [f64; 2] = [0.047, 0.1275];
const LINEARITY: f64 = 0.55;

/// A sheet that deforms as it is told to.
pub(crate) struct Specimen {
    pub(crate) model: Model,
    state: State,
    /// Energy [J] that friction lost so far.
    lost: f64,
    /// Cells along width and height, and their sizes [m].
    cells: [usize; 2],
    spacings: [f64; 2],
}

impl Specimen {
    fn new(cells: [usize; 2], spacings: [f64; 2], warp_rt: f64) -> Self {
        let [width, height] = [0, 1].map(|i| cells[i] as f64 * spacings[i]);
        let text = format!(
            "title = \"specimen\"\nrun = {{ duration = 1.0 }}\nenvironment = {{ gravity = [0, 0, 0] }}\n\
             [fabric.cloth]\nkind = \"measured\"\nareal_density = 0.2\ndrag = 0.0\n\
             warp = {{ emt = {}, lt = {LINEARITY}, force_gf_per_cm = 500, rt = {warp_rt:?} }}\n\
             weft = {{ emt = {}, lt = {LINEARITY}, force_gf_per_cm = 500, rt_percent = {} }}\n\
             shear = {{ g_gf_per_cm_deg = {MODULUS}, 2hg_gf_per_cm = {HYSTERESIS}, 2hg5_gf_per_cm = {HYSTERESIS_5} }}\n\
             bend = {{ warp = {{ rigidity = 9e-6, 2hb_gf_cm_per_cm = {BENDING_HYSTERESIS} }}, \
             weft = {{ rigidity = 6e-6, 2hb_gf_cm_per_cm = {BENDING_HYSTERESIS} }} }}\n\
             [[cloth]]\nname = \"sheet\"\nfabric = \"cloth\"\n\
             grid = {{ columns = {}, rows = {}, width = {width:?}, height = {height:?} }}\n\
             place = {{ origin = [0, 0, 0], width_axis = [1, 0, 0], height_axis = [0, 1, 0] }}\n",
            EXTENSIONS[0],
            EXTENSIONS[1],
            100.0 * RESILIENCE,
            cells[0] + 1,
            cells[1] + 1,
        );
        let scene = Scene::parse(&text).unwrap_or_else(|error| panic!("{}", error.render("test", &text)));
        let model = Model::new(&scene);
        let state = model.initial_state(&scene);
        assert!(
            matches!(&scene.fabrics()["cloth"], Fabric::Measured(fabric) if fabric.friction.shear.is_some())
        );
        Self { model, state, lost: 0.0, cells, spacings }
    }

    fn area(&self) -> f64 {
        (0..2).map(|i| self.cells[i] as f64 * self.spacings[i]).product()
    }

    fn place(&self, shape: impl Fn([f64; 2]) -> DVec3) -> Points {
        let [hx, hy] = self.spacings;
        let place = |j: usize, i: usize| shape([i as f64 * hx, j as f64 * hy]);
        (0..=self.cells[1])
            .flat_map(|j| (0..=self.cells[0]).map(move |i| (j, i)))
            .map(|(j, i)| place(j, i))
            .collect()
    }

    /// Forces [N] on all particles.
    pub(crate) fn forces(&self) -> Points {
        let state = &self.state;
        let at = Configuration {
            time: 0.0,
            particles: self.model.particles(),
            positions: &state.positions,
            velocities: &state.velocities,
            memory: &state.memory,
        };
        let mut forces = Points::zeros(state.positions.len());
        let mut rest = forces.as_mut();
        for block in self.model.blocks() {
            let (mut own, others) = rest.split_at(block.len());
            for force in self.model.forces() {
                force.add_forces(at, block, &mut own, &mut Sweep::default());
            }
            rest = others;
        }
        forces
    }

    /// Deforms the sheet to `shape(s)` and gives the force along s.
    fn deform(&mut self, shape: &impl Fn(f64, [f64; 2]) -> DVec3, s: f64, delta: f64) -> f64 {
        let at = |s: f64| self.place(|place| shape(s, place));
        let (behind, ahead) = (at(s - delta), at(s + delta));
        self.state.positions = at(s);
        let forces = self.forces();
        advance_memory(&Workers::single(), &self.model, &mut self.state);
        self.lost += self.state.friction_loss;
        assert_eq!(forces, self.forces(), "no bit of a force depends on when it slips");
        let rates = behind.iter().zip(ahead.iter()).map(|(behind, ahead)| (ahead - behind) / (2.0 * delta));
        -forces.iter().zip(rates).map(|(force, rate)| force.dot(rate)).sum::<f64>()
    }

    /// Follows `corners` of s in `count` increments between each and the next; the curve s, force on each part.
    fn follow(
        &mut self,
        shape: impl Fn(f64, [f64; 2]) -> DVec3,
        corners: &[f64],
        count: u32,
    ) -> Vec<Vec<[f64; 2]>> {
        let delta = 1e-5 * corners.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        let parts = corners.windows(2).map(|ends| {
            let at = |i: u32| ends[0] + (ends[1] - ends[0]) * f64::from(i) / f64::from(count);
            (0..=count).map(|i| [at(i), self.deform(&shape, at(i), delta)]).collect()
        });
        parts.collect()
    }
}

/// The force at `s`, one of the points of a curve but for rounding.
fn at(curve: &[[f64; 2]], s: f64) -> f64 {
    let nearest = |a: &[f64; 2]| (a[0] - s).abs();
    let found = curve.iter().copied().reduce(|a, b| if nearest(&b) < nearest(&a) { b } else { a });
    let [place, force] = found.unwrap_or([f64::NAN; 2]);
    assert!((place - s).abs() < 1e-9 * s.abs(), "{place} for {s}");
    force
}

/// ∫ force ds by trapezoids.
fn work(curve: &[[f64; 2]]) -> f64 {
    curve.windows(2).map(|pair| 0.5 * (pair[0][1] + pair[1][1]) * (pair[1][0] - pair[0][0])).sum()
}

/// A closed loop after the first: its widths at some s, its area and the energy lost in it, all per area of the sheet.
struct Loop {
    widths: Vec<f64>,
    area: f64,
    lost: f64,
    /// Up and down.
    branches: [Vec<[f64; 2]>; 2],
}

/// From zero to `end`, back to −`end` and around, twice.
fn cycle(
    specimen: &mut Specimen,
    shape: impl Fn(f64, [f64; 2]) -> DVec3,
    end: f64,
    readings: &[f64],
    count: u32,
    area: f64,
) -> Loop {
    specimen.follow(&shape, &[0.0, end, -end, end], count);
    let before = specimen.lost;
    let [down, up] = <[_; 2]>::try_from(specimen.follow(&shape, &[end, -end, end], count))
        .unwrap_or_else(|_| panic!("two branches"));
    let widths = readings.iter().map(|&s| (at(&up, s) - at(&down, s)) / area).collect();
    Loop {
        widths,
        area: (work(&up) + work(&down)) / area,
        lost: (specimen.lost - before) / area,
        branches: [up, down],
    }
}

/// The picture frame: sides as they are, turned by γ.
fn sheared(angle: f64, [x, y]: [f64; 2]) -> DVec3 {
    let (sine, cosine) = libm::sincos(0.5 * angle);
    DVec3::new(x * cosine + y * sine, x * sine + y * cosine, 0.0)
}

fn shear_loop(count: u32) -> (Loop, f64) {
    let mut specimen = Specimen::new([10, 8], [0.02, 0.015], 1.0);
    let area = specimen.area();
    let readings = [0.5_f64, 5.0].map(f64::to_radians);
    let found = cycle(&mut specimen, sheared, 8.0_f64.to_radians(), &readings, count, area);
    // G of the instrument: the slope of the curve, as it is loaded, from 0.5° to 2.5°.
    let [low, high] = [0.5_f64, 2.5].map(f64::to_radians);
    let slope = (at(&found.branches[0], high) - at(&found.branches[0], low)) / (high - low) / area;
    (found, slope)
}

/// Stretched along warp or weft by e and held across.
fn tension_curves(yarns: usize, count: u32) -> ([Vec<[f64; 2]>; 2], Specimen) {
    let mut specimen = Specimen::new([8, 10], [0.02, 0.02], RESILIENCE);
    let shape = move |e: f64, [x, y]: [f64; 2]| match yarns {
        0 => DVec3::new(x, y * (1.0 + e), 0.0),
        _ => DVec3::new(x * (1.0 + e), y, 0.0),
    };
    let curves = specimen.follow(shape, &[0.0, EXTENSIONS[yarns], 0.0], count);
    (<[_; 2]>::try_from(curves).unwrap_or_else(|_| panic!("two branches")), specimen)
}

/// Rolled around the other direction to the curvature κ: cells turn by κ h.
fn rolled(line: usize, spacing: f64) -> impl Fn(f64, [f64; 2]) -> DVec3 {
    move |curvature: f64, place: [f64; 2]| {
        let (turn, along) = (curvature * spacing, (place[line] / spacing).round());
        // The sum of unit vectors at angles of (i − ½ (along − 1)) turn.
        let chord = if turn == 0.0 { along } else { libm::sin(0.5 * along * turn) / libm::sin(0.5 * turn) };
        let direction = 0.5 * (along - 1.0) * turn;
        let (s, z) = (chord * spacing * libm::cos(direction), chord * spacing * libm::sin(direction));
        if line == 0 { DVec3::new(s, place[1], z) } else { DVec3::new(place[0], s, z) }
    }
}

/// Of the specimen's `CELLS` cells in a line, all but one are around its particles that bend.
fn bending_loop(line: usize, count: u32) -> Loop {
    let (mut cells, spacing) = ([5, 5], 1e-3);
    cells[line] = 10;
    let mut specimen = Specimen::new(cells, [spacing; 2], 1.0);
    let area = specimen.area() * (cells[line] - 1) as f64 / cells[line] as f64;
    cycle(&mut specimen, rolled(line, spacing), 250.0, &[50.0, 100.0], count, area)
}

fn loss_row(what: &str, found: &Loop) -> Row {
    Row::new(what, found.area, found.lost, 0.01)
}

pub(crate) static PROBLEM: LazyLock<Problem> = LazyLock::new(|| {
    let mut rows = Vec::new();
    let (shear, modulus) = shear_loop(320);
    rows.push(Row::new("shear: 2HG [N/m]", HYSTERESIS * GF_PER_CM, shear.widths[0], 0.03));
    rows.push(Row::new("shear: 2HG5 [N/m]", HYSTERESIS_5 * GF_PER_CM, shear.widths[1], 0.03));
    rows.push(Row::new("shear: G of the curve up [N/m]", MODULUS * PER_DEGREE, modulus, 0.01));
    rows.push(loss_row("shear: area of the loop, energy lost [J/m²]", &shear));
    for (yarns, name) in ["warp", "weft"].into_iter().enumerate() {
        let ([up, down], specimen) = tension_curves(yarns, 2000);
        let area = specimen.area();
        let (taken, given) = (work(&up) / area, -work(&down) / area);
        let force = at(&up, EXTENSIONS[yarns]) / area;
        let linearity = taken / (0.5 * force * EXTENSIONS[yarns]);
        rows.push(Row::new(format!("{name}: tension at EMT [N/m]"), 500.0 * GF_PER_CM, force, 0.01));
        rows.push(Row::new(format!("{name}: LT of the curve up"), LINEARITY, linearity, 0.01));
        rows.push(Row::new(format!("{name}: RT"), RESILIENCE, given / taken, 0.03));
        // What is left in friction at the end is not lost: next to nothing, as the limit there is zero.
        let lost = specimen.lost / area;
        rows.push(Row::new(
            format!("{name}: area of the loop, energy lost [J/m²]"),
            taken - given,
            lost,
            0.01,
        ));
    }
    for (line, name) in ["weft", "warp"].into_iter().enumerate() {
        let found = bending_loop(line, 500);
        let exact = BENDING_HYSTERESIS * GF_CM_PER_CM;
        rows.push(Row::new(
            format!("bending along {name}: 2HB at 0.5 /cm [N]"),
            exact,
            found.widths[0],
            0.03,
        ));
        rows.push(Row::new(format!("bending along {name}: 2HB at 1 /cm [N]"), exact, found.widths[1], 0.03));
        rows.push(loss_row(&format!("bending along {name}: area of the loop, energy lost [J/m²]"), &found));
    }
    Problem {
        title: "Internal friction",
        text: "A sheet that is deformed by hand as KES does, increment by increment, sheared to ±8°, stretched to 500 gf/cm and \
               back, and bent to ±2.5 /cm: the hysteresis of a closed loop against that which the fabric was given, the curve as it is \
               loaded against its own, and the energy that friction says it lost against the area of the loop. Shear and bending \
               have gone around once before.",
        rows,
    }
});

#[test]
fn loops_have_the_hysteresis_that_went_in() {
    PROBLEM.assert();
}

/// Friction knows where it is and not how it came there: ten times as many increments give the same loop, to roundings of
/// forces and of a difference over 1e-5 of the way.
#[test]
fn loops_do_not_depend_on_increments() {
    let [(coarse, _), (fine, _)] = [32, 320].map(shear_loop);
    for (a, b) in coarse.widths.iter().zip(&fine.widths) {
        assert!((a / b - 1.0).abs() < 1e-8, "{a} and {b} N/m");
    }
    let [coarse, fine] = [50, 500].map(|count| bending_loop(0, count));
    for (a, b) in coarse.widths.iter().zip(&fine.widths) {
        assert!((a / b - 1.0).abs() < 1e-8, "{a} and {b} N");
    }
}

/// The same hysteresis at 5° and 0.5° is what elements of one limit each can do at most: their sum is widest in the middle.
#[test]
fn a_growing_limit_is_what_makes_2hg5_larger() {
    let (found, _) = shear_loop(320);
    let [up, down] = &found.branches;
    let widths: Vec<f64> = up.iter().zip(down.iter().rev()).map(|(up, down)| up[1] - down[1]).collect();
    let middle = widths[widths.len() / 2];
    let widest = widths.iter().copied().fold(0.0, larger);
    assert!(1.5 * middle < widest, "{middle} in the middle of {widest}");
}

/// A small sheet with friction of all kinds, let go from the horizontal.
fn falling(steps_per_frame: u32, step_rule: StepNumbers) -> SceneNumbers {
    SceneNumbers {
        frame_intervals: 20,
        frame_rate: 50.0,
        steps_per_frame,
        step_rule,
        cloths: vec![ClothNumbers {
            columns: 9,
            rows: 9,
            width: 0.2,
            height: 0.2,
            pins: vec![(0, 0), (8, 0)],
            mass: 1e-4,
            drag: 0.0,
            stiffnesses: [80.0, 4.0, 1.5],
            has_friction: true,
            is_measured: true,
            ..ClothNumbers::default()
        }],
        ..SceneNumbers::default()
    }
}

fn record(numbers: &SceneNumbers) -> (Recorder, Points) {
    let mut recorder = Recorder::default();
    let mut simulation = numbers.simulation();
    finish(&mut simulation, &mut recorder);
    (recorder, simulation.frame().state.positions.clone())
}

fn residual(recorder: &Recorder) -> f64 {
    relative_residual(recorder.frames().iter().map(|frame| &frame.energies))
}

/// The energy that friction takes is that which is missing, and both, like the motion, do not depend on the step.
///
/// A slip begins and ends within steps, so that errors of the second order do not fall evenly from step to step: over three
/// halvings by more than 16 of the 64.
#[test]
fn energy_is_accounted_for_and_no_step_matters() {
    let runs = [40, 80, 320].map(|steps_per_frame| record(&falling(steps_per_frame, StepNumbers::Constant)));
    let residuals = runs.each_ref().map(|(recorder, _)| residual(recorder));
    assert!(residuals[0] < 1e-3, "{residuals:?}");
    assert!(residuals[2] < residuals[0] / 16.0, "{residuals:?}");
    let lost = runs.each_ref().map(|(recorder, _)| {
        let frames = recorder.frames();
        let [first, last] = [0, frames.len() - 1].map(|frame| frames[frame].energies);
        last.friction_loss / (first.gravitational - last.gravitational)
    });
    assert!(0.02 < lost[2], "friction takes {lost:?} of the fall");
    assert!((lost[0] / lost[2] - 1.0).abs() < 1e-2, "{lost:?}");
    let [coarse, fine] = [0, 1].map(|run| max_distance(&runs[run].1, &runs[2].1));
    assert!(coarse < 1e-3 * 0.2 && fine < 0.5 * coarse, "{coarse:e} m and {fine:e} m");
    let (adaptive, positions) = record(&falling(1, StepNumbers::Adaptive));
    assert!(residual(&adaptive) < 1e-3, "{:e}", residual(&adaptive));
    assert!(max_distance(&positions, &runs[2].1) < 1e-3 * 0.2);
}

/// Looks at the memory at every accepted and every refused step.
#[derive(Default)]
struct MemoryWatch {
    accepted: Vec<f64>,
    refused: u32,
    losses: Vec<f64>,
}

impl Observer for MemoryWatch {
    fn step(&mut self, _: &Model, state: &State) {
        self.accepted.clone_from(&state.memory);
        self.losses.push(state.friction_loss);
    }

    fn refused_step(&mut self, _: &Model, state: &State) {
        self.refused += 1;
        assert!(self.accepted.is_empty() || self.accepted == state.memory, "a refused step slips");
    }
}

/// Of a run with a tolerance many steps are refused: none of them leaves a trace, and none of the others loses less than nothing.
#[test]
fn refused_steps_do_not_slip() {
    let mut watch = MemoryWatch::default();
    finish(&mut falling(1, StepNumbers::Tolerance(1e-6)).simulation(), &mut watch);
    assert!(10 < watch.refused, "{} refused", watch.refused);
    assert!(watch.losses.iter().all(|loss| 0.0 <= *loss) && watch.losses.iter().any(|loss| 0.0 < *loss));
}

/// A sheet that was bent stays bent. Under drag so large that nothing swings, a strip comes to rest where friction just holds its elastic
/// moment, at 2HB / 2B = 20/m; not quite everywhere, since moments die away from the ends.
#[test]
fn a_strip_that_was_bent_keeps_a_curvature() {
    let text = |drag: f64| {
        format!(
            "title = \"strip\"\nrun = {{ duration = 1.0 }}\nenvironment = {{ gravity = [0, 0, 0] }}\n\
             [fabric.cloth]\nkind = \"measured\"\nareal_density = 0.2\ndrag = {drag:?}\n\
             warp = {{ modulus = 500.0 }}\nweft = {{ modulus = 500.0 }}\nshear = {{ modulus = 30.0 }}\n\
             bend = {{ warp = 9e-6, weft = {{ rigidity = 9e-6, 2hb = 0.36e-3 }} }}\n\
             [[cloth]]\nname = \"strip\"\nfabric = \"cloth\"\n\
             grid = {{ columns = 11, rows = 3, width = 0.03, height = 0.006 }}\n\
             place = {{ origin = [0, 0, 0], width_axis = [1, 0, 0], height_axis = [0, 1, 0] }}\n"
        )
    };
    let scene = Scene::parse(&text(600.0)).unwrap_or_else(|error| panic!("{error}"));
    let model = Model::new(&scene);
    let mut state = model.initial_state(&scene);
    let shape = rolled(0, 0.003);
    let roll = |curvature: f64, state: &mut State| {
        state.positions = crate::common::setup::grid_points(11, 3, |i, j| {
            shape(curvature, [i as f64 * 0.003, j as f64 * 0.003])
        });
        advance_memory(&Workers::single(), &model, state);
    };
    (0..=100).for_each(|i| roll(f64::from(i), &mut state));
    let step = 0.5 * guaranteed_stable_step(&model, &state);
    let mut method = CentralDifference::new(Workers::single());
    (0..150_000)
        .for_each(|_| method.step(&model, &mut state, step).unwrap_or_else(|error| panic!("{error}")));
    let [a, b, c] = [15, 16, 17].map(|particle| state.positions.get(particle));
    let curvature = (a - 2.0 * b + c).length() / (0.003 * 0.003);
    let speed = state.velocities.iter().map(DVec3::length).fold(0.0, larger);
    assert!(speed < 1e-6, "{speed} m/s");
    assert!((18.0..20.5).contains(&curvature), "{curvature} /m");
}
