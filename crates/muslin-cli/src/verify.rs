//! `muslin verify`.

use std::fs::{self, File};
use std::io::BufReader;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use muslin::observe::{Recorder, StateHash};
use muslin::write::{FrameSource, MotionSource, TrajectoryReader};
use muslin::{Points, Scene, Simulation};
use serde_json::{Map, Value};

use crate::args::VerifyArguments;
use crate::error::CliError;
use crate::output::{SUMMARY, file_hash, inputs_hash, is_run_file, require_ended};
use crate::print_text;
use crate::progress::Progress;
use crate::run::{failure, timed_integrator, unstable};
use crate::scene_file::parse;
use crate::summary::{Ending, Summary, outcomes};
use crate::timing::SteppingTime;

const HELP: &str = "name a folder that `muslin run` wrote";

/// Keys of the summary that are compared elsewhere or are not the same in every run.
const UNCOMPARED: [&str; 8] = [
    "muslin",
    "final_state_hash",
    "frame_hashes",
    "files",
    "threads",
    "wall_time",
    "stepping_time",
    "particle_steps_per_second",
];

/// How many differing keys are named at most.
const KEYS_NAMED: usize = 4;

/// What a folder's summary says, as far as it can be verified.
struct Recorded {
    version: String,
    scene_hash: String,
    frame_hashes: Vec<String>,
    final_state_hash: String,
    files: Vec<(String, String)>,
    json: Value,
}

/// Compares every file of a folder with its hash, then runs its scene again and compares every frame and the summary.
pub(crate) fn verify(arguments: &VerifyArguments) -> Result<(), CliError> {
    let dir = &arguments.dir;
    let recorded = Recorded::read(dir)?;
    let text = read_scene(dir)?;
    let mut faults = recorded.file_faults(dir);
    faults.extend(trajectory_fault(dir, &recorded.frame_hashes));
    if recorded.frame_hashes.last() != Some(&recorded.final_state_hash) {
        faults.push("summary.json: `final_state_hash` is not the last of `frame_hashes`".to_owned());
    }
    match recorded.input_fault(dir, &text) {
        Some(fault) => faults.push(fault),
        None => {
            let path = dir.join("scene.toml");
            let scene = parse(&path, &path.display().to_string(), &text)?;
            faults.extend(rerun_fault(&scene, &recorded, arguments)?);
        }
    }
    if faults.is_empty() {
        let frames = recorded.frame_hashes.len();
        return print_text(&format!(
            "{}: verified: {} files unchanged, {frames} frames computed again with the same bits\n",
            dir.display(),
            recorded.files.len()
        ));
    }
    Err(CliError::failed(
        format_args!("{} is not what its summary says\n  {}", dir.display(), faults.join("\n  ")),
        "run the scene again if a file was changed by mistake",
    ))
}

impl Recorded {
    fn read(dir: &Path) -> Result<Self, CliError> {
        require_ended(dir, SUMMARY)?;
        let path = dir.join(SUMMARY);
        let bytes = fs::read(&path).map_err(|error| CliError::read(&path, &error, HELP))?;
        let damaged =
            |reason: &str| CliError::input(format_args!("{} is damaged: {reason}", path.display()), HELP);
        let json: Value = serde_json::from_slice(&bytes).map_err(|error| damaged(&error.to_string()))?;
        let text = |key: &str| {
            let value = json[key].as_str().map(str::to_owned);
            value.ok_or_else(|| damaged(&format!("`{key}` is missing")))
        };
        let hashes = json["frame_hashes"].as_array().ok_or_else(|| damaged("`frame_hashes` is missing"))?;
        let files = json["files"].as_object().ok_or_else(|| damaged("`files` is missing"))?;
        Ok(Self {
            version: text("muslin")?,
            scene_hash: text("scene_hash")?,
            final_state_hash: text("final_state_hash")?,
            frame_hashes: hashes.iter().map(|hash| hash.as_str().unwrap_or_default().to_owned()).collect(),
            files: files
                .iter()
                .map(|(name, hash)| (name.clone(), hash.as_str().unwrap_or_default().to_owned()))
                .collect(),
            json,
        })
    }

    /// Whom a difference may be put down to, if the folder is of another version.
    fn version_note(&self) -> String {
        let this = env!("CARGO_PKG_VERSION");
        if self.version == this {
            return String::new();
        }
        format!(" (the folder is of muslin {}, this is {this})", self.version)
    }

    /// What the summary says otherwise than `summary`, which was computed again.
    fn summary_fault(&self, summary: &Value) -> Option<String> {
        let mut keys = Vec::new();
        for (key, value) in summary.as_object().into_iter().flatten() {
            if !UNCOMPARED.contains(&key.as_str()) {
                add_differing_keys(key, value, &self.json[key], &mut keys);
            }
        }
        let more = keys.len().saturating_sub(KEYS_NAMED);
        keys.truncate(KEYS_NAMED);
        if keys.is_empty() {
            return None;
        }
        let more = if more == 0 { String::new() } else { format!(" and {more} more") };
        let (keys, note) = (keys.join(", "), self.version_note());
        Some(format!("summary.json: not what was computed again: {keys}{more}{note}"))
    }

    /// Which input in `dir`, whose scene is `text`, is not that of this run.
    fn input_fault(&self, dir: &Path, text: &str) -> Option<String> {
        let data = self.files.iter().filter(|(name, _)| !is_run_file(name));
        let hashes: Vec<(&str, String)> =
            data.map(|(name, _)| (name.as_str(), file_hash(&dir.join(name)).unwrap_or_default())).collect();
        if inputs_hash(text, hashes) == self.scene_hash {
            return None;
        }
        let mut data = self.files.iter().filter(|(name, _)| !is_run_file(name));
        let changed = data.find(|(name, hash)| !file_hash(&dir.join(name)).is_ok_and(|found| found == *hash));
        let name = changed.map_or("scene.toml", |(name, _)| name.as_str());
        let what = if name == "scene.toml" { "the scene" } else { "the data" };
        Some(format!("{name} is not {what} of this run, so that it was not run again"))
    }

    /// Files that are gone or whose bytes have changed.
    fn file_faults(&self, dir: &Path) -> Vec<String> {
        let fault = |(name, hash): &(String, String)| match file_hash(&dir.join(name)) {
            Ok(found) if found == *hash => None,
            Ok(_) => Some(format!("{name} was changed")),
            Err(error) => Some(format!("{name} could not be read: {}", crate::error::reason(&error))),
        };
        self.files.iter().filter_map(fault).collect()
    }
}

fn read_scene(dir: &Path) -> Result<String, CliError> {
    let path = dir.join("scene.toml");
    fs::read_to_string(&path).map_err(|error| CliError::read(&path, &error, HELP))
}

/// The frames of `trajectory.npz` that differ from their hashes.
fn trajectory_fault(dir: &Path, frame_hashes: &[String]) -> Option<String> {
    // That the file cannot be opened is a fault of its own already.
    let file = File::open(dir.join("trajectory.npz")).ok()?;
    let mut trajectory = match TrajectoryReader::new(BufReader::new(file)) {
        Ok(trajectory) => trajectory,
        Err(error) => return Some(format!("trajectory.npz cannot be read: {error}")),
    };
    if trajectory.frame_count() != frame_hashes.len() {
        let (found, expected) = (trajectory.frame_count(), frame_hashes.len());
        return Some(format!("trajectory.npz has {found} frames, but the summary has {expected}"));
    }
    let (mut positions, mut velocities) = (Points::default(), Points::default());
    let mut differing = Vec::new();
    for (frame, expected) in frame_hashes.iter().enumerate() {
        let read = trajectory
            .read_positions(frame, &mut positions)
            .and_then(|()| trajectory.read_velocities(frame, &mut velocities));
        if read.is_err() || StateHash::new(&positions, &velocities).to_string() != *expected {
            differing.push(frame);
        }
    }
    let first = *differing.first()?;
    let time = trajectory.times()[first];
    Some(match differing.len() {
        1 => format!("trajectory.npz: frame {first} ({time:.6} s) differs"),
        count => format!("trajectory.npz: {count} frames differ, the first is frame {first} ({time:.6} s)"),
    })
}

/// Adds to `keys` where `found` is not `expected`, as dotted paths below `key` with what is found.
fn add_differing_keys(key: &str, expected: &Value, found: &Value, keys: &mut Vec<String>) {
    match (expected, found) {
        (Value::Object(expected), Value::Object(_)) => {
            for (name, value) in expected {
                add_differing_keys(&format!("{key}.{name}"), value, &found[name], keys);
            }
        }
        _ if expected != found => keys.push(format!("`{key}`")),
        _ => {}
    }
}

/// What a new run has otherwise than the recorded one: its first differing frame, or else its summary.
fn rerun_fault(
    scene: &Scene,
    recorded: &Recorded,
    arguments: &VerifyArguments,
) -> Result<Option<String>, CliError> {
    let integrator = timed_integrator(scene, arguments.threads, &SteppingTime::default())?;
    let mut simulation = Simulation::new(scene, integrator).map_err(|error| unstable(&error))?;
    let never = AtomicBool::new(false);
    let mut progress = Progress::new(scene.run(), 0.0, &never);
    let mut recorder = Recorder::default();
    let mut fault = differing_frame(&mut simulation, recorded, &mut recorder, &mut progress);
    if fault.is_none() {
        let ending = ending_again(&mut simulation, recorded, &mut recorder, &mut progress);
        let summary = summary_again(scene, &simulation, recorded, &recorder, &ending);
        fault = recorded.summary_fault(&summary);
    }
    progress.finish();
    Ok(fault)
}

/// How the run ends after its last recorded frame.
fn ending_again(
    simulation: &mut Simulation,
    recorded: &Recorded,
    recorder: &mut Recorder,
    progress: &mut Progress<'_>,
) -> Ending {
    if simulation.is_finished() {
        return Ending::Complete;
    }
    if recorded.json["status"] != "failed" {
        return Ending::Interrupted;
    }
    match simulation.advance(&mut [recorder, progress]) {
        Err(error) => Ending::Failed(failure(simulation.model(), &error)),
        Ok(()) => Ending::Interrupted,
    }
}

/// The summary of what was computed again, as it is when read from its file.
fn summary_again(
    scene: &Scene,
    simulation: &Simulation,
    recorded: &Recorded,
    recorder: &Recorder,
    ending: &Ending,
) -> Value {
    let summary = Summary {
        scene,
        scene_hash: &recorded.scene_hash,
        model: simulation.model(),
        recorder,
        ending,
        outcomes: &outcomes(scene, recorder, ending),
        files: &Map::new(),
        threads: 0,
        wall_seconds: 0.0,
        stepping_seconds: 0.0,
    };
    let json = summary.to_json();
    // Whole numbers have no sign of their own in a file.
    serde_json::from_str(&json.to_string()).unwrap_or(json)
}

fn differing_frame(
    simulation: &mut Simulation,
    recorded: &Recorded,
    recorder: &mut Recorder,
    progress: &mut Progress<'_>,
) -> Option<String> {
    simulation.observe(&mut [recorder]);
    for (frame, expected) in recorded.frame_hashes.iter().enumerate() {
        let current = simulation.frame();
        if StateHash::new(&current.state.positions, current.velocities).to_string() != *expected {
            let time = current.state.time;
            let note = recorded.version_note();
            return Some(format!("computed again, frame {frame} ({time:.6} s) differs{note}"));
        }
        if frame + 1 == recorded.frame_hashes.len() {
            break;
        }
        if simulation.is_finished() {
            return Some(format!("the scene ends at frame {frame}, but the summary has more"));
        }
        if let Err(error) = simulation.advance(&mut [recorder, progress]) {
            return Some(format!("computed again, {error}"));
        }
    }
    None
}
