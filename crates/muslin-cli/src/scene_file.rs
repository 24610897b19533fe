//! Reading scene files.

use std::fs;
use std::io::{self, Read};
use std::path::Path;

use muslin::Scene;
use muslin::scene::{DataFile, MAX_DATA_BYTES, MAX_SCENE_BYTES, set_value};

use crate::error::{CliError, reason};
use crate::memory::require_memory;
use crate::output::{bytes_hash, inputs_hash, is_run_file};

/// What to name if there is no such file.
const SCENE_HELP: &str =
    "name a scene file such as scenes/hanging.toml, or print one with `muslin new hanging`";

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
        let mut text = read_text(path, "scene file", SCENE_HELP)?;
        for assignment in assignments {
            text = set_value(&text, assignment).map_err(|error| {
                CliError::BadInput(error.render(&format!("--set {assignment}"), assignment))
            })?;
        }
        let mut name = path.display().to_string();
        if !assignments.is_empty() {
            name.push_str(" (with --set)");
        }
        let scene = parse(path, &name, &text)?;
        for file in scene.data_files() {
            require_other_name(file)?;
        }
        require_memory(&scene)?;
        Ok(Self { scene, text, is_changed: !assignments.is_empty() })
    }

    /// What the run depends on beside the version of muslin: see [`inputs_hash`].
    pub(crate) fn hash(&self) -> String {
        let files = self.scene.data_files().iter();
        inputs_hash(&self.text, files.map(|file| (file.name(), bytes_hash(file.bytes()))))
    }
}

/// The scene of `text`, which the file at `path` holds and errors call `name`, with the files beside it that it names.
pub(crate) fn parse(path: &Path, name: &str, text: &str) -> Result<Scene, CliError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut load = |file: &str| read_data(&folder.join(file));
    Scene::parse_with(text, &mut load).map_err(|error| CliError::BadInput(error.render(name, text)))
}

/// The bytes of the file at `path`, or why there are none, as [`Scene::parse_with`] asks for them. Of a file that is too long there
/// is one byte more than [`MAX_DATA_BYTES`].
pub(crate) fn read_data(path: &Path) -> Result<Vec<u8>, String> {
    let read = || -> io::Result<Option<Vec<u8>>> {
        // Not opened first: opening a pipe may wait for ever.
        if !fs::metadata(path)?.is_file() {
            return Ok(None);
        }
        let mut bytes = Vec::new();
        fs::File::open(path)?.take(MAX_DATA_BYTES as u64 + 1).read_to_end(&mut bytes)?;
        Ok(Some(bytes))
    };
    match read() {
        Ok(Some(bytes)) => Ok(bytes),
        Ok(None) => Err(format!("{} is not a file", path.display())),
        Err(error) => Err(format!("{} could not be read: {}", path.display(), reason(&error))),
    }
}

/// Refuses a data file whose copy in the output folder would take the place of another file there.
fn require_other_name(file: &DataFile) -> Result<(), CliError> {
    if !is_run_file(file.name()) {
        return Ok(());
    }
    Err(CliError::input(
        format_args!("the data file {} has the name of a file that a run writes itself", file.name()),
        "give it another name, as it is copied into the output folder",
    ))
}

/// The text of the file at `path`, a `kind` of file, if it is one and of a scene's size; `help` says what to name instead.
pub(crate) fn read_text(path: &Path, kind: &str, help: &str) -> Result<String, CliError> {
    let read_error = |error: &io::Error| CliError::read(path, error, help);
    let file = fs::File::open(path).map_err(|error| read_error(&error))?;
    if file.metadata().map_err(|error| read_error(&error))?.is_dir() {
        return Err(CliError::input(format_args!("{} is a folder, not a {kind}", path.display()), help));
    }
    let mut bytes = Vec::new();
    // One byte more than allowed shows that the file is too long without reading all of it.
    file.take(MAX_SCENE_BYTES as u64 + 1).read_to_end(&mut bytes).map_err(|error| read_error(&error))?;
    if bytes.len() > MAX_SCENE_BYTES {
        let limit = MAX_SCENE_BYTES >> 20;
        return Err(CliError::input(
            format_args!("{} is larger than {limit} MiB, so it is no {kind}", path.display()),
            help,
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
