//! `[run]`: how long and by which method.

use super::table::Entry;
use super::value::{NumberRule, Value, rounded, with_decimals};
use crate::scene::error::{SceneErrorKind, closest, quoted};
use crate::scene::{
    MAX_FRAME_INTERVALS, MAX_STEPS_PER_FRAME, Method, RunSettings, SceneError, Start, StepRule,
};

/// How far from a whole number, relative to it, a number of frames or steps may be.
const WHOLE_TOLERANCE: f64 = 1e-9;
const STEP_HELP: &str =
    "write `step = \"adaptive\"`, `{ tolerance = e }` with e in m, or `{ constant = h }` with h in s";

pub(super) fn read(entry: Entry) -> Result<RunSettings, SceneError> {
    let help = "add a table `[run]` with a duration";
    let mut table = entry.required("", help)?.table("write `[run]`")?;
    let duration = table.take("duration");
    let frame_rate = table.take("frame_rate");
    let method = table.take("method");
    let step = table.take("step");
    let start = table.take("start");
    let seed = table.take("seed");
    let allow_unstable = table.take("allow-unstable");
    table.finish()?;

    let frame_rate = read_frame_rate(frame_rate)?;
    let duration = duration.required("s", "write `duration = ...`")?;
    let frame_intervals = read_frame_intervals(&duration, frame_rate)?;
    Ok(RunSettings {
        duration: frame_intervals as f64 / frame_rate,
        frame_rate,
        frame_intervals,
        method: match method.optional() {
            None => Method::CentralDifference,
            Some(method) => {
                method.choice("is not a method", &[("central-difference", Method::CentralDifference)])?
            }
        },
        step: match step.optional() {
            None => StepRule::Adaptive { tolerance: None },
            Some(step) => read_step(step, frame_rate)?,
        },
        start: match start.optional() {
            None => Start::Consistent,
            Some(start) => {
                let starts = [("consistent", Start::Consistent), ("as-printed", Start::AsPrinted)];
                start.choice("is not a start", &starts)?
            }
        },
        seed: seed.optional().map_or(Ok(0), |seed| seed.integer(0, i64::MAX))?.cast_unsigned(),
        allow_unstable: allow_unstable.optional().map_or(Ok(false), |value| value.boolean())?,
    })
}

fn read_frame_rate(entry: Entry) -> Result<f64, SceneError> {
    let Some(value) = entry.optional() else {
        return Ok(60.0);
    };
    value.number("1/s", NumberRule::Positive)
}

fn read_frame_intervals(value: &Value, frame_rate: f64) -> Result<u64, SceneError> {
    let duration = value.number("s", NumberRule::Positive)?;
    let frames = duration * frame_rate;
    if MAX_FRAME_INTERVALS as f64 + 0.5 <= frames {
        return Err(value.out_of_range(
            "s",
            &format!("give at most {MAX_FRAME_INTERVALS} frames at {frame_rate:?} frames per second"),
            "lower `run.duration` or `run.frame_rate`",
        ));
    }
    let whole_frames = |duration: f64| whole(duration * frame_rate);
    whole_frames(duration).ok_or_else(|| {
        let nearest: Vec<String> = [frames.floor(), frames.ceil()]
            .into_iter()
            .filter(|count| (1.0..=MAX_FRAME_INTERVALS as f64).contains(count))
            .map(|count| shortest(count / frame_rate, |duration| whole_frames(duration) == Some(count as u64)))
            .collect();
        let plural = if nearest.len() == 1 { "duration is" } else { "durations are" };
        value.error(SceneErrorKind::Inconsistent {
            message: format!(
                "`{}` is {} s, which is {} frames at {frame_rate:?} frames per second, but must be a whole number \
                 of frames",
                value.path,
                value.as_written(),
                rounded(frames),
            ),
            help: format!("the nearest possible {plural} {} s", nearest.join(" and ")),
        })
    })
}

fn read_step(value: Value, frame_rate: f64) -> Result<StepRule, SceneError> {
    match value.value.as_str() {
        None => {}
        Some("adaptive") => return Ok(StepRule::Adaptive { tolerance: None }),
        Some(name) => {
            return Err(value.error(SceneErrorKind::UnknownName {
                key: value.path.clone(),
                value: quoted(name),
                rule: "is not a rule for the step",
                valid: [r#""adaptive""#, "`{ tolerance = e }` with e in m", "`{ constant = h }` with h in s"]
                    .map(str::to_owned)
                    .to_vec(),
                closest: closest(name, &["adaptive"]).map(quoted),
            }));
        }
    }
    let empty = value.error(SceneErrorKind::Inconsistent {
        message: "`run.step` is an empty table, but must say which rule the step follows".to_owned(),
        help: STEP_HELP.to_owned(),
    });
    let mut table = value.table(STEP_HELP)?;
    let constant = table.take("constant");
    let tolerance = table.take("tolerance");
    table.finish()?;
    match (constant.optional(), tolerance.optional()) {
        (Some(constant), None) => {
            let steps_per_frame = read_steps_per_frame(&constant, frame_rate)?;
            Ok(StepRule::Constant { steps_per_frame })
        }
        (None, Some(tolerance)) => {
            Ok(StepRule::Adaptive { tolerance: Some(tolerance.number("m", NumberRule::Positive)?) })
        }
        (Some(constant), Some(_)) => Err(constant.error(SceneErrorKind::Inconsistent {
            message:
                "`run.step` has both `constant` and `tolerance`, but a step is either constant or adaptive"
                    .to_owned(),
            help: "keep one of them".to_owned(),
        })),
        (None, None) => Err(empty),
    }
}

fn read_steps_per_frame(value: &Value, frame_rate: f64) -> Result<u64, SceneError> {
    let step = value.number("s", NumberRule::Positive)?;
    let interval = 1.0 / frame_rate;
    let steps = interval / step;
    if MAX_STEPS_PER_FRAME as f64 + 0.5 <= steps {
        return Err(value.out_of_range(
            "s",
            &format!(
                "be at least {:e} s, for at most {MAX_STEPS_PER_FRAME} steps from frame to frame",
                interval / MAX_STEPS_PER_FRAME as f64
            ),
            "raise the step or `run.frame_rate`",
        ));
    }
    let whole_steps = |step: f64| whole(interval / step);
    whole_steps(step).ok_or_else(|| {
        let (fewer, more) = (steps.floor().max(1.0), steps.ceil().max(1.0));
        let distance = |count: f64| (interval / count - step).abs();
        let count = if distance(fewer) < distance(more) { fewer } else { more };
        let nearest = shortest(interval / count, |step| whole_steps(step) == Some(count as u64));
        value.error(SceneErrorKind::Inconsistent {
            message: format!(
                "`{}` is {} s, which gives {} steps from frame to frame at {frame_rate:?} frames per second, but \
                 must give a whole number",
                value.path,
                value.as_written(),
                rounded(steps),
            ),
            help: format!("the nearest step that does is {nearest} s"),
        })
    })
}

/// The whole number, at least 1, that `number` is to [`WHOLE_TOLERANCE`].
fn whole(number: f64) -> Option<u64> {
    let nearest = number.round();
    let is_whole = 1.0 <= nearest && (number - nearest).abs() <= WHOLE_TOLERANCE * nearest;
    is_whole.then_some(nearest as u64)
}

/// `number` with the fewest digits for which `accepts` holds, as TOML.
fn shortest(number: f64, accepts: impl Fn(f64) -> bool) -> String {
    let candidates = (0..17).map(|decimals| with_decimals(number, decimals));
    candidates
        .into_iter()
        .find(|candidate| accepts(*candidate))
        .map_or_else(|| format!("{number:?}"), |candidate| format!("{candidate:?}"))
}
