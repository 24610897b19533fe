//! The files of a finished run.

use std::io;

use muslin::force::{Configuration, Family};
use muslin::observe::{EnergyTerms, ExpectOutcome, FrameRecord};
use muslin::scene::StepRule;
use muslin::write::{
    FrameSource, GlbInfo, ViewInfo, ViewSeries, write_glb, write_poster, write_series, write_trajectory,
    write_view,
};
use muslin::{Model, Points};

use crate::error::CliError;
use crate::file_progress::FileProgress;
use crate::frame_store::FrameReader;
use crate::output::{OutputFile, SUMMARY};
use crate::progress::{duration_text, strain_text};
use crate::run::Run;
use crate::scene_file::SceneFile;
use crate::summary::{Ending, Summary, method_name, outcomes};

/// Vertices per cloth in `cloth.glb` at most.
pub(crate) const GLB_VERTICES: usize = 66_000;

/// Vertices per cloth in `view.html` at most.
pub(crate) const VIEW_VERTICES: usize = 16_400;

/// Vertices per cloth in `poster.png` at most.
const POSTER_VERTICES: usize = 80_000;

/// Drawn coordinates of a failed run relative to the largest one at time zero, at most: more shows only that it failed.
const FAILED_LIMIT: f64 = 3.0;

/// Drawn coordinates [m] at most: single precision holds the squares of distances up to there.
const PICTURE_LIMIT: f64 = 1e18;

/// Width and height of `poster.png` [pixels].
const POSTER_SIZE: [u32; 2] = [1280, 720];

/// Writes all files of `run`, the summary last, and removes the run in progress unless it can go on.
pub(crate) fn write_files(
    run: &mut Run<'_>,
    file: &SceneFile,
    ending: &Ending,
    progress: &FileProgress,
) -> Result<Vec<ExpectOutcome>, CliError> {
    let model = run.simulation.model();
    let (scene, frames, output) = (run.scene, run.recorder.frames(), &mut run.output);
    let store = &mut run.store;
    let times: Vec<f64> = frames.iter().map(|frame| frame.time).collect();
    let pins: Vec<u32> = model.particles().pins().map(|particle| particle as u32).collect();
    progress.writing("scene.toml");
    output.write("scene.toml", |out| io::Write::write_all(out, file.text.as_bytes()))?;
    for data in scene.data_files() {
        progress.writing("data files");
        output.write(data.name(), |out| io::Write::write_all(out, data.bytes()))?;
    }
    let drawn = drawn_frames(&mut store.reader()?, matches!(ending, Ending::Failed(_)))
        .map_err(|error| CliError::write(&output.partial(), &error))?;
    let mut motion = store.reader()?;
    let trajectory = OutputFile::new("trajectory.npz", move |out| {
        write_trajectory(out, &times, &model.surface(usize::MAX).triangles, &mut motion)
    });
    let series = OutputFile::new("series.csv", |out| {
        let columns = series_columns(frames);
        let columns: Vec<(&str, &[f64])> =
            columns.iter().map(|(name, values)| (name.as_str(), &values[..])).collect();
        write_series(out, &columns)
    });
    if drawn == 0 {
        output.remove(&["cloth.glb", "poster.png", "view.html"])?;
        progress.writing("trajectory.npz");
        output.write_together(vec![trajectory, series])?;
    } else {
        let mut pictures =
            || Ok::<_, CliError>(PictureFrames { reader: store.reader()?, frame_count: drawn });
        let [mut of_glb, mut of_poster, mut of_view] = [pictures()?, pictures()?, pictures()?];
        let names: Vec<&str> = model.cloths().iter().map(|cloth| cloth.name.as_str()).collect();
        let (title, frame_rate) = (scene.title(), scene.run().frame_rate);
        let glb = OutputFile::new("cloth.glb", |out| {
            let info = GlbInfo { title, cloth_names: &names, frame_rate };
            write_glb(out, &info, &model.surface(GLB_VERTICES), &mut of_glb)
        });
        let poster = OutputFile::new("poster.png", |out| {
            let mut positions = Points::default();
            of_poster.read_positions(drawn - 1, &mut positions)?;
            write_poster(out, &model.surface(POSTER_VERTICES), &positions, &pins, POSTER_SIZE)
        });
        let info = view_info(run.scene, model, &run.recorder, ending);
        let view = OutputFile::new("view.html", |out| {
            let surface = model.surface(VIEW_VERTICES);
            write_view(out, &info, &surface, &pins, &mut particle_strains(model), &mut of_view)
        });
        progress.writing("trajectory.npz, cloth.glb, poster.png and view.html");
        output.write_together(vec![trajectory, series, glb, poster, view])?;
    }
    let outcomes = outcomes(scene, &run.recorder, ending);
    let [wall_seconds, stepping_seconds] = run.times();
    let summary = Summary {
        scene: run.scene,
        scene_hash: &run.scene_hash,
        model: run.simulation.model(),
        recorder: &run.recorder,
        ending,
        outcomes: &outcomes,
        files: &run.output.hashes().clone(),
        threads: run.threads,
        wall_seconds,
        stepping_seconds,
    };
    let json = summary.to_json();
    run.output.write(SUMMARY, |out| {
        serde_json::to_writer_pretty(&mut *out, &json)?;
        io::Write::write_all(out, b"\n")
    })?;
    run.output.remove_replaced_data()?;
    if *ending != Ending::Interrupted {
        run.output.remove_partial()?;
    }
    Ok(outcomes)
}

/// How many frames can be drawn, which are those before the motion, if it is unstable, leaves all bounds: the first of `frames` whose
/// coordinates stay within [`PICTURE_LIMIT`] and, if the run failed, within [`FAILED_LIMIT`] times the largest at time zero, or
/// metres if that is less than a metre.
fn drawn_frames(frames: &mut FrameReader, has_failed: bool) -> io::Result<usize> {
    let mut positions = Points::default();
    let mut limit = PICTURE_LIMIT;
    for frame in 0..frames.frame_count() {
        frames.read_positions(frame, &mut positions)?;
        let axes = [&positions.x, &positions.y, &positions.z];
        let largest = axes.into_iter().flatten().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        if frame == 0 && has_failed {
            limit = limit.min(FAILED_LIMIT * largest.max(1.0));
        }
        if limit < largest {
            return Ok(frame);
        }
    }
    Ok(frames.frame_count())
}

/// The frames that can be drawn.
struct PictureFrames {
    reader: FrameReader,
    frame_count: usize,
}

impl FrameSource for PictureFrames {
    fn frame_count(&self) -> usize {
        self.frame_count
    }

    fn read_positions(&mut self, frame: usize, positions: &mut Points) -> io::Result<()> {
        self.reader.read_positions(frame, positions)
    }
}

/// Names with units, and values per frame, of `series.csv`.
fn series_columns(frames: &[FrameRecord]) -> Vec<(String, Vec<f64>)> {
    let column = |name: &str, value: &dyn Fn(&FrameRecord) -> f64| {
        (name.to_owned(), frames.iter().map(value).collect::<Vec<f64>>())
    };
    let mut columns = vec![
        column("time [s]", &|frame| frame.time),
        column("step [s]", &|frame| frame.step),
        column("lowest_point [m]", &|frame| frame.lowest_point),
    ];
    for (index, name) in EnergyTerms::NAMES.iter().enumerate() {
        columns.push(column(&format!("{name} [J]"), &|frame| frame.energies.values()[index]));
    }
    for (name, values) in strain_series(frames) {
        columns.push((format!("{name} [1]"), values));
    }
    columns
}

/// Smallest, mean and largest strain per frame of every family that has springs.
fn strain_series(frames: &[FrameRecord]) -> Vec<(String, Vec<f64>)> {
    let mut series = Vec::new();
    for (index, family) in Family::ALL.iter().enumerate() {
        let strains: Vec<_> = frames.iter().filter_map(|frame| frame.strains[index]).collect();
        if !strains.is_empty() {
            let name = family.name();
            series.push((format!("{name}_strain_min"), strains.iter().map(|strain| strain.min).collect()));
            series.push((format!("{name}_strain_mean"), strains.iter().map(|strain| strain.mean).collect()));
            series.push((format!("{name}_strain_max"), strains.iter().map(|strain| strain.max).collect()));
        }
    }
    series
}

/// What a reader of the page must know of a run: why it ended early, at `time` [s], and its warnings.
fn notice(ending: &Ending, time: f64, warnings: &[String]) -> Option<String> {
    let end = match ending {
        Ending::Complete => None,
        Ending::Interrupted => Some(format!("This run was stopped at {time:.6} s.")),
        Ending::Failed(error) => Some(format!("This run failed: {error}. The frames before it are shown.")),
    };
    let warnings = warnings.iter().map(|warning| format!("Warning: {warning}."));
    let sentences: Vec<String> = end.into_iter().chain(warnings).collect();
    (!sentences.is_empty()).then(|| sentences.join(" "))
}

/// What `view.html` tells beside the motion.
fn view_info(
    scene: &muslin::Scene,
    model: &Model,
    recorder: &muslin::observe::Recorder,
    ending: &Ending,
) -> ViewInfo {
    let frames = recorder.frames();
    let settings = scene.run();
    let mut reached = duration_text(frames.last().map_or(0.0, |frame| frame.time));
    if (frames.len() as u64) <= settings.frame_intervals {
        reached.push_str(&format!(" of {}", duration_text(settings.duration)));
    }
    let mut facts = vec![
        ("particles".to_owned(), model.particles().len().to_string()),
        ("springs".to_owned(), model.spring_counts().iter().sum::<u64>().to_string()),
        ("duration".to_owned(), reached),
        ("method".to_owned(), method_name(settings.method).to_owned()),
    ];
    if let Some(step) = recorder.steps().largest {
        let name = match settings.step {
            StepRule::Constant { .. } => "step",
            StepRule::Adaptive { .. } => "longest step",
        };
        facts.push((name.to_owned(), duration_text(step)));
    }
    if let [Some(max), _, _] = recorder.max_strains() {
        facts.push(("largest strain".to_owned(), strain_text(max)));
    }
    let residual = muslin::observe::relative_residual(frames.iter().map(|frame| &frame.energies));
    facts.push(("energy residual".to_owned(), residual_text(residual)));
    if let Some(last) = frames.last() {
        facts.push(("state hash".to_owned(), last.hash.to_string()[..12].to_owned()));
    }
    let energies = EnergyTerms::NAMES.iter().enumerate().map(|(index, name)| ViewSeries {
        name: name.replace('_', " "),
        values: frames.iter().map(|frame| frame.energies.values()[index]).collect(),
    });
    // The smallest strains would crowd the plot; series.csv has them.
    let strains = strain_series(frames).into_iter().filter(|(name, _)| !name.ends_with("_min"));
    ViewInfo {
        title: scene.title().to_owned(),
        notice: notice(ending, frames.last().map_or(0.0, |frame| frame.time), &scene.warnings()),
        frame_rate: settings.frame_rate,
        facts,
        times: frames.iter().map(|frame| frame.time).collect(),
        energies: energies.collect(),
        strains: strains
            .map(|(name, values)| ViewSeries { name: name.replace("_strain_", " "), values })
            .collect(),
    }
}

/// A relative residual [1].
pub(crate) fn residual_text(residual: f64) -> String {
    if residual.is_finite() { format!("{residual:.2e}") } else { "unbounded".to_owned() }
}

/// Gives the strain [1] of every particle from the positions of all.
pub(crate) fn particle_strains(model: &Model) -> impl FnMut(&Points, &mut Vec<f32>) + '_ {
    let velocities = Points::default();
    move |positions, strains| {
        strains.clear();
        strains.resize(positions.len(), 0.0);
        let at = Configuration {
            time: 0.0,
            particles: model.particles(),
            positions,
            velocities: &velocities,
            memory: &[],
        };
        for force in model.forces() {
            force.eval_particle_strains(at, strains);
        }
    }
}
