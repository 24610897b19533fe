//! The rigidity against its energy, its tangent and plates.

use glam::DVec3;

use super::super::{GridLaws, GridSprings};
use super::*;
use crate::InstructionSet;
use crate::scene::{ForceDirection, GridSettings};

const RIGIDITY: BendingRigidity = BendingRigidity { warp: 3e-6, weft: 7e-6, twist: 2e-6 };

/// Grids from the smallest to those with an inside, one of whose corners is held by a clamp of 2 x 2 pins.
fn cases() -> Vec<(GridBending, Particles)> {
    let sizes = [(2, 2), (3, 2), (2, 5), (4, 4), (5, 3), (9, 6), (21, 6)];
    sizes.map(|(columns, rows)| bending(columns, rows, &[(0, 0), (1, 0), (0, 1), (1, 1)])).to_vec()
}

fn bending(columns: usize, rows: usize, pins: &[(usize, usize)]) -> (GridBending, Particles) {
    let grid = Grid::new(0, GridSettings { columns, rows, width: 0.3, height: 0.2 });
    let mut particles = Particles::default();
    particles.extend(grid.particle_count(), 1.0, 0.0);
    for &(column, row) in pins {
        particles.pin(grid.particle(column, row));
    }
    (GridBending::new(grid, RIGIDITY, &particles), particles)
}

/// Points without any order, below 1 m.
fn crumpled(count: usize) -> Points {
    let coordinate = |i: usize, k: f64| libm::sin(k * (i * i + 1) as f64 + k);
    (0..count).map(|i| DVec3::new(coordinate(i, 0.7), coordinate(i, 1.3), coordinate(i, 2.1))).collect()
}

fn configuration<'a>(particles: &'a Particles, positions: &'a Points) -> Configuration<'a> {
    Configuration { time: 0.0, particles, positions, velocities: positions, memory: &[] }
}

/// The forces of a grid that has no springs.
fn forces(bending: &GridBending, particles: &Particles, positions: &Points) -> Points {
    forces_with(InstructionSet::best(), usize::MAX, bending, particles, positions)
}

/// The same with `instructions` and blocks of `block_size` particles.
fn forces_with(
    instructions: InstructionSet,
    block_size: usize,
    bending: &GridBending,
    particles: &Particles,
    positions: &Points,
) -> Points {
    let laws = GridLaws { groups: Vec::new(), direction: ForceDirection::CurrentLength };
    let springs = GridSprings::new(bending.grid, laws, instructions).with_bending(bending.clone());
    let mut forces = Points::zeros(positions.len());
    let at = configuration(particles, positions);
    for block in bending.grid.blocks(block_size) {
        springs.add_forces(at, &block, &mut forces.slice_mut(&block), &mut Sweep::default());
    }
    forces
}

fn energy(bending: &GridBending, particles: &Particles, positions: &Points) -> f64 {
    let mut energies = PotentialEnergies::default();
    bending.add_energies(configuration(particles, positions), &mut energies);
    energies.elastic[Family::Bend as usize]
}

/// The largest of all weights [N/m], which is felt at 1 m.
fn scale(bending: &GridBending) -> f64 {
    16.0 * (bending.along_columns + bending.along_rows + bending.twist)
}

/// F = −∂E/∂x: the energy is quadratic, so that a difference over any distance is exact but for rounding.
#[test]
fn force_is_the_gradient_of_the_energy() {
    for (bending, particles) in cases() {
        let mut positions = crumpled(particles.len());
        let forces = forces(&bending, &particles, &positions);
        for particle in 0..particles.len() {
            let place = positions.get(particle);
            for axis in DVec3::AXES {
                let mut energy_at = |offset: f64| {
                    positions.set(particle, place + axis * offset);
                    energy(&bending, &particles, &positions)
                };
                let difference = (energy_at(-0.5) - energy_at(0.5)) / 1.0;
                let error = (difference - forces.get(particle).dot(axis)).abs();
                assert!(error < 1e-13 * scale(&bending), "{error:e} N on particle {particle} of {bending:?}");
            }
            positions.set(particle, place);
        }
    }
}

/// K u = F(x) − F(x + u), whatever x.
#[test]
fn tangent_is_the_derivative_of_the_force() {
    for (bending, particles) in cases() {
        let positions = crumpled(particles.len());
        let displacements: Points =
            positions.iter().map(|x| DVec3::new(x.y, -0.3 * x.z, x.x * x.y)).collect();
        let moved = positions.iter().zip(displacements.iter()).map(|(x, u)| x + u).collect();
        let mut products = Points::zeros(particles.len());
        let at = configuration(&particles, &positions);
        bending.add_tangent_products(at, &displacements, &(0..particles.len()), &mut products.as_mut());
        let [before, after] = [&positions, &moved].map(|points| forces(&bending, &particles, points));
        for (product, (before, after)) in products.iter().zip(before.iter().zip(after.iter())) {
            assert!((product - (before - after)).length() < 1e-13 * scale(&bending));
        }
    }
}

/// A cylinder z = ½ κ x² has second differences κ h² exactly: E = ½ B κ² times the area around inner columns, and the same
/// along rows. A saddle z = κ x y has ½ 4 D κ² times the whole area.
#[test]
fn energy_is_that_of_a_plate() {
    let (columns, rows) = (7, 5);
    let (bending, particles) = bending(columns, rows, &[]);
    let Grid { column_spacing: hx, row_spacing: hy, .. } = bending.grid;
    let curvature = 3.0;
    let shape = |height: &dyn Fn(f64, f64) -> f64| -> Points {
        let places = (0..columns * rows).map(|p| ((p % columns) as f64 * hx, (p / columns) as f64 * hy));
        places.map(|(x, y)| DVec3::new(x, y, height(x, y))).collect()
    };
    let area = 0.3 * 0.2;
    for (height, rigidity, area) in [
        (&(|x, _| 0.5 * curvature * x * x) as &dyn Fn(f64, f64) -> f64, RIGIDITY.weft, area - 0.2 * hx),
        (&|_, y| 0.5 * curvature * y * y, RIGIDITY.warp, area - 0.3 * hy),
        (&|x, y| curvature * x * y, 4.0 * RIGIDITY.twist, area),
    ] {
        let exact = 0.5 * rigidity * curvature * curvature * area;
        let found = energy(&bending, &particles, &shape(height));
        assert!((found / exact - 1.0).abs() < 1e-12, "{found:e} J for {exact:e} J");
    }
    let flat = forces(&bending, &particles, &shape(&|x, y| 0.4 * x - 2.0 * y + 1.0));
    assert!(flat.iter().all(|force| force.length() < 1e-14 * scale(&bending)));
}

/// The triple around the second of two rows of pins counts twice, whichever end is held.
#[test]
fn a_clamp_is_half_a_cell_long() {
    for (first, second, free) in [(0, 1, 2), (4, 3, 2)] {
        let pins: Vec<_> = (0..3).flat_map(|column| [(column, first), (column, second)]).collect();
        let (clamped, particles) = bending(3, 5, &pins);
        let (unclamped, _) = bending(3, 5, &[]);
        let mut positions = Points::zeros(15);
        positions.set(clamped.grid.particle(1, free), DVec3::Z);
        let [with, without] = [&clamped, &unclamped].map(|bending| energy(bending, &particles, &positions));
        assert!((with - without - 0.5 * clamped.along_rows).abs() < 1e-15 * clamped.along_rows);
        assert_eq!(clamped.clamps.len(), 3, "one for each column, between rows {first}, {second} and {free}");
    }
}

/// Rows that are shorter than a vector, fill some, and are longer than what is worked on at a time.
#[test]
fn blocks_and_instructions_do_not_change_a_bit() {
    let pins = [(0, 0), (1, 0), (0, 1), (1, 1)];
    let wide = [(17, 3), (41, 5), (300, 4), (513, 9)].map(|(columns, rows)| bending(columns, rows, &pins));
    for (bending, particles) in cases().into_iter().chain(wide) {
        let positions = crumpled(particles.len());
        let whole = forces(&bending, &particles, &positions);
        for instructions in InstructionSet::available() {
            for size in [1, usize::MAX] {
                let found = forces_with(instructions, size, &bending, &particles, &positions);
                assert_eq!(found, whole, "{} by {size}", instructions.name());
            }
        }
    }
}

/// What finds them with springs finds what the weights of neighbours give.
#[test]
fn forces_are_those_from_particle_to_particle() {
    for (bending, particles) in cases() {
        let positions = crumpled(particles.len());
        let mut expected = Points::zeros(particles.len());
        let at = configuration(&particles, &positions);
        let all = 0..particles.len();
        bending.add_forces(at, &all, &mut expected.as_mut(), &mut Sweep::default());
        let found = forces(&bending, &particles, &positions);
        for (found, expected) in found.iter().zip(expected.iter()) {
            assert!((found - expected).length() < 1e-13 * scale(&bending), "{found}, {expected}");
        }
    }
}

/// No displacement is stiffer than the largest bound.
#[test]
fn bounds_bound_the_tangent() {
    for (bending, particles) in cases() {
        let count = particles.len();
        let mut bounds = vec![0.0; count];
        let positions = Points::zeros(count);
        bending.add_stiffness_bounds(configuration(&particles, &positions), &(0..count), &mut bounds);
        let largest = bounds.iter().copied().fold(0.0, f64::max);
        let mut u = crumpled(count);
        let free = |points: Points| -> Points {
            let held = points.iter().zip(particles.pinned());
            held.map(|(point, pinned)| if *pinned { DVec3::ZERO } else { point }).collect()
        };
        for _ in 0..50 {
            u = free(u);
            let mut products = Points::zeros(count);
            let at = configuration(&particles, &positions);
            bending.add_tangent_products(at, &u, &(0..count), &mut products.as_mut());
            let square: f64 = u.iter().map(DVec3::length_squared).sum();
            let work: f64 = u.iter().zip(products.iter()).map(|(u, ku)| u.dot(ku)).sum();
            assert!(work <= largest * square * (1.0 + 1e-12), "{work} for {largest} in {bending:?}");
            let length = products.iter().map(DVec3::length_squared).sum::<f64>().sqrt();
            u = products.iter().map(|v| if length > 0.0 { v / length } else { v }).collect();
        }
    }
    // Inside of a large grid all signs alternate in the stiffest mode, and the bound is met.
    let (bending, particles) = bending(9, 9, &[]);
    let (mut bounds, positions) = (vec![0.0; 81], Points::zeros(81));
    bending.add_stiffness_bounds(configuration(&particles, &positions), &(0..81), &mut bounds);
    assert!((bounds[40] / scale(&bending) - 1.0).abs() < 1e-14);
}
