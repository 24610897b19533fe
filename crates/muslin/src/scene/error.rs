//! What is wrong with a scene text: place, value, rule and a way out.

use std::ops::Range;

use super::excerpt;

/// Why a text is not a scene.
///
/// It displays as the message alone; [`position`](Self::position) and [`help`](Self::help) give the rest, and
/// [`render`](Self::render) puts all of it together for a person.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{kind}")]
#[non_exhaustive]
pub struct SceneError {
    // Boxed, so that a `Result` of a small value stays small.
    kind: Box<SceneErrorKind>,
    position: Option<Position>,
}

/// A place in a text, counted in characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Position {
    /// Line, the first being 1.
    pub line: usize,
    /// Column in characters, the first being 1.
    pub column: usize,
    /// Length in characters, at least 1 and not beyond the line's end unless it is 1.
    pub length: usize,
}

/// Which rule is broken. Keys are dotted paths as `set_value` takes them, values are as they stand in the text.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneErrorKind {
    /// The text is longer than [`MAX_SCENE_BYTES`](super::MAX_SCENE_BYTES).
    #[error("the scene is {bytes} bytes long, but must be at most {} bytes", super::MAX_SCENE_BYTES)]
    TooLarge {
        /// Length of the text [B].
        bytes: usize,
    },
    /// The text has no keys.
    #[error("the scene is empty")]
    Empty,
    /// The text does not follow TOML's grammar.
    #[error("the text is not TOML: {message}")]
    NotToml {
        /// What the TOML parser says.
        message: String,
    },
    /// A key that no rule knows.
    #[error("unknown key `{key}` {}", place(table))]
    UnknownKey {
        /// Path of the table, empty at the top level.
        table: String,
        /// The key.
        key: String,
        /// Every key that the table may have.
        valid: Vec<&'static str>,
    },
    /// A required key is absent.
    #[error("`{key}`{} is missing", bracketed(unit))]
    Missing {
        /// Path of the key.
        key: String,
        /// Unit, empty if it has none.
        unit: &'static str,
        /// What to write.
        help: String,
    },
    /// A value of another TOML type than the rule wants.
    #[error("`{key}` is {found}, but must be {expected}{}", bracketed(unit))]
    WrongType {
        /// Path of the value.
        key: String,
        /// Its type, with an article.
        found: &'static str,
        /// The type wanted, with an article.
        expected: &'static str,
        /// Unit, empty if it has none.
        unit: &'static str,
        /// What to write.
        help: String,
    },
    /// A value outside its range.
    #[error("`{key}` is {value}{}, but must {rule}", spaced(unit))]
    OutOfRange {
        /// Path of the value.
        key: String,
        /// The value.
        value: String,
        /// Its unit, empty if it has none.
        unit: &'static str,
        /// What it must do, beginning with a verb.
        rule: String,
        /// What to write.
        help: String,
    },
    /// A name that is none of the known ones.
    #[error("`{key}` is {value}, but {rule}")]
    UnknownName {
        /// Path of the value.
        key: String,
        /// The name, quoted.
        value: String,
        /// What it must be.
        rule: &'static str,
        /// The known names.
        valid: Vec<String>,
        /// The closest of them, if one is close.
        closest: Option<String>,
    },
    /// A name that another table of the scene has already.
    #[error("`{key}` is {value}, but `{other}` has that name already")]
    DuplicateName {
        /// Path of the value.
        key: String,
        /// The name, quoted.
        value: String,
        /// Path of the table that had it first.
        other: String,
    },
    /// A file that the scene names cannot be read.
    #[error("`{key}` names the file {file}, but {reason}")]
    UnreadableFile {
        /// Path of the value.
        key: String,
        /// The file's name, quoted.
        file: String,
        /// Why not.
        reason: String,
        /// What to do.
        help: &'static str,
    },
    /// A file that the scene names breaks a rule. The error's own position is that of its name in the scene.
    #[error("`{file}`{} {message}", line_number(position))]
    Data {
        /// The file's name.
        file: String,
        /// Where in the file, if it is at one place.
        position: Option<Position>,
        /// The line at that place, empty if it is not text.
        line: String,
        /// Value and rule.
        message: String,
        /// What to write.
        help: String,
    },
    /// Values that contradict each other.
    #[error("{message}")]
    Inconsistent {
        /// Place, values and rule.
        message: String,
        /// What to write.
        help: String,
    },
    /// An assignment that cannot be carried out on the text.
    #[error("cannot set {assignment}: {reason}")]
    Assignment {
        /// The assignment, quoted.
        assignment: String,
        /// Why not.
        reason: String,
        /// What to write.
        help: String,
    },
}

impl SceneError {
    /// An error without a place.
    pub(super) fn new(kind: SceneErrorKind) -> Self {
        Self { kind: Box::new(kind), position: None }
    }

    /// An error at a range of bytes of `text`.
    pub(super) fn at(kind: SceneErrorKind, text: &str, span: Range<usize>) -> Self {
        Self { kind: Box::new(kind), position: Some(excerpt::position(text, span)) }
    }

    /// Which rule is broken.
    #[must_use]
    pub fn kind(&self) -> &SceneErrorKind {
        &self.kind
    }

    /// Where in the text, if it is at one place.
    #[must_use]
    pub fn position(&self) -> Option<Position> {
        self.position
    }

    /// The way out, in lower case and without full stop.
    #[must_use]
    pub fn help(&self) -> Option<String> {
        let help = match self.kind() {
            SceneErrorKind::TooLarge { .. } => "a scene describes a run, it does not hold data".to_owned(),
            SceneErrorKind::Empty => "start from a scene that `muslin new` prints".to_owned(),
            SceneErrorKind::NotToml { message } if message == "duplicate key" => {
                "write every key and every table once".to_owned()
            }
            SceneErrorKind::NotToml { message } if message.contains("recurs") => {
                "no part of a scene is nested that deeply".to_owned()
            }
            SceneErrorKind::NotToml { .. } => {
                "tables are `[name]`, values `key = 1.0`, texts in quotes; see https://toml.io".to_owned()
            }
            SceneErrorKind::UnknownKey { key, valid, .. } => {
                let closest = closest(key, valid).map(|name| format!("did you mean `{name}`? "));
                format!("{}valid keys: {}", closest.unwrap_or_default(), valid.join(", "))
            }
            SceneErrorKind::UnknownName { valid, closest, .. } => {
                let closest = closest.as_ref().map(|name| format!("did you mean {name}? "));
                format!("{}valid names: {}", closest.unwrap_or_default(), listed(valid))
            }
            SceneErrorKind::DuplicateName { .. } => "give every cloth its own name".to_owned(),
            SceneErrorKind::UnreadableFile { help, .. } => (*help).to_owned(),
            SceneErrorKind::Missing { help, .. }
            | SceneErrorKind::WrongType { help, .. }
            | SceneErrorKind::OutOfRange { help, .. }
            | SceneErrorKind::Data { help, .. }
            | SceneErrorKind::Inconsistent { help, .. }
            | SceneErrorKind::Assignment { help, .. } => help.clone(),
        };
        (!help.is_empty()).then_some(help)
    }

    /// The whole error for a person: message, place in the file `name`, the line of `text` with a caret, and help; before
    /// that place the one in a data file, if the error is there.
    ///
    /// `text` must be the text that was parsed. Several lines, the last without a line break.
    #[must_use]
    pub fn render(&self, name: &str, text: &str) -> String {
        excerpt::render(self, name, text)
    }
}

/// The most of a user's name or value that a message repeats.
const QUOTED_CHARACTERS: usize = 60;

/// `value` in double quotes with escapes, cut if it is long.
pub(super) fn quoted(value: &str) -> String {
    format!("{:?}", shortened(value))
}

/// `value` on one line, cut if it is long.
pub(super) fn shortened(value: &str) -> String {
    match value.char_indices().nth(QUOTED_CHARACTERS) {
        Some((end, _)) => format!("{}...", &value[..end]),
        None => value.to_owned(),
    }
}

/// The one of `names` that `name` is most probably a slip of.
pub(super) fn closest<'n, N: AsRef<str>>(name: &str, names: &'n [N]) -> Option<&'n str> {
    // A slip changes a few letters: of a long text no name is one.
    if QUOTED_CHARACTERS < name.chars().count() {
        return None;
    }
    let plain = |name: &str| name.to_lowercase().replace('-', "_");
    let name = plain(name);
    let allowed = (name.chars().count() / 3).max(1);
    names
        .iter()
        .map(|candidate| (strsim::osa_distance(&name, &plain(candidate.as_ref())), candidate.as_ref()))
        .filter(|(distance, _)| *distance <= allowed)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}

/// The first names, and how many more there are.
fn listed(names: &[String]) -> String {
    const SHOWN: usize = 12;
    if names.len() <= SHOWN {
        return names.join(", ");
    }
    format!("{} and {} more", names[..SHOWN].join(", "), names.len() - SHOWN)
}

fn place(table: &str) -> String {
    if table.is_empty() { "at the top level".to_owned() } else { format!("in `{table}`") }
}

fn line_number(position: &Option<Position>) -> String {
    position.map_or(String::new(), |position| format!(" line {}:", position.line))
}

fn bracketed(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" [{unit}]") }
}

fn spaced(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" {unit}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_find_their_name_and_other_words_none() {
        let names = ["duration", "frame_rate", "allow-unstable", "x"];
        assert_eq!(closest("durration", &names), Some("duration"));
        assert_eq!(closest("Frame-Rate", &names), Some("frame_rate"));
        assert_eq!(closest("allow_unstable", &names), Some("allow-unstable"));
        assert_eq!(closest("colour", &names), None);
        assert_eq!(closest(&"duration".repeat(1000), &names), None);
    }

    #[test]
    fn a_long_value_is_cut_between_characters() {
        assert_eq!(shortened(&"é".repeat(60)), "é".repeat(60));
        assert_eq!(shortened(&"é".repeat(61)), format!("{}...", "é".repeat(60)));
        assert_eq!(quoted("a\n\u{1b}[31m"), r#""a\n\u{1b}[31m""#);
    }
}
