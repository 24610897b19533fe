//! Every reading of the limit on grids that get finer.

use super::axis::Axis;
use super::extent::Extent;
use super::plot::{Plot, Series, Style};
use super::progress::Progress;
use super::report::{Cell, Column, Content, Figure, Item, Section, Table};
use super::trial::{Outcome, READINGS, Reading, Steps, Trial, run};
use crate::error::CliError;

/// A reading on one grid.
struct Case {
    reading: Reading,
    side: usize,
    outcome: Outcome,
}

/// The section with the table.
pub(crate) fn section(extent: &Extent, share: f64, progress: &Progress<'_>) -> Result<Section, CliError> {
    progress.begin(share, READINGS.len() * extent.sides.len());
    let mut cases = Vec::new();
    for &side in extent.sides {
        for reading in READINGS {
            let trial = Trial::new(reading, side, extent.duration, steps(reading, side)).watching_stability();
            cases.push(Case { reading, side, outcome: run(&trial, progress)? });
        }
    }
    Ok(Section {
        name: "refinement",
        title: "Readings and grids",
        items: vec![
            Item::text(format!(
                "The same cloth on finer grids, {} s of each. The cloth stays the same: its mass and its drag are shared out among \
                 more particles, and the spring constants are kept, since for square cells the moduli of the membrane, \
                 C = k_structural + k_shear + 4 k_bend along the yarns and G = k_shear in shear, do not depend on the size \
                 of the cell. (Bend springs are no bending rigidity: what they resist to falls with the cell.)",
                extent.duration
            )),
            Item::text(
                "Held by two points, the cloth has no finite strain there under Hooke's law: the finer the grid, the fewer threads \
                 carry the weight, and the strain grows without end. Only a limit gives a result that a finer grid \
                 confirms.",
            ),
            Item::Figure(figure(&cases)),
            Item::Table(table(&cases)),
        ],
    })
}

/// Steps that are stable on a grid of `side` x `side`: stiffness grows where fewer springs carry the weight.
fn steps(reading: Reading, side: usize) -> Steps {
    let finer = (side as f64 / 10.0).max(1.0);
    Steps::PerFrame(reading.steps_per_frame * finer.powf(1.34).ceil() as u64)
}

fn figure(cases: &[Case]) -> Figure {
    let series = READINGS.iter().map(|reading| {
        let of_reading = cases.iter().filter(|case| case.reading.name == reading.name);
        let points = of_reading.map(|case| [case.side as f64, 100.0 * case.outcome.max_strain]);
        Series::new(reading.name, reading.colour, Style::Marked, points)
    });
    Figure {
        name: "figure-5-refinement",
        caption: "Largest strain of a structural spring in any step, against the grid.".to_owned(),
        content: Content::Plot(Plot {
            x: Axis::logarithmic("particles along each side"),
            y: Axis::logarithmic("largest strain [%]"),
            series: series.collect(),
        }),
    }
}

fn table(cases: &[Case]) -> Table {
    let rows = cases.iter().map(|case| {
        let outcome = &case.outcome;
        let milliseconds = |step: Option<f64>| Cell::rounded(1e3 * step.unwrap_or(f64::NAN));
        let strain = match &outcome.failure {
            None => Cell::per_cent(outcome.max_strain),
            Some(_) => Cell::text("unstable"),
        };
        vec![
            Cell::text(format!("{0} x {0}", case.side)),
            Cell::text(case.reading.name),
            strain,
            Cell::count(outcome.steps.accepted),
            milliseconds(outcome.steps.smallest),
            Cell::rounded(1e3 * outcome.stable_step),
            Cell::rounded(outcome.residual()),
            Cell::rounded(outcome.stepping_seconds),
        ]
    });
    Table {
        name: "table-5-refinement",
        caption: "Readings and grids. The largest stable step is that of the stiffest state on the way, found by Lanczos \
                  iteration; the time is that of the steps alone, on one thread."
            .to_owned(),
        columns: vec![
            Column::new("grid"),
            Column::new("reading"),
            Column::new("largest strain"),
            Column::new("steps"),
            Column::new("smallest step [ms]"),
            Column::new("largest stable step [ms]"),
            Column::new("energy residual [1]"),
            Column::timed("time [s]"),
        ],
        rows: rows.collect(),
    }
}
