//! All instruments by name, and what each measures in one form.

use super::reading::{Column, Unit};
use super::{
    Along, LabError, Reading, Record, Resolution, bend, bias, cantilever, picture_frame, shear, tensile,
};
use crate::scene::MeasuredFabric;

/// A virtual instrument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instrument {
    /// [`tensile()`]
    Tensile,
    /// [`shear()`]
    Shear,
    /// [`bend()`]
    Bend,
    /// [`cantilever()`]
    Cantilever,
    /// [`bias()`]
    Bias,
    /// [`picture_frame()`]
    PictureFrame,
}

/// What an instrument measured.
#[derive(Debug)]
pub struct Measurement {
    /// What it went through, step by step: the first column is what the instrument sets, the others what it reads there.
    pub columns: Vec<Column>,
    /// What it says, beside what the fabric was given.
    pub readings: Vec<Reading>,
    /// The specimen's way, a frame for each step.
    pub record: Record,
}

impl Instrument {
    /// All instruments.
    pub const ALL: [Self; 6] =
        [Self::Tensile, Self::Shear, Self::Bend, Self::Cantilever, Self::Bias, Self::PictureFrame];

    /// Its name: "tensile".
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Tensile => "tensile",
            Self::Shear => "shear",
            Self::Bend => "bend",
            Self::Cantilever => "cantilever",
            Self::Bias => "bias",
            Self::PictureFrame => "picture-frame",
        }
    }

    /// What it is modelled on: "KES-FB1 tensile test".
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Tensile => "tensile test of KES-FB1",
            Self::Shear => "shear test of KES-FB1",
            Self::Bend => "bending test of KES-FB2",
            Self::Cantilever => "cantilever test of ASTM D1388",
            Self::Bias => "bias extension of FAST-3",
            Self::PictureFrame => "picture frame test",
        }
    }

    /// Whether its specimen is cut along warp or weft; others are at 45° to both, or along both.
    #[must_use]
    pub fn has_yarns(self) -> bool {
        !matches!(self, Self::Bias | Self::PictureFrame)
    }

    /// Measures `fabric` along given yarns, which do not matter to an instrument that [has none](Self::has_yarns).
    ///
    /// # Errors
    /// See [`LabError`].
    pub fn measure(
        self,
        fabric: &MeasuredFabric,
        along: Along,
        resolution: Resolution,
    ) -> Result<Measurement, LabError> {
        match self {
            Self::Tensile => {
                let test = tensile(fabric, along, resolution)?;
                let columns =
                    pair("strain", Unit::PERCENT, "tension", Unit::TENSION, &test.curve, &test.input);
                Ok(Measurement { columns, readings: test.readings, record: test.record })
            }
            Self::Shear => {
                let test = shear(fabric, along, resolution)?;
                let force = "shear force, middle half";
                let mut columns = pair("angle", Unit::ANGLE, force, Unit::TENSION, &test.curve, &test.input);
                columns.push(Column {
                    name: "shear force, whole width",
                    unit: Unit::TENSION,
                    values: test.whole,
                });
                Ok(Measurement { columns, readings: test.readings, record: test.record })
            }
            Self::Bend => {
                let test = bend(fabric, along, resolution)?;
                let columns =
                    pair("curvature", Unit::CURVATURE, "moment", Unit::MOMENT, &test.curve, &test.input);
                Ok(Measurement { columns, readings: test.readings, record: test.record })
            }
            Self::Cantilever => {
                let test = cantilever(fabric, along, resolution)?;
                let mut columns = pair("overhang", Unit::LENGTH, "angle", Unit::ANGLE, &test.curve, &[]);
                // No formula has the angle.
                columns.truncate(2);
                Ok(Measurement { columns, readings: test.readings, record: test.record })
            }
            Self::Bias => {
                let test = bias(fabric, resolution)?;
                let [strain, tension] =
                    [0, 1].map(|axis| test.curve.iter().map(|point| point[axis]).collect());
                let columns = vec![
                    Column { name: "strain", unit: Unit::PERCENT, values: strain },
                    Column { name: "tension", unit: Unit::TENSION, values: tension },
                ];
                Ok(Measurement { columns, readings: test.readings, record: test.record })
            }
            Self::PictureFrame => {
                let test = picture_frame(fabric, resolution)?;
                let unit = Unit::plain("N");
                let columns = pair("angle", Unit::ANGLE, "force", unit, &test.curve, &test.input);
                Ok(Measurement { columns, readings: test.readings, record: test.record })
            }
        }
    }
}

/// Columns of a `curve`: what was set, what was read, and what the fabric was given there.
fn pair(
    set: &'static str,
    set_unit: Unit,
    read: &'static str,
    unit: Unit,
    curve: &[[f64; 2]],
    input: &[f64],
) -> Vec<Column> {
    let of = |axis: usize| curve.iter().map(|point| point[axis]).collect();
    vec![
        Column { name: set, unit: set_unit, values: of(0) },
        Column { name: read, unit, values: of(1) },
        Column { name: "input", unit, values: input.to_vec() },
    ]
}
