//! Every reading of the limit on grids that get finer.

use muslin::force::TangentLaw;

use super::accuracy::SAFE_SHARE;
use super::extent::Extent;
use super::progress::Progress;
use super::report::{Cell, Column, Content, Figure, Item, Section, Table, grouped, per_cent};
use super::trial::{Outcome, READINGS, Reading, Steps, Trial, run};
use crate::error::CliError;
use crate::plot::{Axis, Plot, Series, Style};

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
            Item::text(format!(
                "Held by two points, the cloth has no finite strain there under Hooke's law: the finer the grid, the narrower the \
                 strip that carries the weight, and the strain grows without end. Under the tangent law it stays below the {} of the \
                 paper's curve on every grid, at the price of more steps. A cut-off holds on a coarse grid, but on a fine one its \
                 passes do not reach far enough, and strains exceed the limit. What the projection gives is a matter of its step, \
                 which is here halved with the size of the cells.",
                per_cent(TangentLaw::new(1.0, 0.06).asymptote())
            )),
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

/// How many constant steps of a safe size the run would take.
fn constant_steps(outcome: &Outcome) -> f64 {
    let duration = outcome.frames.last().map_or(f64::NAN, |frame| frame.time);
    (duration / (SAFE_SHARE * outcome.stable_step)).ceil()
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
    let parts = parts.collect::<Vec<_>>().join("; ");
    let mut text = format!("From {from} x {from} to {to} x {to} particles the largest strain goes: {parts}.");
    if let Some(finest) = cases.iter().rfind(|case| case.reading.name == "tangent") {
        text.push_str(&format!(
            " On the finest grid the tangent law takes {} adaptive steps, where safe constant ones are {}.",
            grouped(finest.outcome.steps.accepted),
            grouped(constant_steps(&finest.outcome) as u64)
        ));
    }
    text
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
        let constant = constant_steps(outcome);
        let strain = match &outcome.failure {
            None => Cell::per_cent(outcome.max_strain),
            Some(_) => Cell::text("unstable"),
        };
        vec![
            Cell::text(format!("{0} x {0}", case.side)),
            Cell::text(case.reading.name),
            strain,
            Cell::count(outcome.steps.accepted),
            Cell::rounded(1e3 * outcome.stable_step),
            if constant.is_finite() { Cell::count(constant as u64) } else { Cell::None },
            Cell::rounded(outcome.residual()),
            Cell::rounded(outcome.stepping_seconds),
        ]
    });
    Table {
        name: "table-5-refinement",
        caption: "Readings and grids. Steps are adaptive, but constant with the two limits whose results depend on them. The largest \
                  stable step is that of the stiffest state on the way, found by Lanczos \
                  iteration; safe constant steps are of nine tenths of it all through the run."
            .to_owned(),
        columns: vec![
            Column::new("grid"),
            Column::new("reading"),
            Column::new("largest strain"),
            Column::new("steps"),
            Column::new("largest stable step [ms]"),
            Column::new("safe constant steps"),
            Column::new("missing energy [1]"),
            Column::timed("time of the steps [s]"),
        ],
        rows: rows.collect(),
    }
}
