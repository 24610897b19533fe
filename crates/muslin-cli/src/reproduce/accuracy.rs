//! The paper's second claim on cost: step against error, with a constant and with an adaptive step.

use super::extent::Extent;
use super::progress::Progress;
use super::report::{Cell, Column, Content, Figure, Item, Section, Table, rounded};
use super::trial::{FRAME_RATE, Outcome, Reading, Steps, Trial, reading, run};
use crate::error::CliError;
use crate::plot::{Axis, Plot, Series, Style};

/// Tolerances of the adaptive step [m].
const TOLERANCES: [f64; 3] = [1e-5, 1e-6, 1e-7];

/// Share of the largest stable step on the way that a constant step may have.
pub(crate) const SAFE_SHARE: f64 = 0.9;

/// A run with its error.
struct Accuracy {
    kind: Kind,
    outcome: Outcome,
    /// Largest distance [m] of any particle in any frame from the converged run.
    error: f64,
}

/// How its steps were chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Constant,
    /// The largest constant step that is stable all the way.
    LargestSafe,
    Adaptive,
    Tolerance(f64),
}

/// All runs with one reading.
struct Study {
    reading: Reading,
    figure_name: &'static str,
    table_name: &'static str,
    side: usize,
    duration: f64,
    /// Steps per frame of the longest constant step.
    first: u64,
    /// How often the constant step is halved; the run that all are compared with has two halvings more.
    halvings: u32,
    /// How many times fewer steps could be, were each of them the same share of the largest stable one at its time: the
    /// largest of the fastest frequency over its mean.
    ideal_ratio: f64,
    rows: Vec<Accuracy>,
}

/// The section on step against error.
pub(crate) fn section(extent: &Extent, share: f64, progress: &Progress<'_>) -> Result<Section, CliError> {
    let mut studies = [
        Study {
            reading: reading("none"),
            figure_name: "figure-7-hooke",
            table_name: "table-7-hooke",
            side: extent.side,
            duration: extent.long_duration,
            first: 4,
            halvings: 6,
            ideal_ratio: f64::NAN,
            rows: Vec::new(),
        },
        Study {
            reading: reading("tangent"),
            figure_name: "figure-7-tangent",
            table_name: "table-7-tangent",
            side: extent.side,
            duration: extent.long_duration,
            first: 16,
            halvings: 5,
            ideal_ratio: f64::NAN,
            rows: Vec::new(),
        },
        Study {
            reading: reading("tangent"),
            figure_name: "figure-7-fine",
            table_name: "table-7-fine",
            side: extent.fine_side,
            duration: extent.duration,
            first: 56,
            halvings: 3,
            ideal_ratio: f64::NAN,
            rows: Vec::new(),
        },
    ];
    progress.begin(share, studies.iter().map(Study::work).sum());
    for study in &mut studies {
        study.run(progress)?;
    }
    let mut items = vec![Item::text(
        "The other factor, says the paper, is the step: it should be as short as possible, but the shorter it is the longer the \
         computation takes; hence an adaptive step, of which nothing more is said. muslin takes a share of a step that is certain to be stable in the shape that the cloth \
         has, less where the motion itself is fast, and goes back where a step has made springs too stiff; with a tolerance it \
         holds an estimate of the error, too.",
    )];
    items.push(Item::text(
        "The error here is the largest distance of any particle, in any frame, from a run with a quarter of the shortest \
         constant step. \"Largest safe\" is nine tenths of the largest stable step in the stiffest state on the way: one has to \
         have run the scene to know it. Where no constant step has the error of an adaptive run, it would not be stable.",
    ));
    items.extend(studies.iter().map(|study| Item::Figure(study.figure())));
    items.extend(studies.iter().map(|study| Item::Table(study.table())));
    Ok(Section {
        name: "steps",
        title: "Step against error",
        finding: studies.iter().map(Study::finding).collect::<Vec<_>>().join(" "),
        items,
    })
}

impl Study {
    /// Particles, frames and steps of all constant steps together.
    fn work(&self) -> f64 {
        self.unit() * (self.first << (self.halvings + 3)) as f64
    }

    /// Particles times simulated time [s].
    fn unit(&self) -> f64 {
        (self.side * self.side) as f64 * self.duration
    }

    fn run(&mut self, progress: &Progress<'_>) -> Result<(), CliError> {
        let (first, mut rows) = (self.first, Vec::new());
        let trial = |steps: Steps| {
            let work = match steps {
                Steps::PerFrame(count) => count as f64 * self.unit(),
                Steps::Adaptive | Steps::Tolerance(_) => first as f64 * self.unit(),
            };
            let trial = Trial::new(self.reading, self.side, self.duration, steps);
            Trial { work, ..trial }.keeping_positions().watching_stability()
        };
        let converged =
            run(&trial(Steps::PerFrame(first << (self.halvings + 2))).watching_frequency(), progress)?;
        let safe = (1.0 / (FRAME_RATE * SAFE_SHARE * converged.stable_step)).ceil() as u64;
        let constant = (0..=self.halvings).map(|halving| (Kind::Constant, Steps::PerFrame(first << halving)));
        let tolerances =
            TOLERANCES.map(|tolerance| (Kind::Tolerance(tolerance), Steps::Tolerance(tolerance)));
        let cases = constant
            .chain([(Kind::LargestSafe, Steps::PerFrame(safe)), (Kind::Adaptive, Steps::Adaptive)])
            .chain(tolerances);
        for (kind, steps) in cases {
            let outcome = run(&trial(steps), progress)?;
            rows.push(Accuracy { kind, error: outcome.distance_to(&converged), outcome });
        }
        self.ideal_ratio = 2.0 / (converged.stable_step * converged.mean_frequency);
        self.rows = rows;
        Ok(())
    }

    /// Reading, grid and simulated time.
    fn title(&self) -> String {
        format!("Reading {}, {2} x {2}, {1} s", self.reading.name, self.duration, self.side)
    }

    fn finding(&self) -> String {
        let find = |kind| self.rows.iter().find(|row| row.kind == kind);
        let (Some(safe), Some(adaptive)) = (find(Kind::LargestSafe), find(Kind::Adaptive)) else {
            return String::new();
        };
        let count = |row: &Accuracy| row.outcome.steps.accepted;
        let measured = count(safe) as f64 / count(adaptive) as f64;
        format!(
            "{}: {} steps of the largest safe constant size err by {}\u{a0}mm, {} adaptive ones by {}\u{a0}mm: {} times fewer, \
             where steps in proportion to the largest stable one would be {} times fewer.",
            self.title(),
            count(safe),
            rounded(1e3 * safe.error, 2),
            count(adaptive),
            rounded(1e3 * adaptive.error, 2),
            rounded(measured, 2),
            rounded(self.ideal_ratio, 2)
        )
    }

    /// How many constant steps have the error of `row`, whose own steps are adaptive: between those that were tried, on a
    /// straight line through the logarithms of steps and errors. None beyond them.
    fn equal_constant_steps(&self, row: &Accuracy) -> Option<f64> {
        let is_constant = |row: &&Accuracy| matches!(row.kind, Kind::Constant | Kind::LargestSafe);
        if is_constant(&row) {
            return None;
        }
        let mut constant: Vec<&Accuracy> = self.rows.iter().filter(is_constant).collect();
        constant.sort_by_key(|row| row.outcome.steps.accepted);
        let pair =
            constant.windows(2).find(|pair| pair[1].error <= row.error && row.error < pair[0].error)?;
        let [coarse, fine] = [pair[0], pair[1]];
        let share = libm::log(row.error / coarse.error) / libm::log(fine.error / coarse.error);
        let [from, to] = [coarse, fine].map(|row| row.outcome.steps.accepted as f64);
        Some(from * libm::pow(to / from, share))
    }

    fn figure(&self) -> Figure {
        let points = |is_meant: &dyn Fn(Kind) -> bool| -> Vec<[f64; 2]> {
            let meant = self.rows.iter().filter(|row| is_meant(row.kind));
            meant.map(|row| [row.outcome.steps.accepted as f64, 1e3 * row.error]).collect()
        };
        Figure {
            name: self.figure_name,
            caption: format!("{}: error against the number of steps.", self.title()),
            content: Content::Plot(Plot {
                x: Axis::logarithmic("steps"),
                y: Axis::logarithmic("error [mm]"),
                series: vec![
                    Series::new("constant", 0, Style::Marked, points(&|kind| kind == Kind::Constant)),
                    Series::new("largest safe", 3, Style::Marks, points(&|kind| kind == Kind::LargestSafe)),
                    Series::new("adaptive", 1, Style::Marks, points(&|kind| kind == Kind::Adaptive)),
                    Series::new(
                        "with tolerance",
                        2,
                        Style::Marked,
                        points(&|kind| matches!(kind, Kind::Tolerance(_))),
                    ),
                ],
            }),
        }
    }

    fn table(&self) -> Table {
        let rows = self.rows.iter().map(|row| {
            let steps = row.outcome.steps;
            let milliseconds = |step: Option<f64>| Cell::rounded(1e3 * step.unwrap_or(f64::NAN));
            let error = match &row.outcome.failure {
                None => Cell::rounded(1e3 * row.error),
                Some(_) => Cell::text("unstable"),
            };
            vec![
                Cell::text(match row.kind {
                    Kind::Constant => "constant".to_owned(),
                    Kind::LargestSafe => "constant, largest safe".to_owned(),
                    Kind::Adaptive => "adaptive".to_owned(),
                    Kind::Tolerance(tolerance) => {
                        format!("tolerance {} mm", rounded(1e3 * tolerance, 1))
                    }
                }),
                Cell::count(steps.accepted),
                Cell::count(steps.rejected),
                milliseconds(steps.smallest),
                milliseconds(steps.largest),
                error,
                self.equal_constant_steps(row).map_or(Cell::None, |steps| Cell::count(steps.round() as u64)),
                Cell::rounded(row.outcome.residual()),
                Cell::rounded(1e3 * row.outcome.stepping_seconds),
            ]
        });
        Table {
            name: self.table_name,
            caption: format!("{}: steps and errors.", self.title()),
            columns: vec![
                Column::new("step"),
                Column::new("steps"),
                Column::new("taken back"),
                Column::new("smallest [ms]"),
                Column::new("largest [ms]"),
                Column::new("error [mm]"),
                Column::new("constant steps of that error"),
                Column::new("missing energy [1]"),
                Column::timed("time [ms]"),
            ],
            rows: rows.collect(),
        }
    }
}
