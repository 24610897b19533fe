//! The paper's first claim on cost: time grows with the number of particles.

use super::extent::Extent;
use super::progress::Progress;
use super::report::{Cell, Column, Content, Figure, Item, Section, Table, rounded};
use super::trial::{FRAME_RATE, Steps, Trial, reading, run};
use crate::error::CliError;
use crate::plot::{Axis, Plot, Series, Style};
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
pub(crate) fn section(extent: &Extent, share: f64, progress: &Progress<'_>) -> Result<Section, CliError> {
    // Each takes about as long as the others.
    progress.begin(share, extent.cost_sides.len() as f64);
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
        finding: format!(
            "A simulated second takes a number of steps that grows with the number of particles to the power of {}; the time of \
             each is about proportional to that number.",
            rounded(steps, 3)
        ),
        items: vec![
            Item::text(
                "The paper says that the time of computation grows rapidly with the number of particles. A step does not: each \
                 particle has at most twelve springs, so that its time is proportional to the number of particles. But finer \
                 grids have faster modes and need shorter steps. The step taken here is nine tenths of the largest stable \
                 one of the flat cloth, under Hooke's law.",
            ),
            Item::text(format!(
                "The number of steps for a simulated second grows with the number of particles to the power of {}, about as the square \
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
    let trial = Trial { work: 1.0, ..trial };
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slope_is_that_of_a_power_law() {
        let points: Vec<[f64; 2]> =
            (1..6).map(f64::from).map(|x| [x.ln(), (3.0 * x.powf(1.5)).ln()]).collect();
        assert!((slope(&points) - 1.5).abs() < 1e-12);
    }
}
