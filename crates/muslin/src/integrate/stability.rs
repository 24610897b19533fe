//! The largest time step at which explicit central differences are stable.

use std::ops::Range;

use super::Workers;
use crate::force::Configuration;
use crate::model::Particles;
use crate::{Model, Points, PointsMut, State};

/// Lanczos steps at most; the largest eigenvalue of a long chain or a large grid is by then known to about 1e-4.
const MAX_LANCZOS_STEPS: usize = 120;

/// Relative change of the largest eigenvalue over [`CHECK_INTERVAL`] steps below which the iteration stops.
const EIGENVALUE_TOLERANCE: f64 = 1e-9;

/// Lanczos steps between two looks at the eigenvalue.
const CHECK_INTERVAL: usize = 6;

/// A step [s] that is stable for certain at the state's time and positions; +∞ if nothing is stiff.
///
/// By Gershgorin's theorem the fastest mode ω satisfies
///
/// ```text
/// ω² ≤ max_i bound_i / m_i    and    h = 2 / (ω + 2γ)
/// ```
///
/// with the bounds of [`Force::add_stiffness_bounds`](crate::force::Force::add_stiffness_bounds), and the same of
/// [`Force::add_damping_bounds`](crate::force::Force::add_damping_bounds) for the rate γ of forces on velocity, which are
/// explicit: alone they allow 2 / γ, of which half is taken. Air has no stiffness bound: how its
/// force changes with position is not counted.
///
/// For linear springs along their current length it is the same in every shape that the cloth can take. On a grid it is
/// about 0.7 of the [`largest_stable_step`]; it costs about as much as one step.
#[must_use]
pub fn guaranteed_stable_step(model: &Model, state: &State) -> f64 {
    let at = configuration(model, state);
    let (mut stiffness, mut damping) = (0.0, 0.0);
    let mut bounds = Vec::new();
    for block in model.blocks() {
        bounds.clear();
        bounds.resize(block.len(), 0.0);
        for force in model.forces() {
            force.add_stiffness_bounds(at, block, &mut bounds);
        }
        stiffness = larger(stiffness, largest_rate(at.particles, block, &bounds));
        damping = larger(damping, largest_damping_rate(model, at, block, &mut bounds));
    }
    stable_step(stiffness, damping)
}

/// The largest of bound / mass [1/s²] over the free particles, of those parts of the stiffness bounds that are the same in
/// all states.
#[must_use]
pub fn constant_stiffness(model: &Model, state: &State) -> f64 {
    let at = configuration(model, state);
    let mut stiffness = 0.0;
    let mut bounds = Vec::new();
    for block in model.blocks() {
        bounds.clear();
        bounds.resize(block.len(), 0.0);
        for force in model.forces() {
            force.add_constant_bounds(at, block, &mut bounds);
        }
        stiffness = larger(stiffness, largest_rate(at.particles, block, &bounds));
    }
    stiffness
}

/// `state` as forces see it, with velocities half a step old.
pub(super) fn configuration<'a>(model: &'a Model, state: &'a State) -> Configuration<'a> {
    Configuration {
        time: state.time,
        particles: model.particles(),
        positions: &state.positions,
        velocities: &state.velocities,
        memory: &state.memory,
    }
}

/// The largest of bound / mass over the free particles of `block`, 1/s² for stiffness; NaN if any is.
pub(super) fn largest_rate(particles: &Particles, block: &Range<usize>, bounds: &[f64]) -> f64 {
    let constants = particles.masses()[block.clone()].iter().zip(&particles.pinned()[block.clone()]);
    let squares =
        bounds.iter().zip(constants).map(|(bound, (mass, pinned))| if *pinned { 0.0 } else { bound / mass });
    squares.fold(0.0, larger)
}

/// The largest of damping bound / mass [1/s] over the free particles of `block`, whose `bounds` [kg/s] are overwritten; NaN
/// if any is.
pub(super) fn largest_damping_rate(
    model: &Model,
    at: Configuration<'_>,
    block: &Range<usize>,
    bounds: &mut [f64],
) -> f64 {
    bounds.fill(0.0);
    for force in model.forces() {
        force.add_damping_bounds(at, block, bounds);
    }
    largest_rate(at.particles, block, bounds)
}

/// The step 2 / (ω + 2γ) [s] for a frequency squared ω² [1/s²] and a damping rate γ [1/s]; 0 if they are not numbers.
pub(super) fn stable_step(frequency_squared: f64, damping: f64) -> f64 {
    step_at_rate(frequency_squared.sqrt() + 2.0 * damping)
}

/// The step 2 / `rate` [s] for a rate [1/s]; 0 if that is not a number.
fn step_at_rate(rate: f64) -> f64 {
    if rate.is_nan() { 0.0 } else { 2.0 / rate }
}

/// The larger number, and NaN if either is: `f64::max` would pass over it.
#[inline(always)]
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b <= a { a } else { b }
}

/// The largest of damping bound / mass [1/s] over all free particles, of all forces on velocity; zero without any.
fn damping_rate(model: &Model, state: &State) -> f64 {
    let at = configuration(model, state);
    let mut bounds = Vec::new();
    model.blocks().iter().fold(0.0, |rate, block| {
        bounds.resize(block.len(), 0.0);
        larger(rate, largest_damping_rate(model, at, block, &mut bounds))
    })
}

/// The largest stable step [s] at the state's time, positions and velocities; +∞ if nothing is stiff or damped, 0 if the
/// stiffness is beyond all numbers.
///
/// ```text
/// h = 2 / max(ω, γ)
/// ```
///
/// ω² is the largest eigenvalue of `M^(−1/2) K M^(−1/2)` over the free particles, by Lanczos iteration from a fixed
/// start vector: exact to round-off for small models, too large a step by less than 0.1 % for large ones. γ is the bound of the
/// [`guaranteed_stable_step`] on the rate of all forces on velocity, air and dashpots.
///
/// Below it no motion grows, whatever drag, if K and D = −∂F/∂v are symmetric and D damps, as that of dashpots and of air that
/// presses on faces. Above 2 / ω a fastest mode grows that nothing damps; one that is damped by the rate γ' grows only above
/// ω² h² = 4 + 2 z² / (2 − z), z = γ' h. The [`guaranteed_stable_step`] keeps below half of what damping allows.
///
/// In shapes that the cloth takes later the limit may differ. With linear springs along their current length it stays above the
/// [`guaranteed_stable_step`]; as printed, divided by the rest length, a spring stiffens as it stretches.
#[must_use]
pub fn largest_stable_step(model: &Model, state: &State, workers: &Workers) -> f64 {
    let mut operator = StiffnessOperator::new(model, state, workers);
    let mut current = operator.start_vector();
    let mut previous = Points::zeros(current.len());
    let mut product = Points::zeros(current.len());
    let (mut diagonal, mut off_diagonal): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
    let mut eigenvalue = 0.0;
    for step in 1..=MAX_LANCZOS_STEPS {
        operator.apply(&current, &mut product);
        let alpha = dot(&current, &product);
        let beta_before = off_diagonal.last().copied().unwrap_or(0.0);
        combine(&mut product, -alpha, &current);
        combine(&mut product, -beta_before, &previous);
        diagonal.push(alpha);
        let beta = dot(&product, &product).sqrt();
        if !(alpha.is_finite() && beta.is_finite()) {
            return 0.0;
        }
        let is_exhausted = beta <= 1e-12 * alpha.abs().max(beta_before);
        if is_exhausted || step % CHECK_INTERVAL == 0 || step == MAX_LANCZOS_STEPS {
            let before = std::mem::replace(&mut eigenvalue, largest_eigenvalue(&diagonal, &off_diagonal));
            if is_exhausted || eigenvalue - before <= EIGENVALUE_TOLERANCE * eigenvalue {
                break;
            }
        }
        off_diagonal.push(beta);
        std::mem::swap(&mut previous, &mut current);
        std::mem::swap(&mut current, &mut product);
        scale(&mut current, 1.0 / beta);
    }
    step_at_rate(larger(eigenvalue.max(0.0).sqrt(), damping_rate(model, state)))
}

/// `M^(−1/2) K M^(−1/2)` [1/s²] over the free particles at one configuration.
struct StiffnessOperator<'a> {
    model: &'a Model,
    at: Configuration<'a>,
    workers: &'a Workers,
    scales: Vec<f64>,
    displacements: Points,
}

impl<'a> StiffnessOperator<'a> {
    fn new(model: &'a Model, state: &'a State, workers: &'a Workers) -> Self {
        let particles = model.particles();
        let constants = particles.masses().iter().zip(particles.pinned());
        let scales = constants.map(|(mass, pinned)| if *pinned { 0.0 } else { 1.0 / mass.sqrt() }).collect();
        let at = configuration(model, state);
        Self { model, at, workers, scales, displacements: Points::zeros(particles.len()) }
    }

    /// A unit vector that has a part of every mode: a fixed pseudo-random sequence, zero at pins.
    fn start_vector(&self) -> Points {
        let mut seed = 0x9e37_79b9_7f4a_7c15_u64;
        let mut next = || {
            // Xorshift (Marsaglia 2003), here only to avoid any symmetry of the grid.
            seed ^= seed << 13;
            seed ^= seed >> 7;
            seed ^= seed << 17;
            (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let mut vector: Points = self
            .scales
            .iter()
            .map(|scale| glam::DVec3::new(next(), next(), next()) * f64::from(u8::from(*scale != 0.0)))
            .collect();
        let length = dot(&vector, &vector).sqrt();
        scale(&mut vector, if length > 0.0 { 1.0 / length } else { 0.0 });
        vector
    }

    /// Overwrites `product` with the operator times `vector`.
    fn apply(&mut self, vector: &Points, product: &mut Points) {
        self.displacements.clone_from(vector);
        scale_each(self.displacements.as_mut(), &self.scales);
        let (at, displacements, scales, model) = (self.at, &self.displacements, &self.scales, self.model);
        let apply_block = |block: &Range<usize>, mut product: PointsMut<'_>| {
            product.fill(0.0);
            for force in model.forces() {
                force.add_tangent_products(at, displacements, block, &mut product);
            }
            scale_each(product, &scales[block.clone()]);
        };
        self.workers.for_blocks(model.blocks(), product.as_mut(), &apply_block, &|(), ()| ());
    }
}

/// Multiplies each point by its factor.
fn scale_each(points: PointsMut<'_>, factors: &[f64]) {
    for axis in [points.x, points.y, points.z] {
        for (value, factor) in axis.iter_mut().zip(factors) {
            *value *= factor;
        }
    }
}

/// Multiplies every point by `factor`.
fn scale(points: &mut Points, factor: f64) {
    for axis in [&mut points.x, &mut points.y, &mut points.z] {
        axis.iter_mut().for_each(|value| *value *= factor);
    }
}

/// Adds `factor` times `other` to `points`.
fn combine(points: &mut Points, factor: f64, other: &Points) {
    let axes = [(&mut points.x, &other.x), (&mut points.y, &other.y), (&mut points.z, &other.z)];
    for (values, others) in axes {
        values.iter_mut().zip(others).for_each(|(value, other)| *value += factor * other);
    }
}

/// Sum of the products of all coordinates.
fn dot(a: &Points, b: &Points) -> f64 {
    let axes = [(&a.x, &b.x), (&a.y, &b.y), (&a.z, &b.z)];
    axes.into_iter().map(|(a, b)| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>()).sum()
}

/// Largest eigenvalue of a symmetric tridiagonal matrix, by bisection on the number of eigenvalues above a value.
fn largest_eigenvalue(diagonal: &[f64], off_diagonal: &[f64]) -> f64 {
    let radius = |i: usize| {
        let left = i.checked_sub(1).map_or(0.0, |i| off_diagonal[i].abs());
        left + off_diagonal.get(i).map_or(0.0, |value| value.abs())
    };
    let mut low = diagonal.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut high = (0..diagonal.len()).map(|i| diagonal[i] + radius(i)).fold(f64::NEG_INFINITY, f64::max);
    // Each halving adds a bit; after 64 the interval is one of neighbouring numbers.
    for _ in 0..64 {
        let middle = 0.5 * (low + high);
        if has_eigenvalue_above(diagonal, off_diagonal, middle) { low = middle } else { high = middle }
    }
    high
}

/// Whether any eigenvalue of a symmetric tridiagonal matrix is larger than `value`: Sylvester's law of inertia on the
/// pivots of the matrix less `value`.
fn has_eigenvalue_above(diagonal: &[f64], off_diagonal: &[f64], value: f64) -> bool {
    let mut pivot = -1.0_f64;
    diagonal.iter().enumerate().any(|(i, entry)| {
        let coupling = i.checked_sub(1).map_or(0.0, |i| off_diagonal[i]);
        pivot = entry - value - coupling * coupling / pivot;
        if pivot == 0.0 {
            pivot = -f64::MIN_POSITIVE;
        }
        pivot > 0.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The n x n second-difference matrix has the eigenvalues 2 − 2 cos(k π / (n + 1)).
    #[test]
    fn tridiagonal_eigenvalue_matches_closed_form() {
        for n in [1_usize, 2, 5, 40] {
            let exact = 2.0 - 2.0 * (n as f64 * std::f64::consts::PI / (n as f64 + 1.0)).cos();
            let found = largest_eigenvalue(&vec![2.0; n], &vec![-1.0; n - 1]);
            assert!((found - exact).abs() < 1e-13, "n = {n}: {found} for {exact}");
        }
    }
}
