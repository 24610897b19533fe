//! The folder that a run writes.

use std::fs::{self, File, TryLockError};
use std::io::{self, BufWriter};
use std::iter;
use std::path::{Component, Path, PathBuf};

use rayon::prelude::*;
use serde_json::{Map, Value};
use sha2::{Digest, Sha256};

use crate::error::{CliError, reason};
use crate::frame_store::{Checkpoint, write_whole};

/// Name of the folder inside the output folder that holds a run in progress.
const PARTIAL: &str = ".partial";

/// Name of the file inside it that the process at work holds locked.
const LOCK: &str = "lock";

/// Name of the file that tells of the run and of all other files.
pub(crate) const SUMMARY: &str = "summary.json";

/// Names of all files that a run may write.
const FILES: [&str; 7] =
    ["scene.toml", "trajectory.npz", "series.csv", "cloth.glb", "poster.png", "view.html", SUMMARY];

/// Whether a run writes a file of this name itself, on a file system that knows no capital letters too.
pub(crate) fn is_run_file(name: &str) -> bool {
    let first = name.split('/').next().unwrap_or(name);
    FILES.iter().any(|file| file.eq_ignore_ascii_case(first))
}

/// How to treat what is in the folder already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Existing {
    /// Refuse to touch it.
    Keep,
    /// Replace the files of an earlier run once the new ones are whole.
    Replace,
}

/// What writes a file.
type WriteFile<'a> = dyn FnOnce(&mut BufWriter<File>) -> io::Result<()> + Send + 'a;

/// A file to be written, and how.
pub(crate) struct OutputFile<'a> {
    name: &'static str,
    write: Box<WriteFile<'a>>,
}

impl<'a> OutputFile<'a> {
    pub(crate) fn new(
        name: &'static str,
        write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()> + Send + 'a,
    ) -> Self {
        Self { name, write: Box::new(write) }
    }
}

/// A folder with whole files only, and inside it the run in progress.
pub(crate) struct OutputFolder {
    path: PathBuf,
    hashes: Map<String, Value>,
    /// Data files of an earlier run, with their hashes.
    replaced: Vec<(String, String)>,
    /// Locked until this process ends, so that no other works on the same run.
    lock: Option<File>,
}

impl OutputFolder {
    /// The folder at `path`, made if need be, for a new run of the scene file `scene` with data files called `data` beside it.
    pub(crate) fn create<'d>(
        path: &Path,
        existing: Existing,
        scene: &Path,
        data: impl Iterator<Item = &'d str>,
    ) -> Result<Self, CliError> {
        let mut folder = Self { path: path.to_owned(), hashes: Map::new(), replaced: Vec::new(), lock: None };
        if path.exists() && !path.is_dir() {
            return Err(CliError::input(
                format_args!("{} is a file, but must be a folder or not exist", path.display()),
                "choose another name with `--out DIR`",
            ));
        }
        folder.lock()?;
        // What has no checkpoint, because the run ended before its first, is worth nothing.
        if existing == Existing::Keep && Checkpoint::exists(&folder.partial()) {
            return Err(CliError::input(
                format_args!("{} holds an unfinished run", path.display()),
                "go on with it by `--resume`, start again with `--force`, or choose another folder with `--out DIR`",
            ));
        }
        let scene_folder = scene.parent().unwrap_or(Path::new(""));
        let data: Vec<&str> = data.collect();
        let sources = data.iter().map(|name| scene_folder.join(name));
        for source in iter::once(scene.to_owned()).chain(sources) {
            if folder.would_overwrite(&source, &data) {
                return Err(CliError::input(
                    format_args!("{} would be overwritten by the files of its run", source.display()),
                    "choose another folder with `--out DIR`",
                ));
            }
        }
        folder.require_replaceable(existing)?;
        folder.replaced = folder.recorded_data();
        let make = || {
            if folder.partial().exists() {
                fs::remove_dir_all(folder.partial())?;
            }
            fs::create_dir_all(folder.partial())
        };
        make().map_err(|error| {
            CliError::input(
                format_args!("{} cannot be written: {}", path.display(), reason(&error)),
                "choose a folder that you may write to with `--out DIR`",
            )
        })?;
        folder.lock()?;
        Ok(folder)
    }

    /// The folder at `path` with the checkpoint of its unfinished run.
    pub(crate) fn resume(path: &Path, scene_hash: &str) -> Result<(Self, Checkpoint), CliError> {
        let mut folder = Self { path: path.to_owned(), hashes: Map::new(), replaced: Vec::new(), lock: None };
        folder.lock()?;
        let Some(checkpoint) = Checkpoint::read(&folder.partial())? else {
            return Err(if path.join(SUMMARY).exists() {
                CliError::input(
                    format_args!("the run in {} has ended, there is nothing to resume", path.display()),
                    "run it again with `--force`, or into another folder with `--out DIR`",
                )
            } else {
                CliError::input(
                    format_args!("there is no unfinished run in {}", path.display()),
                    "name its folder with `--out DIR`, or leave out `--resume` to start one",
                )
            });
        };
        if checkpoint.muslin != env!("CARGO_PKG_VERSION") {
            return Err(CliError::input(
                format_args!(
                    "the unfinished run in {} is of muslin {}, but this is {}, which may compute other bits",
                    path.display(),
                    checkpoint.muslin,
                    env!("CARGO_PKG_VERSION")
                ),
                "go on with that version, or start again with `--force`",
            ));
        }
        if checkpoint.scene_hash != scene_hash {
            return Err(CliError::input(
                format_args!("the unfinished run in {} is of another scene or other data", path.display()),
                "give the same scene file, data files and `--set` again, or start again with `--force`",
            ));
        }
        Ok((folder, checkpoint))
    }

    /// Makes sure that no other process works on the run in progress, if there is one.
    fn lock(&mut self) -> Result<(), CliError> {
        self.lock = lock(
            &self.path,
            &self.partial(),
            "wait until it ends or stop it, or choose another folder with `--out DIR`",
        )?;
        Ok(())
    }

    /// Whether the file at `source` is one that a run with the data files `data` in this folder replaces or removes.
    fn would_overwrite(&self, source: &Path, data: &[&str]) -> bool {
        let Ok(source) = source.canonicalize() else { return false };
        let is_source = |path: PathBuf| path.canonicalize().is_ok_and(|path| path == source);
        let is_in_partial = self.partial().canonicalize().is_ok_and(|partial| source.starts_with(partial));
        is_in_partial || FILES.iter().chain(data).any(|name| is_source(self.path.join(name)))
    }

    /// Names and hashes of the data files that the summary in the folder records, if there is one.
    fn recorded_data(&self) -> Vec<(String, String)> {
        let summary = fs::read(self.path.join(SUMMARY)).unwrap_or_default();
        let summary: Value = serde_json::from_slice(&summary).unwrap_or_default();
        let files = summary["files"].as_object().into_iter().flatten();
        let files = files.filter_map(|(name, hash)| Some((name.clone(), hash.as_str()?.to_owned())));
        files.filter(|(name, _)| !is_run_file(name)).collect()
    }

    /// Removes the data files of the run that was replaced, if this one has none of their names. What was changed since
    /// is not the run's, and stays.
    pub(crate) fn remove_replaced_data(&self) -> Result<(), CliError> {
        for (name, hash) in &self.replaced {
            let path = self.path.join(name);
            let is_inside = Path::new(name).components().all(|part| matches!(part, Component::Normal(_)));
            let is_the_runs = is_inside && file_hash(&path).is_ok_and(|found| found == *hash);
            if is_the_runs && !self.hashes.contains_key(name) {
                fs::remove_file(&path).map_err(|error| CliError::write(&path, &error))?;
            }
        }
        Ok(())
    }

    /// Refuses a folder with files, unless they are those of an earlier run and may be replaced.
    fn require_replaceable(&self, existing: Existing) -> Result<(), CliError> {
        if !self.has_files() {
            return Ok(());
        }
        let path = self.path.display();
        match (existing, self.holds_run()) {
            (Existing::Replace, true) => Ok(()),
            (Existing::Replace, false) => Err(CliError::input(
                format_args!(
                    "{path} holds other files than those of a run, which `--force` does not replace"
                ),
                "choose another folder with `--out DIR`",
            )),
            (Existing::Keep, true) => Err(CliError::input(
                format_args!("{path} exists already and is not empty"),
                "replace its files with `--force`, or choose another folder with `--out DIR`",
            )),
            (Existing::Keep, false) => Err(CliError::input(
                format_args!("{path} exists already and is not empty"),
                "choose another folder with `--out DIR`",
            )),
        }
    }

    /// Whether the folder holds a run of this command, ended or not.
    fn holds_run(&self) -> bool {
        let is_summary = |bytes: Vec<u8>| {
            let summary: Option<Value> = serde_json::from_slice(&bytes).ok();
            let has = |key| summary.as_ref().is_some_and(|summary| summary.get(key).is_some());
            ["muslin", "scene_hash", "frame_hashes", "files"].into_iter().all(has)
        };
        Checkpoint::exists(&self.partial()) || fs::read(self.path.join(SUMMARY)).is_ok_and(is_summary)
    }

    /// Whether the folder holds anything but a run in progress.
    fn has_files(&self) -> bool {
        let entries = fs::read_dir(&self.path).into_iter().flatten().flatten();
        entries.into_iter().any(|entry| entry.file_name() != PARTIAL)
    }

    /// Where the run in progress is kept.
    pub(crate) fn partial(&self) -> PathBuf {
        self.path.join(PARTIAL)
    }

    /// The folder.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// SHA-256 of every file written so far, by name.
    pub(crate) fn hashes(&self) -> &Map<String, Value> {
        &self.hashes
    }

    /// Writes the file `name`, first inside the unfinished run and then, when whole, under its name.
    pub(crate) fn write(
        &mut self,
        name: &str,
        write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
    ) -> Result<(), CliError> {
        let hash = self.write_and_hash(name, write)?;
        self.hashes.insert(name.to_owned(), hash.into());
        Ok(())
    }

    /// The same with several files at once, on as many threads as the machine has; all of them, even if one cannot be written.
    pub(crate) fn write_together(&mut self, files: Vec<OutputFile<'_>>) -> Result<(), CliError> {
        let write = |OutputFile { name, write }| (name, self.write_and_hash(name, write));
        let written: Vec<_> = files.into_par_iter().map(write).collect();
        for (name, hash) in written {
            self.hashes.insert(name.to_owned(), hash?.into());
        }
        Ok(())
    }

    /// Writes the file `name` as [`write`](Self::write) does; its SHA-256.
    fn write_and_hash(
        &self,
        name: &str,
        write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
    ) -> Result<String, CliError> {
        let unfinished = self.partial().join(name);
        let path = self.path.join(name);
        // A data file may be in a folder.
        for folder in [unfinished.parent(), path.parent()].into_iter().flatten() {
            fs::create_dir_all(folder).map_err(|error| CliError::write(folder, &error))?;
        }
        write_whole(&unfinished, write)?;
        let finish = || {
            let hash = file_hash(&unfinished)?;
            fs::rename(&unfinished, &path)?;
            Ok(hash)
        };
        finish().map_err(|error| CliError::write(&path, &error))
    }

    /// Removes files of an earlier run that this one has none of.
    pub(crate) fn remove(&self, names: &[&str]) -> Result<(), CliError> {
        names
            .iter()
            .map(|name| self.path.join(name))
            .filter(|path| path.exists())
            .try_for_each(|path| fs::remove_file(&path).map_err(|error| CliError::write(&path, &error)))
    }

    /// Removes the run in progress, which nothing needs any more.
    pub(crate) fn remove_partial(&self) -> Result<(), CliError> {
        let partial = self.partial();
        fs::remove_dir_all(&partial).map_err(|error| CliError::write(&partial, &error))
    }
}

/// Keeps other processes from the folder `partial` within `path` for as long as the file lives.
///
/// Where nothing can be opened or locked there is no file: whatever comes next says why, or works without a lock.
pub(crate) fn lock(path: &Path, partial: &Path, help: &str) -> Result<Option<File>, CliError> {
    let Ok(lock) = File::options().create(true).append(true).open(partial.join(LOCK)) else {
        return Ok(None);
    };
    if matches!(lock.try_lock(), Err(TryLockError::WouldBlock)) {
        return Err(CliError::input(format_args!("another muslin is at work in {}", path.display()), help));
    }
    Ok(Some(lock))
}

/// Refuses the folder `path` whose file `name` is not there because its run has not ended.
pub(crate) fn require_ended(path: &Path, name: &str) -> Result<(), CliError> {
    if path.join(name).exists() || !Checkpoint::exists(&path.join(PARTIAL)) {
        return Ok(());
    }
    Err(CliError::input(
        format_args!("{} holds an unfinished run", path.display()),
        "go on with the same command and `--resume`",
    ))
}

/// SHA-256 of the bytes of a file, 64 hexadecimal digits.
pub(crate) fn file_hash(path: &Path) -> io::Result<String> {
    let mut hasher = Sha256::new();
    io::copy(&mut File::open(path)?, &mut HashWriter(&mut hasher))?;
    Ok(hex(&hasher.finalize()))
}

/// SHA-256 of `bytes`, 64 hexadecimal digits.
pub(crate) fn bytes_hash(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

/// What identifies the inputs of a run: SHA-256 of the scene's `text`; with data files, whose names and hashes are `data`,
/// that of the lines which `sha256sum scene.toml DATA...` prints, data files in the order of their names.
pub(crate) fn inputs_hash<N: AsRef<str>>(text: &str, data: impl IntoIterator<Item = (N, String)>) -> String {
    let scene = bytes_hash(text.as_bytes());
    let mut lines: Vec<String> =
        data.into_iter().map(|(name, hash)| format!("{hash}  {}\n", name.as_ref())).collect();
    if lines.is_empty() {
        return scene;
    }
    lines.insert(0, format!("{scene}  scene.toml\n"));
    bytes_hash(lines.concat().as_bytes())
}

/// Takes bytes into a hash.
struct HashWriter<'a>(&'a mut Sha256);

impl io::Write for HashWriter<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.update(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
