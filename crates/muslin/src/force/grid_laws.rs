//! Which springs a fabric gives a grid.

use super::Family;
use super::law::{BucklingLaw, LinearLaw, ReducedLaw, SpringLaw, TangentLaw};
use crate::model::Grid;
use crate::scene::{BendingModel, ForceDirection, MeasuredFabric, MembraneTension, SpringsFabric};

/// The springs of a grid, in the order in which their forces are added up.
#[derive(Clone, Debug, PartialEq)]
pub struct GridLaws {
    /// What a spring's vector is divided by to give its force a direction.
    pub direction: ForceDirection,
    /// Springs of the same law, those of a family after each other.
    pub groups: Vec<SpringGroup>,
}

/// Springs of one law.
#[derive(Clone, Debug, PartialEq)]
pub struct SpringGroup {
    /// Their family.
    pub family: Family,
    /// Their law.
    pub law: SpringLaw,
    /// Columns and rows to the neighbours that a particle has such springs to: both ends of a spring.
    pub neighbours: Vec<(isize, isize)>,
    /// Which of them there are.
    pub lines: Lines,
}

/// Which lines of a grid springs lie in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lines {
    /// All rows and columns.
    All,
    /// All but the first and the last: springs along columns in inner rows, springs along rows in inner columns.
    Inner,
    /// The first and the last alone.
    Edges,
}

impl GridLaws {
    /// The springs of a fabric of kind `"springs"`: the same everywhere. A family without stiffness has none.
    #[must_use]
    pub fn of_springs(fabric: &SpringsFabric) -> Self {
        let families = [
            (Family::Structural, &fabric.structural, [(-1, 0), (1, 0), (0, -1), (0, 1)]),
            (Family::Shear, &fabric.shear, DIAGONALS),
            (Family::Bend, &fabric.bend, [(-2, 0), (2, 0), (0, -2), (0, 2)]),
        ];
        let groups = families.into_iter().filter(|(_, settings, _)| settings.has_springs());
        let groups = groups.map(|(family, settings, neighbours)| SpringGroup {
            family,
            law: SpringLaw::new(settings),
            neighbours: neighbours.to_vec(),
            lines: Lines::All,
        });
        Self { direction: fabric.force_direction, groups: groups.collect() }
    }

    /// The springs of a fabric of kind `"measured"` on `grid`, which has at least two columns and rows; see
    /// [`MeasuredFabric`] for their laws.
    #[must_use]
    pub fn of_measured(fabric: &MeasuredFabric, grid: &Grid) -> Self {
        let spacings @ [hx, hy] = [grid.column_spacing, grid.row_spacing];
        let [share_x, share_y] = fabric.shear_springs_share(spacings);
        let [weft, warp] = fabric.elastic_tensions();
        let mut groups = Vec::new();
        for (tension, share, width, length, neighbours) in
            [(&weft, share_x, hy, hx, [(-1, 0), (1, 0)]), (&warp, share_y, hx, hy, [(0, -1), (0, 1)])]
        {
            for (lines, width) in [(Lines::Inner, width), (Lines::Edges, 0.5 * width)] {
                let law = structural_law(tension, share, width, length);
                let neighbours = neighbours.to_vec();
                groups.push(SpringGroup { family: Family::Structural, law, neighbours, lines });
            }
        }
        let modulus = fabric.elastic_shear_modulus();
        if 0.0 < modulus {
            let stiffness = modulus * (hx * hx + hy * hy) / (2.0 * hx * hy);
            groups.push(SpringGroup {
                family: Family::Shear,
                law: SpringLaw::Linear(LinearLaw { stiffness }),
                neighbours: DIAGONALS.to_vec(),
                lines: Lines::All,
            });
        }
        if fabric.bending_model == BendingModel::ChoiKo {
            groups.extend(bending_links(fabric, grid));
        }
        Self { direction: ForceDirection::CurrentLength, groups }
    }
}

/// Links to the next particle but one, with the rigidity of `fabric` and where they are hardly bent the stiffness of the two
/// springs that they span.
fn bending_links(fabric: &MeasuredFabric, grid: &Grid) -> impl Iterator<Item = SpringGroup> + use<> {
    let [hx, hy] = [grid.column_spacing, grid.row_spacing];
    let sides = [
        (fabric.bending.weft, fabric.weft.least_modulus(), hy, hx, [(-2, 0), (2, 0)]),
        (fabric.bending.warp, fabric.warp.least_modulus(), hx, hy, [(0, -2), (0, 2)]),
    ];
    let lines = sides.into_iter().filter(|(rigidity, ..)| 0.0 < *rigidity).flat_map(|side| {
        let (_, _, width, ..) = side;
        [(Lines::Inner, width, side), (Lines::Edges, 0.5 * width, side)]
    });
    lines.map(|(lines, width, (rigidity, modulus, _, length, neighbours))| {
        let stiffness = 0.5 * modulus * width / length;
        let law = SpringLaw::Buckling(BucklingLaw::new(rigidity * width, stiffness, 2.0 * length));
        SpringGroup { family: Family::Bend, law, neighbours: neighbours.to_vec(), lines }
    })
}

const DIAGONALS: [(isize, isize); 4] = [(-1, -1), (1, -1), (-1, 1), (1, 1)];

/// The law of springs of `length` [m] that stand for a `width` [m] of a membrane, of whose `tension` shear springs carry
/// the `share` [N/m] per strain.
pub(super) fn structural_law(tension: &MembraneTension, share: f64, width: f64, length: f64) -> SpringLaw {
    // Tension per strain and width is stiffness times length by width.
    let stiffness = |modulus: f64| modulus * width / length;
    match tension {
        MembraneTension::Linear { modulus } => {
            SpringLaw::Linear(LinearLaw { stiffness: stiffness(modulus - share) })
        }
        MembraneTension::Tangent { modulus, strain_scale } => SpringLaw::ReducedTangent(ReducedLaw {
            whole: TangentLaw::with_initial_stiffness(stiffness(*modulus), *strain_scale),
            carried: stiffness(share),
        }),
        MembraneTension::Curve(curve) => SpringLaw::curve(&curve.reduced(share, width)),
    }
}
