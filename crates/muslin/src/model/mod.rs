//! What does not change during a run.
//!
//! A [`Model`] is built from a checked [`Scene`]: its particles, its forces and its cloths. Particles of all cloths are
//! numbered through; within a grid, particle `row * columns + column` follows the first.

mod grid;
mod particles;
mod pin_motion;
mod surface;

use std::ops::Range;

pub use grid::Grid;
pub use particles::{OtherParticle, ParticleRun, ParticleStretch, Particles};
pub use pin_motion::{KeyframePath, MovingPins, PinMotion, SinePath};
pub use surface::{Surface, SurfaceGrid};

use crate::force::{
    AerodynamicWind, Force, Gravity, GridBending, GridDashpots, GridFriction, GridLaws, GridSprings, Gust,
    Noise, ParticleWind, RandomStream,
};
use crate::limit::{GridLimit, Limit};
use crate::scene::{
    BendingModel, Fabric, GustSettings, NoiseSettings, PinPlace, RunSettings, Scene, WindSettings,
};
use crate::{InstructionSet, Points, State};

/// Particles per block at most, unless one row of a grid has more.
///
/// A block's positions, velocities and forces (72 bytes per particle) stay in a core's second-level cache, and there are
/// enough of them even in small grids for threads to share them evenly.
const BLOCK_PARTICLES: usize = 1024;

/// Everything that is constant during a run.
///
/// Invariants: the blocks cover all particles in ascending order without gaps; a block lies within one cloth and
/// consists of whole rows.
#[derive(Debug)]
pub struct Model {
    particles: Particles,
    moving_pins: MovingPins,
    cloths: Vec<Cloth>,
    forces: Vec<Box<dyn Force>>,
    limits: Vec<Box<dyn Limit>>,
    blocks: Vec<Range<usize>>,
    memory_layers: usize,
    depends_on_velocity: bool,
    instructions: InstructionSet,
}

/// One cloth of a [`Model`].
#[derive(Clone, Debug, PartialEq)]
pub struct Cloth {
    /// Name, unique in the model.
    pub name: String,
    /// Its particles.
    pub grid: Grid,
}

impl Model {
    /// Builds the model that `scene` describes, for the best instructions that this processor has.
    #[must_use]
    pub fn new(scene: &Scene) -> Self {
        Self::with_instructions(scene, InstructionSet::best())
    }

    /// Builds the model that `scene` describes, for `instructions`, which change the speed of a run and no bit of it.
    #[must_use]
    pub fn with_instructions(scene: &Scene, instructions: InstructionSet) -> Self {
        let mut particles = Particles::default();
        let mut moving_pins = MovingPins::default();
        let mut cloths = Vec::new();
        let mut forces: Vec<Box<dyn Force>> = Vec::new();
        let mut limits: Vec<Box<dyn Limit>> = Vec::new();
        let environment = scene.environment();
        if environment.gravity != glam::DVec3::ZERO {
            forces.push(Box::new(Gravity::new(environment.gravity, instructions)));
        }
        for settings in scene.cloths() {
            let grid = Grid::new(particles.len(), settings.grid);
            let fabric = &scene.fabrics()[&settings.fabric];
            match fabric {
                Fabric::Springs(fabric) => {
                    particles.extend(grid.particle_count(), fabric.particle_mass, fabric.drag);
                }
                Fabric::Measured(fabric) => {
                    particles.extend_by_area(&grid, fabric.areal_density, fabric.drag);
                }
            }
            for pin in &settings.pins {
                let motion = pin.motion.as_ref().map(PinMotion::new);
                let mut hold = |column: usize, row: usize| {
                    let particle = grid.particle(column, row);
                    let is_new = particles.pin(particle);
                    if let (true, Some(motion)) = (is_new, &motion) {
                        moving_pins.add(particle, grid.place_of(column, row, &settings.place), motion);
                    }
                };
                match pin.place {
                    PinPlace::Particle { column, row } => hold(column, row),
                    PinPlace::Row(row) => (0..grid.columns).for_each(|column| hold(column, row)),
                    PinPlace::Column(column) => (0..grid.rows).for_each(|row| hold(column, row)),
                }
            }
            match fabric {
                Fabric::Springs(fabric) => {
                    let laws = GridLaws::of_springs(fabric);
                    forces.push(Box::new(GridSprings::new(grid, laws, instructions)));
                    forces.extend(boxed(GridDashpots::of_springs(fabric, grid, instructions)));
                    if let Some(limit) = GridLimit::new(grid, fabric) {
                        limits.push(Box::new(limit));
                    }
                }
                Fabric::Measured(fabric) => {
                    let laws = GridLaws::of_measured(fabric, &grid);
                    let mut springs = GridSprings::new(grid, laws, instructions);
                    let bending = GridBending::new(grid, fabric.bending, &particles);
                    let is_rigidity = fabric.bending_model == BendingModel::SecondDifferences;
                    if is_rigidity && !bending.is_zero() {
                        springs = springs.with_bending(bending);
                    }
                    forces.push(Box::new(springs));
                    forces.extend(boxed(GridFriction::of_measured(fabric, grid, instructions)));
                    forces.extend(boxed(GridDashpots::of_measured(fabric, grid, instructions)));
                }
            }
            cloths.push(Cloth { name: settings.name.clone(), grid });
        }
        particles.find_runs();
        let grids: Vec<Grid> = cloths.iter().map(|cloth: &Cloth| cloth.grid).collect();
        forces.extend(winds(&environment.winds, scene.run(), &grids, instructions));
        let blocks = cloths.iter().flat_map(|cloth| cloth.grid.blocks(BLOCK_PARTICLES)).collect();
        let memory_layers = forces.iter().map(|force| force.memory_layers()).max().unwrap_or(0);
        let depends_on_velocity = forces.iter().any(|force| force.depends_on_velocity());
        Self {
            particles,
            moving_pins,
            cloths,
            forces,
            limits,
            blocks,
            memory_layers,
            depends_on_velocity,
            instructions,
        }
    }

    /// Masses, drags and pins.
    #[must_use]
    pub fn particles(&self) -> &Particles {
        &self.particles
    }

    /// The pins that move, and their paths.
    #[must_use]
    pub fn moving_pins(&self) -> &MovingPins {
        &self.moving_pins
    }

    /// Cloths in the order of their particles.
    #[must_use]
    pub fn cloths(&self) -> &[Cloth] {
        &self.cloths
    }

    /// Forces in the order in which they are added up.
    #[must_use]
    pub fn forces(&self) -> &[Box<dyn Force>] {
        &self.forces
    }

    /// Limits in the order in which they are applied after each step.
    #[must_use]
    pub fn limits(&self) -> &[Box<dyn Limit>] {
        &self.limits
    }

    /// Whether any force is a function of velocities.
    #[must_use]
    pub fn depends_on_velocity(&self) -> bool {
        self.depends_on_velocity
    }

    /// Values that forces [remember](State::memory) per particle; zero if none does.
    #[must_use]
    pub fn memory_layers(&self) -> usize {
        self.memory_layers
    }

    /// The instructions that loops over particles use.
    #[must_use]
    pub fn instructions(&self) -> InstructionSet {
        self.instructions
    }

    /// Ranges of particles that are worked on as one.
    #[must_use]
    pub fn blocks(&self) -> &[Range<usize>] {
        &self.blocks
    }

    /// The state at time zero: every cloth at rest, flat and unstretched at its place; only pins that move are where their
    /// paths begin, with the velocity that they have there.
    #[must_use]
    pub fn initial_state(&self, scene: &Scene) -> State {
        let mut positions = Points::zeros(self.particles.len());
        for (cloth, settings) in self.cloths.iter().zip(scene.cloths()) {
            cloth.grid.place(&settings.place, &mut positions);
        }
        let mut state = State::at_rest(positions);
        state.memory.resize(self.memory_layers * self.particles.len(), 0.0);
        for (particle, position) in self.moving_pins.positions(0.0) {
            state.positions.set(particle, position);
        }
        self.moving_pins.eval_velocities(0.0, &mut state.velocities);
        state
    }

    /// What to draw: every cloth, thinned to at most `limit` vertices each.
    ///
    /// # Panics
    /// If `limit` is zero.
    #[must_use]
    pub fn surface(&self, limit: usize) -> Surface {
        let mut surface = Surface::default();
        for Cloth { grid, .. } in &self.cloths {
            surface.add_grid(grid.first_particle, grid.columns, grid.rows, limit);
        }
        surface
    }

    /// Number of springs of each family, in the order of [`Family::ALL`](crate::force::Family::ALL).
    #[must_use]
    pub fn spring_counts(&self) -> [u64; 3] {
        let mut counts = [0; 3];
        for force in &self.forces {
            for (count, added) in counts.iter_mut().zip(force.spring_counts()) {
                *count += added;
            }
        }
        counts
    }
}

/// Forces of one kind, each by itself.
fn boxed<F: Force + 'static>(forces: Vec<F>) -> impl Iterator<Item = Box<dyn Force>> {
    forces.into_iter().map(|force| Box::new(force) as Box<dyn Force>)
}

/// The forces of all winds: one for each on particles, and one for all that push faces, whose velocities add up.
fn winds(
    settings: &[WindSettings],
    run: &RunSettings,
    grids: &[Grid],
    instructions: InstructionSet,
) -> Vec<Box<dyn Force>> {
    let mut forces: Vec<Box<dyn Force>> = Vec::new();
    let mut air: Option<AerodynamicWind> = None;
    for (index, wind) in settings.iter().enumerate() {
        match wind {
            WindSettings::ParticleForce(settings) => {
                forces.push(Box::new(ParticleWind { force: gust(settings, run, index) }));
            }
            WindSettings::Aerodynamic(settings) => {
                let air = air.get_or_insert_with(|| AerodynamicWind {
                    air_density: settings.air_density,
                    normal_coefficient: settings.normal_coefficient,
                    tangential_coefficient: settings.tangential_coefficient,
                    velocity: glam::DVec3::ZERO,
                    gusts: Vec::new(),
                    grids: grids.to_vec(),
                    instructions,
                });
                air.velocity += settings.velocity;
                air.gusts.extend(settings.gust.as_ref().map(|settings| gust(settings, run, index)));
            }
        }
    }
    forces.extend(air.map(|air| Box::new(air) as Box<dyn Force>));
    forces
}

/// The gust of wind number `index`, whose noise no other wind has.
fn gust(settings: &GustSettings, run: &RunSettings, index: usize) -> Gust {
    let GustSettings { amplitude, angular_frequency, phase, direction, noise } = *settings;
    let noise = noise.map(|NoiseSettings { deviation, time }| {
        let stream = RandomStream::new(run.seed, &format!("environment.wind.{index}.noise"));
        Noise::new(deviation, time, run.duration, stream)
    });
    Gust { amplitude, angular_frequency, phase, direction, noise }
}
