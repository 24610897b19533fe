//! `summary.json`: what a run was, what it gave, and the hashes that prove it.

use muslin::force::Family;
use muslin::observe::{EnergyTerms, ExpectOutcome, Recorder, relative_residual};
use muslin::scene::{ExpectedQuantity, ExpectedRange, Method, Start};
use muslin::{Model, Scene};
use serde_json::{Map, Value, json};

use crate::progress::all_digits;

/// How a run ended.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Ending {
    /// At its last frame.
    Complete,
    /// Early, because somebody asked for it.
    Interrupted,
    /// Early, because of this.
    Failed(String),
}

/// Everything that goes into the summary.
pub(crate) struct Summary<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) scene_hash: &'a str,
    pub(crate) model: &'a Model,
    pub(crate) recorder: &'a Recorder,
    pub(crate) ending: &'a Ending,
    pub(crate) outcomes: &'a [ExpectOutcome],
    pub(crate) files: &'a Map<String, Value>,
    pub(crate) threads: usize,
    pub(crate) wall_seconds: f64,
    pub(crate) stepping_seconds: f64,
}

impl Summary<'_> {
    /// The summary as JSON. Units are SI.
    pub(crate) fn to_json(&self) -> Value {
        let (run, frames, steps) = (self.scene.run(), self.recorder.frames(), self.recorder.steps());
        let (status, error) = match self.ending {
            Ending::Complete => ("complete", None),
            Ending::Interrupted => ("interrupted", None),
            Ending::Failed(error) => ("failed", Some(error)),
        };
        let lowest = frames.iter().map(|frame| frame.lowest_point).fold(f64::INFINITY, f64::min);
        let particle_steps = steps.accepted as f64 * self.model.particles().len() as f64;
        json!({
            "muslin": env!("CARGO_PKG_VERSION"),
            "status": status,
            "error": error,
            "warnings": self.scene.warnings(),
            "title": self.scene.title(),
            "scene_hash": self.scene_hash,
            "method": method_name(run.method),
            "start": start_name(run.start),
            "seed": run.seed,
            "duration": run.duration,
            "frame_rate": run.frame_rate,
            "frames": frames.len(),
            "particles": self.model.particles().len(),
            "springs": self.springs(),
            "steps": steps,
            "energy": energy_json(frames.iter().map(|frame| &frame.energies)),
            "strain": self.strains(),
            "lowest_point": { "last": frames.last().map(|frame| frame.lowest_point), "lowest": lowest },
            "expect": self.outcomes.iter().map(outcome_json).collect::<Vec<_>>(),
            "final_state_hash": frames.last().map(|frame| frame.hash),
            "frame_hashes": frames.iter().map(|frame| frame.hash).collect::<Vec<_>>(),
            "files": self.files,
            "threads": self.threads,
            "wall_time": self.wall_seconds,
            "stepping_time": self.stepping_seconds,
            "particle_steps_per_second": particle_steps / self.stepping_seconds,
        })
    }

    fn springs(&self) -> Value {
        let counts = self.model.spring_counts();
        Family::ALL
            .iter()
            .zip(counts)
            .map(|(family, count)| (family.name().to_owned(), json!(count)))
            .collect()
    }

    fn strains(&self) -> Value {
        let last = self.recorder.frames().last();
        let families = Family::ALL.iter().zip(self.recorder.max_strains()).enumerate();
        families
            .map(|(index, (family, max))| {
                let last = last.and_then(|frame| frame.strains[index]);
                (family.name().to_owned(), json!({ "max": max, "last": last }))
            })
            .collect()
    }
}

/// What the complete `scene` gave of what it expects; nothing of a run that has ended early.
pub(crate) fn outcomes(scene: &Scene, recorder: &Recorder, ending: &Ending) -> Vec<ExpectOutcome> {
    match ending {
        Ending::Complete => scene.expectations().iter().map(|line| line.check(recorder)).collect(),
        Ending::Interrupted | Ending::Failed(_) => Vec::new(),
    }
}

/// The ledger at the last frame, and the residual of all frames relative to the largest change of any term.
fn energy_json<'a>(frames: impl Iterator<Item = &'a EnergyTerms> + Clone) -> Value {
    let mut object = Map::new();
    object.insert("residual".to_owned(), json!(relative_residual(frames.clone())));
    object.insert("last".to_owned(), json!(frames.last()));
    object.into()
}

fn outcome_json(outcome: &ExpectOutcome) -> Value {
    json!({
        "quantity": outcome.quantity.name(),
        "range": range_text(outcome),
        "value": outcome.value,
        "met": outcome.met,
    })
}

/// A range as a person writes it, with the quantity's unit.
pub(crate) fn range_text(outcome: &ExpectOutcome) -> String {
    let unit = unit_text(outcome.quantity);
    match outcome.range {
        ExpectedRange::Below(value) => format!("below {}{unit}", all_digits(value)),
        ExpectedRange::Above(value) => format!("above {}{unit}", all_digits(value)),
        ExpectedRange::Between(low, high) => {
            format!("between {} and {}{unit}", all_digits(low), all_digits(high))
        }
    }
}

/// What follows a number of `quantity`: a blank and its unit, nothing if it is a ratio.
pub(crate) fn unit_text(quantity: ExpectedQuantity) -> &'static str {
    match quantity {
        ExpectedQuantity::LowestPoint => " m",
        ExpectedQuantity::MaxStrain | ExpectedQuantity::EnergyResidual => "",
    }
}

/// Name in scene files.
pub(crate) fn method_name(method: Method) -> &'static str {
    match method {
        Method::CentralDifference => "central-difference",
    }
}

fn start_name(start: Start) -> &'static str {
    match start {
        Start::Consistent => "consistent",
        Start::AsPrinted => "as-printed",
    }
}
