//! A table of the scene text, read key by key.

use std::borrow::Cow;
use std::ops::Range;

use glam::DVec3;
use toml::de::DeTable;

use super::value::{NumberRule, Value};
use crate::scene::error::{SceneError, SceneErrorKind, shortened};

/// A table that is read by taking each of its keys once and then calling [`finish`](Self::finish).
///
/// Taking never fails; the entries are converted after `finish`, so that a misspelt key is reported as such and not as
/// a missing one.
pub(super) struct Table<'t> {
    text: &'t str,
    /// Dotted path, empty at the top level.
    path: String,
    /// Where the table is opened; nowhere at the top level.
    span: Option<Range<usize>>,
    entries: &'t DeTable<'t>,
    taken: Vec<&'static str>,
}

/// What a table has under a key: a value or nothing.
#[derive(Clone)]
pub(super) struct Entry<'t> {
    text: &'t str,
    path: String,
    table_span: Option<Range<usize>>,
    value: Option<Value<'t>>,
}

impl<'t> Table<'t> {
    pub(super) fn new(
        text: &'t str,
        path: String,
        span: Option<Range<usize>>,
        entries: &'t DeTable<'t>,
    ) -> Self {
        Self { text, path, span, entries, taken: Vec::new() }
    }

    pub(super) fn path(&self) -> &str {
        &self.path
    }

    /// `kind` at the place where the table is opened.
    pub(super) fn error(&self, kind: SceneErrorKind) -> SceneError {
        match self.span.clone() {
            Some(span) => SceneError::at(kind, self.text, span),
            None => SceneError::new(kind),
        }
    }

    /// The entry of `key`, which thereby is a valid key.
    pub(super) fn take(&mut self, key: &'static str) -> Entry<'t> {
        debug_assert!(!self.taken.contains(&key), "`{key}` is taken once");
        self.taken.push(key);
        self.peek(key)
    }

    /// The entry of `key`, which does not become a valid key.
    pub(super) fn peek(&self, key: &'static str) -> Entry<'t> {
        Entry {
            text: self.text,
            path: joined(&self.path, key),
            table_span: self.span.clone(),
            value: self.entries.get(key).map(|value| Value {
                text: self.text,
                path: joined(&self.path, key),
                span: value.span(),
                value: value.get_ref(),
            }),
        }
    }

    /// Rejects the first key in the text that was not taken.
    pub(super) fn finish(&self) -> Result<(), SceneError> {
        let unknown = self.entries.keys().filter(|key| !self.taken.contains(&key.get_ref().as_ref()));
        match unknown.min_by_key(|key| key.span().start) {
            None => Ok(()),
            Some(key) => {
                let kind = SceneErrorKind::UnknownKey {
                    table: self.path.clone(),
                    key: shortened(&key_as_written(key.get_ref())),
                    valid: self.taken.clone(),
                };
                Err(SceneError::at(kind, self.text, key.span()))
            }
        }
    }

    /// Names and values of a table whose keys are the user's, in the order of the text.
    pub(super) fn into_named_values(self) -> Vec<(&'t str, Value<'t>)> {
        let mut values: Vec<_> = self
            .entries
            .iter()
            .map(|(key, value)| {
                let name = key.get_ref().as_ref();
                let (path, span) = (joined(&self.path, name), value.span());
                (key.span().start, (name, Value { text: self.text, path, span, value: value.get_ref() }))
            })
            .collect();
        values.sort_by_key(|(start, _)| *start);
        values.into_iter().map(|(_, value)| value).collect()
    }
}

impl<'t> Entry<'t> {
    pub(super) fn is_given(&self) -> bool {
        self.value.is_some()
    }

    pub(super) fn optional(self) -> Option<Value<'t>> {
        self.value
    }

    /// The value, or the error that it is missing.
    pub(super) fn required(self, unit: &'static str, help: &str) -> Result<Value<'t>, SceneError> {
        match self.value {
            Some(value) => Ok(value),
            None => Err(self.missing(unit, help)),
        }
    }

    /// The error that there is no value.
    pub(super) fn missing(&self, unit: &'static str, help: &str) -> SceneError {
        let kind = SceneErrorKind::Missing { key: self.path.clone(), unit, help: help.to_owned() };
        match self.table_span.clone() {
            Some(span) => SceneError::at(kind, self.text, span),
            None => SceneError::new(kind),
        }
    }

    /// See [`Value::number`].
    pub(super) fn number(self, unit: &'static str, rule: NumberRule) -> Result<f64, SceneError> {
        let help = format!("write `{} = ...`", last_key(&self.path));
        self.required(unit, &help)?.number(unit, rule)
    }

    /// See [`Value::vector`].
    pub(super) fn vector(self, unit: &'static str) -> Result<DVec3, SceneError> {
        let help = format!("write `{} = [x, y, z]`", last_key(&self.path));
        self.required(unit, &help)?.vector(unit)
    }

    /// See [`Value::direction`].
    pub(super) fn direction(self) -> Result<DVec3, SceneError> {
        let help = format!("write `{} = [x, y, z]`, of any length but zero", last_key(&self.path));
        self.required("", &help)?.direction()
    }

    /// See [`Value::string`].
    pub(super) fn string(self) -> Result<&'t str, SceneError> {
        let help = format!("write `{} = \"...\"`", last_key(&self.path));
        self.required("", &help)?.string()
    }
}

/// The path of `key` in the table at `path`.
pub(in crate::scene) fn joined(path: &str, key: &str) -> String {
    let key = shortened(&key_as_written(key));
    if path.is_empty() { key } else { format!("{path}.{key}") }
}

/// A key as it is written in TOML: in quotes where it must be.
fn key_as_written(key: &str) -> Cow<'_, str> {
    let is_bare = |character: char| character.is_ascii_alphanumeric() || "_-".contains(character);
    if !key.is_empty() && key.chars().all(is_bare) {
        Cow::Borrowed(key)
    } else {
        Cow::Owned(toml_edit::Key::new(key).display_repr().into_owned())
    }
}

/// The last part of the path of a key that needs no quotes.
fn last_key(path: &str) -> &str {
    path.rsplit('.').next().unwrap_or(path)
}
