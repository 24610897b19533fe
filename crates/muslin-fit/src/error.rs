//! Why data cannot be fitted.

use muslin::scene::CellError;

/// What is wrong with measurements, and what to do about it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// A data file breaks a rule.
    #[error("`{file}` {error}")]
    Data {
        /// The file's name.
        file: String,
        /// Place, value, rule and way out. Boxed, so that a `Result` of a small value stays small.
        error: Box<CellError>,
    },
    /// Measurements do not go together, or are named wrongly.
    #[error("{message}")]
    Inconsistent {
        /// What and why, in lower case and without full stop.
        message: String,
        /// The way out.
        help: String,
    },
}

impl FitError {
    /// An error of the whole `file`.
    pub(crate) fn whole(file: &str, message: impl AsRef<str>, help: impl Into<String>) -> Self {
        Self::at_cell(file, CellError::whole(message.as_ref(), help.into()))
    }

    pub(crate) fn at_cell(file: &str, error: CellError) -> Self {
        Self::Data { file: file.to_owned(), error: Box::new(error) }
    }

    pub(crate) fn inconsistent(message: impl Into<String>, help: impl Into<String>) -> Self {
        Self::Inconsistent { message: message.into(), help: help.into() }
    }

    /// The whole error for a person, with the place in the file and a caret. Several lines, the last without a line break.
    #[must_use]
    pub fn render(&self) -> String {
        match self {
            Self::Data { file, error } => error.render(file),
            Self::Inconsistent { message, help } => format!("error: {message}\n  help: {help}"),
        }
    }
}
