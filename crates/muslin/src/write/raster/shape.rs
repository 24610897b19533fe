//! From a model's surface to the triangles of a picture, in a frame where it has size 1 about the origin.

use glam::DVec3;

use super::spline::{refine_curve, refine_grid};
use super::{Material, Mesh};
use crate::model::{Surface, SurfaceGrid};

/// Pixels along a side of a triangle, about.
const TRIANGLE_PIXELS: f64 = 4.5;
/// Most vertices of a surface, about: coarse grids are refined, and fine ones thinned, to fewer.
const MOST_VERTICES: usize = 80_000;
/// Area below which a sheet has collapsed onto a line.
const LEAST_AREA: f64 = 1e-5;
const THREAD_RADIUS: f64 = 0.0045;
/// Radius of a particle of a thread.
pub(in crate::write) const BEAD_RADIUS: f64 = 0.0145;
/// Radius of a particle without springs beside others.
pub(in crate::write) const LONE_BEAD_RADIUS: f64 = 2.0 * BEAD_RADIUS;
const PIN_RADIUS: f64 = 0.0088;
/// Radius of a particle that is all there is.
const LONE_RADIUS: f64 = 0.12;
/// Least distance between pins, and between beads, that are drawn.
const PIN_SPACING: f64 = 0.09;
const BEAD_SPACING: f64 = 0.045;
/// Most pins that are drawn.
const MOST_PINS: usize = 64;

/// Adds the sheets, threads and lone particles of `surface`, whose vertices are at `points`, for a picture of `size`.
///
/// Grids become smooth sheets; triangles that belong to no grid are kept as they are, as are those of a grid in which a
/// point is not finite, without the triangles at that point.
pub(in crate::write) fn add_shape(mesh: &mut Mesh, surface: &Surface, points: &[DVec3], size: [u32; 2]) {
    let longer = f64::from(size[0].max(size[1]));
    // A shape of size 1 is about this many pixels long.
    let spacing = (TRIANGLE_PIXELS / (0.6 * longer)).max(1.0 / 400.0);
    let mut smooth = vec![false; points.len()];
    for grid in &surface.grids {
        let vertices = grid.vertices.clone();
        let knots = &points[vertices.clone()];
        if 1 < grid.columns && 1 < grid.rows && knots.iter().all(|knot| knot.is_finite()) {
            add_grid(mesh, grid, knots, spacing, MOST_VERTICES * knots.len() / points.len());
            smooth[vertices].fill(true);
        }
    }
    let triangles: Vec<[u32; 3]> = surface
        .triangles
        .iter()
        .filter(|triangle| triangle.iter().all(|v| !smooth[*v as usize] && points[*v as usize].is_finite()))
        .copied()
        .collect();
    if !triangles.is_empty() {
        let points: Vec<DVec3> =
            points.iter().map(|point| if point.is_finite() { *point } else { DVec3::ZERO }).collect();
        mesh.add_triangles(&points, &vec![[0.0; 2]; points.len()], &triangles);
    }
    for thread in threads(&surface.lines, points) {
        add_thread(mesh, &thread, spacing);
    }
    for point in surface.points.iter().map(|v| points[*v as usize]) {
        if point.is_finite() {
            mesh.add_sphere(point, LONE_BEAD_RADIUS, 32, Material::Bead);
        }
    }
}

/// Adds a pin's head at some of `pins`, spread evenly where they are dense; those that are not finite are left out.
///
/// The heads are large enough to hide beads of radius `bead`.
pub(in crate::write) fn add_pins(mesh: &mut Mesh, pins: &[DVec3], bead: f64) {
    let radius = PIN_RADIUS.max(1.25 * bead);
    for pin in spread(pins) {
        mesh.add_sphere(pin, radius, 24, Material::Pin);
    }
}

/// Adds a sphere of `material` at the first finite one of `points`, if there is one.
pub(in crate::write) fn add_lone_particle(mesh: &mut Mesh, points: &[DVec3], material: Material) {
    if let Some(point) = points.iter().find(|point| point.is_finite()) {
        mesh.add_sphere(*point, LONE_RADIUS, 96, material);
    }
}

/// Adds a smooth sheet through the `knots` of `grid`, of at most about `most` vertices; its border alone where it has
/// no area.
fn add_grid(mesh: &mut Mesh, grid: &SurfaceGrid, knots: &[DVec3], spacing: f64, most: usize) {
    let (knots, columns) = thinned(knots, grid.columns, most);
    let rows = knots.len() / columns;
    let length = |from: usize, to: usize| (knots[to] - knots[from]).length();
    let across = (0..knots.len()).filter(|v| v % columns != 0).map(|v| length(v - 1, v)).sum::<f64>()
        / ((columns - 1) * rows) as f64;
    let along =
        (columns..knots.len()).map(|v| length(v - columns, v)).sum::<f64>() / (columns * (rows - 1)) as f64;
    let mut steps = [across, along].map(|edge| (edge / spacing).ceil().clamp(1.0, 400.0) as usize);
    let vertices = |steps: [usize; 2]| ((columns - 1) * steps[0] + 1) * ((rows - 1) * steps[1] + 1);
    while most < vertices(steps) && steps != [1, 1] {
        let longer = usize::from(steps[0] < steps[1]);
        steps[longer] -= 1;
    }
    let [fine_across, fine_along] = [across / steps[0] as f64, along / steps[1] as f64];
    let fine = refine_grid(&knots, columns, steps);
    let fine_columns = (columns - 1) * steps[0] + 1;
    let area: f64 = (fine_columns..fine.len())
        .filter(|v| v % fine_columns != 0)
        .map(|v| (fine[v] - fine[v - 1]).cross(fine[v] - fine[v - fine_columns]).length())
        .sum();
    if LEAST_AREA < area {
        mesh.add_sheet(&fine, fine_columns, [fine_across, fine_along]);
    } else {
        let last_row = fine.len() - fine_columns;
        mesh.add_tube(&fine[..fine_columns], THREAD_RADIUS, 10);
        mesh.add_tube(&fine[last_row..], THREAD_RADIUS, 10);
        for column in [0, fine_columns - 1] {
            let border: Vec<DVec3> = fine.iter().skip(column).step_by(fine_columns).copied().collect();
            mesh.add_tube(&border, THREAD_RADIUS, 10);
        }
    }
}

/// Every so-many-th row and column of a grid, and the last, so that at most about `most` knots are left; and how many
/// columns that makes.
fn thinned(knots: &[DVec3], columns: usize, most: usize) -> (Vec<DVec3>, usize) {
    let rows = knots.len() / columns;
    let kept = |count: usize, stride: usize| (count - 1).div_ceil(stride) + 1;
    let mut stride = 1;
    while most.max(4) < kept(columns, stride) * kept(rows, stride) {
        stride += 1;
    }
    let index = move |n: usize, count: usize| n * (count - 1) / (kept(count, stride) - 1);
    let thinned = (0..kept(rows, stride))
        .flat_map(|row| (0..kept(columns, stride)).map(move |column| (row, column)))
        .map(|(row, column)| knots[index(row, rows) * columns + index(column, columns)])
        .collect();
    (thinned, kept(columns, stride))
}

/// Adds a smooth thread through `knots` and beads on some of them.
fn add_thread(mesh: &mut Mesh, knots: &[DVec3], spacing: f64) {
    let length: f64 = knots.windows(2).map(|pair| (pair[1] - pair[0]).length()).sum();
    let edge = length / (knots.len() - 1) as f64;
    let steps = (edge / spacing).ceil().clamp(1.0, 400.0) as usize;
    mesh.add_tube(&refine_curve(knots, steps), THREAD_RADIUS, 12);
    // A long chain shows every so-many-th particle, and its last one.
    let stride = (BEAD_SPACING / edge).ceil().clamp(1.0, knots.len() as f64) as usize;
    for (index, knot) in knots.iter().enumerate() {
        if index % stride == 0 || index + 1 == knots.len() {
            mesh.add_sphere(*knot, BEAD_RADIUS, 24, Material::Bead);
        }
    }
}

/// The points of chains of line segments, each of at least two; a point that is not finite ends a chain.
fn threads(lines: &[[u32; 2]], points: &[DVec3]) -> Vec<Vec<DVec3>> {
    let mut threads: Vec<Vec<DVec3>> = Vec::new();
    let mut end = None;
    for line in lines {
        let [from, to] = line.map(|v| points[v as usize]);
        if !(from.is_finite() && to.is_finite()) {
            end = None;
            continue;
        }
        match threads.last_mut() {
            Some(thread) if end == Some(line[0]) => thread.push(to),
            _ => threads.push(vec![from, to]),
        }
        end = Some(line[1]);
    }
    threads
}

/// Some of `points` that are far from each other: the first, then ever the one farthest from those chosen.
fn spread(points: &[DVec3]) -> Vec<DVec3> {
    let finite: Vec<DVec3> = points.iter().filter(|point| point.is_finite()).copied().collect();
    let mut distances = vec![f64::INFINITY; finite.len()];
    let mut chosen = Vec::new();
    while chosen.len() < MOST_PINS {
        let mut farthest = None;
        let mut largest = PIN_SPACING * PIN_SPACING;
        for (index, distance) in distances.iter().enumerate() {
            if largest < *distance {
                (farthest, largest) = (Some(index), *distance);
            }
        }
        let Some(index) = farthest else { break };
        chosen.push(finite[index]);
        for (distance, point) in distances.iter_mut().zip(&finite) {
            *distance = distance.min(point.distance_squared(finite[index]));
        }
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pins_along_an_edge_are_drawn_sparsely_with_both_ends() {
        let edge: Vec<DVec3> = (0..101).map(|n| DVec3::new(f64::from(n) / 100.0, 0.0, 0.0)).collect();
        let chosen = spread(&edge);
        assert!(chosen.contains(&edge[0]) && chosen.contains(&edge[100]), "{chosen:?}");
        assert!((8..=11).contains(&chosen.len()), "{chosen:?}");
        let close = chosen.iter().any(|a| chosen.iter().any(|b| a != b && a.distance(*b) < PIN_SPACING));
        assert!(!close, "{chosen:?}");
        assert_eq!(spread(&[DVec3::NAN, DVec3::X, DVec3::X]), [DVec3::X]);
    }

    #[test]
    fn lines_chain_into_threads_until_a_point_is_missing() {
        let points: Vec<DVec3> =
            (0..6).map(|n| if n == 3 { DVec3::NAN } else { DVec3::X * f64::from(n) }).collect();
        let threads = threads(&[[0, 1], [1, 2], [2, 3], [3, 4], [4, 5]], &points);
        assert_eq!(threads, [vec![points[0], points[1], points[2]], vec![points[4], points[5]]]);
    }

    #[test]
    fn fine_grids_are_thinned_with_their_border() {
        let knots: Vec<DVec3> =
            (0..100 * 60).map(|v| DVec3::new((v % 100) as f64, (v / 100) as f64, 0.0)).collect();
        let (thin, columns) = thinned(&knots, 100, 1000);
        assert_eq!((columns, thin.len()), (34, 34 * 21));
        assert_eq!(
            [thin[0], thin[33], thin[34 * 20], thin[34 * 21 - 1]],
            [
                DVec3::ZERO,
                DVec3::new(99.0, 0.0, 0.0),
                DVec3::new(0.0, 59.0, 0.0),
                DVec3::new(99.0, 59.0, 0.0)
            ]
        );
        assert_eq!(thinned(&knots, 100, 6000), (knots.clone(), 100));
    }

    #[test]
    fn refinement_keeps_to_its_most_vertices() {
        let mut surface = Surface::default();
        surface.add_grid(0, 40, 30, usize::MAX);
        let points: Vec<DVec3> =
            (0..1200).map(|v| DVec3::new((v % 40) as f64 / 40.0, (v / 40) as f64 / 40.0, 0.0)).collect();
        let mut mesh = Mesh::default();
        add_shape(&mut mesh, &surface, &points, [20_000, 20_000]);
        assert!((MOST_VERTICES / 2..=MOST_VERTICES).contains(&mesh.points.len()), "{}", mesh.points.len());
    }
}
