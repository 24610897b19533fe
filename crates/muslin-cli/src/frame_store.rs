//! The frames of a run on disk, and the checkpoint from which it can go on.

use std::fs::{self, File};
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use muslin::observe::{Frame, FrameRecord, Recorder, StepCounts};
use muslin::write::FrameSource;
use muslin::{Model, Points, State};
use serde::{Deserialize, Serialize};

use crate::error::CliError;

/// Name of the folder inside the output folder that holds a run in progress.
pub(crate) const PARTIAL: &str = ".partial";

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
    bytes: Vec<u8>,
}

/// What a run needs to go on from a frame, beside the frames themselves and the velocities of the half step before it.
#[derive(Serialize, Deserialize)]
pub(crate) struct Checkpoint {
    /// SHA-256 of the scene's text.
    pub(crate) scene_hash: String,
    pub(crate) frame_index: u64,
    time: f64,
    last_step: f64,
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
            let options = File::options().read(true).write(true).create(true).truncate(true).open(&path);
            options.map(|file| BufWriter::with_capacity(1 << 20, file)).map_err(|error| CliError::write(&path, &error))
        };
        Ok(Self {
            folder: folder.to_owned(),
            particle_count,
            frame_count: 0,
            positions: create(POSITIONS)?,
            velocities: create(VELOCITIES)?,
            bytes: Vec::new(),
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
                let mut file = File::options().read(true).write(true).open(&path)?;
                if file.metadata()?.len() < length {
                    return Err(io::Error::new(io::ErrorKind::UnexpectedEof, "it is shorter than its checkpoint says"));
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
            bytes: Vec::new(),
        })
    }

    /// Appends a frame.
    pub(crate) fn push(&mut self, frame: &Frame<'_>) -> Result<(), CliError> {
        interleave(&frame.state.positions, &mut self.bytes);
        let path = self.folder.join(POSITIONS);
        self.positions.write_all(&self.bytes).map_err(|error| CliError::write(&path, &error))?;
        interleave(frame.velocities, &mut self.bytes);
        let path = self.folder.join(VELOCITIES);
        self.velocities.write_all(&self.bytes).map_err(|error| CliError::write(&path, &error))?;
        self.frame_count += 1;
        Ok(())
    }

    /// Forgets all frames after the first `frame_count`, and makes the rest readable.
    pub(crate) fn finish(&mut self, frame_count: u64) -> Result<(), CliError> {
        self.flush()?;
        self.frame_count = self.frame_count.min(frame_count);
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
        interleave(&frame.state.velocities, &mut self.bytes);
        write_whole(&velocities, &self.bytes).map_err(|error| CliError::write(&velocities, &error))?;
        let checkpoint = Checkpoint {
            scene_hash: scene_hash.to_owned(),
            frame_index: frame.index,
            time: frame.state.time,
            last_step: frame.state.last_step,
            steps: *recorder.steps(),
            max_strains: recorder.max_strains(),
            frames: recorder.frames().to_vec(),
            wall_seconds,
            stepping_seconds,
        };
        let path = self.folder.join(CHECKPOINT);
        let text = serde_json::to_vec(&checkpoint).map_err(io::Error::from);
        text.and_then(|text| write_whole(&path, &text)).map_err(|error| CliError::write(&path, &error))?;
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

    fn flush(&mut self) -> Result<(), CliError> {
        for (file, name) in [(&mut self.positions, POSITIONS), (&mut self.velocities, VELOCITIES)] {
            file.flush().map_err(|error| CliError::write(&self.folder.join(name), &error))?;
        }
        Ok(())
    }

    /// Opens the raw positions and velocities for reading, each with its length in bytes.
    pub(crate) fn raw_arrays(&mut self) -> io::Result<[impl Read; 2]> {
        let length = self.frame_count * frame_bytes(self.particle_count);
        let open = |name: &str| File::open(self.folder.join(name)).map(|file| file.take(length));
        Ok([open(POSITIONS)?, open(VELOCITIES)?])
    }

    /// Overwrites `velocities` with those [m/s] of all particles in frame `frame`.
    pub(crate) fn read_velocities(&mut self, frame: usize, velocities: &mut Points) -> io::Result<()> {
        let offset = frame as u64 * frame_bytes(self.particle_count);
        read_points(self.velocities.get_mut(), offset, self.particle_count, velocities)
    }
}

impl FrameSource for FrameStore {
    fn frame_count(&self) -> usize {
        self.frame_count as usize
    }

    fn read_positions(&mut self, frame: usize, positions: &mut Points) -> io::Result<()> {
        let offset = frame as u64 * frame_bytes(self.particle_count);
        read_points(self.positions.get_mut(), offset, self.particle_count, positions)
    }
}

impl Checkpoint {
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
        let mut state = State::at_rest(Points::zeros(store.particle_count));
        (state.time, state.last_step) = (self.time, self.last_step);
        let path = store.folder.join(half_step_file(self.frame_index));
        let mut read = || {
            store.read_positions(self.frame_index as usize, &mut state.positions)?;
            read_points(&mut File::open(&path)?, 0, store.particle_count, &mut state.velocities)
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

/// Name of the file with the velocities [m/s] half a step before frame `frame_index`.
fn half_step_file(frame_index: u64) -> String {
    format!("{HALF_STEP_PREFIX}{frame_index}.f64")
}

/// Writes a file beside its name and renames it when whole.
pub(crate) fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let temporary = path.with_extension("new");
    fs::write(&temporary, bytes)?;
    fs::rename(&temporary, path)
}

/// Bytes of one array of one frame.
fn frame_bytes(particle_count: usize) -> u64 {
    24 * particle_count as u64
}

/// Overwrites `bytes` with `x y z` of each point as little-endian doubles.
fn interleave(points: &Points, bytes: &mut Vec<u8>) {
    bytes.clear();
    bytes.reserve(24 * points.len());
    for point in points.iter() {
        for value in point.to_array() {
            bytes.extend_from_slice(&value.to_le_bytes());
        }
    }
}

/// Overwrites `points` with the `count` points at byte `offset` of `file`.
fn read_points(file: &mut File, offset: u64, count: usize, points: &mut Points) -> io::Result<()> {
    file.seek(SeekFrom::Start(offset))?;
    let mut bytes = vec![0; 24 * count];
    file.read_exact(&mut bytes)?;
    if points.len() != count {
        *points = Points::zeros(count);
    }
    for (index, bytes) in bytes.chunks_exact(24).enumerate() {
        let value = |start: usize| {
            let mut value = [0; 8];
            value.copy_from_slice(&bytes[start..start + 8]);
            f64::from_le_bytes(value)
        };
        points.set(index, glam_vector([value(0), value(8), value(16)]));
    }
    Ok(())
}
