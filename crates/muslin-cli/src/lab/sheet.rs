//! What a test says on the terminal.

use std::fmt::Write as _;

use muslin::lab::Reading;

use super::Test;
use crate::progress::rounded;

/// The instrument's values, a line each, beside what the fabric was given.
pub(super) fn sheet(test: &Test) -> String {
    let Test { instrument, resolution, measurement, .. } = test;
    let record = &measurement.record;
    let mut out = format!(
        "{}: {}, {} cells between clamps, {} particles, {} states at rest to {:.0e} of the largest force\n",
        instrument.title(),
        test.specimen(),
        resolution.cells(),
        record.model.particles().len(),
        record.frames.len(),
        record.relative_residual.max(f64::EPSILON),
    );
    let width = measurement.readings.iter().map(|reading| reading.what.chars().count()).max().unwrap_or(0);
    for reading in &measurement.readings {
        let what = reading.what;
        let pad = " ".repeat(width - what.chars().count());
        let _ = writeln!(out, "  {:<5} {what}{pad}  {}", reading.name, values(reading));
    }
    out
}

/// The measured value, the input and their difference.
fn values(reading: &Reading) -> String {
    let shown = |value: f64| format!("{:>10}", rounded(value / reading.unit.size, 4));
    let measured = format!("{} {:<12}", shown(reading.measured), reading.unit.symbol);
    let text = match (reading.input, reading.relative_difference()) {
        (Some(input), Some(difference)) => {
            format!("{measured} input {}  {:+.2} %", shown(input), 100.0 * difference + 0.0)
        }
        (Some(input), None) => format!("{measured} input {}", shown(input)),
        (None, _) => measured,
    };
    text.trim_end().to_owned()
}
