//! Writes every format from positions that no simulation made: a waving sheet, a swinging string and a bead.
//!
//! `cargo run -p muslin --example write_formats -- FOLDER [FRAMES]`

use std::fs::File;
use std::io::{self, BufReader, BufWriter, Write};
use std::path::PathBuf;

use glam::DVec3;
use muslin::write::{FrameSource, GlbInfo, MotionSource, TrajectoryReader};
use muslin::write::{write_glb, write_series, write_trajectory};
use muslin::{Points, model::Surface};

/// Positions of a sheet of 10 x 10, a string of 8 and a bead, 60 times a second.
struct Waves(usize);

impl FrameSource for Waves {
    fn frame_count(&self) -> usize {
        self.0
    }

    fn read_positions(&mut self, frame: usize, points: &mut Points) -> io::Result<()> {
        let time = frame as f64 / 60.0;
        let sheet = (0..100).map(|p| {
            let (u, v) = (f64::from(p % 10) / 9.0, f64::from(p / 10) / 9.0);
            DVec3::new(u - 0.5, 2.0 - v, 0.3 * v * (5.0 * time + 4.0 * u + 2.0 * v).sin())
        });
        let sway = |n: f64| (0.1 * n * (3.0 * time).cos()).sin();
        let string = (0..8).map(|n| DVec3::new(1.0 + sway(n.into()), 2.0 - 0.1 * f64::from(n), 0.0));
        *points = sheet.chain(string).chain([DVec3::new(-1.0, 2.0 - 0.5 * time, 0.2)]).collect();
        Ok(())
    }
}

impl MotionSource for Waves {
    fn read_velocities(&mut self, _: usize, points: &mut Points) -> io::Result<()> {
        *points = Points::zeros(109);
        Ok(())
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let Some(folder) = arguments.next().map(PathBuf::from) else {
        writeln!(io::stderr(), "usage: write_formats FOLDER [FRAMES]")?;
        std::process::exit(2);
    };
    let mut run = Waves(arguments.next().map_or(Ok(181), |text| text.parse())?);
    let mut surface = Surface::default();
    for (first_particle, columns, rows) in [(0, 10, 10), (100, 1, 8), (108, 1, 1)] {
        surface.add_grid(first_particle, columns, rows, usize::MAX);
    }
    let create = |name: &str| File::create(folder.join(name)).map(BufWriter::new);
    let times: Vec<f64> = (0..run.0).map(|frame| frame as f64 / 60.0).collect();
    write_trajectory(create("trajectory.npz")?, &times, &surface.triangles, &mut run)?;
    let cloth_names = &["sheet", "string", "bead"];
    let info = GlbInfo { title: "A \"waving\" sheet: 布", cloth_names, frame_rate: 60.0 };
    write_glb(create("cloth.glb")?, &info, &surface, &mut run)?;
    write_series(create("series.csv")?, &[("time [s]", &times)])?;
    let mut reader = TrajectoryReader::new(BufReader::new(File::open(folder.join("trajectory.npz"))?))?;
    assert_eq!(reader.read_triangles()?, surface.triangles);
    Ok(())
}
