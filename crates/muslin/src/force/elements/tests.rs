//! Coordinates against their gradients, and what neither sees.

use glam::{DQuat, DVec3};

use super::*;
use crate::model::Particles;
use crate::scene::GridSettings;
use crate::{Points, PointsMut};

/// Every kind of element, and whether those along edges are half.
fn kinds() -> Vec<(Coordinate, bool)> {
    vec![
        (Coordinate::Extension { columns: 1, rows: 0, rest_length: 0.05 }, true),
        (Coordinate::Extension { columns: 0, rows: 1, rest_length: 0.04 }, true),
        (Coordinate::Extension { columns: -1, rows: 1, rest_length: 0.06 }, false),
        (Coordinate::Extension { columns: 0, rows: 2, rest_length: 0.08 }, false),
        (Coordinate::Shear, false),
        (Coordinate::Bend(Line::Weft), true),
        (Coordinate::Bend(Line::Warp), true),
    ]
}

fn grid(columns: usize, rows: usize) -> Grid {
    let extent = |count: usize, spacing: f64| (count - 1) as f64 * spacing;
    Grid::new(0, GridSettings { columns, rows, width: extent(columns, 0.05), height: extent(rows, 0.04) })
}

/// A sheet that is bent, sheared and stretched, with no symmetry; folded onto itself at its middle column if `is_folded`.
fn shaped(grid: &Grid, is_folded: bool) -> Points {
    let place = |particle: usize| {
        let (i, j) = ((particle % grid.columns) as f64, (particle / grid.columns) as f64);
        let wave = |k: f64| 0.01 * libm::sin(k * (i + 1.3 * j) + k);
        let column = if is_folded { (i - (grid.columns / 2) as f64).abs() } else { i };
        DVec3::new(0.05 * column + 0.01 * j + wave(0.9), 0.04 * j + wave(1.7), 2.0 * wave(0.7))
    };
    (0..grid.particle_count()).map(place).collect()
}

fn particles(grid: &Grid, pins: &[usize]) -> Particles {
    let mut particles = Particles::default();
    particles.extend(grid.particle_count(), 1.0, 0.0);
    pins.iter().for_each(|&pin| assert!(particles.pin(pin)));
    particles
}

/// Σ over all elements of share times weight times coordinate, with weights that tell them apart.
fn potential(elements: &GridElements, positions: &Points, particles: &Particles) -> f64 {
    let (mut chunk, mut sum) = (Chunk::EMPTY, 0.0);
    for segment in elements.all() {
        chunk.eval(elements, &segment, positions, particles);
        for (i, share) in chunk.shares_of(1.0)[..chunk.len()].iter().enumerate() {
            sum += weight(&segment, i) * share * chunk.coordinates[i];
        }
    }
    sum
}

fn weight(segment: &Segment, i: usize) -> f64 {
    1.0 + libm::sin((7 * segment.row + 3 * (segment.column + i)) as f64)
}

/// Gradient of the above, block by block.
fn gradient(elements: &GridElements, positions: &Points, particles: &Particles, block_size: usize) -> Points {
    let mut sums = Points::zeros(positions.len());
    let mut rest = sums.as_mut();
    for block in elements.grid.blocks(block_size) {
        let mut chunk = Chunk::EMPTY;
        let (mut own, others): (PointsMut<'_>, _) = rest.split_at(block.len());
        let Some(rows) = elements.grid.block_rows(&block) else { panic!("a block of the grid") };
        for segment in elements.touching(&block) {
            chunk.eval(elements, &segment, positions, particles);
            let (mut factors, shares) = ([0.0; CHUNK], chunk.shares_of(1.0));
            for (i, factor) in factors[..chunk.len()].iter_mut().enumerate() {
                *factor = weight(&segment, i) * shares[i];
            }
            chunk.add_gradients(&factors, &rows, block.start, &mut own);
        }
        rest = others;
    }
    sums
}

fn cases() -> impl Iterator<Item = (GridElements, Points, Particles)> {
    let sizes = [(2, 2), (3, 2), (2, 5), (4, 4), (5, 3), (140, 3)];
    kinds().into_iter().flat_map(move |(coordinate, has_half_edges)| {
        sizes.into_iter().flat_map(move |(columns, rows)| {
            [false, true].map(|is_folded| {
                let grid = grid(columns, rows);
                let positions = shaped(&grid, is_folded);
                let particles = particles(&grid, &[0, 1]);
                (GridElements { grid, coordinate, has_half_edges }, positions, particles)
            })
        })
    })
}

/// A difference over 2 δ is wrong by δ² q''' ~ δ² / h² of the gradient, 4e-10 for δ = 1e-6 of 5 cm, and by roundings ε / δ of a
/// sum of up to 400 coordinates of 0.1.
#[test]
fn gradients_are_the_derivatives_of_the_coordinates() {
    for (elements, mut positions, particles) in cases() {
        let gradients = gradient(&elements, &positions, &particles, usize::MAX);
        let largest = gradients.iter().map(DVec3::length).fold(1.0, f64::max);
        for particle in (0..particles.len()).step_by(1 + particles.len() / 20) {
            let place = positions.get(particle);
            for axis in DVec3::AXES {
                let mut at = |offset: f64| {
                    positions.set(particle, place + axis * offset);
                    potential(&elements, &positions, &particles)
                };
                let difference = (at(1e-6) - at(-1e-6)) / 2e-6;
                let error = (difference - gradients.get(particle).dot(axis)).abs() / largest;
                assert!(error < 1e-8, "{error:e} at {particle} of {elements:?}");
            }
            positions.set(particle, place);
        }
    }
}

/// Turned and moved, a sheet has the same coordinates, and gradients that are turned: to roundings of places of 1 m in
/// gradients over 5 cm, of second differences of 5 mm.
#[test]
fn a_rigid_motion_changes_nothing() {
    let turn = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), 1.1);
    for (elements, positions, particles) in cases() {
        let moved: Points = positions.iter().map(|x| turn * x + DVec3::new(0.3, -0.2, 0.5)).collect();
        let before = potential(&elements, &positions, &particles);
        let after = potential(&elements, &moved, &particles);
        let gradients = gradient(&elements, &positions, &particles, usize::MAX);
        let turned = gradient(&elements, &moved, &particles, usize::MAX);
        let largest = gradients.iter().map(DVec3::length).fold(1.0, f64::max);
        assert!((after - before).abs() < 1e-12, "{:e} of {elements:?}", after - before);
        for (a, b) in gradients.iter().zip(turned.iter()) {
            let error = (turn * a - b).length() / largest;
            assert!(error < 1e-12, "{error:e} of {elements:?}");
        }
    }
}

/// Neither a net force nor a net moment, whatever the forces along the coordinates.
#[test]
fn forces_have_neither_sum_nor_moment() {
    for (elements, positions, particles) in cases() {
        let gradients = gradient(&elements, &positions, &particles, usize::MAX);
        let size: f64 = gradients.iter().map(DVec3::length).sum::<f64>() + 1.0;
        let sum: DVec3 = gradients.iter().sum();
        let moment: DVec3 = positions.iter().zip(gradients.iter()).map(|(x, g)| x.cross(g)).sum();
        assert!(sum.length() < 1e-14 * size, "{sum} of {elements:?}");
        // Places are within 8 m.
        assert!(moment.length() < 8e-14 * size, "{moment} of {elements:?}");
    }
}

/// No bit of what a particle gets depends on where blocks begin.
#[test]
fn blocks_change_no_bit() {
    for (elements, positions, particles) in cases() {
        let whole = gradient(&elements, &positions, &particles, usize::MAX);
        assert_eq!(whole, gradient(&elements, &positions, &particles, 1), "{elements:?}");
    }
}

/// Found with gradients or without, coordinates have the same bits.
#[test]
fn gradients_change_no_bit_of_a_coordinate() {
    for (elements, positions, particles) in cases() {
        let [mut with, mut without] = [Chunk::EMPTY, Chunk::EMPTY];
        for segment in elements.all() {
            with.eval(&elements, &segment, &positions, &particles);
            without.eval_coordinates(&elements, &segment, &positions, &particles);
            let count = with.len();
            assert_eq!(with.coordinates[..count], without.coordinates[..count], "{elements:?}");
            assert_eq!(with.shares_of(1.0), without.shares_of(1.0), "{elements:?}");
        }
    }
}

/// A sheet without any extent has no normals: bending feels nothing there, and no coordinate is without number.
#[test]
fn a_point_has_no_gradients_but_those_of_shear() {
    for (elements, positions, particles) in cases() {
        let point = Points::zeros(positions.len());
        let gradients = gradient(&elements, &point, &particles, usize::MAX);
        assert_eq!(gradients, point, "{elements:?}");
    }
}

/// The bends along the weft of three columns, folded around the middle one, with the right side displaced by `offset` [m]
/// against the left.
fn folded(offset: DVec3) -> (GridElements, Points) {
    let place = |particle: usize| {
        let (i, j) = ((particle % 3) as f64 - 1.0, (particle / 3) as f64);
        DVec3::new(0.05 * i.abs(), 0.04 * j, 0.0) + 0.5 * i * offset
    };
    let elements =
        GridElements { grid: grid(3, 3), coordinate: Coordinate::Bend(Line::Weft), has_half_edges: true };
    (elements, (0..9).map(place).collect())
}

/// Where cells have no area the normal turns over: coordinates go through zero, where one of unit length would make 0.1 m and
/// −0.1 m of them.
#[test]
fn bends_fade_where_cells_fold() {
    let [before, after] = [-2e-6, 2e-6].map(|offset| {
        let (elements, positions) = folded(DVec3::new(0.0, 0.0, offset));
        potential(&elements, &positions, &particles(&elements.grid, &[]))
    });
    // |q| = 0.1 m · 2 |S| / A with |S| = 0.08 m · 2e-6 m and A = 2e-3 m², and half of that in both half elements.
    assert!(before != 0.0 && before == -after, "{before:e} and {after:e}");
    assert!(after.abs() < 2.0 * 1.5 * 1.6e-5, "{after:e}");
}

/// Where a line comes back nearly along the fold, |Δ| = 0.1 m, |b| ≤ 0.08 m and |a| ≤ 0.03 m: however little area is left,
/// gradients are at most 1 + 2 |b| |Δ| / A = 9 for the line's own and 3 for the two beside it, by weights below two.
#[test]
fn gradients_are_bounded_however_cells_collapse() {
    for remainder in [1e-2, 1e-4, 1e-6, 1e-9, 0.0] {
        let (elements, positions) = folded(DVec3::new(remainder, 0.02, 0.0));
        let gradients = gradient(&elements, &positions, &particles(&elements.grid, &[]), usize::MAX);
        let largest = gradients.iter().map(DVec3::length).fold(0.0, f64::max);
        assert!(largest < 30.0, "{largest:e} at {remainder:e} m");
    }
}

/// Bounds are bounds: u · Σ c g gᵀ u ≤ Σ bound |u|², by tensors too, and both are reached within a factor.
#[test]
fn bounds_and_tensors_are_above_every_displacement() {
    for (elements, positions, particles) in cases() {
        let count = positions.len();
        let mut bounds = vec![0.0; count];
        let mut tensors = crate::force::StiffnessTensors::zeros(count);
        let mut displacement: Points =
            (0..count).map(|p| DVec3::new(weight_of(p, 0.3), weight_of(p, 1.1), weight_of(p, 2.3))).collect();
        for (particle, pinned) in particles.pinned().iter().enumerate() {
            if *pinned {
                displacement.set(particle, DVec3::ZERO);
            }
        }
        let (mut chunk, mut stiffness) = (Chunk::EMPTY, 0.0);
        let all = 0..count;
        let rows = 0..elements.grid.rows;
        for segment in elements.all() {
            chunk.eval(&elements, &segment, &positions, &particles);
            let (mut rates, shares) = ([0.0; CHUNK], chunk.shares_of(1.0));
            chunk.eval_rates(&displacement, &mut rates);
            for (share, rate) in shares.iter().zip(&rates[..chunk.len()]) {
                stiffness += share * rate * rate;
            }
            chunk.add_bounds(&shares, particles.pinned(), &rows, all.start, &mut bounds);
            chunk.add_tensors(&shares, particles.pinned(), &rows, all.start, &mut tensors.as_mut());
        }
        let (mut by_bounds, mut by_tensors) = (0.0, 0.0);
        for (particle, u) in displacement.iter().enumerate() {
            by_bounds += bounds[particle] * u.length_squared();
            let (own, off) = (tensors.diagonal.get(particle), tensors.off_diagonal.get(particle));
            by_tensors += (own * u * u).element_sum();
            by_tensors += 2.0 * (off.x * u.y * u.z + off.y * u.x * u.z + off.z * u.x * u.y);
            let trace = own.element_sum();
            assert!(trace <= bounds[particle] * (1.0 + 1e-12), "{trace} for {}", bounds[particle]);
        }
        assert!(stiffness <= by_tensors * (1.0 + 1e-12), "{stiffness} and {by_tensors}: {elements:?}");
        assert!(by_tensors <= by_bounds * (1.0 + 1e-12), "{by_tensors} and {by_bounds}: {elements:?}");
        assert!(stiffness == 0.0 || 0.01 * by_bounds < by_tensors);
    }
}

fn weight_of(particle: usize, k: f64) -> f64 {
    libm::sin(k * (particle * particle + 1) as f64)
}

/// A row of two segments of different lengths, with a clamp in what is longer of the first: none of it is found in later ones.
#[test]
fn clamps_stay_in_their_segment() {
    for line in [Line::Weft, Line::Warp] {
        let grid = grid(140, 6);
        let positions = shaped(&grid, false);
        let pins: Vec<usize> =
            (0..2).flat_map(|row| (66..72).map(move |column| grid.particle(column, row))).collect();
        let particles = particles(&grid, &pins);
        let elements = GridElements { grid, coordinate: Coordinate::Bend(line), has_half_edges: true };
        let (mut chunk, mut clamped) = (Chunk::EMPTY, 0);
        for segment in elements.all() {
            let mut fresh = Chunk::EMPTY;
            fresh.eval(&elements, &segment, &positions, &particles);
            chunk.eval(&elements, &segment, &positions, &particles);
            let count = fresh.len();
            assert_eq!(chunk.shares_of(1.0)[..count], fresh.shares_of(1.0)[..count], "{line:?}, {segment:?}");
            clamped += fresh.clamps[..count].iter().filter(|clamp| **clamp == 1.0).count();
        }
        // Both ends of both rows of pins, or all of the second row.
        assert_eq!(clamped, if line == Line::Weft { 4 } else { 6 });
        let whole = gradient(&elements, &positions, &particles, usize::MAX);
        assert_eq!(gradient(&elements, &positions, &particles, 1), whole, "{line:?}");
    }
}
