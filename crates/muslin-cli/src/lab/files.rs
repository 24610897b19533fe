//! The files of a test.

use std::fmt::Write as _;
use std::io;

use muslin::lab::{Column, EQUILIBRIUM_TOLERANCE, Measurement, Reading};
use muslin::write::{GlbInfo, ViewInfo, write_glb, write_view};
use serde_json::{Value, json};

use super::{Test, VALUES, WHAT};
use crate::files::{GLB_VERTICES, VIEW_VERTICES, particle_strains};
use crate::plot::{Axis, Plot, Series, Style, csv_field, svg_element};
use crate::progress::rounded;

/// States at rest that the animation shows per second [1/s].
const FRAME_RATE: f64 = 10.0;

/// Names and contents of all files, that which tells what they are last.
pub(super) fn files(test: &Test) -> io::Result<Vec<(String, Vec<u8>)>> {
    let Measurement { columns, record, .. } = &test.measurement;
    let title = title(test);
    let mut files = vec![("curve.csv".to_owned(), csv(columns).into_bytes())];
    let plot = plot(columns);
    let svg = svg_element(&title, plot.size(), &plot.elements("curve"), true);
    files.push(("plot.svg".to_owned(), svg.into_bytes()));

    let model = &record.model;
    let mut frames = record.frames.clone();
    let mut glb = Vec::new();
    let info = GlbInfo { title: &title, cloth_names: &["specimen"], frame_rate: FRAME_RATE };
    write_glb(&mut glb, &info, &model.surface(GLB_VERTICES), &mut frames[..])?;
    files.push(("cloth.glb".to_owned(), glb));

    let pins: Vec<u32> = model.particles().pins().map(|particle| particle as u32).collect();
    let info = ViewInfo {
        title,
        notice: Some(
            "A test at rest: each frame is a state of equilibrium, and its time has no meaning.".to_owned(),
        ),
        frame_rate: FRAME_RATE,
        facts: test.measurement.readings.iter().map(fact).collect(),
        ..ViewInfo::default()
    };
    let mut page = Vec::new();
    let surface = model.surface(VIEW_VERTICES);
    write_view(&mut page, &info, &surface, &pins, &mut particle_strains(model), &mut frames[..])?;
    files.push(("view.html".to_owned(), page));
    files.push((VALUES.to_owned(), format!("{:#}\n", values(test)).into_bytes()));
    Ok(files)
}

fn title(test: &Test) -> String {
    format!("{}: {}", test.instrument.title(), test.specimen())
}

fn fact(reading: &Reading) -> (String, String) {
    let value = rounded(reading.measured / reading.unit.size, 4);
    (format!("{} ({})", reading.name, reading.what), format!("{value} {}", reading.unit.symbol))
}

/// The curve with all digits, each column in SI and with its unit in the header.
fn csv(columns: &[Column]) -> String {
    let header: Vec<String> =
        columns.iter().map(|column| csv_field(&format!("{} [{}]", column.name, column.unit.si))).collect();
    let mut text = header.join(",") + "\n";
    let count = columns.first().map_or(0, |column| column.values.len());
    for row in 0..count {
        let cells: Vec<String> = columns.iter().map(|column| format!("{:?}", column.values[row])).collect();
        let _ = writeln!(text, "{}", cells.join(","));
    }
    text
}

/// What is read against what is set, in the instrument's units; of what is read, all that has the unit of the first.
fn plot(columns: &[Column]) -> Plot {
    let label = |column: &Column| format!("{} [{}]", column.name, column.unit.symbol);
    let [set, read, ..] = columns else {
        return Plot { x: Axis::linear(""), y: Axis::linear(""), series: Vec::new() };
    };
    let drawn = columns[1..].iter().filter(|column| column.unit == read.unit);
    let series = drawn.enumerate().map(|(index, column)| {
        let points = set.values.iter().zip(&column.values);
        let points = points.map(|(x, y)| [x / set.unit.size, y / column.unit.size]);
        let (name, style) = match (index, column.name) {
            (0, _) => ("measured", Style::Marked),
            (_, "input") => ("input", Style::Guide),
            (_, name) => (name, Style::Line),
        };
        Series::new(name, index + 1, style, points)
    });
    Plot { x: Axis::linear(label(set)), y: Axis::linear(label(read)), series: series.collect() }
}

/// Every value with all its digits, in SI and in the instrument's unit.
fn values(test: &Test) -> Value {
    let record = &test.measurement.record;
    let readings = test.measurement.readings.iter().map(|reading| {
        let Reading { name, what, unit, measured, input } = reading;
        json!({
            "name": name,
            "what": what,
            "measured": measured,
            "input": input,
            "unit": unit.si,
            "relative_difference": reading.relative_difference(),
            "instrument": {
                "measured": measured / unit.size,
                "input": input.map(|input| input / unit.size),
                "unit": unit.symbol,
            },
        })
    });
    json!({
        "muslin": env!("CARGO_PKG_VERSION"),
        "what": WHAT,
        "instrument": test.instrument.name(),
        "title": test.instrument.title(),
        "fabric": test.fabric.name,
        "along": test.instrument.has_yarns().then(|| test.along.name()),
        "cells": test.resolution.cells(),
        "particles": record.model.particles().len(),
        "states": record.frames.len(),
        "equilibrium": {
            "tolerance": EQUILIBRIUM_TOLERANCE,
            "residual": record.residual,
            "relative_residual": record.relative_residual,
        },
        "readings": readings.collect::<Vec<_>>(),
    })
}
