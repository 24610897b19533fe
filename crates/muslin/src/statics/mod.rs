//! Shapes at rest under what holds and pulls: Newton's method, with conjugate gradients on the tangents of the forces.
//!
//! Only models of one cloth, in the plane of x and y: what the specimens of the [laboratory](crate::lab) need.

mod banded;
#[cfg(test)]
mod tests;
mod unknowns;

use glam::DVec3;

use self::banded::BandedFactor;
use self::unknowns::Unknowns;
use crate::force::{Configuration, Sweep};
use crate::points::dot_in_lanes;
use crate::{Model, Points, PointsMut, State};

/// Largest force on a free particle at rest, relative to the largest force on a held one or of a load.
pub const EQUILIBRIUM_TOLERANCE: f64 = 1e-8;

/// Roundings of the largest coordinate times the stiffness of a particle that its force is known to.
const ROUNDINGS: f64 = 8.0;

/// Newton's steps at most.
const MOST_STEPS: usize = 200;

/// Conjugate gradients' steps from which on the factors that they start from are too old, and at most.
const OLD_FACTORS: usize = 12;
const MOST_PRODUCTS: usize = 80;

/// What conjugate gradients leave of a residual, at least and at most.
const SOLUTION_TOLERANCES: [f64; 2] = [1e-6, 1e-2];

/// How far along a step forces may point back, relative to how they pointed on at its start, and how often it is made shorter.
const MOST_OVERSHOOT: f64 = 0.1;
const MOST_TRIALS: usize = 12;

/// What is added at least to the diagonal of a tangent that is not positive definite, relative to the largest entry there, and by
/// what it grows: the more, the less of a step is along what gives way.
const LEAST_SHIFT: f64 = 1e-8;
const SHIFT_GROWTH: f64 = 4.0;

/// Way of a particle in one of Newton's steps at most, relative to the smaller spacing of the grid.
const LONGEST_WAY: f64 = 2.0;

/// Pinned particles that may move together along a direction, and the load that pulls them there.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Slide {
    /// The particles, all pinned.
    pub(crate) particles: Vec<usize>,
    /// Direction [1], of unit length.
    pub(crate) direction: DVec3,
    /// Load [N] on all of them together.
    pub(crate) load: f64,
}

/// How well a state is at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest {
    /// Largest force [N] on a particle that is free to follow it.
    pub residual: f64,
    /// Largest force [N] on a held particle, or of a load, to compare with.
    pub reference: f64,
    /// Force [N] that rounding of positions may give.
    pub rounding: f64,
    /// Newton's steps that it took.
    pub steps: usize,
}

impl Rest {
    /// The residual [N] at which a state counts as at rest: [`EQUILIBRIUM_TOLERANCE`] of the reference, or rounding.
    #[must_use]
    pub fn allowed(&self) -> f64 {
        EQUILIBRIUM_TOLERANCE * self.reference + self.rounding
    }

    /// Whether the residual is no more than that.
    #[must_use]
    pub fn is_reached(&self) -> bool {
        self.residual <= self.allowed()
    }
}

/// Finds states at rest of one model.
#[derive(Debug)]
pub(crate) struct StaticSolver {
    unknowns: Unknowns,
    /// Loads [N] on particles that may move, slides among them: dead ones, that keep their direction.
    pub(crate) loads: Points,
    /// Of the free particles' part of a tangent, that of this state or of an earlier one.
    factor: Option<BandedFactor>,
    forces: Points,
    /// Stiffness [N/m] of each slide against moving alone.
    slide_stiffnesses: Vec<f64>,
    /// What conjugate gradients leave of a residual.
    tolerance: f64,
    displacements: Points,
    products: Points,
}

impl StaticSolver {
    /// A solver for `model`, without loads.
    pub(crate) fn new(model: &Model) -> Self {
        let count = model.particles().len();
        let [loads, forces, displacements, products] = [(); 4].map(|()| Points::zeros(count));
        let unknowns = Unknowns::new(model);
        let slide_stiffnesses = Vec::new();
        let tolerance = SOLUTION_TOLERANCES[0];
        Self { unknowns, loads, factor: None, forces, slide_stiffnesses, tolerance, displacements, products }
    }

    /// Forces [N] on all particles where the last state was at rest, without loads: on those that are held, what they hold
    /// against.
    pub(crate) fn forces(&self) -> &Points {
        &self.forces
    }

    /// Moves the free particles and `slides` of `state` to rest from where they are, by
    ///
    /// ```text
    /// K d = F(x)    x ← x + d
    /// ```
    ///
    /// with the tangent K = −∂F/∂x. Steps are cut where a particle would go farther than two spacings. Where K is not
    /// positive definite, along the diagonal as much is added as makes it so, and steps go along forces.
    ///
    /// What forces remember stays as it is: whoever takes the state for the next of a test says so to them afterwards.
    ///
    /// # Errors
    /// How far from rest it is after 200 steps.
    pub(crate) fn settle(
        &mut self,
        model: &Model,
        state: &mut State,
        slides: &[Slide],
    ) -> Result<Rest, Rest> {
        let (mut residuals, mut way) = (Vec::new(), Vec::new());
        let mut start = Points::zeros(state.positions.len());
        eval_forces(model, state, &mut self.forces);
        for steps in 0.. {
            let rest = self.rest(model, state, slides, steps, &mut residuals);
            if rest.is_reached() {
                return Ok(rest);
            }
            if steps == MOST_STEPS || !rest.residual.is_finite() {
                return Err(rest);
            }
            // As well as it takes for the next state to be at rest, if the tangent stayed as it is.
            let needed = 0.1 * rest.allowed() / rest.residual;
            self.tolerance = needed.clamp(SOLUTION_TOLERANCES[0], SOLUTION_TOLERANCES[1]);
            self.solve(model, state, slides, &residuals, &mut way);
            self.unknowns.scatter(&way, slides, &mut self.displacements);
            let grid = model.cloths()[0].grid;
            let longest = self.displacements.iter().map(DVec3::length).fold(0.0, f64::max);
            let limit = LONGEST_WAY * grid.column_spacing.min(grid.row_spacing);
            let share = if limit < longest { limit / longest } else { 1.0 };
            start.clone_from(&state.positions);
            let power = dot_in_lanes(&residuals, &way);
            self.go(model, state, slides, (&start, &way), (share, power), &mut residuals);
        }
        unreachable!("the steps above end")
    }

    /// Moves `state` from `start` by a share of the displacements at hand, the unknowns' `way`, and evaluates forces there: by the
    /// `share` given, or less where forces have come to point back by then, as where friction holds again that had slipped.
    /// Forces had the `power` [J] along the way at the start.
    fn go(
        &mut self,
        model: &Model,
        state: &mut State,
        slides: &[Slide],
        (start, way): (&Points, &[f64]),
        (mut share, power): (f64, f64),
        residuals: &mut Vec<f64>,
    ) {
        for _ in 0..MOST_TRIALS {
            for particle in 0..start.len() {
                let place = start.get(particle) + self.displacements.get(particle) * share;
                state.positions.set(particle, place);
            }
            eval_forces(model, state, &mut self.forces);
            self.rest(model, state, slides, 0, residuals);
            let reached = dot_in_lanes(residuals, way);
            if -MOST_OVERSHOOT * power <= reached || reached.is_nan() {
                return;
            }
            // Between where they point on and where they point back.
            share *= (power / (power - reached)).max(0.1);
        }
    }

    /// How well `state` is at rest, and the `residuals` [N] of the unknowns.
    fn rest(
        &mut self,
        model: &Model,
        state: &State,
        slides: &[Slide],
        steps: usize,
        residuals: &mut Vec<f64>,
    ) -> Rest {
        let mut reference: f64 = 0.0;
        for particle in model.particles().pins() {
            reference = reference.max(self.forces.get(particle).length());
        }
        for (particle, load) in self.loads.iter().enumerate() {
            reference = reference.max(load.length());
            // Where there is none, nothing changes.
            self.products.set(particle, self.forces.get(particle) + load);
        }
        self.unknowns.gather(&self.products, slides, residuals);
        let free = self.unknowns.count();
        let mut residual = residuals[..free].iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        for (value, slide) in residuals[free..].iter_mut().zip(slides) {
            *value += slide.load;
            // Per particle, as the reference is.
            let count = slide.particles.len() as f64;
            residual = residual.max(value.abs() / count);
            reference = reference.max(slide.load.abs() / count);
        }
        if residuals.iter().any(|value| value.is_nan()) {
            residual = f64::NAN;
        }
        Rest { residual, reference, rounding: rounding(model, state), steps }
    }

    /// Overwrites `way` with a solution of K d = r, with `residuals` r.
    fn solve(
        &mut self,
        model: &Model,
        state: &State,
        slides: &[Slide],
        residuals: &[f64],
        way: &mut Vec<f64>,
    ) {
        self.eval_slide_stiffnesses(model, state, slides);
        if self.factor.is_some() {
            match self.descend(model, state, slides, residuals, way) {
                Some(products) if products <= OLD_FACTORS => return,
                // The next state starts from new factors.
                Some(_) => {
                    self.factor = None;
                    return;
                }
                None => {}
            }
        }
        let matrix = self.unknowns.matrix(|displacements, products| {
            eval_products(model, state, displacements, products);
        });
        let mut shift = 0.0;
        let factor = loop {
            if let Some(factor) = matrix.factor(shift) {
                break factor;
            }
            shift = if shift == 0.0 { LEAST_SHIFT * matrix.largest_diagonal() } else { SHIFT_GROWTH * shift };
        };
        self.factor = Some(factor);
        if shift == 0.0 && self.descend(model, state, slides, residuals, way).is_some() {
            return;
        }
        // Along forces, as stiff directions let it.
        self.precondition(residuals, way);
        self.factor = None;
    }

    /// Conjugate gradients for K d = r, from zero, with the factors at hand; the number of products it took, or `None` if K
    /// is not positive definite or it takes too many.
    fn descend(
        &mut self,
        model: &Model,
        state: &State,
        slides: &[Slide],
        residuals: &[f64],
        way: &mut Vec<f64>,
    ) -> Option<usize> {
        let mut rest = residuals.to_vec();
        way.clear();
        way.resize(rest.len(), 0.0);
        let mut smoothed = Vec::new();
        self.precondition(&rest, &mut smoothed);
        let mut direction = smoothed.clone();
        let mut product = Vec::new();
        let first = dot_in_lanes(&rest, &smoothed);
        let mut square = first;
        for count in 1..=MOST_PRODUCTS {
            self.product(model, state, slides, &direction, &mut product);
            let curvature = dot_in_lanes(&direction, &product);
            if curvature <= 0.0 || curvature.is_nan() {
                return None;
            }
            let length = square / curvature;
            way.iter_mut().zip(&direction).for_each(|(way, direction)| *way += length * direction);
            rest.iter_mut().zip(&product).for_each(|(rest, product)| *rest -= length * product);
            self.precondition(&rest, &mut smoothed);
            let next = dot_in_lanes(&rest, &smoothed);
            if next <= self.tolerance * self.tolerance * first {
                return Some(count);
            }
            let share = next / square;
            square = next;
            direction
                .iter_mut()
                .zip(&smoothed)
                .for_each(|(direction, smoothed)| *direction = smoothed + share * *direction);
        }
        None
    }

    /// Overwrites `product` with K d, with `direction` d.
    fn product(
        &mut self,
        model: &Model,
        state: &State,
        slides: &[Slide],
        direction: &[f64],
        product: &mut Vec<f64>,
    ) {
        self.unknowns.scatter(direction, slides, &mut self.displacements);
        eval_products(model, state, &self.displacements, &mut self.products);
        self.unknowns.gather(&self.products, slides, product);
    }

    /// Finds how stiff each slide is where all else keeps its place.
    fn eval_slide_stiffnesses(&mut self, model: &Model, state: &State, slides: &[Slide]) {
        self.slide_stiffnesses.clear();
        let mut product = Vec::new();
        for slide in 0..slides.len() {
            let place = self.unknowns.count() + slide;
            let mut unit = vec![0.0; self.unknowns.count() + slides.len()];
            unit[place] = 1.0;
            self.product(model, state, slides, &unit, &mut product);
            self.slide_stiffnesses.push(product[place]);
        }
    }

    /// Overwrites `smoothed` with the solution for the free particles alone, and for each slide alone.
    fn precondition(&self, residuals: &[f64], smoothed: &mut Vec<f64>) {
        smoothed.clear();
        smoothed.extend_from_slice(residuals);
        let (free, slides) = smoothed.split_at_mut(self.unknowns.count());
        if let Some(factor) = &self.factor {
            factor.solve(free);
        }
        slides.iter_mut().zip(&self.slide_stiffnesses).for_each(|(value, stiffness)| *value /= stiffness);
    }
}

/// Force [N] that a particle may have from rounding of its place.
fn rounding(model: &Model, state: &State) -> f64 {
    let positions = &state.positions;
    let extent = [&positions.x, &positions.y]
        .into_iter()
        .flatten()
        .fold(0.0, |largest: f64, value| largest.max(value.abs()));
    let mut stiffness: f64 = 0.0;
    let mut bounds = Vec::new();
    for block in model.blocks() {
        bounds.clear();
        bounds.resize(block.len(), 0.0);
        for force in model.forces() {
            force.add_stiffness_bounds(at(model, state), block, &mut bounds);
        }
        stiffness = bounds.iter().fold(stiffness, |largest, bound| largest.max(*bound));
    }
    ROUNDINGS * f64::EPSILON * extent * stiffness
}

fn at<'a>(model: &'a Model, state: &'a State) -> Configuration<'a> {
    Configuration {
        time: state.time,
        particles: model.particles(),
        positions: &state.positions,
        velocities: &state.velocities,
        memory: &state.memory,
    }
}

/// Overwrites `forces` [N] on all particles.
fn eval_forces(model: &Model, state: &State, forces: &mut Points) {
    let mut sweep = Sweep::default();
    forces.fill(0.0);
    for force in model.forces() {
        sweep.restart();
        for_each_block(model, forces, |block, own| {
            force.add_forces(at(model, state), block, own, &mut sweep);
        });
    }
}

/// Overwrites `products` K u [N] of all particles with the `displacements` u [m].
fn eval_products(model: &Model, state: &State, displacements: &Points, products: &mut Points) {
    products.fill(0.0);
    for force in model.forces() {
        for_each_block(model, products, |block, own| {
            force.add_tangent_products(at(model, state), displacements, block, own);
        });
    }
}

/// Calls `visit` with every block and its part of `points`.
fn for_each_block(
    model: &Model,
    points: &mut Points,
    mut visit: impl FnMut(&std::ops::Range<usize>, &mut PointsMut<'_>),
) {
    let mut rest = points.as_mut();
    for block in model.blocks() {
        let (mut own, others) = rest.split_at(block.len());
        visit(block, &mut own);
        rest = others;
    }
}
