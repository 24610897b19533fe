//! Fig. 3: the hanging cloth, as pictures.

use muslin::Model;
use muslin::write::write_poster;

use super::progress::Progress;
use super::report::{Content, Figure, Item, Picture, Section, rounded};
use super::trial::{Outcome, Steps, Trial, reading, run};
use crate::error::CliError;

/// Times of the pictures, as frames.
const FRAMES: [usize; 6] = [0, 15, 24, 33, 54, 180];

/// Width and height of a picture [pixels].
const SIZE: [u32; 2] = [440, 360];

/// Vertices of a picture at most.
const VERTICES: usize = 10_000;

/// The section with the pictures.
pub(crate) fn section(is_quick: bool, share: f64, progress: &Progress<'_>) -> Result<Section, CliError> {
    let duration = if is_quick { 0.4 } else { 3.0 };
    let linear = reading("none");
    let trial = Trial::new(linear, 10, duration, Steps::PerFrame(linear.steps_per_frame)).keeping_positions();
    progress.begin(share, trial.work);
    let outcome = run(&trial, progress)?;
    let model = Model::new(&trial.scene());
    let frames: Vec<usize> = FRAMES.into_iter().filter(|frame| *frame < outcome.positions.len()).collect();
    let pictures = frames.iter().map(|frame| picture(&model, &outcome, *frame)).collect();
    Ok(Section {
        name: "hanging",
        title: "Fig. 3: the hanging textile",
        finding: "The paper gives no constants for its picture of a hanging cloth; with ours, a cloth let go flat falls, swings \
                  and comes to hang by its corners."
            .to_owned(),
        items: vec![
            Item::text(
                "The paper's result is a picture of a hanging cloth of 10 x 10 particles. It gives no constant, no size and no \
                 time. The scene `scenes/hanging.toml` is ours: 1 m x 1 m and 0.2 kg, let go flat and held by two \
                 corners.",
            ),
            Item::Figure(Figure {
                name: "figure-3-hanging",
                caption: "Fig. 3: the cloth of 10 x 10 particles after it was let go, drawn as a smooth surface. Each picture is \
                          framed by itself."
                    .to_owned(),
                content: Content::Pictures(pictures),
            }),
        ],
    })
}

fn picture(model: &Model, outcome: &Outcome, frame: usize) -> Picture {
    let pins: Vec<u32> = model.particles().pins().map(|particle| particle as u32).collect();
    let mut png = Vec::new();
    // Only an `out` that fails or an empty picture would be an error.
    write_poster(&mut png, &model.surface(VERTICES), &outcome.positions[frame], &pins, SIZE)
        .expect("a vector takes all bytes");
    Picture { png, label: format!("{} s", rounded(outcome.frames[frame].time, 3)), size: SIZE }
}
