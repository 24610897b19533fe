//! Fig. 4: the limit to elongation, and what each reading of it does to a hanging cloth.

use std::f64::consts::PI;

use muslin::force::TangentLaw;

use super::axis::Axis;
use super::extent::Extent;
use super::plot::{Plot, Series, Style};
use super::progress::Progress;
use super::report::{Cell, Column, Content, Figure, Item, Section, Table, rounded};
use super::trial::{FRAME_RATE, Outcome, READINGS, Reading, Steps, Trial, run};
use crate::error::CliError;

/// Extension at which Fig. 4 (a) is drawn to stop, relative to the rest length [1].
const CUT_OFF: f64 = 0.1;

/// Points of a drawn curve.
const POINTS: usize = 100;

/// How often the step is halved.
const HALVINGS: u32 = 4;

/// A reading's runs, each with half of the step of the one before.
struct Runs {
    reading: Reading,
    steps: Vec<f64>,
    outcomes: Vec<Outcome>,
}

/// The section with the curves and the runs.
pub(crate) fn section(extent: &Extent, share: f64, progress: &Progress<'_>) -> Result<Section, CliError> {
    let mut all = Vec::new();
    progress.begin(share, READINGS.len() * (HALVINGS + 1) as usize);
    for reading in READINGS {
        let counts = (0..=HALVINGS).map(|halving| reading.steps_per_frame << halving);
        let mut runs = Runs { reading, steps: Vec::new(), outcomes: Vec::new() };
        for count in counts {
            let trial = Trial::new(reading, extent.side, extent.duration, Steps::PerFrame(count));
            runs.steps.push(1.0 / (FRAME_RATE * count as f64));
            runs.outcomes.push(run(&trial, progress)?);
        }
        all.push(runs);
    }
    Ok(Section {
        name: "limit",
        title: "Fig. 4: the limit to elongation",
        items: vec![
            Item::text(
                "Springs of such a cloth stretch too much. Fig. 4 (a) is what earlier methods did: up to a limit the elongation \
                 is the spring's own, beyond it the length no longer changes. Fig. 4 (b) puts a smooth curve in its place, \
                 y = 0.06 L arctan(5π x / L), from the elongation x to the one adopted, y. Where y enters the equation of \
                 motion is not said.",
            ),
            Item::Figure(curve_figure()),
            Item::Figure(tension_figure()),
            Item::text(curve_text()),
            Item::text(format!(
                "Below, a cloth of {0} x {0} particles hangs by two corners under each reading, for {1} s. The strain is the \
                 largest of any structural spring, over all steps and not only those that are drawn.",
                extent.side, extent.duration
            )),
            Item::Figure(strain_figure(&all)),
            Item::Figure(step_figure(&all)),
            Item::Figure(energy_figure(&all)),
            Item::Table(table(&all)),
            Item::text(verdict(&all)),
        ],
    })
}

/// The extension y [1] that Fig. 4 (b) gives a spring of unit length for x [1], by the law of the program.
fn adopted(x: f64) -> f64 {
    TangentLaw::new(1.0, 0.06).extension(x, 1.0)
}

fn curve_text() -> String {
    let slope = adopted(1e-9) / 1e-9;
    let printed = |x: f64| 0.06 * libm::atan(5.0 * PI * x);
    let difference = (1..=1000).map(|n| 1e-3 * f64::from(n)).map(|x| (adopted(x) - printed(x)).abs());
    format!(
        "The curve begins with a slope of {} and ends at {} of the rest length. An elongation of 5 % becomes {}, one of 20 % \
         becomes {}. The tangent law of muslin, turned round, is this curve to within {} of the rest length.",
        rounded(slope, 4),
        Cell::per_cent(TangentLaw::new(1.0, 0.06).asymptote()).shown(),
        Cell::per_cent(adopted(0.05)).shown(),
        Cell::per_cent(adopted(0.2)).shown(),
        rounded(difference.fold(0.0, f64::max), 1)
    )
}

fn curve_figure() -> Figure {
    let xs = || (0..=POINTS).map(|n| 0.4 * n as f64 / POINTS as f64);
    let per_cent = |[x, y]: [f64; 2]| [100.0 * x, 100.0 * y];
    Figure {
        name: "figure-4-curves",
        caption: format!(
            "Fig. 4: adopted elongation against that of a spring without limit. (a) is drawn with a limit of {} %.",
            100.0 * CUT_OFF
        ),
        content: Content::Plot(Plot {
            x: Axis::linear("elongation x / L [%]"),
            y: Axis::linear("adopted elongation y / L [%]").from_to(0.0, 20.0),
            series: vec![
                Series::new("(a) cut-off", 5, Style::Line, xs().map(|x| per_cent([x, x.min(CUT_OFF)]))),
                Series::new("(b) arctangent", 1, Style::Line, xs().map(|x| per_cent([x, adopted(x)]))),
                Series::new("no limit", 0, Style::Guide, [[0.0, 0.0], [40.0, 40.0]]),
            ],
        }),
    }
}

/// What (b) is as a law of tension: turned round, and taken literally.
fn tension_figure() -> Figure {
    use muslin::force::{ArctangentLaw, TensionLaw};
    let strains = |end: f64| (0..=POINTS).map(move |n| end * n as f64 / POINTS as f64);
    let tangent = TangentLaw::new(1.0, 0.06);
    let arctangent = ArctangentLaw { stiffness: 1.0 };
    Figure {
        name: "figure-4-tensions",
        caption: "The same curve as a law of tension: y as the elongation that a spring has under the force k x (tangent), and as \
                  the elongation that is put into Hooke's law (softening)."
            .to_owned(),
        content: Content::Plot(Plot {
            x: Axis::linear("strain [%]").from_to(0.0, 40.0),
            y: Axis::linear("tension / k L [1]").from_to(0.0, 0.4),
            series: vec![
                Series::new(
                    "tangent",
                    1,
                    Style::Line,
                    strains(tangent.asymptote()).map(|e| [100.0 * e, tangent.tension(e, 1.0)]),
                ),
                Series::new(
                    "softening",
                    2,
                    Style::Line,
                    strains(0.4).map(|e| [100.0 * e, arctangent.tension(e, 1.0)]),
                ),
                Series::new("none: Hooke", 0, Style::Guide, [[0.0, 0.0], [40.0, 0.4]]),
            ],
        }),
    }
}

fn strain_figure(all: &[Runs]) -> Figure {
    let series = all.iter().map(|runs| {
        let points = runs.outcomes[0].strains().map(|[time, strain]| [time, 100.0 * strain]);
        Series::new(runs.reading.name, runs.reading.colour, Style::Line, points)
    });
    Figure {
        name: "figure-4-strain",
        caption:
            "Largest strain in the cloth while it falls and swings, at the longest step of each reading."
                .to_owned(),
        content: Content::Plot(Plot {
            x: Axis::linear("time [s]"),
            y: Axis::linear("largest strain [%]"),
            series: series.collect(),
        }),
    }
}

fn step_figure(all: &[Runs]) -> Figure {
    let series = all.iter().map(|runs| {
        let strains = runs.outcomes.iter().map(|outcome| 100.0 * outcome.max_strain);
        let points = runs.steps.iter().zip(strains).map(|(step, strain)| [1e3 * step, strain]);
        Series::new(runs.reading.name, runs.reading.colour, Style::Marked, points)
    });
    Figure {
        name: "figure-4-steps",
        caption: "Largest strain of the run against its step. A law of tension gives a level line: the motion does not depend on \
                  the step."
            .to_owned(),
        content: Content::Plot(Plot {
            x: Axis::logarithmic("step [ms]"),
            y: Axis::logarithmic("largest strain of the run [%]"),
            series: series.collect(),
        }),
    }
}

fn energy_figure(all: &[Runs]) -> Figure {
    let series = all.iter().map(|runs| {
        let outcome = &runs.outcomes[0];
        let largest = outcome.energies().map(|(_, terms)| terms.residual.abs()).fold(0.0, f64::max);
        // What the residual is relative to: the largest change of any term.
        let scale = largest / outcome.residual();
        let mut so_far = 0.0_f64;
        let points = outcome.energies().map(|(time, terms)| {
            so_far = so_far.max(terms.residual.abs() / scale);
            [time, so_far]
        });
        Series::new(runs.reading.name, runs.reading.colour, Style::Line, points.collect::<Vec<_>>())
    });
    Figure {
        name: "figure-4-energy",
        caption: "Energy that the ledger lacks, the largest so far, relative to the largest change of any of its terms."
            .to_owned(),
        content: Content::Plot(Plot {
            x: Axis::linear("time [s]"),
            y: Axis::logarithmic("missing energy [1]"),
            series: series.collect(),
        }),
    }
}

fn table(all: &[Runs]) -> Table {
    let mut rows = Vec::new();
    for runs in all {
        for (step, outcome) in runs.steps.iter().zip(&runs.outcomes) {
            rows.push(vec![
                Cell::text(runs.reading.name),
                Cell::rounded(1e3 * step),
                Cell::number(outcome.max_strain, format!("{:.4} %", 100.0 * outcome.max_strain)),
                Cell::rounded(outcome.frames.last().map_or(f64::NAN, |frame| frame.lowest_point)),
                Cell::rounded(outcome.residual()),
            ]);
        }
    }
    Table {
        name: "table-4-steps",
        caption: "Each reading with the step halved again and again.".to_owned(),
        columns: [
            "reading",
            "step [ms]",
            "largest strain",
            "lowest point at the end [m]",
            "energy residual [1]",
        ]
        .map(Column::new)
        .to_vec(),
        rows,
    }
}

/// What the runs say of each reading.
fn verdict(all: &[Runs]) -> String {
    let mut sentences = Vec::new();
    for runs in all {
        let (Some(first), Some(last)) = (runs.outcomes.first(), runs.outcomes.last()) else { continue };
        let change = (last.max_strain / first.max_strain - 1.0).abs();
        sentences.push(format!(
            "{}: {} at the longest step, {} at the shortest, a change of {}.",
            runs.reading.name,
            Cell::per_cent(first.max_strain).shown(),
            Cell::per_cent(last.max_strain).shown(),
            Cell::per_cent(change).shown()
        ));
    }
    sentences.join(" ")
}
