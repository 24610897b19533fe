//! Writes every format from positions that no simulation made: a waving sheet, a swinging string and a bead.
//!
//! `cargo run -p muslin --example write_formats -- FOLDER [FRAMES] [COLUMNS]`

use std::fs::File;
use std::io::{self, BufReader, BufWriter};
use std::path::PathBuf;

use glam::DVec3;
use muslin::Points;
use muslin::model::Surface;
use muslin::write::{
    FrameSource, GlbInfo, MotionSource, TrajectoryReader, write_glb, write_series, write_trajectory,
};

const FRAME_RATE: f64 = 60.0;

/// Particles at a time [s]: a sheet of `columns` x `columns`, then a string of 8, then one.
fn positions(columns: usize, time: f64) -> Points {
    let sheet = (0..columns * columns).map(|p| {
        let (u, v) =
            ((p % columns) as f64 / (columns - 1) as f64, (p / columns) as f64 / (columns - 1) as f64);
        DVec3::new(u - 0.5, 2.0 - v, 0.3 * v * (5.0 * time + 4.0 * u + 2.0 * v).sin())
    });
    let angle = |n: f64| 0.1 * n * (3.0 * time).cos();
    let string = (0..8).map(|n| DVec3::new(1.0 + angle(n.into()).sin(), 2.0 - 0.1 * f64::from(n), 0.0));
    sheet.chain(string).chain([DVec3::new(-1.0, 2.0 - 0.5 * time, 0.2)]).collect()
}

/// The run: how many frames of how many columns.
struct Run(usize, usize);

impl FrameSource for Run {
    fn frame_count(&self) -> usize {
        self.0
    }

    fn read_positions(&mut self, frame: usize, points: &mut Points) -> io::Result<()> {
        *points = positions(self.1, frame as f64 / FRAME_RATE);
        Ok(())
    }
}

impl MotionSource for Run {
    fn read_velocities(&mut self, frame: usize, points: &mut Points) -> io::Result<()> {
        // Central differences over 0.2 ms: exact to about 1e-6 m/s.
        let near = |offset: f64| positions(self.1, frame as f64 / FRAME_RATE + offset);
        *points = near(1e-4).iter().zip(near(-1e-4).iter()).map(|(b, a)| (b - a) / 2e-4).collect();
        Ok(())
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = PathBuf::from(arguments.next().ok_or("which folder?")?);
    let frames: usize = arguments.next().map_or(Ok(181), |text| text.parse())?;
    let columns: usize = arguments.next().map_or(Ok(10), |text| text.parse())?;
    let mut surface = Surface::default();
    surface.add_grid(0, columns, columns, usize::MAX);
    surface.add_grid(columns * columns, 1, 8, usize::MAX);
    surface.add_grid(columns * columns + 8, 1, 1, usize::MAX);

    let create = |name: &str| File::create(folder.join(name)).map(BufWriter::new);
    let times: Vec<f64> = (0..frames).map(|frame| frame as f64 / FRAME_RATE).collect();
    let mut run = Run(frames, columns);
    write_trajectory(create("trajectory.npz")?, &times, &surface.triangles, &mut run)?;
    let info = GlbInfo {
        title: "A \"waving\" sheet: 布",
        cloth_names: &["sheet", "string", "bead"],
        frame_rate: FRAME_RATE,
    };
    write_glb(create("cloth.glb")?, &info, &surface, &mut run)?;
    let squares: Vec<f64> = times.iter().map(|time| time * time).collect();
    write_series(create("series.csv")?, &[("time [s]", &times), ("square, \"t²\" [s²]", &squares)])?;

    let mut reader = TrajectoryReader::new(BufReader::new(File::open(folder.join("trajectory.npz"))?))?;
    let mut last = Points::default();
    reader.read_positions(frames - 1, &mut last)?;
    assert_eq!(last, positions(columns, times[frames - 1]));
    Ok(())
}
