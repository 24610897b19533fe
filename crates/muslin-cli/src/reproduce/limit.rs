//! Fig. 4: the limit to elongation, and what each reading of it does to a hanging cloth.

use std::f64::consts::PI;

use muslin::force::TangentLaw;

use super::extent::Extent;
use super::progress::Progress;
use super::report::{Cell, Column, Content, Figure, Item, Section, Table, per_cent, rounded};
use super::trial::{FRAME_RATE, Outcome, READINGS, Reading, Steps, Trial, run};
use crate::error::CliError;
use crate::plot::{Axis, Plot, Series, Style};

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
    let counts = |reading: &Reading| {
        let first = reading.steps_per_frame;
        (0..=HALVINGS).map(move |halving| first << halving)
    };
    let trial = |reading: Reading, count: u64| {
        let trial = Trial::new(reading, extent.side, extent.duration, Steps::PerFrame(count));
        Trial { work: count as f64, ..trial }
    };
    progress.begin(share, READINGS.iter().flat_map(counts).sum::<u64>() as f64);
    let mut all = Vec::new();
    for reading in READINGS {
        let mut runs = Runs { reading, steps: Vec::new(), outcomes: Vec::new() };
        for count in counts(&reading) {
            runs.steps.push(1.0 / (FRAME_RATE * count as f64));
            runs.outcomes.push(run(&trial(reading, count), progress)?);
        }
        all.push(runs);
    }
    Ok(Section {
        name: "limit",
        title: "Fig. 4: the limit to elongation",
        finding: finding(&all),
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
            Item::Figure(taken_figure(&all)),
            Item::Table(table(&all)),
            Item::Terms(all.iter().map(verdict).collect()),
            Item::text(DEFAULT),
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
        per_cent(TangentLaw::new(1.0, 0.06).asymptote()),
        per_cent(adopted(0.05)),
        per_cent(adopted(0.2)),
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
            y: Axis::linear("adopted elongation y / L [%]").between(0.0, 20.0),
            series: vec![
                Series::new("(a) cut-off", 3, Style::Line, xs().map(|x| per_cent([x, x.min(CUT_OFF)]))),
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
            x: Axis::linear("strain [%]").between(0.0, 40.0),
            y: Axis::linear("tension / k L [1]").between(0.0, 0.4),
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
        let scale = outcome.largest_change();
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

/// What limits take, which laws of tension do not.
fn taken_figure(all: &[Runs]) -> Figure {
    let limits = all.iter().filter(|runs| !runs.reading.converges);
    let series = limits.flat_map(|runs| {
        let ends =
            [(runs.outcomes.first(), "h", Style::Line), (runs.outcomes.last(), "h / 16", Style::Guide)];
        ends.into_iter().filter_map(|(outcome, step, style)| {
            let outcome = outcome?;
            let scale = outcome.largest_change();
            let points = outcome.energies().map(|(time, terms)| [time, 100.0 * terms.limit_loss / scale]);
            Some(Series::new(format!("{}, {step}", runs.reading.name), runs.reading.colour, style, points))
        })
    });
    Figure {
        name: "figure-4-taken",
        caption: "Energy that a limit has taken from the cloth, relative to the largest change of any term of the ledger, at the longest \
                  step h and at the shortest. The projection gives some back, as a stiffness does; the laws of tension take none."
            .to_owned(),
        content: Content::Plot(Plot {
            x: Axis::linear("time [s]"),
            y: Axis::linear("energy taken [%]"),
            series: series.collect(),
        }),
    }
}

fn table(all: &[Runs]) -> Table {
    let rows = all.iter().map(|runs| {
        let mut row = vec![Cell::text(runs.reading.name), Cell::rounded(1e3 * runs.steps[0])];
        row.extend(runs.outcomes.iter().map(|outcome| {
            let strain = outcome.max_strain;
            Cell::number(strain, format!("{}\u{a0}%", rounded(100.0 * strain, 5)))
        }));
        let ends = [runs.outcomes.first(), runs.outcomes.last()];
        row.extend(ends.into_iter().flatten().map(|outcome| Cell::rounded(outcome.residual())));
        row.push(runs.outcomes.first().map_or(Cell::None, |outcome| {
            let taken = outcome.frames.last().map_or(f64::NAN, |frame| frame.energies.limit_loss);
            if taken == 0.0 { Cell::None } else { Cell::per_cent(taken / outcome.largest_change()) }
        }));
        row
    });
    Table {
        name: "table-4-steps",
        caption: "Largest strain of each reading with the step halved again and again, and the energy that the ledger lacks, and \
                  that a limit takes, relative to the largest change of any of the ledger's terms."
            .to_owned(),
        columns: [
            "reading",
            "longest step h [ms]",
            "largest strain at h",
            "at h / 2",
            "at h / 4",
            "at h / 8",
            "at h / 16",
            "missing energy [1] at h",
            "the same at h / 16",
            "taken by the limit, at h",
        ]
        .map(Column::new)
        .to_vec(),
        rows: rows.collect(),
    }
}

/// Relative change of the strain from the longest to the shortest step [1] from which on a motion depends on its step.
const DEPENDENCE: f64 = 0.02;

impl Runs {
    /// Largest strains [1] at the longest and at the shortest step.
    fn strains(&self) -> [f64; 2] {
        [self.outcomes.first(), self.outcomes.last()]
            .map(|o| o.map_or(f64::NAN, |outcome| outcome.max_strain))
    }

    /// Relative change [1] of the largest strain from the longest to the shortest step.
    fn change(&self) -> f64 {
        let [longest, shortest] = self.strains();
        (shortest / longest - 1.0).abs()
    }
}

/// What the runs say of a reading.
fn verdict(runs: &Runs) -> (String, String) {
    let [longest, shortest] = runs.strains();
    let found = if runs.change() < DEPENDENCE {
        let change = rounded(100.0 * runs.change(), 1);
        format!("Largest strain {}, the same at every step to {change} % of itself.", per_cent(longest))
    } else {
        format!(
            "Largest strain {} at the longest step and {} at the shortest: the result depends on the step.",
            per_cent(longest),
            per_cent(shortest)
        )
    };
    (runs.reading.name.to_owned(), format!("{} {found}", runs.reading.meaning))
}

/// The largest strains of all readings at the longest step.
fn finding(all: &[Runs]) -> String {
    let strains = all.iter().map(|runs| format!("{} ({})", per_cent(runs.strains()[0]), runs.reading.name));
    let dependent = all.iter().filter(|runs| DEPENDENCE <= runs.change());
    let dependent: Vec<&str> = dependent.map(|runs| runs.reading.name).collect();
    let mut text = format!(
        "Our reading is the tangent law. Largest strains of the same cloth: {}.",
        strains.collect::<Vec<_>>().join(", ")
    );
    if !dependent.is_empty() {
        text.push_str(&format!(" Dependent on the step: {}.", dependent.join(", ")));
    }
    text
}

/// Which reading is ours, and why.
const DEFAULT: &str = "Our reading is the tangent law. It keeps every spring below the end of the paper's curve, it has an energy, its motion \
     does not depend on the step, and it stiffens as the fabrics of Fig. 2 do. The text of the paper speaks for it, too: the \
     limit that the curve replaces is one of length, so y is an elongation and not a force. Its price is a short step, \
     since a spring near its limit is many times as stiff as at rest.";
