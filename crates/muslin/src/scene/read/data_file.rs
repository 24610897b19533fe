//! Files that a value of the scene names.

use super::value::Value;
use crate::scene::data::{CellError, DataFile, DataFiles, LoadError};
use crate::scene::error::{SceneErrorKind, quoted};
use crate::scene::{MAX_DATA_BYTES, SceneError};

/// What `parse` makes of the file that `value` names.
pub(super) fn read<T>(
    value: &Value,
    files: &mut DataFiles,
    parse: impl FnOnce(&DataFile) -> Result<T, CellError>,
) -> Result<T, SceneError> {
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
