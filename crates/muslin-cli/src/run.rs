//! `muslin run`.

use std::io::stdout;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use muslin::integrate::{Integrator, StepError, Workers};
use muslin::observe::Recorder;
use muslin::scene::DataFile;
use muslin::{Model, Scene, Simulation, SimulationError};

use crate::args::RunArguments;
use crate::error::CliError;
use crate::file_progress::FileProgress;
use crate::files::write_files;
use crate::frame_store::FrameStore;
use crate::output::{Existing, OutputFolder};
use crate::progress::Progress;
use crate::report::report;
use crate::scene_file::SceneFile;
use crate::summary::Ending;
use crate::timing::{SteppingTime, TimedIntegrator};

/// Wall time between two checkpoints at least; so much work may be lost when the process is killed.
const CHECKPOINT_INTERVAL: Duration = Duration::from_millis(200);

/// Wall time between two checkpoints at least, as a multiple of what the last one took: they must cost next to nothing.
const CHECKPOINT_COSTS: u32 = 50;

/// Particles from which on a second thread pays.
const PARTICLES_PER_THREAD: usize = 8192;

/// Runs a scene, writes its folder and says what came out.
pub(crate) fn run(arguments: &RunArguments) -> Result<(), CliError> {
    let file = SceneFile::read(&arguments.scene, &arguments.assignments)?;
    let scene_hash = file.hash();
    let path = arguments.out.clone().unwrap_or_else(|| default_folder(&arguments.scene));
    let time = SteppingTime::default();
    let integrator = timed_integrator(&file.scene, arguments.threads, &time)?;
    let interrupted = interruption()?;
    let mut run = if arguments.resume {
        Run::resume(&file.scene, &path, &scene_hash, integrator, time)?
    } else {
        let existing = if arguments.force { Existing::Replace } else { Existing::Keep };
        let data = file.scene.data_files().iter().map(DataFile::name);
        let output = || OutputFolder::create(&path, existing, &arguments.scene, data);
        Run::start(&file.scene, output, scene_hash, integrator, time)?
    };
    let ending = run.go_on(&interrupted)?;
    let progress = FileProgress::new(interrupted);
    let outcomes = write_files(&mut run, &file, &ending, &progress)?;
    drop(progress);
    report(&mut stdout().lock(), &run, &file, &ending, &outcomes)
}

/// A run and what it writes to.
pub(crate) struct Run<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) scene_hash: String,
    pub(crate) simulation: Simulation,
    pub(crate) recorder: Recorder,
    pub(crate) store: FrameStore,
    pub(crate) output: OutputFolder,
    pub(crate) threads: usize,
    time: SteppingTime,
    start: Instant,
    /// Wall and stepping time [s] of the run before it was resumed.
    earlier: [f64; 2],
}

impl<'a> Run<'a> {
    /// A new run in the folder that `output` makes once the scene has proved to be good.
    fn start(
        scene: &'a Scene,
        output: impl FnOnce() -> Result<OutputFolder, CliError>,
        scene_hash: String,
        integrator: Box<dyn Integrator>,
        time: SteppingTime,
    ) -> Result<Self, CliError> {
        let threads = integrator.workers().count();
        let simulation = Simulation::new(scene, integrator).map_err(|error| unstable(&error))?;
        let output = output()?;
        let store = FrameStore::create(&output.partial(), simulation.model().particles().len())?;
        let mut run = Self {
            scene,
            scene_hash,
            simulation,
            recorder: Recorder::default(),
            store,
            output,
            threads,
            time,
            start: Instant::now(),
            earlier: [0.0; 2],
        };
        run.simulation.observe(&mut [&mut run.recorder]);
        run.store.push(&run.simulation.frame())?;
        run.save_checkpoint()?;
        Ok(run)
    }

    /// The unfinished run in the folder `path`.
    fn resume(
        scene: &'a Scene,
        path: &Path,
        scene_hash: &str,
        integrator: Box<dyn Integrator>,
        time: SteppingTime,
    ) -> Result<Self, CliError> {
        let threads = integrator.workers().count();
        let (output, checkpoint) = OutputFolder::resume(path, scene_hash)?;
        let model = Model::new(scene);
        let mut store = FrameStore::open(&output.partial(), model.particles().len(), &checkpoint)?;
        let state = checkpoint.state(&mut store)?;
        let earlier = [checkpoint.wall_seconds, checkpoint.stepping_seconds];
        let frame_index = checkpoint.frame_index;
        let recorder = checkpoint.recorder(&model, &state);
        let simulation =
            Simulation::resume(scene, integrator, state, frame_index).map_err(|error| unstable(&error))?;
        Ok(Self {
            scene,
            scene_hash: scene_hash.to_owned(),
            simulation,
            recorder,
            store,
            output,
            threads,
            time,
            start: Instant::now(),
            earlier,
        })
    }

    /// Steps until the last frame, an interruption or a failed step. All frames before that are then in the store.
    fn go_on(&mut self, interrupted: &AtomicBool) -> Result<Ending, CliError> {
        let mut progress = Progress::new(self.scene.run(), self.simulation.frame().state.time, interrupted);
        let ending = self.step_to_end(interrupted, &mut progress);
        progress.finish();
        let ending = ending?;
        if ending != Ending::Interrupted && ending != Ending::Complete {
            self.store.flush()?;
        } else {
            self.save_checkpoint()?;
        }
        Ok(ending)
    }

    fn step_to_end(
        &mut self,
        interrupted: &AtomicBool,
        progress: &mut Progress<'_>,
    ) -> Result<Ending, CliError> {
        let mut next_checkpoint = Instant::now() + CHECKPOINT_INTERVAL;
        while !self.simulation.is_finished() {
            if interrupted.load(Ordering::Relaxed) {
                return Ok(Ending::Interrupted);
            }
            if let Err(error) = self.simulation.advance(&mut [&mut self.recorder, progress]) {
                return Ok(Ending::Failed(failure(self.simulation.model(), &error)));
            }
            self.store.push(&self.simulation.frame())?;
            let start = Instant::now();
            if next_checkpoint <= start {
                self.save_checkpoint()?;
                let cost = start.elapsed();
                next_checkpoint = start + CHECKPOINT_INTERVAL.max(CHECKPOINT_COSTS * cost);
            }
        }
        Ok(Ending::Complete)
    }

    fn save_checkpoint(&mut self) -> Result<(), CliError> {
        let times = self.times();
        self.store.save_checkpoint(&self.simulation.frame(), &self.recorder, &self.scene_hash, times)
    }

    /// Wall time and time spent in steps [s], those before it was resumed included.
    pub(crate) fn times(&self) -> [f64; 2] {
        [self.earlier[0] + self.start.elapsed().as_secs_f64(), self.earlier[1] + self.time.seconds()]
    }
}

/// The scene's method on `threads` threads, or as many as suit the size of the cloth.
pub(crate) fn timed_integrator(
    scene: &Scene,
    threads: Option<NonZeroUsize>,
    time: &SteppingTime,
) -> Result<Box<dyn Integrator>, CliError> {
    let threads = threads.unwrap_or_else(|| {
        let useful =
            NonZeroUsize::new(scene.particle_count() / PARTICLES_PER_THREAD).unwrap_or(NonZeroUsize::MIN);
        std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN).min(useful)
    });
    let workers = Workers::new(threads).map_err(|error| {
        CliError::input(
            format_args!("{threads} threads cannot be started: {error}"),
            "ask for fewer with `--threads`",
        )
    })?;
    Ok(Box::new(TimedIntegrator::new(Simulation::integrator(scene, workers), time.clone())))
}

/// A flag that Ctrl-C sets; a second Ctrl-C ends the process at once.
pub(crate) fn interruption() -> Result<Arc<AtomicBool>, CliError> {
    let flag = Arc::new(AtomicBool::new(false));
    let handler_flag = Arc::clone(&flag);
    ctrlc::set_handler(move || {
        if handler_flag.swap(true, Ordering::Relaxed) {
            std::process::exit(1);
        }
    })
    .map_err(|error| CliError::failed(format_args!("Ctrl-C cannot be caught: {error}"), "try again"))?;
    Ok(flag)
}

/// `out/NAME` for the scene file NAME.toml.
fn default_folder(scene: &Path) -> PathBuf {
    Path::new("out").join(scene.file_stem().unwrap_or(scene.as_os_str()))
}

/// The message of a scene whose step is too large.
pub(crate) fn unstable(error: &SimulationError) -> CliError {
    match error {
        SimulationError::UnstableStep { suggestion, .. } => CliError::input(
            error,
            format_args!(
                "leave `step` out, so that it is adaptive, take `step = {{ constant = {suggestion:.12e} }}`, or try it all \
                 the same with `--set run.allow-unstable=true`"
            ),
        ),
        other => CliError::input(other, "change the scene"),
    }
}

/// What a failed step means to a person: where, when, and what to do.
pub(crate) fn failure(model: &Model, error: &StepError) -> String {
    let (particle, time) = match *error {
        StepError::NotFinite { particle, time } => (particle, time),
        StepError::TooShort { time, shortest } => {
            return format!(
                "at {time:.6} s the adaptive step would have to be shorter than {shortest:.3e} s: the motion is no \
                 longer finite there, or no step is short enough for the stiffness or the tolerance"
            );
        }
        _ => return error.to_string(),
    };
    let cell = |(name, grid): (&str, muslin::model::Grid)| {
        grid.cell(particle).map(|(column, row)| format!(" (column {column}, row {row} of cloth `{name}`)"))
    };
    let place = model.cloths().iter().find_map(|cloth| cell((&cloth.name, cloth.grid))).unwrap_or_default();
    format!("particle {particle}{place} has no finite position or velocity at {time:.6} s")
}
