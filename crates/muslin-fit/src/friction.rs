//! Shear and bending against the way they came: a slope, and friction around it.

use crate::FitError;
use crate::bending::{check_rigidity, geometric_mean, single_values};
use crate::columns::Kind;
use crate::estimate::{Estimate, Parameter, Undetermined};
use crate::label::Direction;
use crate::least_squares::{Problem, Solution};
use crate::outcome::{FittedPoint, Outcome, WORST_CONDITION};
use crate::path::{turning_points, ways};
use crate::statistics::{is_systematic, scatter, student_t};

/// A resistance to shear or bending that a test gives.
#[derive(Clone, Debug, PartialEq)]
pub struct SlopeFit {
    /// Shear modulus G [N/m] of the loading curve, or rigidity B [N m].
    pub slope: Estimate,
    /// How it was found.
    pub outcome: Outcome,
}

/// What differs between shear and bending.
struct Instrument {
    kind: Kind,
    /// Letter, name and unit of the slope.
    slope: [&'static str; 3],
    /// Name of the sliding path, and its unit.
    path_unit: &'static str,
    /// Unit of the force or moment.
    force_unit: &'static str,
    /// Widths of the loop that instruments give: letter, name and where.
    widths: &'static [(&'static str, &'static str, f64)],
    /// Whether friction may grow with the distance from zero.
    has_growth: bool,
}

const SHEAR: Instrument = Instrument {
    kind: Kind::Shear,
    slope: ["G", "modulus", "N/m"],
    path_unit: "rad",
    force_unit: "N/m",
    widths: &[
        ("2HG", "width of the loop at 0.5 degrees", 0.5 * std::f64::consts::PI / 180.0),
        ("2HG5", "width of the loop at 5 degrees", 5.0 * std::f64::consts::PI / 180.0),
    ],
    has_growth: true,
};

const BEND: Instrument = Instrument {
    kind: Kind::Bend,
    slope: ["B", "rigidity", "N m"],
    path_unit: "1/m",
    force_unit: "N",
    widths: &[("2HB", "width of the loop at 1 per centimetre", 100.0)],
    has_growth: false,
};

/// Shear moduli [N/m] of anything that is cloth.
const SHEAR_MODULI: std::ops::RangeInclusive<f64> = 0.1..=1e4;

/// Shear modulus from angles [rad] and forces per width [N/m] in the order of time.
pub(crate) fn fit_shear(file: &str, rows: &[[f64; 2]]) -> Result<SlopeFit, FitError> {
    let fit = fit_path(file, None, rows, &SHEAR)?;
    if SHEAR_MODULI.contains(&fit.slope.value) {
        return Ok(fit);
    }
    Err(FitError::whole(
        file,
        format!("gives a shear modulus of {:.3e} N/m, which no cloth has", fit.slope.value),
        "see that the units are those of the numbers, and that the columns stand below their names",
    ))
}

/// Shear modulus from values of G [N/m], one a specimen.
pub(crate) fn fit_shear_moduli(file: &str, values: &[f64]) -> SlopeFit {
    let mut outcome = single_values(file, None, Kind::ShearModulus, values.len());
    let slope = geometric_mean(values);
    let [symbol, name, unit] = SHEAR.slope;
    outcome.parameters.push(Parameter { symbol, name, unit, estimate: slope });
    SlopeFit { slope, outcome }
}

/// Rigidity from curvatures [1/m] and moments per width [N] in the order of time.
pub(crate) fn fit_bend(file: &str, direction: Direction, rows: &[[f64; 2]]) -> Result<SlopeFit, FitError> {
    let fit = fit_path(file, Some(direction), rows, &BEND)?;
    check_rigidity(file, fit.slope.value)?;
    Ok(fit)
}

/// A slope through an offset, and friction where the path turns.
///
/// ```text
/// y = G x + c + z h₀ + h₁ (z |x| − x)    dz/dx = (s − z) / d
/// ```
///
/// Friction slides with half of the loop's width h₀ + h₁ |x| against the way s = ±1, and passes from one way to the other over the
/// path d (Dahl 1968). On the way out z |x| is x, so that G is the slope of the loading curve, as instruments take it, and the middle
/// of the loop has the slope G − h₁. A width that falls with |x| is none of a fabric: the loop then has one width, h₁ = 0. On one way alone friction is not to be told from an offset, and the slope is that of the straight line with any
/// offset, as instruments take it between two points.
fn fit_path(
    file: &str,
    direction: Option<Direction>,
    rows: &[[f64; 2]],
    instrument: &Instrument,
) -> Result<SlopeFit, FitError> {
    let path = Path::new(rows);
    let unsolved = || {
        FitError::whole(
            file,
            "has no best law: the search did not end",
            "see that rows are in the order of time",
        )
    };
    let has_loop = !turning_points(rows.iter().map(|row| row[0])).is_empty();
    let straight = path.straight().ok_or_else(unsolved)?;
    let mut notes = Vec::new();
    let sliding = if has_loop {
        let mut best = path.sliding(instrument.has_growth).ok_or_else(unsolved)?;
        if best.parameters.get(GROWTH).is_some_and(|growth| *growth < 0.0) {
            best = path.sliding(false).ok_or_else(unsolved)?;
            notes.push("the loop does not widen with the angle: one width for all angles".to_owned());
        }
        Some(best)
    } else {
        None
    };
    let subject = crate::outcome::subject(if instrument.has_growth { "shear" } else { "bending" }, direction);
    let mut undetermined = Vec::new();
    let chosen = match sliding {
        None => {
            undetermined.push(Undetermined {
                what: format!("friction in {subject}"),
                why: "the data go one way: friction and an offset of the instrument look alike".to_owned(),
                remedy: "measure a loop, out and back".to_owned(),
            });
            straight
        }
        Some(sliding) if is_sliding(&sliding) => sliding,
        Some(_) => {
            notes = vec!["the loop has no width beyond scatter: no friction".to_owned()];
            straight
        }
    };
    let mut outcome = path.outcome(file, direction, instrument, &chosen);
    outcome.notes = [notes, outcome.notes].concat();
    outcome.undetermined.extend(undetermined);
    if WORST_CONDITION < chosen.condition {
        outcome.undetermined.push(Undetermined {
            what: format!("constants of {subject} one by one"),
            why: format!("the data do not tell them apart (condition {:.1e})", chosen.condition),
            remedy: "measure a wider loop with more points after each turn".to_owned(),
        });
    }
    let slope = outcome.parameters[0].estimate;
    Ok(SlopeFit { slope, outcome })
}

/// Places of the parameters.
const SLOPE: usize = 0;
const OFFSET: usize = 1;
const FRICTION: usize = 2;
const SLIDING_PATH: usize = 3;
const GROWTH: usize = 4;

/// Whether the loop has a width beyond scatter.
fn is_sliding(solution: &Solution) -> bool {
    let error = solution.covariance[(FRICTION, FRICTION)].sqrt();
    student_t(solution.freedom) * error < solution.parameters[FRICTION]
}

/// Rows with both columns in parts of their largest value, and the ways that they are on.
struct Path {
    rows: Vec<[f64; 2]>,
    ways: Vec<(f64, Option<usize>)>,
    units: [f64; 2],
}

impl Path {
    fn new(rows: &[[f64; 2]]) -> Self {
        let largest = |index: usize| rows.iter().fold(0.0_f64, |largest, row| largest.max(row[index].abs()));
        let units = [largest(0), largest(1)];
        let ways = ways(&rows.iter().map(|row| row[0]).collect::<Vec<_>>());
        Self { rows: rows.iter().map(|row| [row[0] / units[0], row[1] / units[1]]).collect(), ways, units }
    }

    /// Slope and offset.
    fn straight(&self) -> Option<Solution> {
        let residuals = |p: &[f64]| {
            let slope = libm::exp(p[SLOPE]);
            self.rows.iter().map(|[x, y]| slope * x + p[OFFSET] - y).collect()
        };
        Problem { start: vec![0.0, 0.0], bounds: vec![[-12.0, 6.0], [-2.0, 2.0]], residuals: &residuals }
            .solve()
    }

    /// Slope, offset and friction, for the friction before the first row that fits best: none, or sliding one way or the other.
    fn sliding(&self, has_growth: bool) -> Option<Solution> {
        let solve = |before: f64| {
            let residuals = |p: &[f64]| {
                let (slope, path) = (libm::exp(p[SLOPE]), libm::exp(p[SLIDING_PATH]));
                let friction = self.rows.iter().zip(self.friction(path, before));
                let growth = p.get(GROWTH).copied().unwrap_or(0.0);
                let law =
                    |x: f64, z: f64| slope * x + p[OFFSET] + z * p[FRICTION] + growth * (z * x.abs() - x);
                friction.map(|([x, y], z)| law(*x, z) - y).collect()
            };
            let mut start = vec![0.0, 0.0, 0.05, libm::log(0.05)];
            let mut bounds = vec![[-12.0, 6.0], [-1.0, 1.0], [-1.0, 1.0], [libm::log(1e-3), libm::log(0.5)]];
            if has_growth {
                start.push(0.0);
                bounds.push([-1.0, 1.0]);
            }
            Problem { start, bounds, residuals: &residuals }.solve()
        };
        let solutions = [0.0, 1.0, -1.0].into_iter().filter_map(solve);
        solutions.min_by(|a, b| a.squares().total_cmp(&b.squares()))
    }

    /// z of each row, with the sliding path d in largest x and z before the first row.
    fn friction(&self, path: f64, before: f64) -> Vec<f64> {
        let mut values: Vec<f64> = Vec::with_capacity(self.rows.len());
        for (row, (way, turn)) in self.ways.iter().enumerate() {
            let (from, z) = match *turn {
                Some(turn) => (turn, values[turn]),
                None => (0, before),
            };
            let distance = (self.rows[row][0] - self.rows[from][0]).abs();
            values.push(way + (z - way) * libm::exp(-distance / path));
        }
        values
    }

    fn outcome(
        &self,
        file: &str,
        direction: Option<Direction>,
        instrument: &Instrument,
        solution: &Solution,
    ) -> Outcome {
        let [x_unit, y_unit] = self.units;
        let freedom = solution.freedom;
        let error = |index: usize| solution.covariance[(index, index)].sqrt();
        let logarithm = |index: usize, unit: f64| {
            Estimate::of_logarithm(solution.parameters[index] + libm::log(unit), Some(error(index)), freedom)
        };
        let linear = |index: usize, unit: f64| {
            Estimate::linear(solution.parameters[index] * unit, error(index) * unit, freedom)
        };
        let parameter = |symbol, name, unit, estimate| Parameter { symbol, name, unit, estimate };
        let [symbol, name, unit] = instrument.slope;
        let mut parameters = vec![
            parameter(symbol, name, unit, logarithm(SLOPE, y_unit / x_unit)),
            parameter("c", "offset", instrument.force_unit, linear(OFFSET, y_unit)),
        ];
        let mut results = Vec::new();
        let mut undetermined = Vec::new();
        if FRICTION < solution.parameters.len() {
            parameters.push(parameter(
                "h",
                "friction at rest",
                instrument.force_unit,
                linear(FRICTION, y_unit),
            ));
            parameters.push(parameter(
                "d",
                "sliding path",
                instrument.path_unit,
                logarithm(SLIDING_PATH, x_unit),
            ));
            if GROWTH < solution.parameters.len() {
                parameters.push(parameter("h1", "growth of friction", unit, linear(GROWTH, y_unit / x_unit)));
            }
            for &(symbol, name, at) in instrument.widths {
                if at <= 1.02 * x_unit {
                    let estimate = width(solution, at / x_unit).scaled(y_unit);
                    results.push(parameter(symbol, name, instrument.force_unit, estimate));
                } else {
                    undetermined.push(Undetermined {
                        what: symbol.to_owned(),
                        why: format!("the loop ends before the place of the {name}"),
                        remedy: "measure a wider loop".to_owned(),
                    });
                }
            }
            if solution.at_bound[SLIDING_PATH][0] {
                undetermined.push(Undetermined {
                    what: "sliding path".to_owned(),
                    why: "friction has changed its way before the first point after a turn".to_owned(),
                    remedy: "measure more points after each turn".to_owned(),
                });
            }
        }
        let points = self.rows.iter().zip(&solution.residuals).map(|([x, y], residual)| FittedPoint {
            at: x * x_unit,
            measured: y * y_unit,
            fitted: (y + residual) * y_unit,
        });
        Outcome {
            file: file.to_owned(),
            kind: instrument.kind,
            direction,
            parameters,
            correlations: solution.correlations(),
            condition: solution.condition,
            results,
            points: points.collect(),
            scatter: Some(y_unit * scatter(&solution.residuals, freedom)),
            is_systematic: is_systematic(&solution.residuals),
            notes: Vec::new(),
            undetermined,
        }
    }
}

/// The width 2 (h₀ + h₁ x) of a loop at `x`, in parts of the largest value.
fn width(solution: &Solution, x: f64) -> Estimate {
    let covariance = &solution.covariance;
    let mut value = solution.parameters[FRICTION];
    let mut variance = covariance[(FRICTION, FRICTION)];
    if let Some(growth) = solution.parameters.get(GROWTH) {
        value += growth * x;
        variance += x * (2.0 * covariance[(FRICTION, GROWTH)] + x * covariance[(GROWTH, GROWTH)]);
    }
    Estimate::linear(2.0 * value, 2.0 * variance.max(0.0).sqrt(), solution.freedom)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 0 → 8° → −8° → 0 with friction that slides at once, from a fabric at rest.
    fn shear_loop(modulus: f64, friction: f64, growth: f64, path: f64, count: u32) -> Vec<[f64; 2]> {
        let largest = 8.0_f64.to_radians();
        let mut angles: Vec<f64> = (0..count).map(|i| largest * f64::from(i) / f64::from(count)).collect();
        angles.extend((0..2 * count).map(|i| largest * (1.0 - f64::from(i) / f64::from(count))));
        angles.extend((0..=count).map(|i| largest * (f64::from(i) / f64::from(count) - 1.0)));
        let (mut z, mut before) = (0.0, 0.0);
        angles
            .iter()
            .map(|&angle| {
                let way = if before <= angle { 1.0 } else { -1.0 };
                z = way + (z - way) * (-(angle - before).abs() / path).exp();
                before = angle;
                [angle, modulus * angle + z * (friction + growth * angle.abs())]
            })
            .collect()
    }

    /// The way out has the slope of the middle, 32 N/m, and of the friction that grows with it, 3 N/m.
    #[test]
    fn a_loop_gives_slope_and_widths() {
        let degree = std::f64::consts::PI / 180.0;
        let fit = fit_shear("a.csv", &shear_loop(32.0, 0.5, 3.0, 0.5 * degree, 40)).expect("a fit");
        assert!((fit.slope.value / 35.0 - 1.0).abs() < 1e-5, "{:?}", fit.slope);
        let value = |symbol| fit.outcome.parameter(symbol).expect(symbol).value;
        assert!((value("2HG") / (2.0 * (0.5 + 3.0 * 0.5 * degree)) - 1.0).abs() < 1e-5, "{}", value("2HG"));
        assert!((value("2HG5") / (2.0 * (0.5 + 3.0 * 5.0 * degree)) - 1.0).abs() < 1e-5);
        assert!((value("d") / (0.5 * degree) - 1.0).abs() < 1e-4);
        assert!(fit.outcome.undetermined.is_empty(), "{:?}", fit.outcome.undetermined);
    }

    /// A loop that narrows towards its ends has one width, between those at 0.5° and at 5°, and the slope of its middle.
    #[test]
    fn a_loop_that_narrows_has_one_width() {
        let fit = fit_shear("a.csv", &shear_loop(32.0, 0.5, -1.0, 0.01, 40)).expect("a fit");
        let [first, fifth] = ["2HG", "2HG5"].map(|symbol| fit.outcome.parameter(symbol).expect(symbol).value);
        assert_eq!(first, fifth);
        assert!(2.0 * (0.5 - 0.087) < first && first < 2.0 * (0.5 - 0.008), "{first}");
        assert!((fit.slope.value / 32.0 - 1.0).abs() < 0.03, "{:?}", fit.slope);
        assert_eq!(fit.outcome.parameter("h1"), None);
        let note = "the loop does not widen with the angle: one width for all angles";
        assert!(fit.outcome.notes.iter().any(|found| found == note), "{:?}", fit.outcome.notes);
    }

    #[test]
    fn one_way_gives_a_slope_and_says_what_is_missing() {
        let rows: Vec<[f64; 2]> =
            (1..=20).map(f64::from).map(|i| [10.0 * i, 0.002 + 1e-5 * 10.0 * i]).collect();
        let fit = fit_bend("a.csv", Direction::Warp, &rows).expect("a fit");
        assert!((fit.slope.value / 1e-5 - 1.0).abs() < 1e-6, "{:?}", fit.slope);
        assert_eq!(fit.outcome.undetermined[0].what, "friction in bending along the warp");
    }
}
