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
    let [across, along] = bending.rigidities.map(|rigidity| rigidity.coefficient);
    16.0 * (across + along + bending.twist)
}

/// Crumpled positions of all cases: so little that no line is folded, and so much that all are stretched beyond.
fn crumpled_cases() -> Vec<(GridBending, Particles, Points, f64)> {
    let sizes =
        |bending: &GridBending| [0.2 * bending.grid.column_spacing.min(bending.grid.row_spacing), 10.0];
    let cases = cases().into_iter().flat_map(|(bending, particles)| {
        sizes(&bending).map(|size| {
            let positions = crumpled(particles.len()).iter().map(|point| size * point).collect();
            (bending.clone(), particles.clone(), positions, size)
        })
    });
    cases.collect()
}

/// The derivative at 0 of a polynomial of degree 4 or less, whose values `step` apart are given: exact but for rounding.
fn derivative(value: impl Fn(f64) -> f64, step: f64) -> f64 {
    (8.0 * (value(step) - value(-step)) - (value(2.0 * step) - value(-2.0 * step))) / (12.0 * step)
}

/// F = −∂E/∂x.
#[test]
fn force_is_the_gradient_of_the_energy() {
    for (bending, particles, positions, size) in crumpled_cases() {
        let forces = forces(&bending, &particles, &positions);
        for particle in 0..particles.len() {
            for axis in DVec3::AXES {
                let energy_at = |offset: f64| {
                    let mut positions = positions.clone();
                    positions.set(particle, positions.get(particle) + axis * offset);
                    energy(&bending, &particles, &positions)
                };
                let error = (derivative(energy_at, 0.1 * size) + forces.get(particle).dot(axis)).abs();
                let bound = 1e-12 * size * scale(&bending);
                assert!(error < bound, "{error:e} N on particle {particle} of {bending:?}");
            }
        }
    }
}

/// K u = −∂F(x + s u)/∂s.
#[test]
fn tangent_is_the_derivative_of_the_force() {
    for (bending, particles, positions, size) in crumpled_cases() {
        let displacements: Points =
            positions.iter().map(|x| DVec3::new(x.y, -0.3 * x.z, x.x * x.y / size)).collect();
        let mut products = Points::zeros(particles.len());
        let at = configuration(&particles, &positions);
        bending.add_tangent_products(at, &displacements, &(0..particles.len()), &mut products.as_mut());
        let forces_at = |share: f64| {
            let moved = positions.iter().zip(displacements.iter()).map(|(x, u)| x + share * u).collect();
            forces(&bending, &particles, &moved)
        };
        for (particle, product) in products.iter().enumerate() {
            for axis in DVec3::AXES {
                let found = derivative(|share| forces_at(share).get(particle).dot(axis), 0.1);
                let error = (product.dot(axis) + found).abs();
                assert!(error < 1e-12 * size * scale(&bending), "{error:e} N on {particle} of {bending:?}");
            }
        }
    }
}

/// The particles of `grid`, each at the `place` for its distances [m] from the first along columns and rows.
fn shape(grid: &Grid, place: impl Fn(f64, f64) -> DVec3) -> Points {
    let Grid { columns, rows, column_spacing: hx, row_spacing: hy, .. } = *grid;
    let places = (0..columns * rows).map(|p| ((p % columns) as f64 * hx, (p / columns) as f64 * hy));
    places.map(|(x, y)| place(x, y)).collect()
}

/// A cylinder of curvature κ whose lines turn by θ = κ h at each particle has E = ½ B κ² times the area around inner columns but
/// for θ⁴/90, and the same along rows. A saddle z = κ x y has ½ 4 D κ² times the whole area.
#[test]
fn energy_is_that_of_a_plate() {
    let (bending, particles) = bending(7, 5, &[]);
    let Grid { column_spacing: hx, row_spacing: hy, .. } = bending.grid;
    let area = 0.3 * 0.2;
    for degrees in [0.1, 1.0, 15.0, 30.0, 60.0_f64] {
        let turn = degrees.to_radians();
        let circle = |length: f64, h: f64| {
            let (sine, cosine) = libm::sincos(turn * length / h);
            let radius = h / (2.0 * libm::sin(0.5 * turn));
            (radius * sine, radius * (1.0 - cosine))
        };
        let across = shape(&bending.grid, |x, y| {
            let (x, z) = circle(x, hx);
            DVec3::new(x, y, z)
        });
        let along = shape(&bending.grid, |x, y| {
            let (y, z) = circle(y, hy);
            DVec3::new(x, y, z)
        });
        let sides =
            [(across, RIGIDITY.weft, hx, area - 0.2 * hx), (along, RIGIDITY.warp, hy, area - 0.3 * hy)];
        for (positions, rigidity, h, area) in sides {
            let exact = 0.5 * rigidity * (turn / h) * (turn / h) * area;
            let ratio = energy(&bending, &particles, &positions) / exact;
            // Of the series of ((2 sin θ/2)² + (2 sin θ/2)⁴ / 12) / θ²; the next term is −4.6e-5 θ⁸. At 0.1° rounding of places of
            // 0.3 m is 1e-12 of a second difference.
            let expected = 1.0 - libm::pow(turn, 4.0) / 90.0 + libm::pow(turn, 6.0) / 1008.0;
            let error = (ratio - expected).abs();
            assert!(error < 1e-10 + libm::pow(turn, 8.0) / 1e4, "{ratio} for {expected} at {degrees}°");
        }
    }
    let curvature = 3.0;
    let saddle = shape(&bending.grid, |x, y| DVec3::new(x, y, curvature * x * y));
    let exact = 0.5 * 4.0 * RIGIDITY.twist * curvature * curvature * area;
    let found = energy(&bending, &particles, &saddle);
    assert!((found / exact - 1.0).abs() < 1e-12, "{found:e} J for {exact:e} J");
    let flat =
        forces(&bending, &particles, &shape(&bending.grid, |x, y| DVec3::new(x, y, 0.4 * x - 2.0 * y + 1.0)));
    assert!(flat.iter().all(|force| force.length() < 1e-14 * scale(&bending)));
}

/// Energy and force go on without a step where a line is folded, and stretched.
#[test]
fn folded_lines_are_as_stiff_as_they_get() {
    let line = LineRigidity::new(RIGIDITY.warp, 0.02, 0.01);
    let folded = 0.02 * 0.02;
    let (before, after) = (folded * (1.0 - 1e-9), folded * (1.0 + 1e-9));
    let close = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-8;
    assert!(close(line.energy(before), line.energy(after)));
    assert!(close(line.force_coefficient(before), line.force_coefficient(after)));
    assert!(close(line.force_coefficient(4.0 * folded), line.coefficient * 5.0 / 3.0));
    let [all, along] = line.tangent(before);
    assert!(
        close(all + along * before, line.largest_stiffness())
            && close(all + along * before, 3.0 * line.coefficient)
    );
}

/// The triple around the second of two rows of pins counts twice, whichever end is held.
#[test]
fn a_clamp_is_half_a_cell_long() {
    for (first, second, free) in [(0, 1, 2), (4, 3, 2)] {
        let pins: Vec<_> = (0..3).flat_map(|column| [(column, first), (column, second)]).collect();
        let (clamped, particles) = bending(3, 5, &pins);
        let (unclamped, _) = bending(3, 5, &[]);
        let mut positions = Points::zeros(15);
        positions.set(clamped.grid.particle(1, free), 1e-3 * DVec3::Z);
        let [with, without] = [&clamped, &unclamped].map(|bending| energy(bending, &particles, &positions));
        let expected = clamped.rigidities[1].energy(1e-6);
        assert!((with - without - expected).abs() < 1e-14 * expected);
        assert_eq!(clamped.clamps.len(), 3, "one for each column, between rows {first}, {second} and {free}");
    }
}

/// Rows that are shorter than a vector, fill some, and are longer than what is worked on at a time.
#[test]
fn blocks_and_instructions_do_not_change_a_bit() {
    let pins = [(0, 0), (1, 0), (0, 1), (1, 1)];
    // Of 40 x 20 three rows are worked on at a time, and most of these like those before.
    let wide =
        [(17, 3), (41, 5), (40, 20), (300, 4), (513, 9)].map(|(columns, rows)| bending(columns, rows, &pins));
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

/// What finds them with springs finds what comes of triple after triple.
#[test]
fn forces_are_those_from_triple_to_triple() {
    for (bending, particles, positions, size) in crumpled_cases() {
        let mut expected = Points::zeros(particles.len());
        let at = configuration(&particles, &positions);
        let all = 0..particles.len();
        bending.add_forces(at, &all, &mut expected.as_mut(), &mut Sweep::default());
        let found = forces(&bending, &particles, &positions);
        for (found, expected) in found.iter().zip(expected.iter()) {
            assert!((found - expected).length() < 1e-13 * size * scale(&bending), "{found}, {expected}");
        }
        for block in bending.grid.blocks(1) {
            let mut forces = Points::zeros(block.len());
            bending.add_forces(at, &block, &mut forces.as_mut(), &mut Sweep::default());
            assert!(forces.iter().eq(block.map(|particle| expected.get(particle))));
        }
    }
}

/// No displacement is stiffer than the largest bound, wherever the particles are.
#[test]
fn bounds_bound_the_tangent() {
    for (bending, particles) in cases() {
        for folded in [0.0, 0.3, 0.6, 0.999, 3.0] {
            bound_holds(&bending, &particles, &pleats(&bending.grid, [folded, 0.0]));
            bound_holds(&bending, &particles, &pleats(&bending.grid, [0.0, folded]));
        }
    }
}

/// Inside of a large grid, where lines along columns are folded, the displacement that alternates along them meets their part of the
/// bound.
#[test]
fn folded_lines_meet_the_bound() {
    let rigidity = BendingRigidity { warp: 0.0, weft: 7e-6, twist: 0.0 };
    let grid = Grid::new(0, GridSettings { columns: 9, rows: 9, width: 0.3, height: 0.2 });
    let mut particles = Particles::default();
    particles.extend(81, 1.0, 0.0);
    let bending = GridBending::new(grid, rigidity, &particles);
    let positions = pleats(&grid, [0.999_999, 0.0]);
    let displacements = pleats(&grid, [1.0, 0.0]);
    let (mut bounds, mut products) = (vec![0.0; 81], Points::zeros(81));
    let at = configuration(&particles, &positions);
    bending.add_stiffness_bounds(at, &(0..81), &mut bounds);
    bending.add_tangent_products(at, &displacements, &(0..81), &mut products.as_mut());
    let stiffness = products.get(40).z / displacements.get(40).z;
    assert!((bounds[40] / stiffness - 1.0).abs() < 1e-5, "{} for {stiffness} N/m", bounds[40]);
}

/// A sheet whose lines along columns and rows go up and down, so that |d| is a share of 2h.
fn pleats(grid: &Grid, [across, along]: [f64; 2]) -> Points {
    let sign = |index: usize| if index.is_multiple_of(2) { 0.5 } else { -0.5 };
    let height = |p: usize| {
        across * grid.column_spacing * sign(p % grid.columns)
            + along * grid.row_spacing * sign(p / grid.columns)
    };
    (0..grid.particle_count()).map(|p| DVec3::Z * height(p)).collect()
}

fn bound_holds(bending: &GridBending, particles: &Particles, positions: &Points) {
    let count = particles.len();
    let at = configuration(particles, positions);
    let mut bounds = vec![0.0; count];
    bending.add_stiffness_bounds(at, &(0..count), &mut bounds);
    let largest = bounds.iter().copied().fold(0.0, f64::max);
    let mut u = crumpled(count);
    let free = |points: Points| -> Points {
        let held = points.iter().zip(particles.pinned());
        held.map(|(point, pinned)| if *pinned { DVec3::ZERO } else { point }).collect()
    };
    for _ in 0..50 {
        u = free(u);
        let mut products = Points::zeros(count);
        bending.add_tangent_products(at, &u, &(0..count), &mut products.as_mut());
        let square: f64 = u.iter().map(DVec3::length_squared).sum();
        let work: f64 = u.iter().zip(products.iter()).map(|(u, ku)| u.dot(ku)).sum();
        assert!(work <= largest * square * (1.0 + 1e-12), "{work} for {largest} in {bending:?}");
        let length = products.iter().map(DVec3::length_squared).sum::<f64>().sqrt();
        u = products.iter().map(|v| if length > 0.0 { v / length } else { v }).collect();
    }
}
