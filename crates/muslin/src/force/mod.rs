//! Forces, each of one kind for all particles at once.
//!
//! A [`Force`] is asked for whole blocks of particles, never for one, and adds to these alone. What it adds to a particle
//! has a fixed order, wherever a block begins, so that no division of work among threads changes a sum.

mod aerodynamic;
mod bending;
mod elements;
mod gravity;
mod grid_dashpots;
mod grid_friction;
mod grid_laws;
mod grid_springs;
mod grid_stiffness;
mod grid_strains;
mod gust;
mod law;
mod noise;
mod row_sums;
mod row_sweep;
mod spring;
mod stiffness_tensors;
mod stop;
mod tile;
mod tile_springs;
mod wind;

use std::fmt;
use std::ops::Range;

pub use aerodynamic::AerodynamicWind;
pub use bending::GridBending;
pub use gravity::Gravity;
pub use grid_dashpots::GridDashpots;
pub use grid_friction::GridFriction;
pub use grid_laws::{GridLaws, Lines, SpringGroup};
pub use grid_springs::GridSprings;
pub use gust::Gust;
pub use law::{
    ArctangentLaw, BucklingLaw, Cubic, CurveLaw, LinearLaw, ReducedLaw, SpringLaw, TangentLaw, TensionLaw,
};
pub use noise::{Noise, RandomStream};
pub use row_sweep::Sweep;
pub use spring::{Spring, SpringLength};
pub use stiffness_tensors::{StiffnessTensors, StiffnessTensorsMut};
pub use wind::ParticleWind;

use crate::model::Particles;
use crate::{Points, PointsMut};

/// Where all particles are at one time, how they move, and what they are.
#[derive(Clone, Copy, Debug)]
pub struct Configuration<'a> {
    /// Simulated time [s].
    pub time: f64,
    /// Masses, drags and pins.
    pub particles: &'a Particles,
    /// Positions [m], one per particle.
    pub positions: &'a Points,
    /// Velocities [m/s] at that time, one per particle. Only forces that [depend on them](Force::depends_on_velocity) and
    /// bounds on damping look at them; whoever asks for neither may leave them empty.
    pub velocities: &'a Points,
    /// What forces [remember](Force::advance_memory) of the motion so far; empty for a cloth as new.
    ///
    /// Within each row of a grid, [`Model::memory_layers`](crate::Model::memory_layers) layers of one value per particle
    /// follow each other.
    pub memory: &'a [f64],
}

/// A family of springs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// To the next particle along the grid.
    Structural,
    /// To the next particle along the diagonals.
    Shear,
    /// To the next particle but one along the grid.
    Bend,
}

impl Family {
    /// All families; a family's place here is its index in arrays per family.
    pub const ALL: [Self; 3] = [Self::Structural, Self::Shear, Self::Bend];

    /// Name in scene files and results.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Structural => "structural",
            Self::Shear => "shear",
            Self::Bend => "bend",
        }
    }
}

/// Potential energies [J].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PotentialEnergies {
    /// Of springs, per family in the order of [`Family::ALL`]; that of bending is also the energy of a [rigidity](GridBending).
    pub elastic: [f64; 3],
    /// Of gravity; zero at the origin.
    pub gravitational: f64,
}

/// Strains e = (ℓ − L) / L [1] of one family of springs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrainSums {
    /// Number of springs.
    pub count: u64,
    /// Smallest strain; +∞ without springs.
    pub min: f64,
    /// Largest strain; −∞ without springs.
    pub max: f64,
    /// Sum of the strains.
    pub sum: f64,
}

impl Default for StrainSums {
    fn default() -> Self {
        Self { count: 0, min: f64::INFINITY, max: f64::NEG_INFINITY, sum: 0.0 }
    }
}

/// A spring as part of a cloth: its family, and the particles that it joins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringEnds {
    /// Its family.
    pub family: Family,
    /// The particles at its ends, the lower number first.
    pub particles: [usize; 2],
    /// Rest length L [m].
    pub rest_length: f64,
}

/// A force on all particles.
///
/// `block` is one of the model's [`blocks`](crate::Model::blocks); arrays named after what is added hold one entry per
/// particle of the block, everything in [`Configuration`] one per particle of the model.
pub trait Force: fmt::Debug + Send + Sync {
    /// Adds the force [N] on every particle of `block`.
    ///
    /// `sweep` saves work where one block after the other is asked for, and changes no bit of the result. A force with springs
    /// raises its [largest strains](Sweep::raise_max_strains) if they are watched.
    fn add_forces(
        &self,
        at: Configuration<'_>,
        block: &Range<usize>,
        forces: &mut PointsMut<'_>,
        sweep: &mut Sweep,
    );

    /// Overwrites the `forces` [N] on every particle of `block`: what [`add_forces`](Self::add_forces) adds to zero.
    fn set_forces(
        &self,
        at: Configuration<'_>,
        block: &Range<usize>,
        forces: &mut PointsMut<'_>,
        sweep: &mut Sweep,
    ) {
        forces.fill(0.0);
        self.add_forces(at, block, forces, sweep);
    }

    /// Adds `K u` [N], with the tangent `K = −∂F/∂x` [N/m] and `displacements` u [m] of all particles.
    fn add_tangent_products(
        &self,
        at: Configuration<'_>,
        displacements: &Points,
        block: &Range<usize>,
        products: &mut PointsMut<'_>,
    ) {
        let _ = (at, displacements, block, products);
    }

    /// Adds a bound [N/m] on the stiffness that each particle feels, for the stability of the step.
    ///
    /// With the tangent K = Σ_e K_e over elements e of two ends each, K_e⁺ its part without negative eigenvalues (which
    /// make modes slower), and w = 2 if both ends are free, 1 if the other is pinned, no mode is faster than the largest
    /// `√(bound / mass)` with
    ///
    /// ```text
    /// bound_i = Σ_{e at i} w ‖K_e⁺‖
    /// ```
    ///
    /// (Gershgorin's theorem on M⁻¹ K).
    fn add_stiffness_bounds(&self, at: Configuration<'_>, block: &Range<usize>, bounds: &mut [f64]) {
        let _ = (at, block, bounds);
    }

    /// Adds the stiffness [N/m] that each particle feels in every direction, a tighter bound than that of
    /// [`add_stiffness_bounds`](Self::add_stiffness_bounds).
    ///
    /// With K_e⁺ and w as there, no mode is faster than the largest √λ of
    ///
    /// ```text
    /// λ_i = λ_max(Σ_{e at i} w K_e⁺) / m_i
    /// ```
    ///
    /// since with displacements u, zero at pins, and K_e ≤ K_e⁺,
    ///
    /// ```text
    /// uᵀ K u ≤ Σ_e (u_i − u_j)ᵀ K_e⁺ (u_i − u_j) ≤ Σ_e w (u_iᵀ K_e⁺ u_i + u_jᵀ K_e⁺ u_j) = Σ_i u_iᵀ (Σ_{e at i} w K_e⁺) u_i
    ///        ≤ Σ_i λ_i m_i |u_i|² ≤ max λ_i · uᵀ M u
    /// ```
    ///
    /// (the second step for w = 2 is |a − b|² ≤ 2|a|² + 2|b|² in the norm of K_e⁺, and equal where neighbours move against
    /// each other). Never more than `bound_i / m_i` as ‖Σ w K_e⁺‖ ≤ Σ w ‖K_e⁺‖. `sweep` is what it is for
    /// [`add_forces`](Self::add_forces).
    fn add_stiffness_tensors(
        &self,
        at: Configuration<'_>,
        block: &Range<usize>,
        tensors: &mut StiffnessTensorsMut<'_>,
        sweep: &mut Sweep,
    ) {
        let _ = sweep;
        // The same in all directions.
        let diagonal = &mut tensors.diagonal;
        for entries in [&mut diagonal.x, &mut diagonal.y, &mut diagonal.z] {
            self.add_stiffness_bounds(at, block, entries);
        }
    }

    /// [`add_forces`](Self::add_forces), and that part of the [stiffness bounds](Self::add_stiffness_bounds) which depends on
    /// where the particles are, in one pass. The forces have the same bits.
    fn add_forces_and_varying_bounds(
        &self,
        at: Configuration<'_>,
        block: &Range<usize>,
        forces: &mut PointsMut<'_>,
        bounds: &mut [f64],
        sweep: &mut Sweep,
    ) {
        self.add_forces(at, block, forces, sweep);
        self.add_stiffness_bounds(at, block, bounds);
    }

    /// Adds the other part of the [stiffness bounds](Self::add_stiffness_bounds), which is the same in all states.
    fn add_constant_bounds(&self, at: Configuration<'_>, block: &Range<usize>, bounds: &mut [f64]) {
        let _ = (at, block, bounds);
    }

    /// Whether any part of the stiffness or damping bounds depends on the state.
    fn has_varying_bounds(&self) -> bool {
        true
    }

    /// The longest step [s] that follows how the force changes in time by itself; +∞ if it does not.
    fn longest_step(&self) -> f64 {
        f64::INFINITY
    }

    /// Whether the force is a function of velocities, too.
    ///
    /// A method that keeps velocities of other times then has to find those of the state's time, which costs something.
    fn depends_on_velocity(&self) -> bool {
        false
    }

    /// Adds a bound [kg/s] on the sum of the norms of each particle's row of the damping `D = −∂F/∂v`.
    ///
    /// With a step h and masses m, an explicit method has to keep `h · bound / m` of the order of one.
    fn add_damping_bounds(&self, at: Configuration<'_>, block: &Range<usize>, bounds: &mut [f64]) {
        let _ = (at, block, bounds);
    }

    /// Power [W] that a force on velocities turns into heat inside of the cloth, by all particles at their velocities.
    ///
    /// It is [no external force](Self::is_external): the energy ledger counts this power, and not its work.
    fn damping_power(&self, at: Configuration<'_>) -> f64 {
        let _ = at;
        0.0
    }

    /// How many layers of [memory](Configuration::memory) there are at least, that the force may use its own.
    fn memory_layers(&self) -> usize {
        0
    }

    /// Brings the `memory` of `block` up to date where the particles are; the energy [J] that friction lost on the way there.
    ///
    /// `memory` holds what [`Configuration::memory`] holds of the block. Once more at the same positions nothing changes and
    /// nothing is lost, and no bit of a force depends on whether it was done there or not: so forces may be evaluated as often
    /// as one likes, and memory is brought up to date once a step is final.
    fn advance_memory(&self, at: Configuration<'_>, block: &Range<usize>, memory: &mut [f64]) -> f64 {
        let _ = (at, block, memory);
        0.0
    }

    /// Adds the potential energy [J] of all particles, if the force has one; what friction elements hold is a part of it.
    fn add_energies(&self, at: Configuration<'_>, energies: &mut PotentialEnergies) {
        let _ = (at, energies);
    }

    /// Whether the force has no potential energy, so that its work has to be summed along the way.
    fn is_external(&self) -> bool {
        false
    }

    /// Number of springs per family, in the order of [`Family::ALL`].
    fn spring_counts(&self) -> [u64; 3] {
        [0; 3]
    }

    /// Shows every spring to `visit` once, family by family in the order of [`Family::ALL`].
    fn visit_springs(&self, visit: &mut dyn FnMut(SpringEnds)) {
        let _ = visit;
    }

    /// Adds the strains of all springs, per family in the order of [`Family::ALL`].
    fn add_strains(&self, at: Configuration<'_>, strains: &mut [StrainSums; 3]) {
        let _ = (at, strains);
    }

    /// Replaces the strain [1] of each particle that has structural springs by the one farthest from zero among them.
    fn eval_particle_strains(&self, at: Configuration<'_>, strains: &mut [f32]) {
        let _ = (at, strains);
    }
}
