//! A table of tension against strain in a file that the scene names.

use super::data_file;
use super::value::Value;
use crate::scene::data::{self, CellError, Column, DataFile, DataFiles, DataTable};
use crate::scene::measured::units::GRAM_FORCE_PER_CM;
use crate::scene::{SceneError, TensionCurve, TensionCurveError};

const COLUMNS: [Column; 2] = [
    Column {
        name: "strain",
        units: &[("1", 1.0), ("%", 100.0)],
        hint: "strain is the extension by the length at rest",
    },
    Column {
        name: "tension",
        units: &[("N", 1.0)],
        hint: "a spring has the tension per width times the width it stands for, the spacing of the grid",
    },
];

/// Units of tension per width, each with how many of it are one N/m.
const PER_WIDTH: Column = Column {
    name: "tension",
    units: &[("N/m", 1.0), ("N/cm", 0.01), ("gf/cm", 1.0 / GRAM_FORCE_PER_CM)],
    hint: "tension is the force by the width of the specimen",
};

/// The curve of a spring in the file that `value` names.
pub(super) fn read(value: &Value, files: &mut DataFiles) -> Result<TensionCurve, SceneError> {
    data_file::read(value, files, |file| parse(file, COLUMNS, TensionCurve::new))
}

/// The curve of a fabric, per width, in the file that `value` names.
pub(super) fn read_per_width(value: &Value, files: &mut DataFiles) -> Result<TensionCurve, SceneError> {
    let [strain, _] = COLUMNS;
    data_file::read(value, files, |file| parse(file, [strain, PER_WIDTH], TensionCurve::per_width))
}

fn parse(
    file: &DataFile,
    columns: [Column; 2],
    curve: fn(&[[f64; 2]]) -> Result<TensionCurve, TensionCurveError>,
) -> Result<TensionCurve, CellError> {
    let text = data::text(file.bytes())?;
    let table = DataTable::read(text, columns)?;
    if let [_] = table.rows() {
        let message = "has 1 point, but must have at least 2".to_owned();
        return Err(CellError::at(text, table.span(0, 0), message, "add the next measured point".to_owned()));
    }
    curve(table.rows()).map_err(|error| {
        let help = error.help.to_owned();
        CellError::at(text, table.span(error.point, error.coordinate), error.to_string(), help)
    })
}
