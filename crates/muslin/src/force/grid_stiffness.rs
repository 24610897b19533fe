//! The stiffness tensors of a grid's springs.

use std::ops::Range;

use super::Configuration;
use super::grid_springs::{GridSprings, SpringRow, columns};
use super::law::{LawVisitor, TensionLaw};
use super::spring::{Spring, SpringLength};
use super::stiffness_tensors::StiffnessTensorsMut;
use crate::instructions::Vectorise;
use crate::scene::ForceDirection;

/// Adds the stiffness tensors of the `springs` on a `block`.
pub(super) struct AddGridTensors<'a, 'b> {
    pub(super) springs: &'a GridSprings,
    pub(super) at: Configuration<'a>,
    pub(super) block: &'a Range<usize>,
    pub(super) tensors: &'a mut StiffnessTensorsMut<'b>,
}

impl Vectorise for AddGridTensors<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { springs, at, block, tensors } = self;
        let Some(rows) = springs.grid.block_rows(block) else { return };
        // Loops of its own, since a closure of theirs would not be compiled for the same instructions.
        for group in &springs.families {
            for row in rows.clone() {
                for neighbour in &group.neighbours {
                    for pair in neighbour.row_pairs(&springs.grid, row, group.lines) {
                        let row = group.row(at, &pair, block.start, neighbour);
                        group.law.visit(AddTensors { row, tensors: &mut *tensors });
                    }
                }
            }
        }
    }
}

/// Adds the stiffness tensors w (k_a⁺ n nᵀ + c⁺ (1 − n nᵀ)) of a row of springs.
///
/// Where both ends coincide there is no direction n, and the larger stiffness counts in all of them.
struct AddTensors<'a, 'b, 'c> {
    row: SpringRow<'a>,
    tensors: &'b mut StiffnessTensorsMut<'c>,
}

impl LawVisitor for AddTensors<'_, '_, '_> {
    #[inline(always)]
    fn visit<L: TensionLaw>(self, law: L) {
        let Self { row, tensors } = self;
        let [x, y, z] = row.positions(&row.pair.own);
        let [other_x, other_y, other_z] = row.positions(&row.pair.other);
        let StiffnessTensorsMut { diagonal, off_diagonal } = tensors;
        let target = row.target();
        add_row(
            &row.spring(law),
            (x, y, z),
            (other_x, other_y, other_z),
            &row.at.particles.pinned()[row.pair.other.clone()],
            (
                &mut diagonal.x[target.clone()],
                &mut diagonal.y[target.clone()],
                &mut diagonal.z[target.clone()],
            ),
            (
                &mut off_diagonal.x[target.clone()],
                &mut off_diagonal.y[target.clone()],
                &mut off_diagonal.z[target],
            ),
        );
    }
}

/// Adds the tensors of springs from own to other positions [m], of which the others are `pinned` or not.
#[inline(always)]
fn add_row<L: TensionLaw>(
    spring: &Spring<L>,
    (x, y, z): (&[f64], &[f64], &[f64]),
    (other_x, other_y, other_z): (&[f64], &[f64], &[f64]),
    pinned: &[bool],
    (xx, yy, zz): (&mut [f64], &mut [f64], &mut [f64]),
    (yz, xz, xy): (&mut [f64], &mut [f64], &mut [f64]),
) {
    let count = x.len();
    let (y, z, pinned) = (&y[..count], &z[..count], &pinned[..count]);
    let (other_x, other_y, other_z) = (&other_x[..count], &other_y[..count], &other_z[..count]);
    let (xx, yy, zz) = (&mut xx[..count], &mut yy[..count], &mut zz[..count]);
    let (yz, xz, xy) = (&mut yz[..count], &mut xz[..count], &mut xy[..count]);
    for i in 0..count {
        let [dx, dy, dz] = [other_x[i] - x[i], other_y[i] - y[i], other_z[i] - z[i]];
        let length = SpringLength::from_squared(dx * dx + dy * dy + dz * dz);
        let [along, across] = stiffnesses(spring, length);
        let weight = columns(pinned[i]);
        let everywhere = weight * across;
        let excess = weight * (along - across) * length.inverse * length.inverse;
        xx[i] += everywhere + excess * dx * dx;
        yy[i] += everywhere + excess * dy * dy;
        zz[i] += everywhere + excess * dz * dz;
        yz[i] += excess * dy * dz;
        xz[i] += excess * dx * dz;
        xy[i] += excess * dx * dy;
    }
}

/// Stiffnesses [N/m] along and across a spring, zero where negative.
#[inline(always)]
fn stiffnesses<L: TensionLaw>(spring: &Spring<L>, at: SpringLength) -> [f64; 2] {
    let rest_length = spring.rest_length;
    let (tension, tangent) = spring.law.tension_and_tangent(at.length - rest_length, rest_length);
    let [along, across] = match spring.direction {
        ForceDirection::CurrentLength => [tangent, tension * at.inverse],
        ForceDirection::RestLength => {
            [(tangent * at.length + tension) * (1.0 / rest_length), tension * (1.0 / rest_length)]
        }
    };
    // Comparisons in place of `max`, which would pass over what is not a number.
    let [along, across] = [along, across].map(|stiffness| if stiffness < 0.0 { 0.0 } else { stiffness });
    let larger = if along < across { across } else { along };
    [along, if at.inverse == 0.0 { larger } else { across }]
}
