//! Every reading of the limit on grids that get finer.

use super::axis::Axis;
use super::extent::Extent;
use super::plot::{Plot, Series, Style};
use super::progress::Progress;
use super::report::{Cell, Column, Content, Figure, Item, Section, Table, per_cent};
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
    let mut trials = Vec::new();
    for &side in extent.sides {
        for reading in READINGS {
            let trial = Trial::new(reading, side, extent.duration, steps(reading, side)).watching_stability();
            trials.push((reading, side, trial));
        }
    }
    progress.begin(share, trials.iter().map(|(_, _, trial)| trial.work).sum());
    let mut cases = Vec::new();
    for (reading, side, trial) in trials {
        cases.push(Case { reading, side, outcome: run(&trial, progress)? });
    }
    Ok(Section {
        name: "refinement",
        title: "Readings and grids",
        finding: finding(&cases),
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

/// Adaptive steps where the motion does not depend on them; else a constant one with room to the largest stable one.
fn steps(reading: Reading, side: usize) -> Steps {
    if reading.converges {
        return Steps::Adaptive;
    }
    // The largest stable step falls as the side of a cell.
    Steps::PerFrame((reading.steps_per_frame * side as u64).div_ceil(10))
}

/// Largest strains of every reading on the coarsest and on the finest grid.
fn finding(cases: &[Case]) -> String {
    let parts = READINGS.iter().filter_map(|reading| {
        let mut of_reading = cases.iter().filter(|case| case.reading.name == reading.name);
        let (first, last) = (of_reading.next()?, of_reading.next_back()?);
        let [from, to] = [first, last].map(|case| per_cent(case.outcome.max_strain));
        Some(format!("{} from {from} to {to}", reading.name))
    });
    let [from, to] = [cases.first(), cases.last()].map(|case| case.map_or(0, |case| case.side));
    format!(
        "From {from} x {from} to {to} x {to} particles the largest strain goes: {}.",
        parts.collect::<Vec<_>>().join("; ")
    )
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
