//! The forces on a block that do not depend on velocities, and what is stiff about them.

use std::ops::Range;

use super::stability::larger;
use crate::force::{Configuration, Sweep};
use crate::{Model, PointsMut};

/// Overwrites `forces` [N] of a block with those that do not depend on velocities.
pub(super) fn eval_block(
    model: &Model,
    at: Configuration<'_>,
    block: &Range<usize>,
    mut forces: PointsMut<'_>,
    sweep: &mut Sweep,
) {
    let mut others = model.forces().iter().filter(|force| !force.depends_on_velocity());
    match others.next() {
        Some(force) => force.set_forces(at, block, &mut forces, sweep),
        None => forces.fill(0.0),
    }
    others.for_each(|force| force.add_forces(at, block, &mut forces, sweep));
}

/// The same, and the varying stiffness `bounds` [N/m].
pub(super) fn eval_block_and_bounds(
    model: &Model,
    at: Configuration<'_>,
    block: &Range<usize>,
    (mut forces, bounds): (PointsMut<'_>, &mut [f64]),
    sweep: &mut Sweep,
) {
    bounds.fill(0.0);
    let mut is_set = false;
    for force in model.forces() {
        if force.depends_on_velocity() {
            // Its force is added later, but what is stiff about it counts here.
            force.add_stiffness_bounds(at, block, bounds);
        } else if force.has_varying_bounds() {
            if !std::mem::replace(&mut is_set, true) {
                forces.fill(0.0);
            }
            force.add_forces_and_varying_bounds(at, block, &mut forces, bounds, sweep);
        } else if std::mem::replace(&mut is_set, true) {
            force.add_forces(at, block, &mut forces, sweep);
        } else {
            force.set_forces(at, block, &mut forces, sweep);
        }
    }
    if !is_set {
        forces.fill(0.0);
    }
}

/// The larger ones of rates by norms and by blocks.
pub(super) fn larger_rates(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [larger(a[0], b[0]), larger(a[1], b[1])]
}
