//! A table of tension against strain in a file that the scene names.

use super::value::Value;
use crate::scene::data::{self, CellError, Column, DataFile, DataFiles, DataTable, LoadError};
use crate::scene::error::{SceneErrorKind, quoted};
use crate::scene::{MAX_DATA_BYTES, SceneError, TensionCurve};

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
    let file = load(value, files)?;
    parse(file).map_err(|CellError { position, line, message, help }| {
        value.error(SceneErrorKind::Data { file: file.name().to_owned(), position, line, message, help })
    })
}

/// The file that `value` names.
fn load<'f>(value: &Value, files: &'f mut DataFiles) -> Result<&'f DataFile, SceneError> {
    let name = value.string()?;
    files.load(name).map_err(|error| {
        const MOVED: &str = "put the file beside the scene file: a scene is moved with its files";
        let (reason, help) = match error {
            LoadError::Name(rule) => {
                return value.out_of_range(
                    "",
                    rule,
                    "put the file beside the scene file, or into a folder there",
                );
            }
            LoadError::NoLoader => {
                ("this scene is read from its text alone".to_owned(), "give the files to `Scene::parse_with`")
            }
            LoadError::TooLong => (
                format!("it is longer than {} MiB", MAX_DATA_BYTES >> 20),
                "thin it out: some dozens of points tell as much",
            ),
            LoadError::Reason(reason) => (reason, MOVED),
        };
        let (key, file) = (value.path.clone(), quoted(name));
        value.error(SceneErrorKind::UnreadableFile { key, file, reason, help })
    })
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
