//! Measures how the scene `flag-flutter` flutters: frequency, swing and wave of its middle row.
//!
//! `cargo run --release -p muslin --example measure_flutter`; the path of another scene with a flag of the same grid may follow.

#![allow(clippy::print_stdout, reason = "its numbers are what it is for")]

use muslin::glam::DVec3;
use muslin::integrate::Workers;
use muslin::observe::{Frame, Observer};
use muslin::scene::WindSettings;
use muslin::{Model, Scene, Simulation};

/// Time [s] after which the flag has forgotten how it started.
const SETTLED: f64 = 2.0;

/// What the middle row of particles does across the wind [m], frame by frame.
#[derive(Default)]
struct MiddleRow {
    across: DVec3,
    frames: Vec<(f64, Vec<f64>)>,
}

impl Observer for MiddleRow {
    fn frame(&mut self, model: &Model, frame: &Frame<'_>) {
        let grid = model.cloths()[0].grid;
        let offset =
            |column| frame.state.positions.get(grid.particle(column, grid.rows / 2)).dot(self.across);
        if SETTLED <= frame.state.time {
            self.frames.push((frame.state.time, (0..grid.columns).map(offset).collect()));
        }
    }
}

impl MiddleRow {
    /// Amplitude [m] and phase [rad] of `column` at `frequency` [1/s]: a Fourier transform in a Hann window.
    fn wave(&self, column: usize, frequency: f64) -> (f64, f64) {
        let count = self.frames.len() as f64;
        let mean = self.frames.iter().map(|(_, row)| row[column]).sum::<f64>() / count;
        let (mut sine, mut cosine) = (0.0, 0.0);
        for (k, (time, row)) in self.frames.iter().enumerate() {
            let window = 1.0 - (std::f64::consts::TAU * k as f64 / count).cos();
            let phase = std::f64::consts::TAU * frequency * time;
            cosine += window * (row[column] - mean) * phase.cos();
            sine += window * (row[column] - mean) * phase.sin();
        }
        (2.0 / count * sine.hypot(cosine), sine.atan2(cosine))
    }

    /// Largest less smallest place [m] of the last column, and √8 times its deviation: of a sine they are the same.
    fn swings(&self, last: usize) -> (f64, f64) {
        let places = || self.frames.iter().map(|(_, row)| row[last]);
        let mean = places().sum::<f64>() / self.frames.len() as f64;
        let square = places().map(|place| (place - mean).powi(2)).sum::<f64>() / self.frames.len() as f64;
        (places().fold(f64::MIN, f64::max) - places().fold(f64::MAX, f64::min), (8.0 * square).sqrt())
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let other = std::env::args().nth(1).map(std::fs::read_to_string).transpose()?;
    let scene = Scene::parse(other.as_deref().unwrap_or(include_str!("../../../scenes/flag-flutter.toml")))?;
    let [WindSettings::Aerodynamic(air)] = scene.environment().winds[..] else {
        return Err("one steady aerodynamic wind".into());
    };
    let mut row = MiddleRow { across: air.velocity.cross(DVec3::Y).normalize(), ..MiddleRow::default() };
    let mut simulation = Simulation::new(&scene, Simulation::integrator(&scene, Workers::single()))?;
    while !simulation.is_finished() {
        simulation.advance(&mut [&mut row])?;
    }

    let (grid, speed) = (simulation.model().cloths()[0].grid, air.velocity.length());
    let (last, length) = (grid.columns - 1, (grid.columns - 1) as f64 * grid.column_spacing);
    let trial = |k: usize| 0.3 + 0.01 * k as f64;
    let loudness = |&a: &usize, &b: &usize| row.wave(last, trial(a)).0.total_cmp(&row.wave(last, trial(b)).0);
    let frequency = trial((0..700).max_by(loudness).unwrap_or_default());
    // Over the outer half, where the wave runs freely; its phase lags less than half a turn.
    let lag =
        (row.wave(last, frequency).1 - row.wave(last / 2, frequency).1).rem_euclid(std::f64::consts::TAU);
    let wave_length = std::f64::consts::TAU / lag * (last - last / 2) as f64 * grid.column_spacing;
    let (largest, mean) = row.swings(last);
    println!("frequency {frequency:.2} /s, f L / U = {:.3}", frequency * length / speed);
    println!("swing {largest:.3} m at most, {mean:.3} m on average, of {length} m");
    println!("wave of {:.2} L at {:.2} U", wave_length / length, frequency * wave_length / speed);
    if other.is_none() {
        assert!(
            (1.5..1.7).contains(&frequency) && (0.25..0.30).contains(&mean),
            "the flag flutters otherwise"
        );
    }
    Ok(())
}
