//! What the command says at the end of a run.

use std::io::{self, Write};

use muslin::force::Family;
use muslin::observe::{ExpectOutcome, relative_residual};

use crate::error::CliError;
use crate::progress::{duration_text, significant};
use crate::run::Run;
use crate::scene_file::SceneFile;
use crate::summary::{Ending, range_text};

/// Says what came out of `run` of the scene in `file`, and fails if the run did.
pub(crate) fn report(
    out: &mut impl Write,
    run: &Run<'_>,
    file: &SceneFile,
    ending: &Ending,
    outcomes: &[ExpectOutcome],
) -> Result<(), CliError> {
    // A closed pipe must not turn a good run into a failed one.
    let _ = write_report(out, run, outcomes);
    let path = run.output.path().display();
    match ending {
        Ending::Complete => {}
        Ending::Interrupted => {
            return Err(CliError::failed(
                format_args!(
                    "stopped at {:.6} s; {path} holds the frames so far",
                    run.simulation.frame().state.time
                ),
                "go on with the same command and `--resume`",
            ));
        }
        Ending::Failed(error) => {
            let step = run.simulation.frame().state.last_step;
            return Err(CliError::failed(
                format_args!("{error}; {path} holds the frames before it"),
                format_args!(
                    "the motion has become unstable: take a step smaller than {}; `muslin check` names the largest \
                     stable one",
                    duration_text(step)
                ),
            ));
        }
    }
    let violated: Vec<_> = outcomes.iter().filter(|outcome| !outcome.met).map(violation_text).collect();
    if violated.is_empty() {
        return Ok(());
    }
    let help = if file.is_changed {
        "the scene may expect this without `--set` only; all files were written"
    } else {
        "change the scene or what it expects; all files were written"
    };
    Err(CliError::failed(
        format_args!("the run does not meet its [expect] table: {}", violated.join("; ")),
        help,
    ))
}

fn write_report(out: &mut impl Write, run: &Run<'_>, outcomes: &[ExpectOutcome]) -> io::Result<()> {
    let frames = run.recorder.frames();
    let [wall, stepping] = run.times();
    let simulated = frames.last().map_or(0.0, |frame| frame.time);
    let path = run.output.path().display();
    writeln!(
        out,
        "{path}: {} frames, {} simulated in {} ({} of it steps)",
        frames.len(),
        duration_text(simulated),
        duration_text(wall),
        duration_text(stepping)
    )?;
    for (family, max) in Family::ALL.iter().zip(run.recorder.max_strains()) {
        if let Some(max) = max {
            writeln!(out, "  largest {:<10} strain  {} %", family.name(), significant(100.0 * max))?;
        }
    }
    if let Some(last) = frames.last() {
        writeln!(out, "  lowest point at the end    {} m", significant(last.lowest_point))?;
    }
    let residual = relative_residual(frames.iter().map(|frame| &frame.energies));
    writeln!(out, "  energy residual            {residual:.2e} of the largest term")?;
    for outcome in outcomes.iter().filter(|outcome| outcome.met) {
        writeln!(out, "  as expected                {}", outcome_text(outcome))?;
    }
    if let Some(last) = frames.last() {
        writeln!(out, "  hash of the last state     {}", last.hash)?;
    }
    for warning in run.scene.warnings() {
        writeln!(out, "warning: {warning}")?;
    }
    writeln!(out, "look at it: muslin view {path}, or open {path}/view.html")
}

/// With all digits of the value, which may be just outside its range.
fn violation_text(outcome: &ExpectOutcome) -> String {
    format!("`{}` is {:?}, expected {}", outcome.quantity.name(), outcome.value, range_text(outcome.range))
}

fn outcome_text(outcome: &ExpectOutcome) -> String {
    let name = outcome.quantity.name();
    format!("`{name}` is {}, expected {}", significant(outcome.value), range_text(outcome.range))
}
