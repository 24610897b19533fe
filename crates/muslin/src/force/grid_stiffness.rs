//! The stiffness tensors of a grid's springs.

use super::grid_springs::{SpringRow, columns};
use super::law::{LawVisitor, TensionLaw};
use super::spring::Spring;
use super::stiffness_tensors::StiffnessTensorsMut;
use crate::scene::ForceDirection;

/// Adds the stiffness tensors w (k_a⁺ n nᵀ + c⁺ (1 − n nᵀ)) of a row of springs.
///
/// Where both ends coincide there is no direction n, and the larger stiffness counts in all of them.
pub(super) struct AddTensors<'a, 'b> {
    pub(super) row: SpringRow<'a>,
    pub(super) tensors: &'a mut StiffnessTensorsMut<'b>,
}

impl LawVisitor for AddTensors<'_, '_> {
    fn visit<L: TensionLaw>(self, law: L) {
        let Self { row, tensors } = self;
        let spring = row.spring(law);
        let (count, target) = (row.pair.own.len(), row.target());
        let [x, y, z] = row.positions(&row.pair.own).map(|values| &values[..count]);
        let [other_x, other_y, other_z] = row.positions(&row.pair.other).map(|values| &values[..count]);
        let pinned = &row.at.particles.pinned()[row.pair.other.clone()][..count];
        let StiffnessTensorsMut { diagonal, off_diagonal } = tensors;
        let xx = &mut diagonal.x[target.clone()][..count];
        let yy = &mut diagonal.y[target.clone()][..count];
        let zz = &mut diagonal.z[target.clone()][..count];
        let yz = &mut off_diagonal.x[target.clone()][..count];
        let xz = &mut off_diagonal.y[target.clone()][..count];
        let xy = &mut off_diagonal.z[target][..count];
        for i in 0..count {
            let [dx, dy, dz] = [other_x[i] - x[i], other_y[i] - y[i], other_z[i] - z[i]];
            let length_squared = dx * dx + dy * dy + dz * dz;
            let [along, across] = stiffnesses(&spring, length_squared.sqrt());
            let weight = columns(pinned[i]);
            let everywhere = weight * across;
            let excess = weight * (along - across) / if length_squared == 0.0 { 1.0 } else { length_squared };
            xx[i] += everywhere + excess * dx * dx;
            yy[i] += everywhere + excess * dy * dy;
            zz[i] += everywhere + excess * dz * dz;
            yz[i] += excess * dy * dz;
            xz[i] += excess * dx * dz;
            xy[i] += excess * dx * dy;
        }
    }
}

/// Stiffnesses [N/m] along and across a spring of `length` [m], zero where negative.
#[inline(always)]
fn stiffnesses<L: TensionLaw>(spring: &Spring<L>, length: f64) -> [f64; 2] {
    let rest_length = spring.rest_length;
    let (tension, tangent) = spring.law.tension_and_tangent(length - rest_length, rest_length);
    let [along, across] = match spring.direction {
        ForceDirection::CurrentLength => [tangent, if length == 0.0 { 0.0 } else { tension / length }],
        ForceDirection::RestLength => [(tangent * length + tension) / rest_length, tension / rest_length],
    };
    // Comparisons in place of `max`, which would pass over what is not a number.
    let [along, across] = [along, across].map(|stiffness| if stiffness < 0.0 { 0.0 } else { stiffness });
    if length == 0.0 {
        [along; 2].map(|along| if along < across { across } else { along })
    } else {
        [along, across]
    }
}
