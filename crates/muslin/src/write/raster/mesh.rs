//! The triangles a picture is made of.

use std::f64::consts::TAU;

use glam::DVec3;

/// What a triangle is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::write) enum Material {
    /// Woven cloth, seen from both sides.
    Cloth,
    /// A thread: a cloth of a single column or row.
    Thread,
    /// A particle of a thread, or a lone one.
    Bead,
    /// The head of a pin.
    Pin,
}

/// Triangles with smooth normals, in a frame where the drawn shape has size 1 about the origin.
#[derive(Clone, Debug, Default)]
pub(in crate::write) struct Mesh {
    /// Place of each vertex.
    pub(in crate::write) points: Vec<DVec3>,
    /// Unit normal of each vertex, on the front.
    pub(in crate::write) normals: Vec<DVec3>,
    /// Place of each vertex along the weft and the warp, as a length in the same frame.
    pub(in crate::write) yarns: Vec<[f64; 2]>,
    /// Vertices of each triangle, counter-clockwise seen from the front.
    pub(in crate::write) triangles: Vec<[u32; 3]>,
    /// Material of each triangle.
    pub(in crate::write) materials: Vec<Material>,
    /// Triangles that cast shadows: as `triangles`, but every other column and row of a fine sheet.
    pub(in crate::write) occluders: Vec<[u32; 3]>,
}

/// Columns and rows from which on a sheet casts its shadows with half of them.
const FINE: usize = 64;

impl Mesh {
    /// Adds a surface through `points`, row by row with `columns` in a row, `spacing` apart along the yarns.
    ///
    /// # Panics
    /// If there are more vertices than `u32` counts.
    pub(in crate::write) fn add_sheet(&mut self, points: &[DVec3], columns: usize, spacing: [f64; 2]) {
        let yarns = (0..points.len())
            .map(|v| [(v % columns) as f64 * spacing[0], (v / columns) as f64 * spacing[1]])
            .collect::<Vec<_>>();
        let rows = points.len() / columns;
        let all = |count: usize| (0..count).collect::<Vec<_>>();
        let triangles = sheet_triangles(columns, &all(columns), &all(rows));
        let (first_vertex, first_occluder) = (self.first_new_vertex(), self.occluders.len());
        self.add_triangles(points, &yarns, &triangles);
        if FINE <= columns.min(rows) {
            let every_other = |count: usize| (0..count - 1).step_by(2).chain([count - 1]).collect::<Vec<_>>();
            let coarse = sheet_triangles(columns, &every_other(columns), &every_other(rows));
            self.occluders.truncate(first_occluder);
            self.occluders.extend(coarse.iter().map(|triangle| triangle.map(|v| first_vertex + v)));
        }
    }

    /// Adds cloth made of `triangles` over `points`, with the area-weighted mean of its triangles as each normal.
    pub(in crate::write) fn add_triangles(
        &mut self,
        points: &[DVec3],
        yarns: &[[f64; 2]],
        triangles: &[[u32; 3]],
    ) {
        let mut sums = vec![DVec3::ZERO; points.len()];
        for triangle in triangles {
            let [a, b, c] = triangle.map(|v| points[v as usize]);
            for v in triangle {
                sums[*v as usize] += (b - a).cross(c - a);
            }
        }
        let first = self.first_new_vertex();
        self.points.extend(points);
        self.normals.extend(sums.iter().map(|sum| sum.try_normalize().unwrap_or(DVec3::Y)));
        self.yarns.extend(yarns);
        self.extend_triangles(first, triangles, Material::Cloth);
    }

    /// Adds a sphere of `segments` meridians and half as many parallels.
    pub(in crate::write) fn add_sphere(
        &mut self,
        centre: DVec3,
        radius: f64,
        segments: u32,
        material: Material,
    ) {
        let first = self.first_new_vertex();
        let parallels = segments / 2;
        let mut triangles = Vec::new();
        for parallel in 0..=parallels {
            let polar = 0.5 * TAU * f64::from(parallel) / f64::from(parallels);
            for meridian in 0..=segments {
                let azimuth = TAU * f64::from(meridian) / f64::from(segments);
                let ring = libm::sin(polar);
                let normal =
                    DVec3::new(ring * libm::sin(azimuth), libm::cos(polar), ring * libm::cos(azimuth));
                self.add_vertex(centre + normal * radius, normal);
                if 0 < parallel && 0 < meridian {
                    let d = parallel * (segments + 1) + meridian;
                    let [a, b, c] = [d - segments - 2, d - segments - 1, d - 1];
                    triangles.extend([[a, c, d], [a, d, b]]);
                }
            }
        }
        self.extend_triangles(first, &triangles, material);
    }

    /// Adds a tube of `sides` faces around a `path`; its ends are open.
    ///
    /// Points of the path that coincide with the one before are left out.
    pub(in crate::write) fn add_tube(&mut self, path: &[DVec3], radius: f64, sides: u32) {
        let mut path = path.to_vec();
        path.dedup();
        let first = self.first_new_vertex();
        let mut triangles = Vec::new();
        // Any direction that is not along the path starts the frame, which then turns as little as it can.
        let mut across = DVec3::Z;
        for (index, centre) in path.iter().enumerate() {
            let along = path[(index + 1).min(path.len() - 1)] - path[index.saturating_sub(1)];
            let along = along.try_normalize().unwrap_or(DVec3::Y);
            across = (across - along * across.dot(along))
                .try_normalize()
                .unwrap_or_else(|| along.any_orthonormal_vector());
            let side = along.cross(across);
            for turn in 0..=sides {
                let angle = TAU * f64::from(turn) / f64::from(sides);
                let normal = across * libm::cos(angle) + side * libm::sin(angle);
                self.add_vertex(*centre + normal * radius, normal);
                if 0 < index && 0 < turn {
                    let d = index as u32 * (sides + 1) + turn;
                    let [a, b, c] = [d - sides - 2, d - sides - 1, d - 1];
                    triangles.extend([[a, b, d], [a, d, c]]);
                }
            }
        }
        self.extend_triangles(first, &triangles, Material::Thread);
    }

    fn add_vertex(&mut self, point: DVec3, normal: DVec3) {
        self.points.push(point);
        self.normals.push(normal);
        self.yarns.push([0.0; 2]);
    }

    fn first_new_vertex(&self) -> u32 {
        u32::try_from(self.points.len()).expect("a picture has fewer than 2^32 vertices")
    }

    fn extend_triangles(&mut self, first: u32, triangles: &[[u32; 3]], material: Material) {
        let placed = triangles.iter().map(|triangle| triangle.map(|v| first + v));
        self.triangles.extend(placed.clone());
        self.occluders.extend(placed);
        self.materials.resize(self.triangles.len(), material);
    }
}

/// The triangles between some `columns` and `rows` of a grid that has `stride` columns.
fn sheet_triangles(stride: usize, columns: &[usize], rows: &[usize]) -> Vec<[u32; 3]> {
    let mut triangles = Vec::with_capacity(2 * columns.len() * rows.len());
    for (parity, row) in rows.windows(2).enumerate() {
        for (column_parity, column) in columns.windows(2).enumerate() {
            let vertex = |row: usize, column: usize| (row * stride + column) as u32;
            let [a, b] = [vertex(row[0], column[0]), vertex(row[0], column[1])];
            let [d, c] = [vertex(row[1], column[0]), vertex(row[1], column[1])];
            // Diagonals alternate, so that the picture has no preferred direction.
            if (parity + column_parity) % 2 == 0 {
                triangles.extend([[a, b, c], [a, c, d]]);
            } else {
                triangles.extend([[a, b, d], [b, c, d]]);
            }
        }
    }
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every triangle with area must turn its front the way the normals of its vertices point.
    fn assert_fronts_follow_normals(mesh: &Mesh) {
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|v| mesh.points[v as usize]);
            let normal = triangle.iter().map(|v| mesh.normals[*v as usize]).sum::<DVec3>();
            let area_vector = (b - a).cross(c - a);
            assert!(area_vector.length() < 1e-12 || 0.0 < area_vector.dot(normal), "{triangle:?}");
        }
    }

    #[test]
    fn solids_turn_their_fronts_out() {
        let mut mesh = Mesh::default();
        mesh.add_sphere(DVec3::new(1.0, 2.0, 3.0), 0.5, 12, Material::Pin);
        assert!(mesh.points.iter().all(|p| ((*p - DVec3::new(1.0, 2.0, 3.0)).length() - 0.5).abs() < 1e-15));
        mesh.add_tube(&[DVec3::ZERO, DVec3::ZERO, DVec3::Z, DVec3::new(1.0, 0.0, 2.0)], 0.1, 8);
        assert!(mesh.normals.iter().all(|normal| (normal.length() - 1.0).abs() < 1e-12));
        assert_fronts_follow_normals(&mesh);
        assert_eq!(mesh.materials.len(), mesh.triangles.len());
    }

    #[test]
    fn a_sheet_in_the_plane_faces_z() {
        let points: Vec<DVec3> = (0..6).map(|v| DVec3::new((v % 3) as f64, (v / 3) as f64, 0.0)).collect();
        let mut mesh = Mesh::default();
        mesh.add_sheet(&points, 3, [1.0, 2.0]);
        assert_eq!(mesh.triangles.len(), 4);
        assert!(mesh.normals.iter().all(|normal| *normal == DVec3::Z));
        assert_eq!(mesh.yarns[5], [2.0, 2.0]);
        assert_fronts_follow_normals(&mesh);
    }

    /// The coarse sheet covers what the fine one does, up to its last column and row.
    #[test]
    fn a_fine_sheet_casts_the_shadow_of_a_coarser_one() {
        let columns = 71;
        let points: Vec<DVec3> =
            (0..columns * 70).map(|v| DVec3::new((v % columns) as f64, (v / columns) as f64, 0.0)).collect();
        let mut mesh = Mesh::default();
        mesh.add_sphere(DVec3::ZERO, 0.5, 8, Material::Pin);
        let sphere = mesh.occluders.len();
        mesh.add_sheet(&points, columns, [1.0, 1.0]);
        let sheet = &mesh.occluders[sphere..];
        assert_eq!(sheet.len(), 2 * 35 * 35);
        let twice_area: f64 = sheet
            .iter()
            .map(|triangle| triangle.map(|v| mesh.points[v as usize]))
            .map(|[a, b, c]| (b - a).cross(c - a).z)
            .sum();
        assert_eq!(twice_area, 2.0 * 70.0 * 69.0);
    }

    #[test]
    fn a_sheet_without_area_gets_upright_normals() {
        let mut mesh = Mesh::default();
        mesh.add_sheet(&[DVec3::X; 4], 2, [1.0, 1.0]);
        assert_eq!(mesh.normals, [DVec3::Y; 4]);
    }
}
