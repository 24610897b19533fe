//! `muslin fabric`.

use std::fmt::Write as _;

use muslin::integrate::{Workers, largest_stable_step};
use muslin::scene::{BendingFriction, BendingModel, LibraryFabric, MeasuredFabric, MembraneTension};
use muslin::{Model, Scene};

use crate::error::CliError;
use crate::print_text;
use crate::progress::{duration_text, significant};

/// Prints names and titles of all fabrics.
pub(crate) fn list() -> Result<(), CliError> {
    let width = LibraryFabric::ALL.into_iter().map(|fabric| fabric.name().len()).max().unwrap_or(0);
    let lines = LibraryFabric::ALL.map(|fabric| format!("{:<width$}  {}\n", fabric.name(), fabric.title()));
    print_text(&format!(
        "{}\nshow one: muslin fabric show {}\n",
        lines.concat(),
        LibraryFabric::ALL[0].name()
    ))
}

/// Prints the table of the fabric `name`, and as comments what follows from its values.
pub(crate) fn show(name: &str) -> Result<(), CliError> {
    let Some(fabric) = LibraryFabric::find(name) else {
        let names = LibraryFabric::ALL.map(LibraryFabric::name).join(", ");
        return Err(CliError::input(
            format_args!("there is no fabric `{name}`"),
            format_args!("fabrics: {names}"),
        ));
    };
    let step = stable_step(fabric)?;
    print_text(&format!("[fabric.{name}]\n{}\n{}", fabric.text(), derived(&fabric.fabric(), step)))
}

/// The largest stable step [s] of a flat sheet in cells of 10 mm.
fn stable_step(fabric: LibraryFabric) -> Result<f64, CliError> {
    let text = format!(
        "title = \"sheet\"\nrun = {{ duration = 1.0 }}\nenvironment = {{ gravity = [0, 0, 0] }}\n\
         [fabric.f]\nkind = \"library\"\nname = \"{}\"\n\
         [[cloth]]\nname = \"sheet\"\nfabric = \"f\"\n\
         grid = {{ columns = 21, rows = 21, width = 0.2, height = 0.2 }}\n\
         place = {{ origin = [0, 0, 0], width_axis = [1, 0, 0], height_axis = [0, 1, 0] }}\n",
        fabric.name()
    );
    let scene = Scene::parse(&text).map_err(|error| CliError::BadInput(error.render("sheet", &text)))?;
    let model = Model::new(&scene);
    Ok(largest_stable_step(&model, &model.initial_state(&scene), &Workers::single()))
}

/// What follows from the values of `fabric`, a comment a line; `step` [s] is the largest stable one.
fn derived(fabric: &MeasuredFabric, step: f64) -> String {
    let step = format!("{} in cells of 10 mm, unstretched", duration_text(step));
    format!("{}#   {:<22} {step}\n", properties(fabric), "largest stable step")
}

/// What follows from the values of `fabric` whatever the grid, a comment a line.
pub(crate) fn properties(fabric: &MeasuredFabric) -> String {
    let mut text = String::from("# what follows from these values\n");
    for (what, value) in lines(fabric) {
        let _ = writeln!(text, "#   {what:<22} {value}");
    }
    text
}

/// Names of quantities of `fabric`, and their values with units.
pub(crate) fn lines(fabric: &MeasuredFabric) -> Vec<(&'static str, String)> {
    let mut lines = Vec::new();
    let mut line = |what: &'static str, value: String| lines.push((what, value));
    line("areal density", format!("{} g/m²", significant(1e3 * fabric.areal_density)));
    line("tension along warp", tension(&fabric.warp));
    line("tension along weft", tension(&fabric.weft));
    line("shear modulus", format!("{} N/m", significant(fabric.shear_modulus)));
    let (bending, bending_model) = (fabric.bending, fabric.bending_model);
    let [warp, weft, bias] =
        [bending.warp, bending.weft, bending.bias()].map(|rigidity| significant(1e6 * rigidity));
    line("bending rigidity", format!("{warp} µN m along warp, {weft} along weft, {bias} at 45°"));
    if let Some(text) = friction(fabric) {
        line("held by friction", text);
    }
    let [warp, weft] = bending.bending_lengths(fabric.areal_density).map(|length| significant(1e3 * length));
    if bending_model == BendingModel::ChoiKo {
        line("bent by", "links that buckle at once".to_owned());
    }
    line("bending length", format!("{warp} mm along warp, {weft} along weft"));
    let [narrowest, widest] = fabric.cell_ratios();
    line(
        "cells of a grid",
        format!(
            "more than {} and less than {} times as wide as high",
            significant(narrowest),
            significant(widest)
        ),
    );
    lines
}

/// The curvature that friction can hold, 2HB / 2B, if there is any.
fn friction(fabric: &MeasuredFabric) -> Option<String> {
    let held = |friction: Option<BendingFriction>, rigidity: f64| {
        friction.map_or(0.0, |friction| friction.moment / rigidity)
    };
    let warp = held(fabric.friction.warp_bend, fabric.bending.warp);
    let weft = held(fabric.friction.weft_bend, fabric.bending.weft);
    let text = format!("curvature of {} /m along warp, {} along weft", significant(warp), significant(weft));
    (0.0 < warp + weft).then_some(text)
}

fn tension(tension: &MembraneTension) -> String {
    match tension {
        MembraneTension::Linear { modulus } => format!("{} N/m times the strain", significant(*modulus)),
        MembraneTension::Tangent { modulus, .. } => format!(
            "{} N/m at rest; strain stays below {} %",
            significant(*modulus),
            significant(100.0 * tension.asymptote().unwrap_or(f64::INFINITY))
        ),
        MembraneTension::Curve(curve) => format!("a table of {} points", curve.points().len()),
    }
}
