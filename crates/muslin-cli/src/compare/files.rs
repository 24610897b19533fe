//! The files of a comparison.

use std::fmt::Write as _;

use muslin::lab::{Along, EQUILIBRIUM_TOLERANCE, Instrument};
use serde_json::{Value as Json, json};

use super::figures::{Figure, figure};
use super::measure::{Outcome, Trial};
use super::page::{page, svg};
use super::table::{Row, Section, Value};
use super::{Comparison, PAGE, VALUES, WHAT};
use crate::plot::csv_field;

/// The tables.
const TABLE: &str = "table.csv";

/// Names and contents of all files, that which tells what they are last.
pub(super) fn files(comparison: &Comparison) -> Vec<(String, Vec<u8>)> {
    let Comparison { names, trials, sections, .. } = comparison;
    let figures: Vec<Option<Figure>> = trials.iter().map(|trial| figure(trial, names)).collect();
    let mut files = Vec::new();
    for figure in figures.iter().flatten() {
        files.push((format!("{}.svg", figure.name), svg(figure, true)));
        files.push((format!("{}.csv", figure.name), figure.plot.to_csv()));
    }
    files.push((TABLE.to_owned(), table(sections)));
    files.push((PAGE.to_owned(), page(comparison, &figures)));
    files.push((VALUES.to_owned(), format!("{:#}\n", values(comparison))));
    files.into_iter().map(|(name, text)| (name, text.into_bytes())).collect()
}

/// All tables as one, in SI and with all digits; what a fabric lacks is told in place of its number.
fn table(sections: &[Section]) -> String {
    let mut text = "instrument,along,name,what,unit,A,B,B / A\n".to_owned();
    for (section, row) in rows(sections) {
        let values = [0, 1].map(|fabric| match &row.values[fabric] {
            Value::Number(number) => format!("{number:?}"),
            Value::Lacking(lacking) => lacking.clone(),
        });
        let [first, second] = values;
        let cells = [
            section.instrument.map_or("", Instrument::name).to_owned(),
            row.along.map_or("", Along::name).to_owned(),
            row.name.to_owned(),
            csv_field(row.what),
            row.unit.si.to_owned(),
            first,
            second,
            row.ratio().map_or(String::new(), |ratio| format!("{ratio:?}")),
        ];
        let _ = writeln!(text, "{}", cells.join(","));
    }
    text
}

/// Every row with its section.
fn rows(sections: &[Section]) -> impl Iterator<Item = (&Section, &Row)> {
    sections.iter().flat_map(|section| section.rows.iter().map(move |row| (section, row)))
}

/// Every value with all its digits, in SI.
fn values(comparison: &Comparison) -> Json {
    let Comparison { names: [first, second], resolution, trials, sections } = comparison;
    let quantity = |(section, row): (&Section, &Row)| {
        let [a, b] = [0, 1].map(|fabric| row.values[fabric].number());
        let lacking = |fabric: usize| match &row.values[fabric] {
            Value::Number(_) => None,
            Value::Lacking(lacking) => Some(lacking.clone()),
        };
        json!({
            "instrument": section.instrument.map(Instrument::name),
            "along": row.along.map(Along::name),
            "name": row.name,
            "what": row.what,
            "unit": row.unit.si,
            "a": a,
            "b": b,
            "ratio": row.ratio(),
            "lacking": { "a": lacking(0), "b": lacking(1) },
        })
    };
    json!({
        "muslin": env!("CARGO_PKG_VERSION"),
        "what": WHAT,
        "a": first,
        "b": second,
        "cells": resolution.cells(),
        "equilibrium_tolerance": EQUILIBRIUM_TOLERANCE,
        "tests": trials.iter().map(test).collect::<Vec<_>>(),
        "quantities": rows(sections).map(quantity).collect::<Vec<_>>(),
    })
}

fn test(trial: &Trial) -> Json {
    let specimen = |outcome: &Outcome| match outcome {
        Ok(measured) => {
            json!({ "states": measured.states, "relative_residual": measured.relative_residual })
        }
        Err(_) => Json::Null,
    };
    let [a, b] = &trial.outcomes;
    json!({
        "instrument": trial.test.instrument.name(),
        "title": trial.test.instrument.title(),
        "along": trial.test.along.map(Along::name),
        "a": specimen(a),
        "b": specimen(b),
    })
}
