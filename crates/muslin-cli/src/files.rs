//! The files of a finished run.

use std::io;

use muslin::force::{Configuration, Family};
use muslin::observe::{EnergyTerms, ExpectOutcome, FrameRecord};
use muslin::write::{GlbInfo, write_glb, write_series, write_trajectory};
use muslin::{Model, Points};

use crate::error::CliError;
use crate::output::SUMMARY;
use crate::progress::{duration_text, significant};
use crate::run::Run;
use crate::scene_file::SceneFile;
use crate::summary::{Ending, Summary, method_name};

/// Vertices per cloth in `cloth.glb` at most.
const GLB_VERTICES: usize = 66_000;

/// Vertices per cloth in `view.html` at most.
const VIEW_VERTICES: usize = 16_400;

/// Vertices per cloth in `poster.png` at most.
const POSTER_VERTICES: usize = 263_000;

/// Width and height of `poster.png` [pixels].
const POSTER_SIZE: [u32; 2] = [1280, 720];

/// Writes all files of `run`, the summary last, and removes the run in progress unless it can go on.
pub(crate) fn write_files(
    run: &mut Run<'_>,
    file: &SceneFile,
    ending: &Ending,
) -> Result<Vec<ExpectOutcome>, CliError> {
    let model = run.simulation.model();
    let (scene, frames, store, output) = (run.scene, run.recorder.frames(), &mut run.store, &mut run.output);
    let times: Vec<f64> = frames.iter().map(|frame| frame.time).collect();
    let pins: Vec<u32> = model.particles().pins().map(|particle| particle as u32).collect();
    output.write("scene.toml", |out| io::Write::write_all(out, file.text.as_bytes()))?;
    output.write("trajectory.npz", |out| {
        write_trajectory(out, &times, &model.surface(usize::MAX).triangles, store)
    })?;
    output.write("series.csv", |out| {
        let columns = series_columns(frames);
        let columns: Vec<(&str, &[f64])> =
            columns.iter().map(|(name, values)| (name.as_str(), &values[..])).collect();
        write_series(out, &columns)
    })?;
    let names: Vec<&str> = model.cloths().iter().map(|cloth| cloth.name.as_str()).collect();
    let info = GlbInfo { title: scene.title(), cloth_names: &names, frame_rate: scene.run().frame_rate };
    output.write("cloth.glb", |out| write_glb(out, &info, &model.surface(GLB_VERTICES), store))?;
    let outcomes: Vec<ExpectOutcome> = match ending {
        Ending::Complete => scene.expectations().iter().map(|line| line.check(&run.recorder)).collect(),
        Ending::Interrupted | Ending::Failed(_) => Vec::new(),
    };
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
    if *ending != Ending::Interrupted {
        run.output.remove_partial()?;
    }
    Ok(outcomes)
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
