//! The paper's two claims on cost: time grows with the number of particles, and steps must be short but not too short.

use super::axis::Axis;
use super::extent::Extent;
use super::plot::{Plot, Series, Style};
use super::progress::Progress;
use super::report::{Cell, Column, Content, Figure, Item, Section, Table, rounded};
use super::trial::{FRAME_RATE, Outcome, Steps, Trial, reading, run};
use crate::error::CliError;
use muslin::integrate::{Workers, largest_stable_step};
use muslin::{Model, suggested_step};

/// Particles times steps that a measurement of time takes about.
const MEASURED_WORK: f64 = 1.2e7;

/// Time of a step on one grid.
struct Cost {
    side: usize,
    particles: f64,
    /// Largest stable step of the flat cloth [s].
    stable_step: f64,
    /// Wall time of a step [s].
    step_seconds: f64,
    /// Steps that a simulated second takes.
    steps_per_second: f64,
}

/// The section on time against the number of particles.
pub(crate) fn particles_section(
    extent: &Extent,
    share: f64,
    progress: &Progress<'_>,
) -> Result<Section, CliError> {
    progress.begin(share, extent.cost_sides.len());
    let mut costs = Vec::new();
    for &side in extent.cost_sides {
        costs.push(measure(side, progress)?);
    }
    let per_step = exponent(&costs, |cost| cost.step_seconds);
    let per_second = exponent(&costs, |cost| cost.step_seconds * cost.steps_per_second);
    let steps = exponent(&costs, |cost| cost.steps_per_second);
    Ok(Section {
        name: "particles",
        title: "Time against the number of particles",
        items: vec![
            Item::text(
                "The paper says that the time of computation grows rapidly with the number of particles. A step does not: each \
                 particle has at most twelve springs, so that its time is proportional to the number of particles. But finer \
                 grids have faster modes and need shorter steps. The step taken here is nine tenths of the largest stable \
                 one of the flat cloth, under Hooke's law.",
            ),
            Item::text(format!(
                "The number of steps for a simulated second grows with the number of particles to the power of {}: with the square \
                 root, since the mass of a particle falls with their number and the spring constants stay.",
                rounded(steps, 3)
            )),
            Item::timed(Item::text(format!(
                "Measured in this run, on one thread: the time of a step grows with the number of particles to the power of {}, \
                 and that of a simulated second to the power of {}.",
                rounded(per_step, 3),
                rounded(per_second, 3)
            ))),
            Item::timed(Item::Figure(time_figure(&costs))),
            Item::Table(cost_table(&costs)),
        ],
    })
}

fn measure(side: usize, progress: &Progress<'_>) -> Result<Cost, CliError> {
    let linear = reading("none");
    let particles = (side * side) as f64;
    let scene = Trial::new(linear, side, 1.0 / FRAME_RATE, Steps::PerFrame(1 << 16)).scene();
    let model = Model::new(&scene);
    let stable_step = largest_stable_step(&model, &model.initial_state(&scene), &Workers::single());
    let step = suggested_step(FRAME_RATE, stable_step);
    let per_frame = (1.0 / (FRAME_RATE * step)).round() as u64;
    let frames = (MEASURED_WORK / (particles * per_frame as f64)).clamp(1.0, 30.0).round();
    let trial = Trial::new(linear, side, frames / FRAME_RATE, Steps::PerFrame(per_frame));
    let outcome = run(&trial, progress)?;
    let step_seconds = outcome.stepping_seconds / outcome.steps.accepted as f64;
    Ok(Cost { side, particles, stable_step, step_seconds, steps_per_second: FRAME_RATE * per_frame as f64 })
}

/// The slope of the straight line through the logarithms of number of particles and `value`, by least squares.
fn exponent(costs: &[Cost], value: impl Fn(&Cost) -> f64) -> f64 {
    let points: Vec<[f64; 2]> =
        costs.iter().map(|cost| [libm::log(cost.particles), libm::log(value(cost))]).collect();
    slope(&points)
}

fn slope(points: &[[f64; 2]]) -> f64 {
    let count = points.len() as f64;
    let mean = |axis: usize| points.iter().map(|point| point[axis]).sum::<f64>() / count;
    let (x_mean, y_mean) = (mean(0), mean(1));
    let products: f64 = points.iter().map(|[x, y]| (x - x_mean) * (y - y_mean)).sum();
    let squares: f64 = points.iter().map(|[x, _]| (x - x_mean) * (x - x_mean)).sum();
    products / squares
}

fn time_figure(costs: &[Cost]) -> Figure {
    let points = |value: &dyn Fn(&Cost) -> f64| -> Vec<[f64; 2]> {
        costs.iter().map(|cost| [cost.particles, value(cost)]).collect()
    };
    Figure {
        name: "figure-6-particles",
        caption: "Measured time of one step, and of a simulated second, against the number of particles."
            .to_owned(),
        content: Content::Plot(Plot {
            x: Axis::logarithmic("particles"),
            y: Axis::logarithmic("time [s]"),
            series: vec![
                Series::new("one step", 1, Style::Marked, points(&|cost| cost.step_seconds)),
                Series::new(
                    "a simulated second",
                    2,
                    Style::Marked,
                    points(&|cost| cost.step_seconds * cost.steps_per_second),
                ),
            ],
        }),
    }
}

fn cost_table(costs: &[Cost]) -> Table {
    let rows = costs.iter().map(|cost| {
        vec![
            Cell::text(format!("{0} x {0}", cost.side)),
            Cell::rounded(1e3 * cost.stable_step),
            Cell::count(cost.steps_per_second as u64),
            Cell::rounded(1e6 * cost.step_seconds),
            Cell::rounded(1e9 * cost.step_seconds / cost.particles),
            Cell::rounded(cost.step_seconds * cost.steps_per_second),
        ]
    });
    Table {
        name: "table-6-particles",
        caption: "What a step and a simulated second cost.".to_owned(),
        columns: vec![
            Column::new("grid"),
            Column::new("largest stable step [ms]"),
            Column::new("steps per simulated second"),
            Column::timed("time of a step [µs]"),
            Column::timed("per particle [ns]"),
            Column::timed("time of a simulated second [s]"),
        ],
        rows: rows.collect(),
    }
}

/// A run with its error.
struct Accuracy {
    name: String,
    outcome: Outcome,
    error: f64,
}

/// How often the constant step is halved; the run that all are compared with has two halvings more.
const HALVINGS: u32 = 5;

/// The section on step against error.
pub(crate) fn steps_section(
    extent: &Extent,
    share: f64,
    progress: &Progress<'_>,
) -> Result<Section, CliError> {
    progress.begin(share, 2 * (HALVINGS + 2) as usize);
    let mut items = vec![Item::text(
        "The other factor, says the paper, is the step: it should be as short as possible, but the shorter it is the longer the \
         computation takes; hence an adaptive step, of which nothing more is said. The error here is the largest distance of \
         any particle, in any frame, from a run with a quarter of the shortest step.",
    )];
    for (name, table_name, figure_name) in
        [("none", "table-7-hooke", "figure-7-hooke"), ("tangent", "table-7-tangent", "figure-7-tangent")]
    {
        let reading = reading(name);
        let first = if name == "none" { 4 } else { reading.steps_per_frame };
        let trial = |count: u64| {
            Trial::new(reading, extent.side, extent.duration, Steps::PerFrame(count)).keeping_positions()
        };
        let converged = run(&trial(first << (HALVINGS + 2)), progress)?;
        let mut rows = Vec::new();
        for halving in 0..=HALVINGS {
            let count = first << halving;
            let outcome = run(&trial(count), progress)?;
            let error = outcome.distance_to(&converged);
            rows.push(Accuracy { name: "constant".to_owned(), outcome, error });
        }
        items.push(Item::Figure(error_figure(figure_name, name, &rows)));
        items.push(Item::Table(error_table(table_name, name, &rows)));
    }
    // Figures beside each other, tables below.
    items.sort_by_key(|item| matches!(item, Item::Table(_)));
    Ok(Section { name: "steps", title: "Step against error", items })
}

fn error_figure(figure_name: &'static str, reading: &str, rows: &[Accuracy]) -> Figure {
    let points = |name: &str| -> Vec<[f64; 2]> {
        let of_name = rows.iter().filter(|row| row.name == name);
        of_name.map(|row| [row.outcome.steps.accepted as f64, 1e3 * row.error]).collect()
    };
    Figure {
        name: figure_name,
        caption: format!("Error against the number of steps, with the reading {reading}."),
        content: Content::Plot(Plot {
            x: Axis::logarithmic("steps"),
            y: Axis::logarithmic("error [mm]"),
            series: vec![Series::new("constant step", 1, Style::Marked, points("constant"))],
        }),
    }
}

fn error_table(table_name: &'static str, reading: &str, rows: &[Accuracy]) -> Table {
    let rows = rows.iter().map(|row| {
        let milliseconds = |step: Option<f64>| Cell::rounded(1e3 * step.unwrap_or(f64::NAN));
        vec![
            Cell::text(&*row.name),
            Cell::count(row.outcome.steps.accepted),
            milliseconds(row.outcome.steps.smallest),
            milliseconds(row.outcome.steps.largest),
            Cell::rounded(1e3 * row.error),
            Cell::rounded(row.outcome.residual()),
            Cell::rounded(1e3 * row.outcome.stepping_seconds),
        ]
    });
    Table {
        name: table_name,
        caption: format!("Step and error with the reading {reading}."),
        columns: vec![
            Column::new("step"),
            Column::new("steps"),
            Column::new("smallest [ms]"),
            Column::new("largest [ms]"),
            Column::new("error [mm]"),
            Column::new("energy residual [1]"),
            Column::timed("time [ms]"),
        ],
        rows: rows.collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slope_is_that_of_a_power_law() {
        let points: Vec<[f64; 2]> =
            (1..6).map(|n| f64::from(n)).map(|x| [x.ln(), (3.0 * x.powf(1.5)).ln()]).collect();
        assert!((slope(&points) - 1.5).abs() < 1e-12);
    }
}
