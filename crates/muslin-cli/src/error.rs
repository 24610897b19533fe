//! What the command says when something is wrong, and its exit code.

use std::fmt;
use std::io;
use std::path::Path;
use std::process::ExitCode;

/// An error of the command: a message for a person, and whether the input or the run is to blame.
#[derive(Debug)]
pub(crate) enum CliError {
    /// The input cannot be used: exit code 2. The text is complete, with place, value, rule and way out.
    BadInput(String),
    /// The run failed: exit code 1.
    Failed(String),
}

impl CliError {
    /// Bad input with a way out.
    pub(crate) fn input(message: impl fmt::Display, help: impl fmt::Display) -> Self {
        Self::BadInput(with_help(message, help))
    }

    /// A failed run with a way out.
    pub(crate) fn failed(message: impl fmt::Display, help: impl fmt::Display) -> Self {
        Self::Failed(with_help(message, help))
    }

    /// A file that could not be written during a run.
    pub(crate) fn write(path: &Path, error: &io::Error) -> Self {
        let help = match error.kind() {
            io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
                "choose a folder that you may write to with `--out DIR`"
            }
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded | io::ErrorKind::FileTooLarge => {
                "make room and go on with `--resume`, or choose another folder with `--out DIR`"
            }
            _ => "check the folder, then go on with `--resume` or start again with `--force`",
        };
        Self::failed(format_args!("{} could not be written: {}", path.display(), reason(error)), help)
    }

    /// Results that could not be printed. A reader who goes away is no failure.
    pub(crate) fn print(result: io::Result<()>) -> Result<(), Self> {
        match result {
            Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Self::failed(
                format_args!("the standard output could not be written: {}", reason(&error)),
                "check where it goes",
            )),
            _ => Ok(()),
        }
    }

    /// A file that could not be read.
    pub(crate) fn read(path: &Path, error: &io::Error, help: &str) -> Self {
        Self::input(format_args!("{} could not be read: {}", path.display(), reason(error)), help)
    }

    /// The exit code that DIR's readers and scripts rely on.
    pub(crate) fn exit_code(&self) -> ExitCode {
        match self {
            Self::Failed(_) => ExitCode::from(1),
            Self::BadInput(_) => ExitCode::from(2),
        }
    }
}

impl fmt::Display for CliError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BadInput(text) | Self::Failed(text) => f.write_str(text),
        }
    }
}

/// The system's reason without its error number, in lower case.
pub(crate) fn reason(error: &io::Error) -> String {
    let text = error.to_string();
    let text = text.split(" (os error").next().unwrap_or(&text);
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_lowercase().chain(letters).collect())
}

fn with_help(message: impl fmt::Display, help: impl fmt::Display) -> String {
    format!("error: {message}\n  help: {help}")
}
