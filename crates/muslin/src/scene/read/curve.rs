//! A table of tension against strain in a file that the scene names.

use super::data_file;
use super::value::Value;
use crate::scene::data::{self, CellError, Column, DataFile, DataFiles, DataTable};
use crate::scene::{SceneError, TensionCurve};

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

/// The curve in the file that `value` names.
pub(super) fn read(value: &Value, files: &mut DataFiles) -> Result<TensionCurve, SceneError> {
    data_file::read(value, files, parse)
}

fn parse(file: &DataFile) -> Result<TensionCurve, CellError> {
    let text = data::text(file.bytes())?;
    let table = DataTable::read(text, COLUMNS)?;
    if let [_] = table.rows() {
        let message = "has 1 point, but must have at least 2".to_owned();
        return Err(CellError::at(text, table.span(0, 0), message, "add the next measured point".to_owned()));
    }
    TensionCurve::new(table.rows()).map_err(|error| {
        let help = error.help.to_owned();
        CellError::at(text, table.span(error.point, error.coordinate), error.to_string(), help)
    })
}
