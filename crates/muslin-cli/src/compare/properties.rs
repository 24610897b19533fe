//! What fabrics have by themselves, on no instrument.

use muslin::lab::{Along, Unit};
use muslin::scene::{BendingFriction, MeasuredFabric, MembraneTension};

use super::table::{Row, Value};
use crate::lab::NamedFabric;

const AREAL_DENSITY: Unit = Unit { si: "kg/m²", symbol: "g/m²", size: 1e-3 };
const MODULUS: Unit = Unit::plain("N/m");
const RIGIDITY: Unit = Unit { si: "N m", symbol: "µN m", size: 1e-6 };
const TIME: Unit = Unit { si: "s", symbol: "ms", size: 1e-3 };

/// A quantity of a fabric.
struct Property {
    along: Option<Along>,
    name: &'static str,
    what: &'static str,
    unit: Unit,
    value: Value,
}

/// The quantities of both fabrics, without those that neither has.
pub(super) fn rows(fabrics: &[NamedFabric; 2]) -> Vec<Row> {
    let [first, second] = [0, 1].map(|fabric| properties(&fabrics[fabric].fabric));
    let rows = first.into_iter().zip(second).map(|(first, second)| {
        let Property { along, name, what, unit, value } = first;
        Row { along, name, what, unit, values: [value, second.value] }
    });
    rows.filter(|row| row.values.iter().any(|value| value.number().is_some())).collect()
}

/// All quantities of `fabric`, always the same in the same order.
fn properties(fabric: &MeasuredFabric) -> Vec<Property> {
    let property = |name, what, unit, value| Property { along: None, name, what, unit, value };
    let bending = fabric.bending;
    let damping = fabric.damping;
    let time = |what, time| property("τ", what, TIME, Value::positive(time, "no damping"));
    let mut all = vec![
        property("ρ", "areal density", AREAL_DENSITY, Value::Number(fabric.areal_density)),
        property("k_d", "drag per area", Unit::plain("kg/(s m²)"), Value::positive(fabric.drag, "no drag")),
    ];
    for along in Along::ALL {
        all.extend(along_yarns(fabric, along).map(|property| Property { along: Some(along), ..property }));
    }
    all.extend([
        property(
            "G",
            "shear modulus per radian",
            MODULUS,
            Value::positive(fabric.shear_modulus, "no resistance to shear"),
        ),
        property(
            "B",
            "bending rigidity at 45°",
            RIGIDITY,
            Value::positive(bending.bias(), "no bending rigidity"),
        ),
        time("damping time along the warp", damping.warp),
        time("damping time along the weft", damping.weft),
        time("damping time in shear", damping.shear),
        time("damping time in bending", damping.bend),
    ]);
    all
}

/// What `fabric` has along given yarns.
fn along_yarns(fabric: &MeasuredFabric, along: Along) -> [Property; 5] {
    let (tension, rigidity, friction): (&MembraneTension, f64, Option<BendingFriction>) = match along {
        Along::Warp => (&fabric.warp, fabric.bending.warp, fabric.friction.warp_bend),
        Along::Weft => (&fabric.weft, fabric.bending.weft, fabric.friction.weft_bend),
    };
    let [warp, weft] = fabric.bending.bending_lengths(fabric.areal_density);
    let length = if along == Along::Warp { warp } else { weft };
    let greatest =
        tension.asymptote().map_or_else(|| Value::Lacking("no such strain".to_owned()), Value::Number);
    let held = friction.filter(|_| 0.0 < rigidity).map_or(0.0, |friction| friction.moment / rigidity);
    let property = |name, what, unit, value| Property { along: None, name, what, unit, value };
    let of_rigidity = |number| Value::positive(number, "no bending rigidity");
    [
        property("K", "tensile modulus at rest", MODULUS, Value::Number(tension.slope(0.0))),
        property("e", "strain that no tension reaches", Unit::PERCENT, greatest),
        property("B", "bending rigidity", RIGIDITY, of_rigidity(rigidity)),
        property("c", "bending length, (B / ρ g)^(1/3)", Unit::LENGTH, of_rigidity(length)),
        property(
            "κ",
            "curvature that friction holds, 2HB / 2B",
            Unit::plain("1/m"),
            Value::positive(held, "no friction"),
        ),
    ]
}
