//! Wind that pushes faces, not particles.

use std::ops::Range;

use glam::DVec3;

use super::{Configuration, Force, Gust, Sweep};
use crate::instructions::Vectorise;
use crate::model::Grid;
use crate::{InstructionSet, Points, PointsMut};

/// Cells of a grid whose forces are at hand at a time, in a core's first-level cache.
const CHUNK: usize = 128;

/// Air in motion, which pushes each face of a cloth by its velocity relative to it.
///
/// A face is a cell of a grid, the surface that is bilinear between its corners a, b, c, d (in turn around it). With air of
/// density ρ and velocity w(t), the same everywhere:
///
/// ```text
/// S = ½ (c − a) × (d − b) = A n [m²]    u = w − ¼ (v_a + v_b + v_c + v_d) [m/s]    u_t = u − (u·n) n
///
/// F = ½ ρ A [C_N |u·n| (u·n) n + C_T |u| u_t] [N]        a quarter of it on each corner
/// ```
///
/// The first term is the pressure on a plate, the second friction along it. In still air (w = 0) they are drag. The law is
/// that of a plate in steady flow, face by face: no wake, no lift but that of the pressure, no air that moves with the cloth, no
/// lee of other faces.
///
/// S is the area vector of the bilinear surface, and that of both ways to cut the cell into two triangles, so that nothing
/// depends on a diagonal. For a flat convex cell A is its area; where a cell is creased, S is the sum of the areas of its parts
/// as vectors, and a cell that is folded onto itself or has no extent, A = 0, feels nothing. A grid of one row or column has
/// no faces.
#[derive(Clone, Debug, PartialEq)]
pub struct AerodynamicWind {
    /// Density of the air ρ [kg/m³].
    pub air_density: f64,
    /// Coefficient C_N [1] of the pressure along the normal.
    pub normal_coefficient: f64,
    /// Coefficient C_T [1] of the friction along the face.
    pub tangential_coefficient: f64,
    /// Mean velocity of the air [m/s].
    pub velocity: DVec3,
    /// What comes on top of it [m/s].
    pub gusts: Vec<Gust>,
    /// Grids whose cells are faces.
    pub grids: Vec<Grid>,
    /// What its loops are compiled for.
    pub instructions: InstructionSet,
}

impl AerodynamicWind {
    /// Velocity w of the air [m/s] at `time` [s], which must not be negative.
    #[must_use]
    pub fn air_velocity(&self, time: f64) -> DVec3 {
        self.gusts.iter().fold(self.velocity, |velocity, gust| velocity + gust.value(time))
    }

    /// The cells that the particles of `block` are corners of, in ascending order and at most [`CHUNK`] at a time, each with
    /// where their first and second rows of corners begin in the block, if they do.
    ///
    /// Cells on the border of two blocks are among those of both. So every particle gets what its cells add in the same order,
    /// whatever the blocks.
    fn runs(&self, block: &Range<usize>) -> impl Iterator<Item = (Cells, [Option<usize>; 2])> + use<> {
        let found = self.grids.iter().find_map(|grid| Some((*grid, grid.block_rows(block)?)));
        let start = block.start;
        found.into_iter().flat_map(move |(grid, rows)| {
            let cell_rows = rows.start.saturating_sub(1)..rows.end.min(grid.rows - 1);
            let columns = (0..grid.columns - 1).step_by(CHUNK);
            let places = cell_rows.flat_map(move |row| columns.clone().map(move |column| (column, row)));
            places.map(move |(column, row)| {
                let cells = Cells {
                    first: grid.particle(column, row),
                    count: CHUNK.min(grid.columns - 1 - column),
                    columns: grid.columns,
                };
                let target = |row: usize| rows.contains(&row).then(|| grid.particle(column, row) - start);
                (cells, [target(row), target(row + 1)])
            })
        })
    }
}

/// Adds the forces [N] of the air on a block.
struct AddForces<'a, 'b> {
    wind: &'a AerodynamicWind,
    at: Configuration<'a>,
    block: &'a Range<usize>,
    forces: &'a mut PointsMut<'b>,
}

impl Vectorise for AddForces<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { wind, at, block, forces } = self;
        let air = wind.air_velocity(at.time);
        let (mut faces, mut corner_forces) = (Faces::NONE, [[0.0; CHUNK]; 3]);
        for (cells, targets) in wind.runs(block) {
            faces.eval(at, air, cells);
            faces.eval_corner_forces(wind, &mut corner_forces);
            for target in targets.into_iter().flatten() {
                let corners = target..target + cells.count + 1;
                let [x, y, z] = &corner_forces;
                add_to_corners(&mut forces.x[corners.clone()], x);
                add_to_corners(&mut forces.y[corners.clone()], y);
                add_to_corners(&mut forces.z[corners], z);
            }
        }
    }
}

/// Adds bounds [kg/s] on the damping of a block by the air.
struct AddBounds<'a> {
    wind: &'a AerodynamicWind,
    at: Configuration<'a>,
    block: &'a Range<usize>,
    bounds: &'a mut [f64],
}

impl Vectorise for AddBounds<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { wind, at, block, bounds } = self;
        let air = wind.air_velocity(at.time);
        let (mut faces, mut corner_bounds) = (Faces::NONE, [0.0; CHUNK]);
        for (cells, targets) in wind.runs(block) {
            faces.eval(at, air, cells);
            faces.eval_corner_bounds(wind, &mut corner_bounds);
            for target in targets.into_iter().flatten() {
                add_to_corners(&mut bounds[target..target + cells.count + 1], &corner_bounds);
            }
        }
    }
}

/// Neighbouring cells of one row.
#[derive(Clone, Copy, Debug)]
struct Cells {
    /// Particle at the first corner of the first cell.
    first: usize,
    /// Number of cells.
    count: usize,
    /// Particles from a row to the next.
    columns: usize,
}

impl Cells {
    /// Each coordinate of the four corners of all cells, in turn around each.
    fn corner_axes<'a>(&self, points: &'a Points) -> [[&'a [f64]; 4]; 3] {
        let offsets = [0, 1, self.columns + 1, self.columns];
        [&points.x, &points.y, &points.z]
            .map(|axis| offsets.map(|offset| &axis[self.first + offset..][..self.count]))
    }
}

/// The faces of some cells, coordinate by coordinate, so that loops over them vectorise.
struct Faces {
    count: usize,
    /// From the first to the third corner [m].
    diagonals: [[f64; CHUNK]; 3],
    /// From the second to the fourth corner [m].
    other_diagonals: [[f64; CHUNK]; 3],
    /// Velocities of the air relative to the faces [m/s].
    velocities: [[f64; CHUNK]; 3],
}

impl Faces {
    const NONE: Self = Self {
        count: 0,
        diagonals: [[0.0; CHUNK]; 3],
        other_diagonals: [[0.0; CHUNK]; 3],
        velocities: [[0.0; CHUNK]; 3],
    };

    /// Replaces the faces by those of `cells` in air of velocity `air` [m/s].
    #[inline(always)]
    fn eval(&mut self, at: Configuration<'_>, air: DVec3, cells: Cells) {
        self.count = cells.count;
        for (axis, [a, b, c, d]) in cells.corner_axes(at.positions).into_iter().enumerate() {
            difference(&mut self.diagonals[axis], c, a);
            difference(&mut self.other_diagonals[axis], d, b);
        }
        for (axis, corners) in cells.corner_axes(at.velocities).into_iter().enumerate() {
            relative_to_mean(&mut self.velocities[axis], air[axis], corners);
        }
    }

    /// Overwrites the first `forces` with those [N] on each corner of the faces.
    #[inline(always)]
    fn eval_corner_forces(&self, wind: &AerodynamicWind, forces: &mut [[f64; CHUNK]; 3]) {
        let factor = 0.125 * wind.air_density;
        let [x, y, z] = forces;
        for i in 0..self.count.min(CHUNK) {
            let face = self.face(i);
            let pressure = wind.normal_coefficient * face.normal_speed.abs();
            let friction = wind.tangential_coefficient * face.speed;
            let along_normal = (pressure - friction) * face.normal_speed;
            let force = (face.normal * along_normal + face.velocity * friction) * (factor * face.area);
            (x[i], y[i], z[i]) = (force.x, force.y, force.z);
        }
    }

    /// Overwrites the first `bounds` [kg/s] with what the faces add at each corner.
    #[inline(always)]
    fn eval_corner_bounds(&self, wind: &AerodynamicWind, bounds: &mut [f64; CHUNK]) {
        for (i, bound) in bounds[..self.count.min(CHUNK)].iter_mut().enumerate() {
            let face = self.face(i);
            let slope =
                wind.normal_coefficient * face.normal_speed.abs() + wind.tangential_coefficient * face.speed;
            *bound = 0.25 * wind.air_density * face.area * slope;
        }
    }

    /// Face number `i`.
    #[inline(always)]
    fn face(&self, i: usize) -> Face {
        let [[px, py, pz], [qx, qy, qz]] = [&self.diagonals, &self.other_diagonals];
        let [x, y, z] = &self.velocities;
        let (p, q) = (DVec3::new(px[i], py[i], pz[i]), DVec3::new(qx[i], qy[i], qz[i]));
        Face::new(p.cross(q) * 0.5, DVec3::new(x[i], y[i], z[i]))
    }
}

/// Overwrites the first `values` with a − b.
#[inline(always)]
fn difference(values: &mut [f64; CHUNK], a: &[f64], b: &[f64]) {
    let count = a.len().min(CHUNK);
    let (a, b) = (&a[..count], &b[..count]);
    for i in 0..count {
        values[i] = a[i] - b[i];
    }
}

/// Overwrites the first `values` with `air` less the mean of four corners, opposite ones first, so that it does not matter
/// from which corner a cell is counted.
#[inline(always)]
fn relative_to_mean(values: &mut [f64; CHUNK], air: f64, [a, b, c, d]: [&[f64]; 4]) {
    let count = a.len().min(CHUNK);
    let (a, b, c, d) = (&a[..count], &b[..count], &c[..count], &d[..count]);
    for i in 0..count {
        values[i] = air - 0.25 * ((a[i] + c[i]) + (b[i] + d[i]));
    }
}

/// A face, and how the air moves relative to it.
struct Face {
    /// Area A [m²].
    area: f64,
    /// Unit normal n [1]; zero without area.
    normal: DVec3,
    /// Velocity u of the air relative to the face [m/s].
    velocity: DVec3,
    /// |u| [m/s].
    speed: f64,
    /// u · n [m/s].
    normal_speed: f64,
}

impl Face {
    #[inline(always)]
    fn new(area: DVec3, velocity: DVec3) -> Self {
        let size = area.length();
        // None without area, by a division that is the same for all.
        let normal = area * (1.0 / if size > 0.0 { size } else { f64::INFINITY });
        let speed = velocity.length();
        Self { area: size, normal, velocity, speed, normal_speed: velocity.dot(normal) }
    }
}

impl Force for AerodynamicWind {
    fn add_forces(
        &self,
        at: Configuration<'_>,
        block: &Range<usize>,
        forces: &mut PointsMut<'_>,
        _sweep: &mut Sweep,
    ) {
        self.instructions.run(AddForces { wind: self, at, block, forces });
    }

    fn longest_step(&self) -> f64 {
        self.gusts.iter().map(Gust::longest_step).fold(f64::INFINITY, f64::min)
    }

    fn depends_on_velocity(&self) -> bool {
        true
    }

    /// ```text
    /// |∂F/∂u| ≤ ρ A (C_N |u·n| + C_T |u|)
    /// ```
    ///
    /// of which a quarter acts on each corner, and a quarter of ∂u is due to each.
    fn add_damping_bounds(&self, at: Configuration<'_>, block: &Range<usize>, bounds: &mut [f64]) {
        self.instructions.run(AddBounds { wind: self, at, block, bounds });
    }

    fn is_external(&self) -> bool {
        true
    }
}

/// Adds to both corners of each cell its value, the first of `values`; there is one corner more than cells.
#[inline(always)]
fn add_to_corners(corners: &mut [f64], values: &[f64; CHUNK]) {
    let count = (corners.len() - 1).min(CHUNK);
    let values = &values[..count];
    let firsts = &mut corners[..count];
    for i in 0..count {
        firsts[i] += values[i];
    }
    let seconds = &mut corners[1..][..count];
    for i in 0..count {
        seconds[i] += values[i];
    }
}
