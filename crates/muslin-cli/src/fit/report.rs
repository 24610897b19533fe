//! The files of a fit: the fabric, tables, plots, all numbers, and a page of them.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use muslin_fit::{FabricFit, FabricText, Outcome, Parameter, Undetermined};
use serde_json::{Value, json};

use super::figures::{Figure, figures};
use crate::plot::{FIGURE_STYLE, escaped, svg_element};

/// All numbers, and the file that tells what the folder holds.
pub(super) const NUMBERS: &str = "fit.json";

/// What `fit` in [`NUMBERS`] says.
pub(super) const FORMAT: &str = "muslin fit 1";

/// The page.
pub(super) const PAGE: &str = "index.html";

/// How the page is laid out.
const PAGE_STYLE: &str = include_str!("page.css");

/// Name and content of every file.
pub(super) fn files(fit: &FabricFit, text: &FabricText, name: &str) -> Vec<(String, Vec<u8>)> {
    let figures: Vec<Figure> = fit.outcomes().flat_map(figures).collect();
    let mut files = vec![(format!("{name}.toml"), text.toml.clone().into_bytes())];
    files.extend(text.tables.iter().map(|(name, content)| (name.clone(), content.clone().into_bytes())));
    for figure in &figures {
        let svg = svg_element(&figure.caption, figure.plot.size(), &figure.plot.elements(&figure.name), true);
        files.push((format!("{}.svg", figure.name), svg.into_bytes()));
    }
    files.push((PAGE.to_owned(), page(text, name, &figures).into_bytes()));
    let mut numbers = numbers(fit, name);
    numbers["files"] = files.iter().map(|(name, _)| name.as_str()).collect();
    files.push((NUMBERS.to_owned(), format!("{numbers:#}\n").into_bytes()));
    files
}

/// Names of the files that the fit at `path` wrote beside it; none if there is no such.
pub(super) fn recorded_files(path: &Path) -> Vec<String> {
    let numbers: Value = serde_json::from_slice(&fs::read(path).unwrap_or_default()).unwrap_or_default();
    let names = numbers["files"].as_array().into_iter().flatten().filter_map(Value::as_str);
    // A fit writes no folders, and nothing outside its own.
    names
        .filter(|name| !name.contains(['/', '\\', ':']) && !name.starts_with('.'))
        .map(str::to_owned)
        .collect()
}

/// The page: one file that needs no other.
fn page(text: &FabricText, name: &str, figures: &[Figure]) -> String {
    let title = format!("The fabric {name}, identified");
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n\
         <style>\n{FIGURE_STYLE}{PAGE_STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n<div class=\"figures\">\n"
    );
    for figure in figures {
        let svg =
            svg_element(&figure.caption, figure.plot.size(), &figure.plot.elements(&figure.name), false);
        let caption = escaped(&figure.caption);
        let _ = writeln!(out, "<figure>\n{svg}<figcaption>{caption}</figcaption>\n</figure>");
    }
    let _ = write!(
        out,
        "</div>\n<pre>{}</pre>\n<footer>Written by muslin {}. Every number with all its digits is in <code>{NUMBERS}</code>.\
         </footer>\n</body>\n</html>\n",
        escaped(&text.toml),
        env!("CARGO_PKG_VERSION")
    );
    out
}

fn numbers(fit: &FabricFit, name: &str) -> Value {
    json!({
        "fit": FORMAT,
        "muslin": env!("CARGO_PKG_VERSION"),
        "fabric": name,
        "areal_density": fit.areal_density,
        "confidence": muslin_fit::CONFIDENCE,
        "tests": fit.outcomes().map(outcome).collect::<Vec<_>>(),
        "warnings": fit.warnings,
        "undetermined": fit.undetermined.iter().map(undetermined).collect::<Vec<_>>(),
    })
}

fn outcome(outcome: &Outcome) -> Value {
    json!({
        "file": outcome.file,
        "test": outcome.kind.test().name(),
        "direction": outcome.direction.map(|direction| direction.name()),
        "constants": outcome.parameters.iter().map(parameter).collect::<Vec<_>>(),
        "correlations": outcome.correlations,
        "condition": finite(outcome.condition),
        "results": outcome.results.iter().map(parameter).collect::<Vec<_>>(),
        "scatter": outcome.scatter,
        "systematic": outcome.is_systematic,
        "notes": outcome.notes,
        "points": outcome.points.iter().map(|point| [point.at, point.measured, point.fitted]).collect::<Vec<_>>(),
    })
}

fn parameter(parameter: &Parameter) -> Value {
    let estimate = parameter.estimate;
    json!({
        "symbol": parameter.symbol,
        "name": parameter.name,
        "unit": parameter.unit,
        "value": estimate.value,
        "standard_error": estimate.standard_error.and_then(finite),
        "interval": estimate.interval.map(|ends| ends.map(finite)),
    })
}

fn undetermined(undetermined: &Undetermined) -> Value {
    json!({ "what": undetermined.what, "why": undetermined.why, "remedy": undetermined.remedy })
}

/// `value`, if JSON has it.
fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}
