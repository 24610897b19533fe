//! Tables that instruments write: their columns and units.

use std::f64::consts::PI;

use muslin::scene::{Column, units};

use crate::label::Test;

/// What a table holds, which its columns tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Tension against strain.
    Tensile,
    /// EMT and LT of KES at a force.
    KesTensile,
    /// Force along the edge against the angle.
    Shear,
    /// G of KES.
    ShearModulus,
    /// Moment against curvature.
    Bend,
    /// B of KES.
    Rigidity,
    /// Overhang against the angle of the chord.
    Cantilever,
    /// Bending length.
    BendingLength,
}

const METRES: &[(&str, f64)] = &[("mm", 1000.0), ("cm", 100.0), ("m", 1.0)];

const ANGLES: &[(&str, f64)] = &[("deg", 180.0 / PI), ("rad", 1.0)];

const PER_WIDTH: &[(&str, f64)] =
    &[("gf/cm", 1.0 / units::GRAM_FORCE_PER_CM), ("N/m", 1.0), ("N/cm", 0.01), ("N/mm", 0.001)];

const FRACTIONS: &[(&str, f64)] = &[("%", 100.0), ("1", 1.0)];

pub(crate) const TENSILE: [Column; 2] = [
    Column { name: "strain", units: FRACTIONS, hint: "strain is the extension by the length at rest" },
    Column { name: "tension", units: PER_WIDTH, hint: "tension is the force by the width of the specimen" },
];

pub(crate) const KES_TENSILE: [Column; 3] = [
    Column { name: "emt", units: FRACTIONS, hint: "EMT is the strain at the greatest force" },
    Column {
        name: "lt",
        units: &[("1", 1.0)],
        hint: "LT is the work by that of a linear fabric, a number such as 0.55",
    },
    Column {
        name: "force",
        units: PER_WIDTH,
        hint: "the greatest force by the width of the specimen; 500 gf/cm in the standard test of KES",
    },
];

pub(crate) const SHEAR: [Column; 2] = [
    Column { name: "angle", units: ANGLES, hint: "the angle of shear is 0 at rest" },
    Column { name: "force", units: PER_WIDTH, hint: "the force along the edge by the length of that edge" },
];

pub(crate) const SHEAR_MODULUS: [Column; 1] = [Column {
    name: "g",
    units: &[("gf/(cm deg)", PI / 180.0 / units::GRAM_FORCE_PER_CM), ("N/m", 1.0)],
    hint: "G is the slope of force by width against the angle; N/m are meant per radian",
}];

pub(crate) const BEND: [Column; 2] = [
    Column {
        name: "curvature",
        units: &[("1/cm", 0.01), ("1/m", 1.0), ("1/mm", 0.001)],
        hint: "curvature is one by the radius",
    },
    Column {
        name: "moment",
        units: &[
            ("gf cm/cm", 1000.0 / units::STANDARD_GRAVITY),
            ("N", 1.0),
            ("mN", 1000.0),
            ("N mm/mm", 1.0),
        ],
        hint: "the moment by the width of the specimen; N m per m are N",
    },
];

pub(crate) const RIGIDITY: [Column; 1] = [Column {
    name: "b",
    units: &[("gf cm^2/cm", 1.0 / units::GRAM_FORCE_CM2_PER_CM), ("N m", 1.0), ("uN m", 1e6)],
    hint: "B is the moment by the width and the curvature",
}];

pub(crate) const CANTILEVER: [Column; 2] = [
    Column { name: "overhang", units: METRES, hint: "overhang is the length of the strip beyond the edge" },
    Column {
        name: "angle",
        units: ANGLES,
        hint: "the angle below the horizontal of the line from the edge to the tip",
    },
];

pub(crate) const BENDING_LENGTH: [Column; 1] = [Column {
    name: "bending_length",
    units: METRES,
    hint: "half of the overhang at which the tip hangs 41.5 degrees below the edge",
}];

impl Kind {
    /// Names of columns with the kinds that they tell, the more telling first.
    const BY_COLUMN: [(&'static str, Self); 12] = [
        ("strain", Self::Tensile),
        ("overhang", Self::Cantilever),
        ("angle", Self::Shear),
        ("curvature", Self::Bend),
        ("bending_length", Self::BendingLength),
        ("emt", Self::KesTensile),
        ("lt", Self::KesTensile),
        ("g", Self::ShearModulus),
        ("b", Self::Rigidity),
        ("tension", Self::Tensile),
        ("moment", Self::Bend),
        ("force", Self::Shear),
    ];

    /// The kind of a table with columns of these names.
    pub(crate) fn of_columns(names: &[&str]) -> Option<Self> {
        let known = |(name, kind): (&str, Self)| names.contains(&name).then_some(kind);
        Self::BY_COLUMN.into_iter().find_map(known)
    }

    /// The test that gives it.
    #[must_use]
    pub fn test(self) -> Test {
        match self {
            Self::Tensile | Self::KesTensile => Test::Tensile,
            Self::Shear | Self::ShearModulus => Test::Shear,
            Self::Bend | Self::Rigidity => Test::Bend,
            Self::Cantilever | Self::BendingLength => Test::Cantilever,
        }
    }

    /// What it is, for a message.
    pub(crate) fn title(self) -> &'static str {
        match self.test() {
            Test::Tensile => "a tensile test",
            Test::Shear => "a shear test",
            Test::Bend => "a bending test",
            Test::Cantilever => "a cantilever test",
        }
    }

    /// A header of the curve that `test` measures.
    pub(crate) fn header_for(self, test: Test) -> &'static str {
        match test {
            Test::Tensile => "strain [%],tension [gf/cm]",
            Test::Shear => "angle [deg],force [gf/cm]",
            Test::Bend => "curvature [1/cm],moment [gf cm/cm]",
            Test::Cantilever => "overhang [mm],angle [deg]",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: 1 gf cm/cm is the weight of a gram; 1 gf/(cm deg) is 56.188 N/m; 1 gf cm²/cm is 98.0665 µN m.
    #[test]
    fn units_are_exact() {
        let close = |parts: f64, si: f64| assert!((parts * si - 1.0).abs() < 1e-12, "{parts} by {si}");
        let unit = |column: &Column, name: &str| {
            column.units.iter().find(|(unit, _)| *unit == name).map_or(f64::NAN, |(_, parts)| *parts)
        };
        close(unit(&BEND[1], "gf cm/cm"), 9.806_65e-3);
        close(unit(&TENSILE[1], "gf/cm"), 0.980_665);
        close(unit(&SHEAR_MODULUS[0], "gf/(cm deg)"), 0.980_665 * 180.0 / PI);
        close(unit(&RIGIDITY[0], "gf cm^2/cm"), 9.806_65e-5);
        close(unit(&BEND[0], "1/cm"), 100.0);
        close(unit(&TENSILE[1], "N/mm"), 1000.0);
    }

    #[test]
    fn columns_tell_the_kind_in_any_order() {
        assert_eq!(Kind::of_columns(&["force", "angle"]), Some(Kind::Shear));
        assert_eq!(Kind::of_columns(&["angle", "overhang"]), Some(Kind::Cantilever));
        assert_eq!(Kind::of_columns(&["force", "lt", "emt"]), Some(Kind::KesTensile));
        assert_eq!(Kind::of_columns(&["time", "tension"]), Some(Kind::Tensile));
        assert_eq!(Kind::of_columns(&["1.0", "2.0"]), None);
    }
}
