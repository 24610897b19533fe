//! The plain scalar loop: the same cloth as a textbook writes it.
//!
//! An array of structures, a square root and a division for the force of a spring, compiled as users compile. It has what
//! helps without making it another program: constants of all particles are taken out of loops, edges are an `if` that is
//! nearly always false, and memory is asked for once.
//!
//! There are two: one looks at the neighbours of each particle and computes each spring twice, the other goes through a list of
//! springs, computes each once and adds its force to both ends, for which it reads and writes more memory.

use glam::DVec3;
use muslin::force::Family;
use muslin::{Model, State};

/// A particle.
#[derive(Clone, Copy, Debug)]
struct Particle {
    position: DVec3,
    velocity: DVec3,
    force: DVec3,
    is_pinned: bool,
}

/// A spring in the list.
#[derive(Clone, Copy, Debug)]
struct Spring {
    ends: [u32; 2],
    stiffness: f64,
    rest_length: f64,
}

/// A neighbour of a particle in the grid.
#[derive(Clone, Copy, Debug)]
struct Neighbour {
    columns: isize,
    rows: isize,
    stiffness: f64,
    rest_length: f64,
}

/// Where springs are found.
#[derive(Clone, Debug)]
enum Springs {
    Neighbours(Box<[Neighbour; 12]>),
    List(Vec<Spring>),
}

/// Which of the two loops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Loop {
    /// Over the neighbours of each particle.
    Neighbours,
    /// Over a list of springs.
    List,
}

/// A cloth of linear springs in a square grid, under gravity and drag.
#[derive(Clone, Debug)]
pub(crate) struct Textbook {
    particles: Vec<Particle>,
    springs: Springs,
    columns: usize,
    mass: f64,
    drag: f64,
    gravity: DVec3,
    step: f64,
    last_step: f64,
}

impl Textbook {
    /// The cloth of `model` in `state`, whose families of springs have `stiffnesses` [N/m], at steps of `step` [s].
    pub(crate) fn new(
        model: &Model,
        state: &State,
        stiffnesses: [f64; 3],
        gravity: DVec3,
        step: f64,
        kind: Loop,
    ) -> Self {
        let (constants, grid) = (model.particles(), model.cloths()[0].grid);
        let particles = (0..constants.len())
            .map(|index| Particle {
                position: state.positions.get(index),
                velocity: state.velocities.get(index),
                force: DVec3::ZERO,
                is_pinned: constants.pinned()[index],
            })
            .collect();
        let springs = match kind {
            Loop::Neighbours => Springs::Neighbours(Box::new(neighbours(grid.column_spacing, stiffnesses))),
            Loop::List => Springs::List(list(model, stiffnesses)),
        };
        let (mass, drag) = (constants.masses()[0], constants.drags()[0]);
        Self { particles, springs, columns: grid.columns, mass, drag, gravity, step, last_step: 0.0 }
    }

    /// Positions [m].
    pub(crate) fn positions(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.particles.iter().map(|particle| particle.position)
    }

    /// Takes `count` steps.
    pub(crate) fn run(&mut self, count: u64) {
        for _ in 0..count {
            match &self.springs {
                Springs::Neighbours(neighbours) => {
                    eval_by_neighbours(
                        &mut self.particles,
                        self.columns,
                        neighbours,
                        self.mass * self.gravity,
                    );
                }
                Springs::List(springs) => {
                    eval_by_list(&mut self.particles, springs, self.mass * self.gravity);
                }
            }
            self.move_all();
        }
    }

    /// Central differences, as the paper's equation (5) has them.
    fn move_all(&mut self) {
        let denominator = 2.0 * self.mass + self.drag * self.last_step;
        let velocity_factor = (2.0 * self.mass - self.drag * self.step) / denominator;
        let force_factor = (self.last_step + self.step) / denominator;
        for particle in &mut self.particles {
            if !particle.is_pinned {
                particle.velocity = velocity_factor * particle.velocity + force_factor * particle.force;
                particle.position += self.step * particle.velocity;
            }
        }
        self.last_step = self.step;
    }
}

/// All neighbours that a particle in the middle of a square grid has.
fn neighbours(spacing: f64, stiffnesses: [f64; 3]) -> [Neighbour; 12] {
    let families = [
        [(-1, 0), (1, 0), (0, -1), (0, 1)],
        [(-1, -1), (1, -1), (-1, 1), (1, 1)],
        [(-2, 0), (2, 0), (0, -2), (0, 2)],
    ];
    let mut all = families.into_iter().zip(stiffnesses).flat_map(|(places, stiffness)| {
        places.map(|(columns, rows): (isize, isize)| {
            let rest_length = spacing * ((columns * columns + rows * rows) as f64).sqrt();
            Neighbour { columns, rows, stiffness, rest_length }
        })
    });
    std::array::from_fn(|_| all.next().unwrap_or_else(|| unreachable!("three families of four")))
}

/// Every spring of `model` once, in the order of its particles: what is near in the grid is near in the list.
fn list(model: &Model, stiffnesses: [f64; 3]) -> Vec<Spring> {
    let mut springs = Vec::new();
    for force in model.forces() {
        force.visit_springs(&mut |spring| {
            let family = Family::ALL.iter().position(|family| *family == spring.family).unwrap_or_default();
            springs.push(Spring {
                ends: spring.particles.map(|particle| particle as u32),
                stiffness: stiffnesses[family],
                rest_length: spring.rest_length,
            });
        });
    }
    springs.sort_by_key(|spring| spring.ends);
    springs
}

/// The force [N] of a spring on the end that `vector` [m] starts from.
#[inline]
fn spring_force(vector: DVec3, stiffness: f64, rest_length: f64) -> DVec3 {
    let length = vector.length();
    vector * (stiffness * (length - rest_length) / length)
}

fn eval_by_neighbours(
    particles: &mut [Particle],
    columns: usize,
    neighbours: &[Neighbour; 12],
    weight: DVec3,
) {
    let rows = particles.len() / columns;
    for row in 0..rows {
        for column in 0..columns {
            let position = particles[row * columns + column].position;
            let mut force = weight;
            for neighbour in neighbours {
                let other_column = column as isize + neighbour.columns;
                let other_row = row as isize + neighbour.rows;
                if 0 <= other_column
                    && other_column < columns as isize
                    && 0 <= other_row
                    && other_row < rows as isize
                {
                    let other = particles[other_row as usize * columns + other_column as usize].position;
                    force += spring_force(other - position, neighbour.stiffness, neighbour.rest_length);
                }
            }
            particles[row * columns + column].force = force;
        }
    }
}

fn eval_by_list(particles: &mut [Particle], springs: &[Spring], weight: DVec3) {
    for particle in particles.iter_mut() {
        particle.force = weight;
    }
    for spring in springs {
        let [one, other] = spring.ends.map(|end| end as usize);
        let vector = particles[other].position - particles[one].position;
        let force = spring_force(vector, spring.stiffness, spring.rest_length);
        particles[one].force += force;
        particles[other].force -= force;
    }
}
