//! What was measured, as text and as JSON.

use std::io::{self, Write};

use serde_json::{Map, Value, json};

use super::measure::Spread;

/// Width of the labels.
const LABEL: usize = 46;

/// What a number should be.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Target {
    AtLeast(f64),
    AtMost(f64),
}

impl Target {
    fn is_met(self, value: f64) -> bool {
        match self {
            Self::AtLeast(bound) => bound <= value,
            Self::AtMost(bound) => value <= bound,
        }
    }

    fn to_text(self, value: f64) -> String {
        let (sign, bound) = match self {
            Self::AtLeast(bound) => ('≥', bound),
            Self::AtMost(bound) => ('≤', bound),
        };
        format!("target {sign} {bound}, {}", if self.is_met(value) { "met" } else { "missed" })
    }
}

/// One line: a number, a ratio, or both.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    label: String,
    value: Option<(f64, &'static str)>,
    ratio: Option<Spread>,
    target: Option<Target>,
    /// What the line is about, for programs.
    about: Value,
}

impl Row {
    /// `value` with its unit.
    pub(crate) fn value(label: impl Into<String>, value: f64, unit: &'static str) -> Self {
        Self {
            label: label.into(),
            value: Some((value, unit)),
            ratio: None,
            target: None,
            about: Value::Null,
        }
    }

    /// A time per particle and step [ns].
    pub(crate) fn time(label: impl Into<String>, time: Spread) -> Self {
        Self::value(label, time.median, "ns")
    }

    /// A `ratio` alone.
    pub(crate) fn ratio(label: impl Into<String>, ratio: Spread) -> Self {
        Self { label: label.into(), value: None, ratio: Some(ratio), target: None, about: Value::Null }
    }

    /// With a `ratio`.
    pub(crate) fn with_ratio(self, ratio: Spread) -> Self {
        Self { ratio: Some(ratio), ..self }
    }

    /// With what the ratio should be, or the number if there is no ratio.
    pub(crate) fn with_target(self, target: Target) -> Self {
        Self { target: Some(target), ..self }
    }

    /// With a target if there is one.
    pub(crate) fn with_target_if(self, is_asked: bool, target: Target) -> Self {
        if is_asked { self.with_target(target) } else { self }
    }

    /// With what it is about.
    pub(crate) fn about(self, about: Value) -> Self {
        Self { about, ..self }
    }

    /// The number that the target speaks of.
    fn judged(&self) -> f64 {
        match (self.ratio, self.value) {
            (Some(ratio), _) => ratio.median,
            (None, value) => value.map_or(f64::NAN, |(value, _)| value),
        }
    }

    fn write(&self, out: &mut impl Write) -> io::Result<()> {
        let value = self.value.map_or(String::new(), |(value, unit)| format!("{} {unit:<4}", rounded(value)));
        let ratio = self.ratio.map_or(String::new(), |Spread { median, quartiles: [low, high] }| {
            format!("{} [{}, {}]", rounded(median), rounded(low), rounded(high))
        });
        let target = self.target.map_or(String::new(), |target| target.to_text(self.judged()));
        let padding = LABEL.saturating_sub(self.label.chars().count());
        let line = format!("  {}{:padding$} {value:>15}  {ratio:<24} {target}", self.label, "");
        writeln!(out, "{}", line.trim_end())
    }

    fn to_json(&self) -> Value {
        let mut object = Map::new();
        object.insert("label".to_owned(), json!(self.label));
        if let Some((value, unit)) = self.value {
            object.insert("value".to_owned(), json!(value));
            object.insert("unit".to_owned(), json!(unit));
        }
        if let Some(Spread { median, quartiles }) = self.ratio {
            object.insert("ratio".to_owned(), json!(median));
            object.insert("quartiles".to_owned(), json!(quartiles));
        }
        if let Some(target) = self.target {
            let (sense, bound) = match target {
                Target::AtLeast(bound) => ("at least", bound),
                Target::AtMost(bound) => ("at most", bound),
            };
            object.insert("target".to_owned(), json!([sense, bound]));
            object.insert("met".to_owned(), json!(target.is_met(self.judged())));
        }
        if let Value::Object(about) = &self.about {
            object.extend(about.clone());
        }
        object.into()
    }
}

/// Three digits or more.
fn rounded(value: f64) -> String {
    if value != 0.0 && value.abs() < 1e-3 {
        return format!("{value:.1e}");
    }
    let digits = match value.abs() {
        0.0..1.0 => 3,
        1.0..10.0 => 2,
        10.0..100.0 => 1,
        _ => 0,
    };
    format!("{value:.digits$}")
}

/// Writes sections as they come, and remembers them.
pub(crate) struct Report<W: Write> {
    out: W,
    sections: Vec<Value>,
    missed: usize,
    targets: usize,
}

impl<W: Write> Report<W> {
    /// A report to `out`.
    pub(crate) fn new(out: W) -> Self {
        Self { out, sections: Vec::new(), missed: 0, targets: 0 }
    }

    /// Writes a line that is no result.
    pub(crate) fn note(&mut self, text: &str) -> io::Result<()> {
        writeln!(self.out, "{text}")
    }

    /// Writes a section's `title`, then its `rows`; `columns` says what number and ratio are.
    pub(crate) fn section(
        &mut self,
        name: &str,
        title: &str,
        columns: [&str; 2],
        rows: &[Row],
    ) -> io::Result<()> {
        let [value, ratio] = columns;
        writeln!(self.out, "\n{name}: {title}")?;
        writeln!(self.out, "  {:LABEL$} {value:>15}  {ratio}", "")?;
        for row in rows {
            row.write(&mut self.out)?;
            if let Some(target) = row.target {
                self.targets += 1;
                self.missed += usize::from(!target.is_met(row.judged()));
            }
        }
        self.out.flush()?;
        let rows: Vec<Value> = rows.iter().map(Row::to_json).collect();
        self.sections.push(json!({ "name": name, "title": title, "rows": rows }));
        Ok(())
    }

    /// Says how many targets were missed; everything as JSON, with what `machine` it was.
    pub(crate) fn finish(mut self, machine: Value) -> io::Result<Value> {
        writeln!(self.out, "\n{} of {} targets missed", self.missed, self.targets)?;
        Ok(json!({ "machine": machine, "sections": self.sections }))
    }
}
