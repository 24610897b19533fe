//! A folder that is written as a whole: that of a reproduction, or of a test.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::error::{CliError, reason};
use crate::output::lock;

/// What a folder is, and how that is told.
#[derive(Debug)]
pub(crate) struct Owner {
    /// Name of the folder inside that holds files until all are whole.
    pub(crate) partial: &'static str,
    /// The JSON file whose `key` has the `value` that tells it.
    pub(crate) file: &'static str,
    pub(crate) key: &'static str,
    pub(crate) value: &'static str,
    /// In words: "a reproduction".
    pub(crate) name: &'static str,
    /// How to choose another folder: "choose another folder".
    pub(crate) elsewhere: &'static str,
}

/// A folder that changes only when everything is computed and written.
pub(crate) struct Folder {
    path: PathBuf,
    owner: &'static Owner,
    /// Locked until this process ends, so that no other writes here.
    lock: Option<File>,
}

impl Folder {
    /// The folder at `path`, made if need be. What is in it must be of the same `owner`, and is then replaced if that is wanted.
    pub(crate) fn create(path: &Path, may_replace: bool, owner: &'static Owner) -> Result<Self, CliError> {
        let shown = path.display();
        if path.exists() && !path.is_dir() {
            let message = format_args!("{shown} is a file, but must be a folder or not exist");
            return Err(CliError::input(message, "choose another name"));
        }
        let mut folder = Self { path: path.to_owned(), owner, lock: None };
        let help = "wait until it ends or stop it, or choose another folder";
        folder.lock = lock(&folder.path, &folder.partial(), help)?;
        match (folder.has_files(), folder.is_of_owner(), may_replace) {
            (false, _, _) | (true, true, true) => {}
            (true, true, false) => {
                return Err(CliError::input(
                    format_args!("{shown} exists already and is not empty"),
                    format_args!("replace its files with `--force`, or {}", owner.elsewhere),
                ));
            }
            (true, false, true) => {
                return Err(CliError::input(
                    format_args!(
                        "{shown} holds other files than those of {}, which `--force` does not replace",
                        owner.name
                    ),
                    owner.elsewhere,
                ));
            }
            (true, false, false) => {
                let message = format_args!("{shown} exists already and is not empty");
                return Err(CliError::input(message, owner.elsewhere));
            }
        }
        // What another left when it was stopped is worth nothing.
        let make = || {
            let _ = fs::remove_dir_all(folder.partial());
            fs::create_dir_all(folder.partial())
        };
        make().map_err(|error| {
            CliError::input(
                format_args!("{shown} cannot be written: {}", reason(&error)),
                "choose a folder that you may write to",
            )
        })?;
        let help = "wait until it ends or stop it, or choose another folder";
        folder.lock = lock(&folder.path, &folder.partial(), help)?;
        Ok(folder)
    }

    fn partial(&self) -> PathBuf {
        self.path.join(self.owner.partial)
    }

    /// Whether there is anything but what is in progress.
    fn has_files(&self) -> bool {
        let entries = fs::read_dir(&self.path).into_iter().flatten().flatten();
        entries.into_iter().any(|entry| entry.file_name() != self.owner.partial)
    }

    fn is_of_owner(&self) -> bool {
        let Owner { file, key, value, .. } = self.owner;
        let bytes = fs::read(self.path.join(file)).unwrap_or_default();
        let found: Option<Value> = serde_json::from_slice(&bytes).ok();
        found.is_some_and(|found| found[key] == *value)
    }

    /// Writes all `files` beside their names, and moves them there when all are whole.
    pub(crate) fn write(&self, files: &[(String, Vec<u8>)]) -> Result<(), CliError> {
        let failed = |path: &Path, error: &io::Error| {
            let message = format!("{} could not be written: {}", path.display(), reason(error));
            CliError::failed(message, "check the folder, or choose another")
        };
        for (name, bytes) in files {
            let path = self.partial().join(name);
            fs::write(&path, bytes).map_err(|error| failed(&path, &error))?;
        }
        for (name, _) in files {
            let path = self.path.join(name);
            fs::rename(self.partial().join(name), &path).map_err(|error| failed(&path, &error))?;
        }
        self.discard();
        Ok(())
    }

    /// Removes what is unfinished, and the folder if nothing else is in it.
    pub(crate) fn discard(&self) {
        let _ = fs::remove_dir_all(self.partial());
        // Fails, as it should, if there are files.
        let _ = fs::remove_dir(&self.path);
    }
}
