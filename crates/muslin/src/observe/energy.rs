//! The energy ledger: where the energy is, where it came from and went, and what is missing.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::pin_work::PinWork;
use super::{Frame, Observer};
use crate::force::{Configuration, Force, PotentialEnergies, Sweep};
use crate::points::sum_in_lanes;
use crate::{Model, Points, PointsMut, State, StepSummary};

/// Energies [J] at one time.
///
/// ```text
/// residual = (kinetic + elastic + gravitational) − (the same at time zero) − wind work − pin work
///            + drag loss + limit loss + friction loss + damping loss
/// ```
///
/// The residual would be zero in exact integration; with central differences it falls as the step squared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EnergyTerms {
    /// ½ Σ m v² over the particles that are free.
    pub kinetic: f64,
    /// Of structural springs, and what friction along yarns holds.
    pub elastic_structural: f64,
    /// Of shear springs, and what friction in shear holds.
    pub elastic_shear: f64,
    /// Of bending: of bend springs, or of a measured fabric's rigidity, and what friction in bending holds.
    pub elastic_bend: f64,
    /// −Σ m g · x, zero at the origin.
    pub gravitational: f64,
    /// Work done by the wind on the cloth since time zero.
    pub wind_work: f64,
    /// Work done by pins that move since time zero.
    pub pin_work: f64,
    /// Energy that drag took from free particles since time zero.
    pub drag_loss: f64,
    /// Energy that limits against super-elongation took since time zero.
    pub limit_loss: f64,
    /// Energy that internal friction took since time zero.
    pub friction_loss: f64,
    /// Energy that internal damping took since time zero.
    pub damping_loss: f64,
    /// What does not add up.
    pub residual: f64,
}

impl EnergyTerms {
    /// Names of the terms, in the order of [`values`](Self::values).
    pub const NAMES: [&str; 12] = [
        "kinetic",
        "elastic_structural",
        "elastic_shear",
        "elastic_bend",
        "gravitational",
        "wind_work",
        "pin_work",
        "drag_loss",
        "limit_loss",
        "friction_loss",
        "damping_loss",
        "residual",
    ];

    /// The terms [J] in the order of [`NAMES`](Self::NAMES).
    #[must_use]
    pub fn values(&self) -> [f64; 12] {
        [
            self.kinetic,
            self.elastic_structural,
            self.elastic_shear,
            self.elastic_bend,
            self.gravitational,
            self.wind_work,
            self.pin_work,
            self.drag_loss,
            self.limit_loss,
            self.friction_loss,
            self.damping_loss,
            self.residual,
        ]
    }

    /// What drag, limits, friction and damping took.
    fn losses(&self) -> f64 {
        self.drag_loss + self.limit_loss + self.friction_loss + self.damping_loss
    }

    /// Kinetic, elastic and gravitational energy together.
    fn total(&self) -> f64 {
        self.kinetic + self.elastic_structural + self.elastic_shear + self.elastic_bend + self.gravitational
    }
}

/// Place of the residual among the terms.
const RESIDUAL: usize = EnergyTerms::NAMES.len() - 1;

/// The largest residual of any frame, relative to the largest change of any term since the first frame.
///
/// Zero if no energy changes at all; +∞ if one is no longer a finite number, as before an unstable run ends.
#[must_use]
pub fn relative_residual<'a>(frames: impl IntoIterator<Item = &'a EnergyTerms>) -> f64 {
    let mut frames = frames.into_iter();
    let Some(first) = frames.next() else { return 0.0 };
    let (mut residual, mut scale) = (0.0_f64, 0.0_f64);
    for terms in frames {
        if !terms.values().iter().all(|value| value.is_finite()) {
            return f64::INFINITY;
        }
        residual = residual.max(terms.residual.abs());
        for (value, initial) in terms.values().iter().zip(first.values()).take(RESIDUAL) {
            scale = scale.max((value - initial).abs());
        }
    }
    if scale > 0.0 { residual / scale } else { 0.0 }
}

/// Sums the work of wind and pins and all losses over all steps, and takes stock at every frame.
///
/// Over a step of h with displacement Δ = h v, with F_w the force of the wind and F the force of everything but the pins:
///
/// ```text
/// wind work += ½ Σ (F_w,before + F_w,after) · Δ        over all particles
/// pin work  −= ½ Σ (F_before + F_after) · Δ            over the pins that move
/// drag loss += Σ k_d v² h                              over the free particles
/// friction loss += State::friction_loss
/// ```
///
/// A force that depends on velocities does the work F · Δ with F in the middle of the step, at x − ½ Δ and v: there the
/// state's velocities are at home. So are those that [damping power](Force::damping_power) belongs to, of which the step
/// loses h times as much. To wind and pins comes [`State::limit_work`] of every
/// step: what limits do on pins, the pins do against it. All are of second order, like the motion itself. What moves a pin
/// has the mass and the drag of its particle to itself: its kinetic energy and the drag on it are in no term.
#[derive(Clone, Debug, Default)]
pub struct EnergyLedger {
    initial: Option<EnergyTerms>,
    current: EnergyTerms,
    external_before: Points,
    external_after: Points,
    pins: PinWork,
    middle_positions: Points,
}

impl EnergyLedger {
    /// A ledger that continues a run from `state`, with the terms of its `first` and of its `current` frame.
    #[must_use]
    pub fn resume(model: &Model, state: &State, first: EnergyTerms, current: EnergyTerms) -> Self {
        let mut ledger = Self { initial: Some(first), current, ..Self::default() };
        eval_external_forces(model, state, &mut ledger.external_before);
        ledger.pins = PinWork::new(model, state);
        ledger
    }

    /// The terms at the latest frame.
    #[must_use]
    pub fn terms(&self) -> &EnergyTerms {
        &self.current
    }

    /// Adds what the forces that depend on velocities did over the step that led to `state`.
    fn add_work_of_moving(&mut self, model: &Model, state: &State) {
        if !model.depends_on_velocity() {
            return;
        }
        let half_step = 0.5 * state.last_step;
        self.middle_positions.clone_from(&state.positions);
        let middle = &mut self.middle_positions;
        for (positions, velocities) in [
            (&mut middle.x, &state.velocities.x),
            (&mut middle.y, &state.velocities.y),
            (&mut middle.z, &state.velocities.z),
        ] {
            positions
                .iter_mut()
                .zip(velocities)
                .for_each(|(position, velocity)| *position -= half_step * velocity);
        }
        let at = Configuration {
            time: state.time - half_step,
            particles: model.particles(),
            positions: &self.middle_positions,
            velocities: &state.velocities,
            memory: &state.memory,
        };
        let forces = |is_external: bool| {
            let moving = model.forces().iter().filter(|force| force.depends_on_velocity());
            moving.filter(move |force| force.is_external() == is_external)
        };
        // What was known of the forces before the step is no longer needed.
        let sums = &mut self.external_after;
        if forces(true).next().is_some() {
            sum_forces(model, at, forces(true), sums);
            // What such forces do on a pin that moves does not reach the cloth.
            for pin in model.moving_pins().particles() {
                sums.set(pin, DVec3::ZERO);
            }
            self.current.wind_work += mean_power(sums, sums, &state.velocities) * state.last_step;
        }
        if forces(false).next().is_some() {
            let power: f64 = forces(false).map(|force| force.damping_power(at)).sum();
            self.current.damping_loss += power * state.last_step;
            if model.moving_pins().is_empty() {
                return;
            }
            sum_forces(model, at, forces(false), sums);
            // A pin that moves works against the damping of the cloth that it holds.
            let pins = model.moving_pins().particles();
            let power: f64 = pins.map(|pin| sums.get(pin).dot(state.velocities.get(pin))).sum();
            self.current.pin_work -= power * state.last_step;
        }
    }
}

impl Observer for EnergyLedger {
    fn step(&mut self, model: &Model, state: &State) {
        assert!(
            self.initial.is_some(),
            "an energy ledger sees the first frame before any step: call `Simulation::observe`"
        );
        self.current.limit_loss -= state.limit_work.on_free + state.limit_work.on_pins;
        self.current.friction_loss += state.friction_loss;
        self.current.pin_work += self.pins.add_step(model, state) - state.limit_work.on_pins;
        if eval_external_forces(model, state, &mut self.external_after) {
            let power = mean_power(&self.external_before, &self.external_after, &state.velocities);
            self.current.wind_work += power * state.last_step;
            std::mem::swap(&mut self.external_before, &mut self.external_after);
        }
        self.add_work_of_moving(model, state);
    }

    fn wants_summary(&self) -> bool {
        true
    }

    fn summary(&mut self, summary: &StepSummary) {
        self.current.drag_loss += summary.drag_loss;
    }

    fn frame(&mut self, model: &Model, frame: &Frame<'_>) {
        let particles = model.particles();
        let at = Configuration {
            time: frame.state.time,
            particles,
            positions: &frame.state.positions,
            velocities: frame.velocities,
            memory: &frame.state.memory,
        };
        let mut potentials = PotentialEnergies::default();
        for force in model.forces() {
            force.add_energies(at, &mut potentials);
        }
        let moving = frame.velocities.iter().zip(particles.masses()).zip(particles.pinned());
        let squares = moving.filter(|(_, pinned)| !**pinned).map(|((v, mass), _)| mass * v.length_squared());
        self.current.kinetic = 0.5 * squares.sum::<f64>();
        let [structural, shear, bend] = potentials.elastic;
        self.current.elastic_structural = structural;
        self.current.elastic_shear = shear;
        self.current.elastic_bend = bend;
        self.current.gravitational = potentials.gravitational;
        let initial = match &self.initial {
            Some(initial) => initial,
            None => {
                eval_external_forces(model, frame.state, &mut self.external_before);
                self.pins = PinWork::new(model, frame.state);
                self.initial.insert(self.current)
            }
        };
        let gained = self.current.total() - initial.total();
        let work = self.current.wind_work + self.current.pin_work;
        self.current.residual = gained - work + self.current.losses();
    }
}

/// Overwrites `forces` with the sum [N] of the forces that have no potential and depend on no velocity, if there are any;
/// whether there are.
fn eval_external_forces(model: &Model, state: &State, forces: &mut Points) -> bool {
    let mut external =
        model.forces().iter().filter(|force| force.is_external() && !force.depends_on_velocity()).peekable();
    if external.peek().is_none() {
        return false;
    }
    let at = Configuration {
        time: state.time,
        particles: model.particles(),
        positions: &state.positions,
        velocities: &state.velocities,
        memory: &state.memory,
    };
    sum_forces(model, at, external, forces);
    true
}

/// Overwrites `sums` [N] with the sum of `forces`.
fn sum_forces<'a>(
    model: &Model,
    at: Configuration<'_>,
    forces: impl Iterator<Item = &'a Box<dyn Force>>,
    sums: &mut Points,
) {
    if sums.len() != at.positions.len() {
        *sums = Points::zeros(at.positions.len());
    }
    sums.fill(0.0);
    let mut sweep = Sweep::default();
    for force in forces {
        let mut rest = sums.as_mut();
        for block in model.blocks() {
            let (mut own, others): (PointsMut<'_>, _) = rest.split_at(block.len());
            force.add_forces(at, block, &mut own, &mut sweep);
            rest = others;
        }
    }
}

/// ½ Σ (F_before + F_after) · v [W].
fn mean_power(before: &Points, after: &Points, velocities: &Points) -> f64 {
    let axes = [
        (&before.x, &after.x, &velocities.x),
        (&before.y, &after.y, &velocities.y),
        (&before.z, &after.z, &velocities.z),
    ];
    axes.into_iter()
        .map(|(before, after, velocities)| {
            sum_in_lanes(velocities, |i, velocity| 0.5 * (before[i] + after[i]) * velocity)
        })
        .sum()
}
