//! The frames of a run on disk, and the checkpoint from which it can go on.

use std::fs::{self, File};
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use muslin::observe::{Frame, FrameRecord, Recorder, StepCounts};
use muslin::write::{
    FrameSource, MotionSource, POINT_BYTES, read_points, read_values, write_points, write_values,
};
use muslin::{Model, Points, State, StepMemory};
use serde::{Deserialize, Serialize};

use crate::error::CliError;

const POSITIONS: &str = "positions.f64";
const VELOCITIES: &str = "velocities.f64";
const CHECKPOINT: &str = "checkpoint.json";

/// The frames of a run in progress: raw little-endian doubles, `x y z` per particle, frame after frame.
pub(crate) struct FrameStore {
    folder: PathBuf,
    particle_count: usize,
    frame_count: u64,
    positions: BufWriter<File>,
    velocities: BufWriter<File>,
}

/// What a run needs to go on from a frame, beside the frames themselves and, in a file of their own, the velocities of the
/// half step before it with what forces remember.
#[derive(Serialize, Deserialize)]
pub(crate) struct Checkpoint {
    /// Version of muslin; another one may compute other bits.
    pub(crate) muslin: String,
    /// SHA-256 of the scene's text.
    pub(crate) scene_hash: String,
    pub(crate) frame_index: u64,
    time: f64,
    last_step: f64,
    step_memory: StepMemory,
    /// How many values forces remember.
    memory_values: usize,
    steps: StepCounts,
    max_strains: [Option<f64>; 3],
    frames: Vec<FrameRecord>,
    pub(crate) wall_seconds: f64,
    pub(crate) stepping_seconds: f64,
}

impl FrameStore {
    /// An empty store in the new folder `folder`.
    pub(crate) fn create(folder: &Path, particle_count: usize) -> Result<Self, CliError> {
        fs::create_dir_all(folder).map_err(|error| CliError::write(folder, &error))?;
        let create = |name: &str| {
            let path = folder.join(name);
            let file = File::options().write(true).create(true).truncate(true).open(&path);
            file.map(|file| BufWriter::with_capacity(1 << 20, file))
                .map_err(|error| CliError::write(&path, &error))
        };
        Ok(Self {
            folder: folder.to_owned(),
            particle_count,
            frame_count: 0,
            positions: create(POSITIONS)?,
            velocities: create(VELOCITIES)?,
        })
    }

    /// The store in `folder`, cut to the frames up to the checkpoint.
    pub(crate) fn open(
        folder: &Path,
        particle_count: usize,
        checkpoint: &Checkpoint,
    ) -> Result<Self, CliError> {
        let frame_count = checkpoint.frame_index + 1;
        let length = frame_count * frame_bytes(particle_count);
        let open = |name: &str| {
            let path = folder.join(name);
            let open = || {
                let mut file = File::options().write(true).open(&path)?;
                if file.metadata()?.len() < length {
                    return Err(io::Error::new(
                        io::ErrorKind::UnexpectedEof,
                        "it is shorter than its checkpoint says",
                    ));
                }
                file.set_len(length)?;
                file.seek(SeekFrom::End(0))?;
                Ok(BufWriter::with_capacity(1 << 20, file))
            };
            open().map_err(|error| CliError::read(&path, &error, "start again with `--force`"))
        };
        Ok(Self {
            folder: folder.to_owned(),
            particle_count,
            frame_count,
            positions: open(POSITIONS)?,
            velocities: open(VELOCITIES)?,
        })
    }

    /// Appends a frame.
    pub(crate) fn push(&mut self, frame: &Frame<'_>) -> Result<(), CliError> {
        let arrays = [
            (&mut self.positions, &frame.state.positions, POSITIONS),
            (&mut self.velocities, frame.velocities, VELOCITIES),
        ];
        for (file, points, name) in arrays {
            write_points(file, points).map_err(|error| CliError::write(&self.folder.join(name), &error))?;
        }
        self.frame_count += 1;
        Ok(())
    }

    /// Replaces the checkpoint by one at `frame`, the last that was appended.
    pub(crate) fn save_checkpoint(
        &mut self,
        frame: &Frame<'_>,
        recorder: &Recorder,
        scene_hash: &str,
        [wall_seconds, stepping_seconds]: [f64; 2],
    ) -> Result<(), CliError> {
        self.flush()?;
        let velocities = self.folder.join(half_step_file(frame.index));
        write_whole(&velocities, |out| {
            write_points(out, &frame.state.velocities)?;
            write_values(out, &frame.state.memory)
        })?;
        let checkpoint = Checkpoint {
            muslin: env!("CARGO_PKG_VERSION").to_owned(),
            scene_hash: scene_hash.to_owned(),
            frame_index: frame.index,
            time: frame.state.time,
            last_step: frame.state.last_step,
            step_memory: frame.state.step_memory,
            memory_values: frame.state.memory.len(),
            steps: *recorder.steps(),
            max_strains: recorder.max_strains(),
            frames: recorder.frames().to_vec(),
            wall_seconds,
            stepping_seconds,
        };
        let path = self.folder.join(CHECKPOINT);
        write_whole(&path, |out| Ok(serde_json::to_writer(out, &checkpoint)?))?;
        self.remove_older_half_steps(frame.index);
        Ok(())
    }

    /// Removes the velocities of checkpoints before `frame_index`. What cannot be removed does no harm.
    fn remove_older_half_steps(&self, frame_index: u64) {
        let keep = half_step_file(frame_index);
        for entry in fs::read_dir(&self.folder).into_iter().flatten().flatten() {
            let name = entry.file_name();
            if name.to_string_lossy().starts_with(HALF_STEP_PREFIX) && *name != *keep {
                let _ = fs::remove_file(entry.path());
            }
        }
    }

    /// Its frames so far, to be read beside others that do.
    pub(crate) fn reader(&mut self) -> Result<FrameReader, CliError> {
        self.flush()?;
        let open = |name: &str| {
            let path = self.folder.join(name);
            File::open(&path).map_err(|error| CliError::read(&path, &error, "start again with `--force`"))
        };
        Ok(FrameReader {
            particle_count: self.particle_count,
            frame_count: self.frame_count,
            positions: open(POSITIONS)?,
            velocities: open(VELOCITIES)?,
        })
    }

    /// Makes all frames readable.
    pub(crate) fn flush(&mut self) -> Result<(), CliError> {
        for (file, name) in [(&mut self.positions, POSITIONS), (&mut self.velocities, VELOCITIES)] {
            file.flush().map_err(|error| CliError::write(&self.folder.join(name), &error))?;
        }
        Ok(())
    }
}

/// The frames of a [`FrameStore`], in files that it has opened for itself.
pub(crate) struct FrameReader {
    particle_count: usize,
    frame_count: u64,
    positions: File,
    velocities: File,
}

impl FrameSource for FrameReader {
    fn frame_count(&self) -> usize {
        self.frame_count as usize
    }

    fn read_positions(&mut self, frame: usize, positions: &mut Points) -> io::Result<()> {
        let offset = frame as u64 * frame_bytes(self.particle_count);
        read_at(&mut self.positions, offset, self.particle_count, positions)
    }
}

impl MotionSource for FrameReader {
    fn read_velocities(&mut self, frame: usize, velocities: &mut Points) -> io::Result<()> {
        let offset = frame as u64 * frame_bytes(self.particle_count);
        read_at(&mut self.velocities, offset, self.particle_count, velocities)
    }
}

impl Checkpoint {
    /// Whether there is a checkpoint in `folder`.
    pub(crate) fn exists(folder: &Path) -> bool {
        folder.join(CHECKPOINT).exists()
    }

    /// The checkpoint in `folder`, if there is one.
    pub(crate) fn read(folder: &Path) -> Result<Option<Self>, CliError> {
        let path = folder.join(CHECKPOINT);
        let bytes = match fs::read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(CliError::read(&path, &error, "start again with `--force`")),
        };
        serde_json::from_slice(&bytes).map(Some).map_err(|error| {
            CliError::input(
                format_args!("{} is damaged: {error}", path.display()),
                "start again with `--force`",
            )
        })
    }

    /// The state at the checkpoint, whose positions are those of its frame in `store`.
    pub(crate) fn state(&self, store: &mut FrameStore) -> Result<State, CliError> {
        let mut frames = store.reader()?;
        let mut state = State::at_rest(Points::zeros(store.particle_count));
        (state.time, state.last_step, state.step_memory) = (self.time, self.last_step, self.step_memory);
        let path = store.folder.join(half_step_file(self.frame_index));
        let mut read = || {
            frames.read_positions(self.frame_index as usize, &mut state.positions)?;
            let mut file = File::open(&path)?;
            read_points(&mut file, store.particle_count, &mut state.velocities)?;
            // A damaged number must not ask for more memory than there is.
            let values = file.metadata()?.len().saturating_sub(frame_bytes(store.particle_count)) / 8;
            if values < self.memory_values as u64 {
                return Err(io::Error::new(
                    io::ErrorKind::UnexpectedEof,
                    "it is shorter than its checkpoint says",
                ));
            }
            state.memory.resize(self.memory_values, 0.0);
            read_values(&mut file, &mut state.memory)
        };
        read().map_err(|error| CliError::read(&path, &error, "start again with `--force`"))?;
        Ok(state)
    }

    /// The recorder as it was at the checkpoint, whose state is `state`.
    pub(crate) fn recorder(self, model: &Model, state: &State) -> Recorder {
        Recorder::resume(model, state, self.steps, self.max_strains, self.frames)
    }
}

const HALF_STEP_PREFIX: &str = "half-step-velocities-";

/// Name of the file with the velocities [m/s] half a step before frame `frame_index`, and what forces remember there.
fn half_step_file(frame_index: u64) -> String {
    format!("{HALF_STEP_PREFIX}{frame_index}.f64")
}

/// Writes a file beside its name and renames it when whole.
pub(crate) fn write_whole(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), CliError> {
    let mut temporary = path.as_os_str().to_owned();
    temporary.push(".new");
    let write = || {
        let mut out = BufWriter::with_capacity(1 << 20, File::create(&temporary)?);
        write(&mut out)?;
        out.into_inner().map_err(io::IntoInnerError::into_error)?;
        fs::rename(&temporary, path)
    };
    write().map_err(|error| {
        // What is not whole must not take up room that the way out may need.
        let _ = fs::remove_file(&temporary);
        CliError::write(path, &error)
    })
}

/// Bytes of one array of one frame.
fn frame_bytes(particle_count: usize) -> u64 {
    (POINT_BYTES * particle_count) as u64
}

/// Overwrites `points` with the `count` points at byte `offset` of `file`.
fn read_at(file: &mut File, offset: u64, count: usize, points: &mut Points) -> io::Result<()> {
    file.seek(SeekFrom::Start(offset))?;
    read_points(file, count, points)
}
