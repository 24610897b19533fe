//! What the command says at the end of a run.

use std::io::{self, Write};

use muslin::force::Family;
use muslin::integrate::{Workers, guaranteed_stable_step, largest_stable_step};
use muslin::observe::{ExpectOutcome, relative_residual};
use muslin::scene::{ExpectedQuantity, StepRule};
use muslin::suggested_step;

use crate::error::CliError;
use crate::files::residual_text;
use crate::progress::{duration_text, rounded, strain_text};
use crate::run::Run;
use crate::scene_file::SceneFile;
use crate::summary::{Ending, range_text, unit_text};

/// Says what came out of `run` of the scene in `file`, and fails if the run did.
pub(crate) fn report(
    out: &mut impl Write,
    run: &Run<'_>,
    file: &SceneFile,
    ending: &Ending,
    outcomes: &[ExpectOutcome],
) -> Result<(), CliError> {
    let printed = CliError::print(write_report(out, run, outcomes));
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
            let message = format_args!("{error}; {path} holds the frames before it");
            return Err(CliError::failed(message, advice(run)));
        }
    }
    let violated: Vec<_> = outcomes.iter().filter(|outcome| !outcome.met).map(violation_text).collect();
    if violated.is_empty() {
        return printed;
    }
    let help = if file.is_changed {
        "`[expect]` was written for the scene without `--set`; all files were written"
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
    let path = run.output.path();
    writeln!(
        out,
        "{}: {} frames, {} simulated in {} ({} of it steps)",
        path.display(),
        frames.len(),
        duration_text(simulated),
        duration_text(wall),
        duration_text(stepping)
    )?;
    for (family, max) in Family::ALL.iter().zip(run.recorder.max_strains()) {
        if let Some(max) = max {
            writeln!(out, "  largest {:<10} strain  {}", family.name(), strain_text(max))?;
        }
    }
    if let Some(last) = frames.last() {
        writeln!(out, "  lowest point at the end    {} m", rounded(last.lowest_point, 6))?;
    }
    let residual = relative_residual(frames.iter().map(|frame| &frame.energies));
    writeln!(out, "  energy residual            {} of the largest change", residual_text(residual))?;
    for outcome in outcomes.iter().filter(|outcome| outcome.met) {
        writeln!(out, "  as expected                {}", outcome_text(outcome))?;
    }
    if let Some(last) = frames.last() {
        writeln!(out, "  hash of the last state     {}", last.hash)?;
    }
    for warning in run.scene.warnings() {
        writeln!(out, "warning: {warning}")?;
    }
    let page = path.join("view.html").display().to_string();
    writeln!(
        out,
        "look at it: muslin view {}, or open {}",
        shell_word(&path.display().to_string()),
        shell_word(&page)
    )?;
    out.flush()
}

/// What to do about `run`, whose motion has left the finite numbers.
fn advice(run: &Run<'_>) -> String {
    let model = run.simulation.model();
    let start = model.initial_state(run.scene);
    let step = run.simulation.frame().state.last_step;
    if let StepRule::Adaptive { tolerance } = run.scene.run().step {
        let way_out = if tolerance.is_some() { "raise the tolerance, or " } else { "" };
        return format!("{way_out}check the quantities of the scene");
    }
    let largest = largest_stable_step(model, &start, &Workers::single());
    if step <= guaranteed_stable_step(model, &start).max(largest) {
        return "take a smaller step: this one is stable in the initial shape, but springs that stiffen need less; or check \
                the quantities of the scene"
            .to_owned();
    }
    let suggestion = suggested_step(run.scene.run().frame_rate, largest);
    format!(
        "the motion has become unstable: the largest stable step in the initial shape is {}; take `step = {{ constant \
         = {suggestion:.12e} }}`",
        duration_text(largest)
    )
}

/// `text` as one word of a shell, quoted if need be.
pub(crate) fn shell_word(text: &str) -> String {
    let is_plain = |letter: char| letter.is_alphanumeric() || "/._-+,:@%".contains(letter);
    if cfg!(windows) {
        let is_plain = text.chars().all(|letter| is_plain(letter) || letter == '\\');
        return if is_plain { text.to_owned() } else { format!("\"{text}\"") };
    }
    if !text.is_empty() && text.chars().all(is_plain) {
        text.to_owned()
    } else {
        format!("'{}'", text.replace('\'', "'\\''"))
    }
}

/// With all digits of the value, which may be just outside its range.
fn violation_text(outcome: &ExpectOutcome) -> String {
    let (name, unit) = (outcome.quantity.name(), unit_text(outcome.quantity));
    format!("`{name}` is {:?}{unit}, expected {}", outcome.value, range_text(outcome))
}

fn outcome_text(outcome: &ExpectOutcome) -> String {
    let (name, unit) = (outcome.quantity.name(), unit_text(outcome.quantity));
    let value = rounded(outcome.value, 4);
    let per_cent = match outcome.quantity {
        ExpectedQuantity::MaxStrain => format!(" ({})", strain_text(outcome.value)),
        ExpectedQuantity::LowestPoint | ExpectedQuantity::EnergyResidual => String::new(),
    };
    format!("`{name}` is {value}{unit}{per_cent}, expected {}", range_text(outcome))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn words_are_quoted_where_a_shell_would_split_them() {
        let words = ["out/a-1.toml", "my cloth", "it's", "a$b", ""].map(shell_word);
        assert_eq!(words, ["out/a-1.toml", "'my cloth'", "'it'\\''s'", "'a$b'", "''"]);
    }
}
