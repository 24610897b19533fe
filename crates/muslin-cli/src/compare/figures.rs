//! Plots of a comparison: the curves of both fabrics on one instrument.

use muslin::lab::Column;

use super::measure::Trial;
use crate::plot::{Axis, Plot, Series, Style};

/// A plot with the name of its files and what it shows.
pub(super) struct Figure {
    pub(super) name: String,
    pub(super) caption: String,
    pub(super) plot: Plot,
}

/// The curves of `trial`, in the instrument's units, of the fabrics called `names`; none if no fabric has one.
pub(super) fn figure(trial: &Trial, names: &[String; 2]) -> Option<Figure> {
    let measured = || trial.outcomes.iter().map(|outcome| outcome.as_ref().ok());
    let (set, read) = measured().flatten().find_map(|measured| curve(&measured.columns))?;
    let label = |column: &Column| format!("{} [{}]", column.name, column.unit.symbol);
    let curves = measured().zip(["A", "B"].into_iter().zip(names)).enumerate();
    let series = curves.filter_map(|(index, (measured, (letter, name)))| {
        let (set, read) = curve(&measured?.columns)?;
        let points = set.values.iter().zip(&read.values);
        let points = points.map(|(x, y)| [x / set.unit.size, y / read.unit.size]);
        Some(Series::new(format!("{letter} {name}"), index + 1, Style::Marked, points))
    });
    Some(Figure {
        name: trial.test.file_name(),
        caption: trial.test.title(),
        plot: Plot { x: Axis::linear(label(set)), y: Axis::linear(label(read)), series: series.collect() },
    })
}

/// What an instrument sets and what it reads first.
fn curve(columns: &[Column]) -> Option<(&Column, &Column)> {
    match columns {
        [set, read, ..] => Some((set, read)),
        _ => None,
    }
}
