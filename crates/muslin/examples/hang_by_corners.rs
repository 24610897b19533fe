//! How a square of 30 cm hangs by one corner and by two, of three fabrics, on three grids: how far shapes
//! still depend on the grid.
//!
//! `cargo run --release -p muslin --example hang_by_corners -- [FOLDER]`
//!
//! A cloth is rolled around the vertical at first, and in drag until it is still; a finer one begins with the shape of the
//! coarser. Prints a table; with a folder it writes a picture of the finest there. Asserts that they come closer. It takes some minutes
//! of processor time.

use std::f64::consts::SQRT_2;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use glam::DVec3;
use muslin::integrate::Workers;
use muslin::model::Surface;
use muslin::scene::LibraryFabric;
use muslin::write::write_poster;
use muslin::{Model, Points, Scene, Simulation};

type AnyError = Box<dyn std::error::Error + Send + Sync>;

const FABRICS: [&str; 3] = ["typical-polyester-faille", "typical-wool-tropical", "typical-cotton-broadcloth"];

/// Length [m] of an edge.
const SIZE: f64 = 0.3;

/// Drag per area [kg/(s m²)]: about that with which a pendulum as long as the cloth comes to rest soonest.
const DRAG: f64 = 1.5;

/// Radius [m] of the roll that a cloth is at first: corners of an edge are 228 mm apart then.
const RADIUS: f64 = 0.12;

/// A cloth is still when no particle is faster [m/s]: in a second it moves by less than a tenth of a millimetre.
const STILL: f64 = 1e-4;

/// Cells along an edge, each twice the one before.
const CELLS: [usize; 3] = [10, 20, 40];

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
        let fabric = fabric.text().replace("drag = 0.0 ", &format!("drag = {DRAG:?} "));
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

    /// The shapes [m] of still cloth on all grids.
    fn shapes(self) -> Result<Vec<Points>, AnyError> {
        let mut shapes: Vec<Points> = Vec::new();
        for cells in CELLS {
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

/// The mean distance [m] of the nodes of the coarsest grid in a shape of `cells` from those in the `finest`.
fn mean_distance(shape: &Points, cells: usize, finest: &Points) -> f64 {
    let (skip, finest_skip) = (cells / CELLS[0], CELLS[2] / CELLS[0]);
    let mut sum = 0.0;
    for row in 0..=CELLS[0] {
        for column in 0..=CELLS[0] {
            let own = shape.get(particle(cells, column * skip, row * skip));
            sum += own.distance(finest.get(particle(CELLS[2], column * finest_skip, row * finest_skip)));
        }
    }
    sum / (CELLS[0] + 1).pow(2) as f64
}

/// Writes a picture of `shapes`, three by one corner behind three by two, to `folder`.
fn write_picture(folder: &str, cases: &[Case], shapes: &[&Points]) -> io::Result<()> {
    let (mut surface, mut positions, mut pins) = (Surface::default(), Vec::new(), Vec::new());
    for (index, (case, shape)) in cases.iter().zip(shapes).enumerate() {
        let first = positions.len();
        let side = CELLS[2] + 1;
        surface.add_grid(first, side, side, usize::MAX);
        pins.extend([0, CELLS[2]].iter().take(case.corners).map(|column| (first + column) as u32));
        let place = DVec3::new((index / 2) as f64, 0.0, (case.corners - 1) as f64) * DISTANCE;
        positions.extend(shape.iter().map(|position| position + place));
    }
    let file = BufWriter::new(File::create(Path::new(folder).join("hang-by-corners.png"))?);
    write_poster(file, &surface, &positions.into_iter().collect(), &pins, [1200, 900])
}

fn main() -> Result<(), AnyError> {
    let cases: Vec<Case> =
        FABRICS.into_iter().flat_map(|fabric| [1, 2].map(|corners| Case { fabric, corners })).collect();
    let shapes: Vec<Vec<Points>> = std::thread::scope(|scope| {
        let runs: Vec<_> = cases.iter().map(|case| scope.spawn(|| case.shapes())).collect();
        let joined = runs.into_iter().map(|run| run.join().map_err(|_| "a run panicked")?);
        joined.collect::<Result<_, AnyError>>()
    })?;
    let mut out = io::stdout();
    writeln!(out, "| fabric | corners | lowest point, 40 cells | 10 cells from that | 20 cells from that |")?;
    writeln!(out, "|---|---|---|---|---|")?;
    for (case, shapes) in cases.iter().zip(&shapes) {
        let finest = &shapes[2];
        let [far, near] = [0, 1].map(|grid| mean_distance(&shapes[grid], CELLS[grid], finest));
        let lowest = finest.y.iter().copied().fold(f64::INFINITY, f64::min);
        writeln!(
            out,
            "| `{}` | {} | {:.1} mm | {:.2} mm, {:.2} % | {:.2} mm, {:.2} % |",
            case.fabric,
            case.corners,
            1e3 * lowest,
            1e3 * far,
            100.0 * far / SIZE,
            1e3 * near,
            100.0 * near / SIZE,
        )?;
    }
    if let Some(folder) = std::env::args().nth(1) {
        let finest: Vec<&Points> = shapes.iter().map(|shapes| &shapes[2]).collect();
        write_picture(&folder, &cases, &finest)?;
    }
    for shapes in &shapes {
        let [far, near] = [0, 1].map(|grid| mean_distance(&shapes[grid], CELLS[grid], &shapes[2]));
        assert!(near < far, "a finer grid is no closer: {far:e} m, then {near:e} m");
    }
    Ok(())
}
