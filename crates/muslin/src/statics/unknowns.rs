//! What may move, and in which order.

use glam::DVec3;

use super::Slide;
use super::banded::BandedMatrix;
use crate::model::Grid;
use crate::{Model, Points};

/// Axes in which particles move: all of statics is in the plane of x and y.
const AXES: usize = 2;

/// How many particles along the grid's lines forces reach: bending by second differences reaches two, and one on diagonals.
const REACH: usize = 2;

/// Where the particles are that a force on one sees, in columns and rows. Thirteen such diamonds tile the grid, so that with
/// colours 2 i + 3 j modulo 13 every particle sees each colour once at most.
const DIAMOND: [[isize; 2]; 13] = [
    [0, 0],
    [-1, 0],
    [1, 0],
    [0, -1],
    [0, 1],
    [-2, 0],
    [2, 0],
    [0, -2],
    [0, 2],
    [-1, -1],
    [1, -1],
    [-1, 1],
    [1, 1],
];
const COLOURS: usize = DIAMOND.len();

/// The coordinates of the free particles, ordered so that those that forces couple are near, and after them the slides'.
#[derive(Clone, Debug)]
pub(super) struct Unknowns {
    grid: Grid,
    /// The free particles in order; each has an unknown per axis.
    free: Vec<usize>,
    /// Place among the free particles, per particle.
    places: Vec<Option<usize>>,
    half_bandwidth: usize,
}

impl Unknowns {
    /// Those of the only cloth of `model`.
    pub(super) fn new(model: &Model) -> Self {
        let grid = model.cloths()[0].grid;
        let is_wide = grid.rows < grid.columns;
        let (outer, inner) = if is_wide { (grid.columns, grid.rows) } else { (grid.rows, grid.columns) };
        let mut free = Vec::new();
        let mut places = vec![None; model.particles().len()];
        for i in 0..outer {
            for j in 0..inner {
                let particle = if is_wide { grid.particle(i, j) } else { grid.particle(j, i) };
                if !model.particles().pinned()[particle] {
                    places[particle] = Some(free.len());
                    free.push(particle);
                }
            }
        }
        let half_bandwidth = (REACH * inner * AXES + AXES - 1).min((free.len() * AXES).max(1) - 1);
        Self { grid, free, places, half_bandwidth }
    }

    /// Number of coordinates of free particles.
    pub(super) fn count(&self) -> usize {
        self.free.len() * AXES
    }

    /// `vectors` of all particles, as the unknowns see them: sums of a slide's particles along its direction come last.
    pub(super) fn gather(&self, vectors: &Points, slides: &[Slide], values: &mut Vec<f64>) {
        values.clear();
        values.extend(self.free.iter().flat_map(|&particle| [vectors.x[particle], vectors.y[particle]]));
        values.extend(slides.iter().map(|slide| {
            slide.particles.iter().map(|&particle| vectors.get(particle).dot(slide.direction)).sum::<f64>()
        }));
    }

    /// Overwrites `displacements` of all particles with those that `values` of the unknowns give.
    pub(super) fn scatter(&self, values: &[f64], slides: &[Slide], displacements: &mut Points) {
        displacements.fill(0.0);
        for (&particle, value) in self.free.iter().zip(values.chunks_exact(AXES)) {
            displacements.set(particle, DVec3::new(value[0], value[1], 0.0));
        }
        for (slide, value) in slides.iter().zip(&values[self.count()..]) {
            for &particle in &slide.particles {
                displacements.set(particle, displacements.get(particle) + slide.direction * *value);
            }
        }
    }

    /// The matrix of the free particles' unknowns whose products `product` evaluates: with displacements of all particles,
    /// it overwrites the products.
    ///
    /// Particles of one colour are moved together, as each product belongs to one of them.
    pub(super) fn matrix(&self, mut product: impl FnMut(&Points, &mut Points)) -> BandedMatrix {
        let mut matrix = BandedMatrix::zeros(self.count(), self.half_bandwidth);
        let [mut displacements, mut products] = [(); 2].map(|()| Points::zeros(self.places.len()));
        for colour in 0..COLOURS {
            for axis in 0..AXES {
                displacements.fill(0.0);
                for &particle in self.free.iter().filter(|&&particle| self.colour(particle) == Some(colour)) {
                    displacements.set(particle, DVec3::AXES[axis]);
                }
                product(&displacements, &mut products);
                for (place, &particle) in self.free.iter().enumerate() {
                    let Some(source) = self.source(particle, colour) else { continue };
                    let column = source * AXES + axis;
                    matrix.set_lower(place * AXES, column, products.x[particle]);
                    matrix.set_lower(place * AXES + 1, column, products.y[particle]);
                }
            }
        }
        matrix
    }

    fn colour(&self, particle: usize) -> Option<usize> {
        let (column, row) = self.grid.cell(particle)?;
        Some((2 * column + 3 * row) % COLOURS)
    }

    /// The place of the free particle of `colour` that a force on `particle` sees, if there is one.
    fn source(&self, particle: usize, colour: usize) -> Option<usize> {
        let (column, row) = self.grid.cell(particle)?;
        let offset = (colour + COLOURS - self.colour(particle)?) % COLOURS;
        let seen = |&&[columns, rows]: &&[isize; 2]| {
            (2 * columns + 3 * rows).rem_euclid(COLOURS as isize) as usize == offset
        };
        let [columns, rows] = *DIAMOND.iter().find(seen)?;
        let column = column.checked_add_signed(columns).filter(|&column| column < self.grid.columns)?;
        let row = row.checked_add_signed(rows).filter(|&row| row < self.grid.rows)?;
        self.places[self.grid.particle(column, row)]
    }
}
