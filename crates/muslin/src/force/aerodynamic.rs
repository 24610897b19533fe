//! Wind that pushes faces, not particles.

use std::ops::Range;

use glam::DVec3;

use super::{Configuration, Force, Gust};
use crate::model::Grid;
use crate::{Points, PointsMut};

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
}

impl AerodynamicWind {
    /// Velocity w of the air [m/s] at `time` [s], which must not be negative.
    #[must_use]
    pub fn air_velocity(&self, time: f64) -> DVec3 {
        self.gusts.iter().fold(self.velocity, |velocity, gust| velocity + gust.value(time))
    }

    /// Calls `visit` with the cells that the particles of `block` are corners of, in ascending order and at most [`CHUNK`] at a
    /// time, and with where their first and second rows of corners begin in the block, if they do.
    ///
    /// Cells on the border of the block are visited for both blocks. So every particle gets what its cells add in the same order, whatever
    /// the blocks.
    fn for_each_run(&self, block: &Range<usize>, mut visit: impl FnMut(Cells, [Option<usize>; 2])) {
        let found = self.grids.iter().find_map(|grid| Some((grid, grid.block_rows(block)?)));
        let Some((grid, rows)) = found else { return };
        for row in rows.start.saturating_sub(1)..rows.end.min(grid.rows - 1) {
            for column in (0..grid.columns - 1).step_by(CHUNK) {
                let cells = Cells {
                    first: grid.particle(column, row),
                    count: CHUNK.min(grid.columns - 1 - column),
                    columns: grid.columns,
                };
                let target =
                    |row: usize| rows.contains(&row).then(|| grid.particle(column, row) - block.start);
                visit(cells, [target(row), target(row + 1)]);
            }
        }
    }

    /// Overwrites the first forces with those [N] on each corner of `cells` in air of velocity `air` [m/s].
    fn eval_corner_forces(&self, at: Configuration<'_>, air: DVec3, cells: Cells, forces: &mut CornerForces) {
        let positions = Corners::new(at.positions, cells);
        let velocities = Corners::new(at.velocities, cells);
        let factor = 0.125 * self.air_density;
        let count = cells.count;
        let (x, y, z) = (&mut forces.x[..count], &mut forces.y[..count], &mut forces.z[..count]);
        for i in 0..count {
            let face = Face::new(positions.area(i), air - velocities.mean(i));
            let pressure = self.normal_coefficient * face.normal_speed.abs();
            let friction = self.tangential_coefficient * face.speed;
            let along_normal = (pressure - friction) * face.normal_speed;
            let force = (face.normal * along_normal + face.velocity * friction) * (factor * face.area);
            (x[i], y[i], z[i]) = (force.x, force.y, force.z);
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

/// Forces [N] on one corner of each of some cells.
struct CornerForces {
    x: [f64; CHUNK],
    y: [f64; CHUNK],
    z: [f64; CHUNK],
}

impl CornerForces {
    const ZERO: Self = Self { x: [0.0; CHUNK], y: [0.0; CHUNK], z: [0.0; CHUNK] };
}

/// Vectors at the corners of some cells: a row of them and the next, each one longer than the cells.
struct Corners<'a> {
    near: [&'a [f64]; 3],
    far: [&'a [f64]; 3],
}

impl<'a> Corners<'a> {
    fn new(points: &'a Points, cells: Cells) -> Self {
        let row =
            |first: usize| [&points.x, &points.y, &points.z].map(|axis| &axis[first..][..cells.count + 1]);
        Self { near: row(cells.first), far: row(cells.first + cells.columns) }
    }

    /// Area vector of cell `i` [m²], if these are positions [m].
    #[inline]
    fn area(&self, i: usize) -> DVec3 {
        let diagonal = |axis: usize| self.far[axis][i + 1] - self.near[axis][i];
        let other = |axis: usize| self.far[axis][i] - self.near[axis][i + 1];
        let (p, q) = (DVec3::from_array([0, 1, 2].map(diagonal)), DVec3::from_array([0, 1, 2].map(other)));
        p.cross(q) * 0.5
    }

    /// Mean of the corners of cell `i`.
    #[inline]
    fn mean(&self, i: usize) -> DVec3 {
        let sum = |axis: usize| {
            (self.near[axis][i] + self.far[axis][i + 1]) + (self.near[axis][i + 1] + self.far[axis][i])
        };
        DVec3::from_array([0, 1, 2].map(sum)) * 0.25
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
    #[inline]
    fn new(area: DVec3, velocity: DVec3) -> Self {
        let size = area.length();
        let normal = area * if size > 0.0 { 1.0 / size } else { 0.0 };
        let speed = velocity.length();
        Self { area: size, normal, velocity, speed, normal_speed: velocity.dot(normal) }
    }
}

impl Force for AerodynamicWind {
    fn add_forces(&self, at: Configuration<'_>, block: &Range<usize>, forces: &mut PointsMut<'_>) {
        let air = self.air_velocity(at.time);
        let mut corner_forces = CornerForces::ZERO;
        self.for_each_run(block, |cells, targets| {
            self.eval_corner_forces(at, air, cells, &mut corner_forces);
            for target in targets.into_iter().flatten() {
                for (forces, corner_forces) in [
                    (&mut *forces.x, &corner_forces.x),
                    (&mut *forces.y, &corner_forces.y),
                    (&mut *forces.z, &corner_forces.z),
                ] {
                    add_to_corners(&mut forces[target..=target + cells.count], &corner_forces[..cells.count]);
                }
            }
        });
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
        let air = self.air_velocity(at.time);
        let mut corner_bounds = [0.0; CHUNK];
        self.for_each_run(block, |cells, targets| {
            let positions = Corners::new(at.positions, cells);
            let velocities = Corners::new(at.velocities, cells);
            for (i, bound) in corner_bounds[..cells.count].iter_mut().enumerate() {
                let face = Face::new(positions.area(i), air - velocities.mean(i));
                let slope = self.normal_coefficient * face.normal_speed.abs()
                    + self.tangential_coefficient * face.speed;
                *bound = 0.25 * self.air_density * face.area * slope;
            }
            for target in targets.into_iter().flatten() {
                add_to_corners(&mut bounds[target..=target + cells.count], &corner_bounds[..cells.count]);
            }
        });
    }

    fn is_external(&self) -> bool {
        true
    }
}

/// Adds to both corners of each cell its value; there is one corner more than cells.
fn add_to_corners(corners: &mut [f64], values: &[f64]) {
    for (corner, value) in corners.iter_mut().zip(values) {
        *corner += value;
    }
    for (corner, value) in corners[1..].iter_mut().zip(values) {
        *corner += value;
    }
}
