//! A folder of its own for every test, and the command started in it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;

/// A scene that takes milliseconds: 5 x 4 particles, 10 frames of 10 steps after the first.
pub(crate) const SMALL: &str = r#"title = "Small cloth"

[run]
duration = 0.5
frame_rate = 20.0
step = { constant = 5e-3 }

[environment]
gravity = [0.0, -9.81, 0.0]

[fabric.plain]
kind = "springs"
particle_mass = 0.02
drag = 0.01
structural = { stiffness = 20.0, law = "linear" }
shear = { stiffness = 5.0, law = "linear" }
bend = { stiffness = 1.0, law = "linear" }

[[cloth]]
name = "sheet"
fabric = "plain"
grid = { columns = 5, rows = 4, width = 1.0, height = 0.75 }
place = { origin = [0.0, 1.0, 0.0], width_axis = [1, 0, 0], height_axis = [0, 0, 1] }
pins = [{ column = 0, row = 0 }, { column = -1, row = 0 }]
"#;

/// A folder that is removed at the end of the test.
pub(crate) struct Work(tempfile::TempDir);

/// How a command ended.
pub(crate) struct Outcome {
    pub(crate) code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Work {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    /// A folder with `scene.toml`: [`SMALL`] with pieces replaced.
    pub(crate) fn with_scene(changes: &[(&str, &str)]) -> Self {
        let work = Self::new();
        work.write("scene.toml", scene(changes));
        work
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        fs::write(self.path(name), content).expect("a file in the temporary folder");
    }

    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    pub(crate) fn text(&self, name: &str) -> String {
        String::from_utf8(self.read(name)).expect("UTF-8 text")
    }

    pub(crate) fn summary(&self, folder: &str) -> Value {
        serde_json::from_slice(&self.read(&format!("{folder}/summary.json"))).expect("JSON")
    }

    /// Names in a folder, in order; none if there is no such folder.
    pub(crate) fn names(&self, folder: &str) -> Vec<String> {
        let entries = fs::read_dir(self.path(folder)).into_iter().flatten();
        let mut names: Vec<String> = entries
            .map(|entry| entry.expect("an entry").file_name().into_string().expect("a UTF-8 name"))
            .collect();
        names.sort();
        names
    }

    /// Every file of a folder with its content.
    pub(crate) fn contents(&self, folder: &str) -> Vec<(String, Vec<u8>)> {
        let names = self.names(folder).into_iter();
        names.map(|name| (name.clone(), self.read(&format!("{folder}/{name}")))).collect()
    }

    /// The command, to be started in this folder.
    pub(crate) fn command<'a>(&self, arguments: impl IntoIterator<Item = &'a str>) -> Command {
        self.any_command(env!("CARGO_BIN_EXE_muslin"), arguments)
    }

    /// A shell that starts the command as `"$@"`.
    pub(crate) fn shell<'a>(&self, script: &str, arguments: impl IntoIterator<Item = &'a str>) -> Command {
        let mut command = self.any_command("sh", ["-c", script, "sh", env!("CARGO_BIN_EXE_muslin")]);
        command.args(arguments);
        command
    }

    fn any_command<'a>(&self, program: &str, arguments: impl IntoIterator<Item = &'a str>) -> Command {
        let mut command = Command::new(program);
        command.args(arguments).current_dir(self.0.path()).stdin(Stdio::null());
        command
    }

    /// Runs the command with arguments between blanks.
    pub(crate) fn muslin(&self, arguments: &str) -> Outcome {
        Outcome::of(&mut self.command(arguments.split_whitespace()))
    }

    /// Asserts that two folders hold the same run: the same files, and summaries that differ in times only.
    pub(crate) fn assert_same_run(&self, folder: &str, other: &str) {
        let timeless = |folder: &str| {
            let mut summary = self.summary(folder);
            let object = summary.as_object_mut().expect("an object");
            for key in ["wall_time", "stepping_time", "particle_steps_per_second", "threads"] {
                assert!(object.remove(key).is_some(), "the summary has no {key}");
            }
            summary
        };
        assert_eq!(timeless(folder), timeless(other));
        assert_eq!(self.names(folder), self.names(other));
        for name in self.names(folder).iter().filter(|name| *name != "summary.json") {
            let same = self.read(&format!("{folder}/{name}")) == self.read(&format!("{other}/{name}"));
            assert!(same, "{name} differs");
        }
    }
}

impl Outcome {
    pub(crate) fn of(command: &mut Command) -> Self {
        Self::of_output(command.output().expect("the command starts"))
    }

    pub(crate) fn of_output(output: Output) -> Self {
        Self {
            code: output.status.code(),
            stdout: String::from_utf8(output.stdout).expect("UTF-8 on stdout"),
            stderr: String::from_utf8(output.stderr).expect("UTF-8 on stderr"),
        }
    }

    /// Asserts the exit code, and that stderr has nothing but plain lines of progress.
    #[track_caller]
    pub(crate) fn assert_success(&self) {
        assert_eq!(self.code, Some(0), "{}", self.stderr);
        let is_progress = |line: &str| {
            let parts = ["s  step ", "x real time  ", " left"];
            (parts.iter().all(|part| line.contains(part)) || line.starts_with("writing "))
                && !line.contains(char::is_control)
        };
        assert!(self.stderr.lines().all(is_progress), "{}", self.stderr);
    }

    /// What was said beside that files are being written, which depends on how long that takes.
    pub(crate) fn messages(&self) -> String {
        self.stderr.split_inclusive('\n').filter(|line| !line.starts_with("writing ")).collect()
    }

    /// Asserts the exit code and the whole of stderr.
    #[track_caller]
    pub(crate) fn assert_failure(&self, code: i32, message: &str) {
        assert_eq!(self.messages().trim_end(), message.trim_end());
        assert_eq!(self.code, Some(code));
    }
}

/// [`SMALL`] with pieces replaced.
pub(crate) fn scene(changes: &[(&str, &str)]) -> String {
    changes.iter().fold(SMALL.to_owned(), |text, (old, new)| {
        assert!(text.contains(old), "the scene has no {old}");
        text.replacen(old, new, 1)
    })
}

/// Whether there is a file or folder at `path`.
pub(crate) fn exists(path: impl AsRef<Path>) -> bool {
    path.as_ref().exists()
}
