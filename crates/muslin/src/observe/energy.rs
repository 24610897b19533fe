//! The energy ledger: where the energy is, where it came from and went, and what is missing.

use serde::{Deserialize, Serialize};

use super::{Frame, Observer};
use crate::force::{Configuration, Force, PotentialEnergies};
use crate::{Model, Points, PointsMut, State};

/// Energies [J] at one time.
///
/// ```text
/// residual = (kinetic + elastic + gravitational) − (the same at time zero) − wind work + drag loss
/// ```
///
/// The residual would be zero in exact integration; with central differences it falls as the step squared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EnergyTerms {
    /// ½ Σ m v².
    pub kinetic: f64,
    /// Of structural springs.
    pub elastic_structural: f64,
    /// Of shear springs.
    pub elastic_shear: f64,
    /// Of bend springs.
    pub elastic_bend: f64,
    /// −Σ m g · x, zero at the origin.
    pub gravitational: f64,
    /// Work done by the wind on the cloth since time zero.
    pub wind_work: f64,
    /// Energy that drag took since time zero.
    pub drag_loss: f64,
    /// What does not add up.
    pub residual: f64,
}

impl EnergyTerms {
    /// Names of the terms, in the order of [`values`](Self::values).
    pub const NAMES: [&str; 8] = [
        "kinetic",
        "elastic_structural",
        "elastic_shear",
        "elastic_bend",
        "gravitational",
        "wind_work",
        "drag_loss",
        "residual",
    ];

    /// The terms [J] in the order of [`NAMES`](Self::NAMES).
    #[must_use]
    pub fn values(&self) -> [f64; 8] {
        [
            self.kinetic,
            self.elastic_structural,
            self.elastic_shear,
            self.elastic_bend,
            self.gravitational,
            self.wind_work,
            self.drag_loss,
            self.residual,
        ]
    }

    /// Kinetic, elastic and gravitational energy together.
    fn total(&self) -> f64 {
        self.kinetic + self.elastic_structural + self.elastic_shear + self.elastic_bend + self.gravitational
    }
}

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
        for (value, initial) in terms.values().iter().zip(first.values()).take(7) {
            scale = scale.max((value - initial).abs());
        }
    }
    if scale > 0.0 { residual / scale } else { 0.0 }
}

/// Sums the work of the wind and the loss to drag over all steps, and takes stock at every frame.
///
/// Over a step of h with displacement Δ = h v:
///
/// ```text
/// wind work += ½ Σ (F_before + F_after) · Δ        drag loss += Σ k_d v² h
/// ```
///
/// A force that depends on velocities does the work F · Δ with F in the middle of the step, at x − ½ Δ and v: there the
/// state's velocities are at home. All are of second order, like the motion itself.
#[derive(Clone, Debug, Default)]
pub struct EnergyLedger {
    initial: Option<EnergyTerms>,
    current: EnergyTerms,
    external_before: Points,
    external_after: Points,
    middle_positions: Points,
}

impl EnergyLedger {
    /// A ledger that continues a run from `state`, with the terms of its `first` and of its `current` frame.
    #[must_use]
    pub fn resume(model: &Model, state: &State, first: EnergyTerms, current: EnergyTerms) -> Self {
        let mut ledger = Self { initial: Some(first), current, ..Self::default() };
        eval_external_forces(model, state, &mut ledger.external_before);
        ledger
    }

    /// The terms at the latest frame.
    #[must_use]
    pub fn terms(&self) -> &EnergyTerms {
        &self.current
    }

    /// Adds the work of the forces that depend on velocities over the step that led to `state`.
    fn add_work_of_moving(&mut self, model: &Model, state: &State) {
        let forces =
            || model.forces().iter().filter(|force| force.is_external() && force.depends_on_velocity());
        if forces().next().is_none() {
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
        };
        // What was known of the forces before the step is no longer needed.
        sum_forces(model, at, forces(), &mut self.external_after);
        let power = mean_power(&self.external_after, &self.external_after, &state.velocities);
        self.current.wind_work += power * state.last_step;
    }
}

impl Observer for EnergyLedger {
    fn step(&mut self, model: &Model, state: &State) {
        assert!(
            self.initial.is_some(),
            "an energy ledger sees the first frame before any step: call `Simulation::observe`"
        );
        self.current.drag_loss += drag_power(model, state) * state.last_step;
        if eval_external_forces(model, state, &mut self.external_after) {
            let power = mean_power(&self.external_before, &self.external_after, &state.velocities);
            self.current.wind_work += power * state.last_step;
            std::mem::swap(&mut self.external_before, &mut self.external_after);
        }
        self.add_work_of_moving(model, state);
    }

    fn frame(&mut self, model: &Model, frame: &Frame<'_>) {
        let particles = model.particles();
        let at = Configuration {
            time: frame.state.time,
            particles,
            positions: &frame.state.positions,
            velocities: frame.velocities,
        };
        let mut potentials = PotentialEnergies::default();
        for force in model.forces() {
            force.add_energies(at, &mut potentials);
        }
        let squares =
            frame.velocities.iter().zip(particles.masses()).map(|(v, mass)| mass * v.length_squared());
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
                self.initial.insert(self.current)
            }
        };
        let gained = self.current.total() - initial.total();
        self.current.residual = gained - self.current.wind_work + self.current.drag_loss;
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
    for force in forces {
        let mut rest = sums.as_mut();
        for block in model.blocks() {
            let (mut own, others): (PointsMut<'_>, _) = rest.split_at(block.len());
            force.add_forces(at, block, &mut own);
            rest = others;
        }
    }
}

/// Σ k_d v² [W] with the state's velocities.
fn drag_power(model: &Model, state: &State) -> f64 {
    let velocities = &state.velocities;
    sum_in_lanes(model.particles().drags(), |i, drag| {
        let (x, y, z) = (velocities.x[i], velocities.y[i], velocities.z[i]);
        drag * (x * x + y * y + z * z)
    })
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

/// Sum of `term(index, value)` over `values`, in eight partial sums so that it can use vector registers; the order is
/// the same on every machine.
fn sum_in_lanes(values: &[f64], term: impl Fn(usize, f64) -> f64) -> f64 {
    let mut lanes = [0.0; 8];
    for (chunk_index, chunk) in values.chunks(8).enumerate() {
        for (lane, (offset, &value)) in lanes.iter_mut().zip(chunk.iter().enumerate()) {
            *lane += term(8 * chunk_index + offset, value);
        }
    }
    lanes.iter().sum()
}
