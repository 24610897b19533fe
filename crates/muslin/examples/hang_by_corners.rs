//! How a square of 30 cm hangs by one corner and by two, of three fabrics without friction, on three grids or four: how far
//! shapes still depend on the grid.
//!
//! `cargo run --release -p muslin --example hang_by_corners -- [CELLS [FOLDER]]`
//!
//! A cloth is rolled around the vertical at first, and in drag until it is still; a finer one begins with the shape of the
//! coarser, so that all have the same folds. The finest has 40 CELLS along an edge, which takes some minutes of processor time, or 80,
//! which takes ten times as long. Prints a table; with a folder it writes a picture of the finest there. Asserts that finer grids are
//! closer to the finest.

use std::f64::consts::SQRT_2;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use glam::{DQuat, DVec3};
use muslin::integrate::Workers;
use muslin::model::Surface;
use muslin::scene::LibraryFabric;
use muslin::write::write_poster;
use muslin::{Model, Points, Scene, Simulation};

type AnyError = Box<dyn std::error::Error + Send + Sync>;

/// Fabrics, taken without their friction in bending, which holds cloth in more than one shape.
const FABRICS: [&str; 3] = ["typical-polyester-faille", "typical-wool-tropical", "typical-cotton-broadcloth"];

/// Length [m] of an edge.
const SIZE: f64 = 0.3;

/// Drag per area [kg/(s m²)]: about that with which a pendulum as long as the cloth comes to rest soonest.
const DRAG: f64 = 1.0;

/// Radius [m] of the roll that a cloth is at first: corners of an edge are 228 mm apart then.
const RADIUS: f64 = 0.12;

/// A cloth is still when no particle is faster [m/s]: in a second it moves by less than a hundredth of a millimetre.
const STILL: f64 = 1e-5;

/// Cells along an edge of the coarsest grid, and of the finest if nobody says; each has twice those of the one before.
const COARSEST: usize = 10;
const FINEST: usize = 40;

/// Distance [m] from one cloth to the next in the picture.
const DISTANCE: f64 = 0.42;

/// A cloth of the fabric that hangs by one corner, or by two.
#[derive(Clone, Copy)]
struct Case {
    fabric: &'static str,
    corners: usize,
}

impl Case {
    fn scene(self, cells: usize) -> Result<Scene, AnyError> {
        let fabric = LibraryFabric::find(self.fabric).ok_or("no such fabric")?;
        let fabric = elastic(fabric.text()).replace("drag = 0.0 ", &format!("drag = {DRAG:?} "));
        let other = if self.corners == 2 { ", { column = -1, row = 0 }" } else { "" };
        Ok(Scene::parse(&format!(
            "title = \"square\"\nrun = {{ duration = 60.0, frame_rate = 20.0 }}\n\
             environment = {{ gravity = [0.0, -9.81, 0.0] }}\n[fabric.f]\n{fabric}\n\
             [[cloth]]\nname = \"square\"\nfabric = \"f\"\n\
             grid = {{ columns = {0}, rows = {0}, width = {SIZE:?}, height = {SIZE:?} }}\n\
             place = {{ origin = [0, 0, 0], width_axis = [1, 0, 0], height_axis = [0, -1, 0] }}\n\
             pins = [{{ column = 0, row = 0 }}{other}]\n",
            cells + 1,
        ))?)
    }

    /// Where a particle is at first [m]: unstretched, on a roll around the vertical, the cloth hung by its corner or its edge.
    fn rolled(self, flat: DVec3) -> DVec3 {
        let (across, down) = match self.corners {
            1 => ((flat.x + flat.y) / SQRT_2, (flat.y - flat.x) / SQRT_2),
            _ => (flat.x - 0.5 * SIZE, flat.y),
        };
        let (sine, cosine) = libm::sincos(across / RADIUS);
        DVec3::new(RADIUS * sine, down, RADIUS * (1.0 - cosine))
    }

    /// The shapes [m] of still cloth on all grids up to that of `finest` cells.
    fn shapes(self, finest: usize) -> Result<Vec<Points>, AnyError> {
        let mut shapes: Vec<Points> = Vec::new();
        for cells in grids(finest) {
            let scene = self.scene(cells)?;
            let model = Model::new(&scene);
            let mut state = model.initial_state(&scene);
            state.positions = match shapes.last() {
                Some(coarser) => refined(coarser, cells),
                None => state.positions.iter().map(|flat| self.rolled(flat)).collect(),
            };
            let method = Simulation::integrator(&scene, Workers::single());
            shapes.push(still(Simulation::resume(&scene, method, state, 0)?)?);
        }
        Ok(shapes)
    }
}

/// Cells along an edge of all grids up to that of `finest`.
fn grids(finest: usize) -> impl Iterator<Item = usize> {
    std::iter::successors(Some(COARSEST), |cells| Some(2 * cells)).take_while(move |cells| *cells <= finest)
}

/// The `text` of a fabric without friction in bending.
fn elastic(text: &str) -> String {
    let parts = text.split(", 2hb = ").enumerate();
    parts
        .map(
            |(index, part)| if index == 0 { part } else { part.split_once(' ').map_or("", |(_, rest)| rest) },
        )
        .collect()
}

/// Positions [m] of all particles when they are still.
fn still(mut simulation: Simulation) -> Result<Points, AnyError> {
    while !simulation.is_finished() {
        simulation.advance(&mut [])?;
        let frame = simulation.frame();
        if frame.velocities.iter().all(|velocity| velocity.length() < STILL) {
            return Ok(frame.state.positions.clone());
        }
    }
    Err("it does not come to rest within a minute".into())
}

/// Number of the particle at a column and row of a grid of `cells` along an edge.
fn particle(cells: usize, column: usize, row: usize) -> usize {
    row * (cells + 1) + column
}

/// The `coarser` shape in `cells`, twice as many: new particles are midway between old ones.
fn refined(coarser: &Points, cells: usize) -> Points {
    let at = |column: usize, row: usize| coarser.get(particle(cells / 2, column, row));
    let places = (0..=cells).flat_map(|row| (0..=cells).map(move |column| (column, row)));
    places
        .map(|(column, row)| {
            let [left, top] = [column / 2, row / 2];
            let [right, bottom] = [column.div_ceil(2), row.div_ceil(2)];
            0.25 * (at(left, top) + at(right, top) + at(left, bottom) + at(right, bottom))
        })
        .collect()
}

/// The places [m] of the nodes of the coarsest grid in a `shape`.
fn nodes(shape: &Points) -> Vec<DVec3> {
    let cells = shape.len().isqrt() - 1;
    let skip = cells / COARSEST;
    let places = (0..=COARSEST).flat_map(|row| (0..=COARSEST).map(move |column| (column, row)));
    places.map(|(column, row)| shape.get(particle(cells, column * skip, row * skip))).collect()
}

/// The mean distance [m] of the nodes of the coarsest grid in two shapes. By one corner, the first in the list, cloth hangs as well
/// turned around the vertical: it is turned to where the sum of the squares is least.
fn mean_distance(shape: &Points, other: &Points, corners: usize) -> f64 {
    let [nodes, others] = [shape, other].map(nodes);
    let pairs = || nodes.iter().zip(&others);
    let across: f64 = pairs().map(|(a, b)| a.z * b.x - a.x * b.z).sum();
    let along: f64 = pairs().map(|(a, b)| a.x * b.x + a.z * b.z).sum();
    let turn =
        if corners == 1 { DQuat::from_rotation_y(libm::atan2(across, along)) } else { DQuat::IDENTITY };
    pairs().map(|(a, b)| (turn * *a).distance(*b)).sum::<f64>() / nodes.len() as f64
}

/// The mean distances [m] of all `shapes` but the finest from that.
fn distances(shapes: &[Points], corners: usize) -> Vec<f64> {
    let Some((finest, others)) = shapes.split_last() else { return Vec::new() };
    others.iter().map(|shape| mean_distance(shape, finest, corners)).collect()
}

/// Writes a picture of `shapes`, three by one corner behind three by two, to `folder`.
fn write_picture(folder: &str, cases: &[Case], shapes: &[&Points]) -> io::Result<()> {
    let (mut surface, mut positions, mut pins) = (Surface::default(), Vec::new(), Vec::new());
    for (index, (case, shape)) in cases.iter().zip(shapes).enumerate() {
        let first = positions.len();
        let side = shape.len().isqrt();
        surface.add_grid(first, side, side, usize::MAX);
        pins.extend([0, side - 1].iter().take(case.corners).map(|column| (first + column) as u32));
        let place = DVec3::new((index / 2) as f64, 0.0, (case.corners - 1) as f64) * DISTANCE;
        positions.extend(shape.iter().map(|position| position + place));
    }
    let file = BufWriter::new(File::create(Path::new(folder).join("hang-by-corners.png"))?);
    write_poster(file, &surface, &positions.into_iter().collect(), &pins, [1200, 900])
}

fn main() -> Result<(), AnyError> {
    let mut arguments = std::env::args().skip(1);
    let finest = arguments.next().map_or(Ok(FINEST), |cells| cells.parse())?;
    let folder = arguments.next();
    if let Some(folder) = &folder {
        std::fs::create_dir_all(folder)?;
    }
    let cases: Vec<Case> =
        FABRICS.into_iter().flat_map(|fabric| [1, 2].map(|corners| Case { fabric, corners })).collect();
    let shapes: Vec<Vec<Points>> = std::thread::scope(|scope| {
        let runs: Vec<_> = cases.iter().map(|case| scope.spawn(|| case.shapes(finest))).collect();
        let joined = runs.into_iter().map(|run| run.join().map_err(|_| "a run panicked")?);
        joined.collect::<Result<_, AnyError>>()
    })?;
    let mut out = io::stdout();
    let others = grids(finest / 2).map(|cells| format!(" {cells} cells from that |"));
    writeln!(out, "| fabric | corners | lowest point, {finest} cells |{}", others.collect::<String>())?;
    writeln!(out, "|---|---|---|{}", "---|".repeat(grids(finest / 2).count()))?;
    for (case, shapes) in cases.iter().zip(&shapes) {
        let lowest = shapes.last().into_iter().flat_map(|shape| shape.y.iter().copied()).fold(0.0, f64::min);
        write!(out, "| `{}` | {} | {:.1} mm |", case.fabric, case.corners, 1e3 * lowest)?;
        for distance in distances(shapes, case.corners) {
            write!(out, " {:.2} mm, {:.2} % |", 1e3 * distance, 100.0 * distance / SIZE)?;
        }
        writeln!(out)?;
    }
    if let Some(folder) = folder {
        let finest: Vec<&Points> = shapes.iter().filter_map(|shapes| shapes.last()).collect();
        write_picture(&folder, &cases, &finest)?;
    }
    for (case, shapes) in cases.iter().zip(&shapes) {
        let distances = distances(shapes, case.corners);
        assert!(distances.is_sorted_by(|a, b| b < a), "a finer grid is no closer: {distances:?} m");
    }
    Ok(())
}
