//! Files beside the scene that it names.

mod table;

use std::collections::BTreeMap;
use std::collections::btree_map;

pub use table::{CellError, Column, DataTable, column_names, text};

use super::error::quoted;

/// The longest data file [B] that a scene may name.
pub const MAX_DATA_BYTES: usize = 1 << 24;

/// A file that a scene names, as it was read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DataFile {
    name: String,
    bytes: Vec<u8>,
}

impl DataFile {
    /// Its name in the scene: a path below the scene's folder, with `/` between folders, none of them `..`.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What it holds, byte by byte.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }
}

/// Reads a file that a scene names: its bytes, or in lower case and without full stop why it cannot be read.
pub(super) type Load<'l> = dyn FnMut(&str) -> Result<Vec<u8>, String> + 'l;

/// The files that a scene names, each loaded once.
pub(super) struct DataFiles<'l> {
    load: Option<&'l mut Load<'l>>,
    files: BTreeMap<String, DataFile>,
}

/// Why a file that a scene names cannot be used.
pub(super) enum LoadError {
    /// What a name of a file must do.
    Name(&'static str),
    /// There is nobody to load it.
    NoLoader,
    /// It is longer than [`MAX_DATA_BYTES`].
    TooLong,
    /// What whoever loads it says.
    Reason(String),
}

impl<'l> DataFiles<'l> {
    /// Files that `load` reads; without it none can be.
    pub(super) fn new(load: Option<&'l mut Load<'l>>) -> Self {
        Self { load, files: BTreeMap::new() }
    }

    /// The file called `name`.
    pub(super) fn load(&mut self, name: &str) -> Result<&DataFile, LoadError> {
        check_name(name).map_err(LoadError::Name)?;
        let vacant = match self.files.entry(name.to_owned()) {
            btree_map::Entry::Occupied(known) => return Ok(known.into_mut()),
            btree_map::Entry::Vacant(vacant) => vacant,
        };
        let load = self.load.as_mut().ok_or(LoadError::NoLoader)?;
        let bytes = load(name).map_err(LoadError::Reason)?;
        if MAX_DATA_BYTES < bytes.len() {
            return Err(LoadError::TooLong);
        }
        Ok(vacant.insert(DataFile { name: name.to_owned(), bytes }))
    }

    /// All files that were loaded, by name.
    pub(super) fn into_files(self) -> Vec<DataFile> {
        self.files.into_values().collect()
    }
}

/// The longest name of a data file [B]. File systems have room for as much.
const MAX_NAME_BYTES: usize = 200;

/// Whether `name` means the same file on every system, and one below the scene's folder: what a name must do if not.
fn check_name(name: &str) -> Result<(), &'static str> {
    if name.is_empty() || MAX_NAME_BYTES < name.len() {
        return Err("be the name of a file, of 1 to 200 bytes");
    }
    if name.chars().any(|c| c.is_control() || "\\:*?\"<>|".contains(c)) {
        return Err("have `/` between folders, and none of \\ : * ? \" < > | and control characters");
    }
    if name.starts_with('/') {
        return Err("be a path that starts at the scene's folder");
    }
    if name.split('/').any(|part| part == "..") {
        return Err("stay in the scene's folder, without `..`");
    }
    // A file system may drop dots and blanks at the end; what starts with a dot is hidden, and may be a run's own.
    let is_plain = |part: &str| !part.is_empty() && !part.starts_with('.') && !part.ends_with(['.', ' ']);
    if !name.split('/').all(is_plain) {
        return Err("have no part that is empty, starts with a dot, or ends in a dot or blank");
    }
    Ok(())
}

/// `names` for a message: in quotes, with `and` before the last.
fn listed<'n>(names: impl IntoIterator<Item = &'n str>) -> String {
    let names: Vec<String> = names.into_iter().map(quoted).collect();
    names.join(" and ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stay_in_the_folder_of_the_scene() {
        for name in ["warp.csv", "data/cotton 150 g/warp.csv", "布.csv", "a..b.csv"] {
            assert_eq!(check_name(name), Ok(()), "{name}");
        }
        let bad = [
            "",
            "/warp.csv",
            "../warp.csv",
            "a/../../b",
            "a/..",
            "C:warp.csv",
            "a\\b.csv",
            "a//b",
            "a/",
            ".partial/x",
            "./a",
            "a\n",
            "a.",
            "nul\0",
        ];
        for name in bad {
            assert!(check_name(name).is_err(), "{name:?}");
        }
        assert!(check_name(&"a".repeat(201)).is_err());
    }

    #[test]
    fn a_file_is_loaded_once() {
        let mut count = 0;
        let mut load = |_: &str| {
            count += 1;
            Ok(vec![1, 2])
        };
        let mut files = DataFiles::new(Some(&mut load));
        for _ in 0..2 {
            assert!(files.load("a.csv").is_ok_and(|file| file.bytes() == [1, 2]));
        }
        assert_eq!(files.into_files().len(), 1);
        assert_eq!(count, 1);
    }
}
