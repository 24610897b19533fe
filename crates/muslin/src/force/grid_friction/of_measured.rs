//! What the internal friction of a measured fabric becomes on a grid.

use super::GridFriction;
use super::limit::FrictionLimit;
use crate::InstructionSet;
use crate::force::Family;
use crate::force::elements::{Coordinate, GridElements, Line};
use crate::force::grid_laws::structural_law;
use crate::model::Grid;
use crate::scene::MeasuredFabric;

impl GridFriction {
    /// The friction of `fabric` on `grid`, which has at least two columns and rows; each of a cloth's has a layer of memory of its own.
    ///
    /// Per element with cells h_x × h_y, of which those along edges have half:
    ///
    /// ```text
    /// shear        q = sin γ      k = h_x h_y k_γ        Y = h_x h_y (Y₀ + c |sin γ|)
    /// weft         q = ℓ − h_x    k = k_T h_y / h_x      Y = μ h_y T_el
    /// weft, bent   q = κ h_x²     k = B_f h_y / h_x³     Y = M h_y / h_x
    /// ```
    ///
    /// and the same along the warp. In bending a force f along q is the moment f h_x, and f dq the work M dκ of h_x h_y.
    #[must_use]
    pub fn of_measured(fabric: &MeasuredFabric, grid: Grid, instructions: InstructionSet) -> Vec<Self> {
        let [hx, hy] = [grid.column_spacing, grid.row_spacing];
        let friction = &fabric.friction;
        let mut all = Vec::new();
        let mut push = |coordinate, stiffness, limit, family| {
            let elements = GridElements { grid, coordinate, has_half_edges: coordinate != Coordinate::Shear };
            let layer = all.len();
            let compliance = 1.0 / stiffness;
            all.push(Self { elements, stiffness, compliance, limit, layer, family, instructions });
        };
        if let Some(shear) = friction.shear {
            let area = hx * hy;
            let limit = FrictionLimit::Affine { at_rest: area * shear.at_rest, growth: area * shear.growth };
            push(Coordinate::Shear, area * shear.stiffness, limit, Family::Shear);
        }
        let [weft, warp] = fabric.elastic_tensions();
        for (friction, tension, columns, rows, width, rest_length) in
            [(friction.weft, weft, 1, 0, hy, hx), (friction.warp, warp, 0, 1, hx, hy)]
        {
            if let Some(friction) = friction {
                let law = structural_law(&tension, 0.0, width, rest_length);
                let limit = FrictionLimit::Tension { law, ratio: friction.ratio, rest_length };
                let stiffness = friction.stiffness * width / rest_length;
                push(
                    Coordinate::Extension { columns, rows, rest_length },
                    stiffness,
                    limit,
                    Family::Structural,
                );
            }
        }
        for (friction, line, width, spacing) in
            [(friction.weft_bend, Line::Weft, hy, hx), (friction.warp_bend, Line::Warp, hx, hy)]
        {
            if let Some(friction) = friction {
                let limit = FrictionLimit::Affine { at_rest: friction.moment * width / spacing, growth: 0.0 };
                let stiffness = friction.rigidity * width / (spacing * spacing * spacing);
                push(Coordinate::Bend(line), stiffness, limit, Family::Bend);
            }
        }
        all
    }
}
