//! Plots of a fit: what was measured beside its law, and what the law leaves over.

use std::f64::consts::PI;

use muslin_fit::{Kind, Outcome, Test};

use crate::plot::{Axis, Plot, Series, Style};

/// A plot with its name and what it shows.
pub(super) struct Figure {
    /// Name of its file without ending.
    pub(super) name: String,
    pub(super) caption: String,
    pub(super) plot: Plot,
}

/// Axes of a test: label, and how many of its unit are one in SI.
struct Axes {
    x: (&'static str, f64),
    y: (&'static str, f64),
}

impl Axes {
    fn of(kind: Kind) -> Self {
        const DEGREES: f64 = 180.0 / PI;
        match kind.test() {
            Test::Tensile => Self { x: ("strain [%]", 100.0), y: ("tension per width [N/m]", 1.0) },
            Test::Shear => Self { x: ("angle [deg]", DEGREES), y: ("force per width [N/m]", 1.0) },
            Test::Bend => Self { x: ("curvature [1/cm]", 0.01), y: ("moment per width [mN]", 1000.0) },
            Test::Cantilever => {
                Self { x: ("angle of the chord [deg]", DEGREES), y: ("overhang [mm]", 1000.0) }
            }
        }
    }
}

/// The plots of `outcome`: none of values one a specimen.
pub(super) fn figures(outcome: &Outcome) -> Vec<Figure> {
    if outcome.points.is_empty() {
        return Vec::new();
    }
    let axes = Axes::of(outcome.kind);
    let direction = outcome.direction.map_or(String::new(), |direction| format!("-{direction}"));
    let name = format!("{}{direction}", outcome.kind.test().name());
    let (x, y) = (axes.x.1, axes.y.1);
    let measured = outcome.points.iter().map(|point| [x * point.at, y * point.measured]);
    let fitted = outcome.points.iter().map(|point| [x * point.at, y * point.fitted]);
    let rest = outcome.points.iter().map(|point| [x * point.at, y * (point.measured - point.fitted)]);
    let rest: Vec<[f64; 2]> = rest.collect();
    // Both signs alike, with room for the marks; some room too where nothing is left.
    let largest =
        rest.iter().fold(f64::MIN_POSITIVE.sqrt(), |largest, point| largest.max(1.08 * point[1].abs()));
    let ends = outcome.points.iter().map(|point| x * point.at);
    let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
    // Room for the marks at both ends; two readings at one angle have no extent.
    let room = (0.03 * (high - low)).max(1e-3 * high.abs());
    let across = || Axis::linear(axes.x.0).between(low - room, high + room);
    let curve = Plot {
        x: across(),
        y: Axis::linear(axes.y.0),
        series: vec![
            Series::new("measured", 2, Style::Marks, measured),
            Series::new("fitted", 1, Style::Line, fitted),
        ],
    };
    let residuals = Plot {
        x: across(),
        y: Axis::linear(format!("measured less fitted, {}", axes.y.0)).between(-largest, largest),
        series: vec![
            Series::new("measured", 2, Style::Marks, rest.iter().copied()),
            Series::new("fitted", 1, Style::Guide, [[low, 0.0], [high, 0.0]]),
        ],
    };
    let subject = outcome.subject();
    vec![
        Figure {
            caption: format!("{subject}: {} and its law", outcome.file),
            name: name.clone(),
            plot: curve,
        },
        Figure {
            caption: format!("{subject}: what the law leaves of {}", outcome.file),
            name: format!("{name}-residuals"),
            plot: residuals,
        },
    ]
}
