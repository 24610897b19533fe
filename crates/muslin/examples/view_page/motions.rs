//! Motions that look like cloth, without a simulation.

use std::f64::consts::PI;
use std::io;

use glam::DVec3;
use muslin::Points;
use muslin::model::Surface;

/// A name and its function of time [s].
pub(crate) type Curve = (&'static str, fn(f64) -> f64);

/// Energies [J] that look like those of a swinging sheet.
pub(crate) const ENERGIES: [Curve; 8] = [
    ("kinetic", |t| 0.61 * decay(2.0 * t) * (3.4 * t).sin().powi(2)),
    ("gravitational", |t| -0.96 * (1.0 - decay(t) * (3.4 * t).cos())),
    ("elastic structural", |t| 0.11 * (1.0 - decay(t) * (6.8 * t).cos())),
    ("elastic shear", |t| 0.05 * (1.0 - decay(t) * (5.1 * t).cos())),
    ("elastic bend", |t| 0.012 * (1.0 - decay(t))),
    ("wind work", |t| 0.08 * (1.0 - (2.0 * t).cos()) * decay(0.3 * t)),
    ("drag loss", |t| 0.62 * (1.0 - decay(t))),
    ("residual", |t| 3e-5 * (40.0 * t).sin()),
];

/// Strains [1] likewise.
pub(crate) const STRAINS: [Curve; 6] = [
    ("structural max", |t| 0.06 + 0.03 * decay(t) * (6.8 * t).cos() - 0.09 * decay(3.0 * t)),
    ("structural mean", |t| 0.014 * (1.0 - decay(2.0 * t))),
    ("shear max", |t| 0.05 * (1.0 - decay(t) * (5.0 * t).cos())),
    ("shear mean", |t| 0.011 * (1.0 - decay(2.0 * t))),
    ("bend max", |t| 0.03 * (1.0 - decay(t))),
    ("bend mean", |t| 0.006 * (1.0 - decay(2.0 * t))),
];

fn decay(t: f64) -> f64 {
    (-1.1 * t).exp()
}

/// A made-up motion of a number of particles along each of its directions.
pub(crate) enum Motion {
    /// A sheet that swings down from two corners.
    Sheet(usize),
    /// A sheet that falls far.
    Falling(usize),
    /// A thread that swings from one end.
    Thread(usize),
    /// Single particles that fall apart.
    Beads(usize),
}

impl Motion {
    pub(crate) fn new(name: &str, count: usize) -> io::Result<Self> {
        match name {
            _ if count < 2 => Err(io::Error::other("a motion has at least two particles")),
            "sheet" => Ok(Self::Sheet(count)),
            "falling" => Ok(Self::Falling(count)),
            "thread" => Ok(Self::Thread(count)),
            "beads" => Ok(Self::Beads(count)),
            _ => Err(io::Error::other("a motion is `sheet`, `falling`, `thread` or `beads`")),
        }
    }

    pub(crate) fn title(&self) -> &'static str {
        match self {
            Self::Sheet(_) => "Hanging cloth",
            Self::Falling(_) => "Falling cloth",
            Self::Thread(_) => "A thread that swings",
            Self::Beads(_) => "Beads",
        }
    }

    /// Columns and rows of particles.
    fn grid(&self) -> (usize, usize) {
        match *self {
            Self::Sheet(count) | Self::Falling(count) => (count, count),
            Self::Thread(count) | Self::Beads(count) => (1, count),
        }
    }

    pub(crate) fn surface(&self) -> Surface {
        let (columns, rows) = self.grid();
        let mut surface = Surface::default();
        match *self {
            Self::Beads(count) => (0..count).for_each(|bead| surface.add_grid(bead, 1, 1, 1)),
            _ => surface.add_grid(0, columns, rows, usize::MAX),
        }
        surface
    }

    pub(crate) fn pins(&self) -> Vec<u32> {
        match *self {
            Self::Sheet(count) => vec![0, count as u32 - 1],
            Self::Thread(_) => vec![0],
            Self::Falling(_) | Self::Beads(_) => Vec::new(),
        }
    }

    pub(crate) fn spring_count(&self) -> usize {
        match *self {
            Self::Sheet(n) | Self::Falling(n) => 2 * n * (n - 1) + 2 * (n - 1) * (n - 1) + 2 * n * (n - 2),
            Self::Thread(n) => 2 * n - 3,
            Self::Beads(_) => 0,
        }
    }

    /// Positions [m] of all particles at `time` [s].
    pub(crate) fn positions(&self, time: f64) -> Points {
        let (columns, rows) = self.grid();
        let share = |index: usize, count: usize| index as f64 / (count.max(2) - 1) as f64;
        (0..columns * rows)
            .map(|p| self.point(share(p % columns, columns), share(p / columns, rows), time))
            .collect()
    }

    /// The particle at (u, v) in [0, 1]² at time t [s].
    fn point(&self, u: f64, v: f64, t: f64) -> DVec3 {
        let swing = decay(t) * (3.4 * t).cos();
        match self {
            Self::Sheet(_) => {
                let fall = 1.0 - swing; // 0 flat, 1 hanging
                let (down, out) = (fall * PI / 2.0).sin_cos();
                let ripple = v * (0.05 * (5.0 * PI * u + 2.0 * t).sin() + 0.1 * (PI * u).sin()) * fall;
                let along = v * (1.0 + 0.03 * fall) + 0.18 * (PI * u).sin() * fall;
                let x = (u - 0.5) * (1.0 - 0.24 * v * fall);
                DVec3::new(x, 1.0 - along * down - ripple * out, along * out + ripple * down)
            }
            Self::Falling(_) => {
                let fall = 2.0 * (t + 0.5 * ((-2.0 * t).exp() - 1.0)) * 4.9;
                let dome = 0.3 * ((u - 0.5).powi(2) + (v - 0.5).powi(2)) * (1.0 - decay(2.0 * t));
                let flutter = 0.03 * (8.0 * u + 6.0 * v + 5.0 * t).sin() * (1.0 - decay(t));
                DVec3::new(u - 0.5, 30.0 - fall + dome + flutter, v - 0.5)
            }
            Self::Thread(_) => {
                let angle = 1.2 * swing * (1.0 + 0.15 * v * (9.0 * t).sin());
                DVec3::new(v * angle.sin(), 2.0 - v * angle.cos(), 0.05 * v * (4.0 * t).sin())
            }
            Self::Beads(_) => DVec3::new(4.0 * v - 2.0, 5.0 - 0.5 * (1.0 - v) * t * t, (6.0 * v).sin()),
        }
    }

    /// Overwrites `strains` [1] with the mean stretch of each particle towards the next row and column.
    pub(crate) fn eval_strains(&self, positions: &Points, strains: &mut Vec<f32>) {
        let (columns, rows) = self.grid();
        let rest = 1.0 / (rows - 1) as f64;
        let stretch = |from: usize, to: usize| positions.get(from).distance(positions.get(to)) / rest - 1.0;
        strains.clear();
        strains.extend((0..positions.len()).map(|p| {
            let row = if p + columns < positions.len() { p } else { p - columns };
            let column = if p % columns + 1 < columns { p } else { p.saturating_sub(1) };
            match self {
                Self::Beads(_) => 0.0,
                Self::Thread(_) => stretch(row, row + 1) as f32,
                _ => (0.5 * stretch(row, row + columns) + 0.2 * stretch(column, column + 1)) as f32,
            }
        }));
    }
}
