//! What writers draw of a model: triangles, and lines and points where a cloth has no area.

use crate::Points;

/// The drawable shape of a model, or of a subset of its particles.
///
/// Vertex `v` is particle `vertices[v]` of the model. `triangles`, `lines` and `points` hold vertex indices. A grid
/// with at least two columns and rows gives triangles; one with a single column or row gives lines; a single particle
/// gives a point. A vertex of one grid appears in just one of the three.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Surface {
    /// Particle of each vertex, ascending.
    pub vertices: Vec<u32>,
    /// Triangles, counter-clockwise seen from the front (the side that width axis × height axis points to).
    pub triangles: Vec<[u32; 3]>,
    /// Line segments.
    pub lines: Vec<[u32; 2]>,
    /// Lone vertices.
    pub points: Vec<u32>,
}

impl Surface {
    /// Adds a grid of `columns` x `rows` particles whose first is `first_particle`.
    ///
    /// At most `limit` vertices are kept: where the grid has more, whole columns and rows are left out evenly, never
    /// the first and the last ones.
    ///
    /// # Panics
    /// If `columns`, `rows` or `limit` is zero, or a particle's index does not fit `u32`.
    pub fn add_grid(&mut self, first_particle: usize, columns: usize, rows: usize, limit: usize) {
        assert!(0 < columns && 0 < rows && 0 < limit, "a drawn grid has at least one column, row and vertex");
        let stride =
            (1..).find(|&s| kept(columns, s) * kept(rows, s) <= limit.max(4)).expect("a grid thins to 2 x 2");
        let column_indices = thinned(columns, stride);
        let row_indices = thinned(rows, stride);
        let first_vertex = u32::try_from(self.vertices.len()).expect("vertex indices fit u32");
        for &row in &row_indices {
            for &column in &column_indices {
                let particle = first_particle + row * columns + column;
                self.vertices.push(u32::try_from(particle).expect("particle indices fit u32"));
            }
        }
        let (kept_columns, kept_rows) = (column_indices.len() as u32, row_indices.len() as u32);
        let vertex = |column: u32, row: u32| first_vertex + row * kept_columns + column;
        match (kept_columns, kept_rows) {
            (1, 1) => self.points.push(first_vertex),
            (1, _) => self.lines.extend((1..kept_rows).map(|row| [vertex(0, row - 1), vertex(0, row)])),
            (_, 1) => {
                self.lines.extend((1..kept_columns).map(|column| [vertex(column - 1, 0), vertex(column, 0)]));
            }
            _ => {
                for row in 1..kept_rows {
                    for column in 1..kept_columns {
                        let [a, b] = [vertex(column - 1, row - 1), vertex(column, row - 1)];
                        let [c, d] = [vertex(column, row), vertex(column - 1, row)];
                        // Diagonals alternate, so that the picture has no preferred direction.
                        if (column + row) % 2 == 0 {
                            self.triangles.extend([[a, b, c], [a, c, d]]);
                        } else {
                            self.triangles.extend([[a, b, d], [b, c, d]]);
                        }
                    }
                }
            }
        }
    }

    /// Overwrites `normals` with a unit normal [1] per vertex: the area-weighted mean over its triangles.
    ///
    /// `positions` [m] are those of all particles of the model. A vertex without triangles, or whose triangles have no
    /// area together, gets `[0, 1, 0]`.
    ///
    /// # Panics
    /// If a vertex's particle is not in `positions`.
    pub fn eval_normals(&self, positions: &Points, normals: &mut Vec<[f32; 3]>) {
        let mut sums = vec![glam::DVec3::ZERO; self.vertices.len()];
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|vertex| positions.get(self.vertices[vertex as usize] as usize));
            let area_vector = (b - a).cross(c - a);
            for vertex in triangle {
                sums[*vertex as usize] += area_vector;
            }
        }
        normals.clear();
        normals.extend(
            sums.iter().map(|sum| sum.try_normalize().unwrap_or(glam::DVec3::Y).as_vec3().to_array()),
        );
    }
}

/// How many of `count` indices remain when every `stride`-th is kept, and the last.
fn kept(count: usize, stride: usize) -> usize {
    (count - 1).div_ceil(stride) + 1
}

/// Indices spread evenly from the first to the last of `count`, [`kept`] of them.
fn thinned(count: usize, stride: usize) -> Vec<usize> {
    let intervals = kept(count, stride) - 1;
    // A single index has no interval; the divisor is then any.
    (0..=intervals).map(|n| n * (count - 1) / intervals.max(1)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn a_grid_gives_two_triangles_per_cell_facing_the_front() {
        let (columns, rows) = (4, 3);
        let mut surface = Surface::default();
        surface.add_grid(0, columns, rows, usize::MAX);
        assert_eq!(surface.triangles.len(), 2 * 3 * 2);
        let positions: Points =
            (0..12).map(|p| DVec3::new((p % columns) as f64, (p / columns) as f64, 0.0)).collect();
        let mut normals = Vec::new();
        surface.eval_normals(&positions, &mut normals);
        assert!(normals.iter().all(|&normal| normal == [0.0, 0.0, 1.0]), "{normals:?}");
    }

    #[test]
    fn thinning_keeps_the_border_and_the_limit() {
        let mut surface = Surface::default();
        surface.add_grid(7, 1000, 600, 5000);
        assert!(surface.vertices.len() <= 5000 && 4000 < surface.vertices.len());
        assert_eq!(surface.vertices.first(), Some(&7));
        assert_eq!(surface.vertices.last(), Some(&(7 + 600_000 - 1)));
    }

    #[test]
    fn columns_become_lines_and_a_particle_a_point() {
        let mut surface = Surface::default();
        surface.add_grid(0, 1, 3, 100);
        surface.add_grid(3, 1, 1, 100);
        assert_eq!(surface.lines, [[0, 1], [1, 2]]);
        assert_eq!(surface.points, [3]);
        assert!(surface.triangles.is_empty());
    }
}
