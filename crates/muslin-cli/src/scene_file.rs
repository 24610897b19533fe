//! Reading scene files.

use std::fs;
use std::io::{self, Read};
use std::path::Path;

use muslin::Scene;
use muslin::scene::{MAX_SCENE_BYTES, set_value};

use crate::error::CliError;
use crate::memory::require_memory;

/// A scene and the text that it was read from, after the changes of the command line.
pub(crate) struct SceneFile {
    pub(crate) scene: Scene,
    pub(crate) text: String,
    /// Whether the command line changed it.
    pub(crate) is_changed: bool,
}

impl SceneFile {
    /// Reads the scene at `path` and makes the changes `assignments` (`key=value`). It fits this machine's memory.
    pub(crate) fn read(path: &Path, assignments: &[String]) -> Result<Self, CliError> {
        let mut text = read_text(path)?;
        for assignment in assignments {
            text = set_value(&text, assignment).map_err(|error| {
                CliError::BadInput(error.render(&format!("--set {assignment}"), assignment))
            })?;
        }
        let mut name = path.display().to_string();
        if !assignments.is_empty() {
            name.push_str(" (with --set)");
        }
        let scene = Scene::parse(&text).map_err(|error| CliError::BadInput(error.render(&name, &text)))?;
        require_memory(&scene)?;
        Ok(Self { scene, text, is_changed: !assignments.is_empty() })
    }
}

/// The text of the file at `path`, if it is one and of a scene's size.
fn read_text(path: &Path) -> Result<String, CliError> {
    const HELP: &str =
        "name a scene file such as scenes/hanging.toml, or print one with `muslin new hanging`";
    let read_error = |error: &io::Error| CliError::read(path, error, HELP);
    let file = fs::File::open(path).map_err(|error| read_error(&error))?;
    if file.metadata().map_err(|error| read_error(&error))?.is_dir() {
        return Err(CliError::input(format_args!("{} is a folder, not a scene file", path.display()), HELP));
    }
    let mut bytes = Vec::new();
    // One byte more than allowed shows that the file is too long without reading all of it.
    file.take(MAX_SCENE_BYTES as u64 + 1).read_to_end(&mut bytes).map_err(|error| read_error(&error))?;
    if bytes.len() > MAX_SCENE_BYTES {
        let limit = MAX_SCENE_BYTES >> 20;
        return Err(CliError::input(
            format_args!("{} is larger than {limit} MiB, so it is no scene file", path.display()),
            HELP,
        ));
    }
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let line = 1 + error.as_bytes()[..valid].iter().filter(|&&byte| byte == b'\n').count();
        CliError::input(
            format_args!("{}:{line} is not UTF-8 text (byte {valid} of the file)", path.display()),
            "save the file as UTF-8",
        )
    })
}
