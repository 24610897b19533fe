//! Tension along the yarns: linear, tangent, or a table.

use std::f64::consts::FRAC_PI_2;

use muslin::scene::{KesTensile, MembraneTension};

use crate::FitError;
use crate::columns::Kind;
use crate::estimate::{Estimate, Parameter, Undetermined};
use crate::kes_values::{area, resilience, summary};
use crate::label::Direction;
use crate::least_squares::{Problem, Solution};
use crate::outcome::{FittedPoint, Outcome, subject};
use crate::statistics::{is_systematic, mean, scatter, student_t};
use crate::table::{interpolated, monotone_table};

/// Scatter in parts of the largest tension above which a law that leaves a systematic rest gives way to a table.
pub const LARGEST_MISFIT: f64 = 0.02;

/// Moduli [N/m] of anything that is cloth, by far.
const MODULI: std::ops::RangeInclusive<f64> = 0.1..=5e6;

/// How far above the largest strain the asymptote is at least, in parts.
const LEAST_ROOM: f64 = 1e-3;

/// The strain scale, in largest strains, at which the tangent law differs from the linear by less than 1e-4.
const LARGEST_SCALE: f64 = 60.0;

/// The tension that a test gives.
#[derive(Clone, Debug, PartialEq)]
pub struct TensionFit {
    /// The law, or the table.
    pub tension: MembraneTension,
    /// How it was found.
    pub outcome: Outcome,
}

/// The row of the largest strain.
pub(crate) fn turning_point(rows: &[[f64; 2]]) -> usize {
    let larger = |best: usize, row: usize| if rows[best][0] < rows[row][0] { row } else { best };
    (0..rows.len()).fold(0, larger)
}

/// Tension from a curve of strain and tension per width, out and perhaps back.
///
/// The way out counts, as for the values of KES. The linear law T = K e stands unless the tangent law T = K a tan(e / a) leaves less
/// by more than chance would, at 5 % (F = t²), which is when the 95 % interval of a by profile likelihood has an upper end. Either
/// gives way to a table if its rest is systematic and above [`LARGEST_MISFIT`].
pub(crate) fn fit_curve(file: &str, direction: Direction, rows: &[[f64; 2]]) -> Result<TensionFit, FitError> {
    let top = turning_point(rows);
    let way_out = Normalised::new(&rows[..=top]);
    let unsolved = || {
        FitError::whole(
            file,
            "has no best law: the search did not end",
            "see that the curve is that of one specimen",
        )
    };
    let linear = way_out.linear().ok_or_else(unsolved)?;
    let tangent = way_out.tangent().ok_or_else(unsolved)?;
    let evidence = Evidence::of(&linear, &tangent);
    let chosen = if evidence.is_tangent { &tangent } else { &linear };
    let mut fit = way_out.fit(file, direction, chosen, &evidence);
    let (MembraneTension::Linear { modulus } | MembraneTension::Tangent { modulus, .. }) = fit.tension else {
        return Ok(fit);
    };
    if !MODULI.contains(&modulus) {
        return Err(FitError::whole(
            file,
            format!("gives a modulus of {modulus:.3e} N/m, which no cloth has"),
            "see that the units are those of the numbers, and that the columns stand below their names",
        ));
    }
    let subject = subject("tension", Some(direction));
    if let (false, Some(least)) = (evidence.is_tangent, way_out.least_scale(&linear, &tangent)) {
        fit.outcome.undetermined.push(Undetermined {
            what: format!("strain scale of the {subject}"),
            why: format!(
                "the data stay where the law is linear: every strain scale above {least:.3} fits as well ({:.0} %)",
                100.0 * crate::CONFIDENCE
            ),
            remedy: "measure to a larger strain, where the curve bends".to_owned(),
        });
    }
    let misfit = chosen.squares().sqrt() / (chosen.freedom.max(1) as f64).sqrt();
    if LARGEST_MISFIT < misfit && fit.outcome.is_systematic {
        fit = way_out.table(fit);
    }
    let scatter = fit.outcome.scatter.unwrap_or(0.0);
    fit.outcome.results = summary(rows, top, scatter);
    match resilience(rows, top, scatter) {
        Ok(estimate) => {
            if estimate.interval.is_some_and(|[_, high]| 1.0 <= high) {
                fit.outcome.notes.push("the loop has no area beyond scatter: no friction".to_owned());
            }
            fit.outcome.results.push(Parameter { symbol: "RT", name: "resilience", unit: "", estimate });
        }
        Err(why) => fit.outcome.undetermined.push(Undetermined {
            what: format!("friction in {subject}"),
            why,
            remedy: "measure the way back to no tension too".to_owned(),
        }),
    }
    Ok(fit)
}

/// Tension from values of KES, one a specimen: the law of each, and the geometric mean of their constants.
pub(crate) fn fit_kes(
    file: &str,
    direction: Direction,
    tests: &[KesTensile],
) -> Result<TensionFit, FitError> {
    let mut moduli = Vec::new();
    let mut scales = Vec::new();
    for test in tests {
        let law = test.tension().map_err(|error| {
            FitError::whole(file, error.to_string(), "give the measured curve, `strain [%],tension [gf/cm]`")
        })?;
        match law {
            MembraneTension::Tangent { modulus, strain_scale } => {
                moduli.push(libm::log(modulus));
                scales.push(libm::log(strain_scale));
            }
            MembraneTension::Linear { modulus } => moduli.push(libm::log(modulus)),
            MembraneTension::Curve(_) => {}
        }
    }
    if !scales.is_empty() && scales.len() < moduli.len() {
        return Err(FitError::whole(
            file,
            "has specimens with an LT of 1 beside others of less",
            "an LT of 1 is a fabric that does not stiffen: see that it was measured",
        ));
    }
    let freedom = tests.len() - 1;
    let estimate = |logarithms: &[f64]| {
        let (mean, error) = mean(logarithms);
        Estimate::of_logarithm(mean, error, freedom)
    };
    let modulus = estimate(&moduli);
    let mut parameters = vec![Parameter { symbol: "K", name: "modulus", unit: "N/m", estimate: modulus }];
    let tension = if scales.is_empty() {
        MembraneTension::Linear { modulus: modulus.value }
    } else {
        let scale = estimate(&scales);
        parameters.push(Parameter { symbol: "a", name: "strain scale", unit: "", estimate: scale });
        MembraneTension::Tangent { modulus: modulus.value, strain_scale: scale.value }
    };
    let mut outcome = Outcome {
        file: file.to_owned(),
        kind: Kind::KesTensile,
        direction: Some(direction),
        correlations: correlations_of(&moduli, &scales),
        condition: 1.0,
        parameters,
        results: Vec::new(),
        points: Vec::new(),
        scatter: None,
        is_systematic: false,
        notes: vec!["the law has EMT and LT exactly, in closed form".to_owned()],
        undetermined: Vec::new(),
    };
    if tests.len() < 2 {
        outcome.undetermined.push(no_scatter(&outcome.subject(), "specimen"));
    }
    Ok(TensionFit { tension, outcome })
}

/// What is missing to tell how well a single value is known.
pub(crate) fn no_scatter(subject: &str, row: &str) -> Undetermined {
    Undetermined {
        what: format!("standard error of the {subject}"),
        why: format!("there is one {row}"),
        remedy: format!("give more of them, a row for each {row}"),
    }
}

/// Correlations of the values of specimens; none where there is but one constant, or fewer than three specimens to tell them from.
fn correlations_of(first: &[f64], second: &[f64]) -> Vec<Vec<f64>> {
    if second.len() < 3 {
        return Vec::new();
    }
    let (x, y) = (mean(first).0, mean(second).0);
    let sum =
        |f: &dyn Fn(f64, f64) -> f64| first.iter().zip(second).map(|(a, b)| f(a - x, b - y)).sum::<f64>();
    let product = (sum(&|a, _| a * a) * sum(&|_, b| b * b)).sqrt();
    let correlation = if 0.0 < product { sum(&|a, b| a * b) / product } else { 0.0 };
    vec![vec![1.0, correlation], vec![correlation, 1.0]]
}

/// Which law, and why.
struct Evidence {
    is_tangent: bool,
    /// F = (S_linear − S_tangent) / (S_tangent / (n − 2)).
    statistic: f64,
    /// The value of F that chance exceeds once in twenty times.
    threshold: f64,
}

impl Evidence {
    fn of(linear: &Solution, tangent: &Solution) -> Self {
        let t = student_t(tangent.freedom);
        let statistic =
            (linear.squares() - tangent.squares()) / (tangent.squares() / tangent.freedom.max(1) as f64);
        let is_tangent = t * t < statistic && !tangent.at_bound[1][1];
        Self { is_tangent, statistic, threshold: t * t }
    }

    fn sentence(&self) -> String {
        let [verb, relation] =
            if self.is_tangent { ["bends", "above"] } else { ["does not bend", "not above"] };
        format!(
            "the curve {verb} by more than scatter: F = {:.*} is {relation} {:.2} (5 %)",
            if self.statistic < 100.0 { 2 } else { 0 },
            self.statistic.max(0.0),
            self.threshold
        )
    }
}

/// A way out with strains in parts of the largest, and tensions in parts of theirs.
struct Normalised {
    rows: Vec<[f64; 2]>,
    /// The largest strain and the largest tension [N/m].
    units: [f64; 2],
}

impl Normalised {
    fn new(way_out: &[[f64; 2]]) -> Self {
        let largest =
            |index: usize| way_out.iter().fold(0.0_f64, |largest, row| largest.max(row[index].abs()));
        let units = [largest(0), largest(1)];
        Self { rows: way_out.iter().map(|row| [row[0] / units[0], row[1] / units[1]]).collect(), units }
    }

    /// The bounds of the logarithm of the strain scale.
    fn scale_bounds() -> [f64; 2] {
        [libm::log((1.0 + LEAST_ROOM) / FRAC_PI_2), libm::log(LARGEST_SCALE)]
    }

    /// The linear law, in closed form; the search does not move from it.
    fn linear(&self) -> Option<Solution> {
        let modulus = self.best_modulus(|strain| strain);
        let residuals = |p: &[f64]| {
            let modulus = libm::exp(p[0]);
            self.rows.iter().map(|[strain, tension]| modulus * strain - tension).collect()
        };
        let start = libm::log(modulus.max(1e-6));
        Problem { start: vec![start], bounds: vec![[start - 3.0, start + 3.0]], residuals: &residuals }
            .solve()
    }

    /// The tangent law, from the constants that its EMT and LT have in closed form.
    fn tangent(&self) -> Option<Solution> {
        let residuals = |p: &[f64]| {
            let [modulus, scale] = [libm::exp(p[0]), libm::exp(p[1])];
            self.rows
                .iter()
                .map(|[strain, tension]| modulus * scale * libm::tan(strain / scale) - tension)
                .collect()
        };
        let bounds = Self::scale_bounds();
        let scale = self.closed_form_scale().clamp(libm::exp(bounds[0]) * 1.01, 0.9 * LARGEST_SCALE);
        let modulus = libm::log(self.best_modulus(|strain| scale * libm::tan(strain / scale)).max(1e-6));
        let start = vec![modulus, libm::log(scale)];
        // A modulus at rest may be far below the slope of the chord, and never above it for a curve that stiffens.
        Problem { start, bounds: vec![[-12.0, 3.0], bounds], residuals: &residuals }.solve()
    }

    /// The strain scale that the curve's EMT and LT give; a large one if the curve does not stiffen.
    fn closed_form_scale(&self) -> f64 {
        let [[extension, force], work] = [self.rows[self.rows.len() - 1], [area(&self.rows).0, 0.0]];
        let linearity = KesTensile::linearity_of_work(work[0], extension, force);
        let test = KesTensile { extension, linearity: linearity.max(KesTensile::LEAST_LINEARITY), force };
        match test.tension() {
            Ok(MembraneTension::Tangent { strain_scale, .. }) => strain_scale,
            _ => 10.0,
        }
    }

    /// The modulus of least squares for tensions of modulus one.
    fn best_modulus(&self, tension: impl Fn(f64) -> f64) -> f64 {
        let (mut products, mut squares) = (0.0, 0.0);
        for &[strain, measured] in &self.rows {
            let unit = tension(strain);
            products += unit * measured;
            squares += unit * unit;
        }
        products / squares
    }

    /// The lower end of the strain scale's 95 % interval by profile likelihood: where the least sum of squares over all moduli is
    /// by t² / (n − 2) larger than the least of all. `None` if there is none above the bound.
    fn least_scale(&self, linear: &Solution, tangent: &Solution) -> Option<f64> {
        let t = student_t(tangent.freedom);
        let least = linear.squares().min(tangent.squares());
        let limit = least * (1.0 + t * t / tangent.freedom.max(1) as f64);
        let squares = |scale: f64| {
            let unit = |strain: f64| scale * libm::tan(strain / scale);
            let modulus = self.best_modulus(unit);
            self.rows
                .iter()
                .map(|[strain, tension]| modulus * unit(*strain) - tension)
                .map(|r| r * r)
                .sum::<f64>()
        };
        let [low, high] = Self::scale_bounds();
        let (mut low, mut high) = (low, high);
        if squares(libm::exp(low)) <= limit {
            return None;
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if squares(libm::exp(middle)) <= limit { high = middle } else { low = middle }
        }
        Some(libm::exp(high) * self.units[0])
    }

    /// The law with the constants of `solution`.
    fn fit(&self, file: &str, direction: Direction, solution: &Solution, evidence: &Evidence) -> TensionFit {
        let [strain_unit, tension_unit] = self.units;
        let constant = |index: usize, unit: f64| {
            let error = solution.covariance[(index, index)].sqrt();
            Estimate::of_logarithm(
                solution.parameters[index] + libm::log(unit),
                Some(error),
                solution.freedom,
            )
        };
        let modulus = constant(0, tension_unit / strain_unit);
        let mut parameters = vec![Parameter { symbol: "K", name: "modulus", unit: "N/m", estimate: modulus }];
        let tension = if evidence.is_tangent {
            let scale = constant(1, strain_unit);
            parameters.push(Parameter { symbol: "a", name: "strain scale", unit: "", estimate: scale });
            MembraneTension::Tangent { modulus: modulus.value, strain_scale: scale.value }
        } else {
            MembraneTension::Linear { modulus: modulus.value }
        };
        let points =
            self.rows.iter().zip(&solution.residuals).map(|([strain, tension], residual)| FittedPoint {
                at: strain * strain_unit,
                measured: tension * tension_unit,
                fitted: (tension + residual) * tension_unit,
            });
        let outcome = Outcome {
            file: file.to_owned(),
            kind: Kind::Tensile,
            direction: Some(direction),
            parameters,
            correlations: solution.correlations(),
            condition: solution.condition,
            results: Vec::new(),
            points: points.collect(),
            scatter: Some(tension_unit * scatter(&solution.residuals, solution.freedom)),
            is_systematic: is_systematic(&solution.residuals),
            notes: vec![evidence.sentence()],
            undetermined: Vec::new(),
        };
        TensionFit { tension, outcome }
    }

    /// The table through the points in place of the law of `fit`.
    fn table(&self, fit: TensionFit) -> TensionFit {
        let rows: Vec<[f64; 2]> = fit.outcome.points.iter().map(|point| [point.at, point.measured]).collect();
        let Some(curve) = monotone_table(&rows) else { return fit };
        let law = if fit.outcome.parameters.len() == 1 { "linear" } else { "tangent" };
        let points: Vec<FittedPoint> = fit
            .outcome
            .points
            .iter()
            .map(|point| FittedPoint { fitted: interpolated(&curve, point.at), ..*point })
            .collect();
        let residuals: Vec<f64> = points.iter().map(|point| point.fitted - point.measured).collect();
        let misfit = fit.outcome.scatter.unwrap_or(0.0) / self.units[1];
        let note = format!(
            "a table of {} points: the {law} law leaves a systematic {:.1} % of the largest tension",
            curve.points().len(),
            100.0 * misfit
        );
        let freedom = points.len().saturating_sub(curve.points().len()).max(1);
        let outcome = Outcome {
            parameters: Vec::new(),
            correlations: Vec::new(),
            condition: 1.0,
            scatter: Some(scatter(&residuals, freedom)),
            is_systematic: is_systematic(&residuals),
            points,
            notes: [fit.outcome.notes, vec![note]].concat(),
            undetermined: Vec::new(),
            ..fit.outcome
        };
        TensionFit { tension: MembraneTension::Curve(curve), outcome }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tangent(modulus: f64, scale: f64, largest: f64, count: u32) -> Vec<[f64; 2]> {
        let strain = |i: u32| largest * f64::from(i) / f64::from(count - 1);
        (0..count).map(|i| [strain(i), modulus * scale * (strain(i) / scale).tan()]).collect()
    }

    /// Without scatter the law comes back, to the accuracy of the search.
    #[test]
    fn a_tangent_law_comes_back() {
        let fit = fit_curve("a.csv", Direction::Warp, &tangent(3623.0, 0.0358, 0.047, 40)).expect("a fit");
        let MembraneTension::Tangent { modulus, strain_scale } = fit.tension else { panic!("{fit:?}") };
        assert!((modulus / 3623.0 - 1.0).abs() < 1e-6, "{modulus}");
        assert!((strain_scale / 0.0358 - 1.0).abs() < 1e-6, "{strain_scale}");
        // A way out alone has no friction to find.
        assert_eq!(fit.outcome.undetermined.len(), 1, "{:?}", fit.outcome.undetermined);
    }

    /// A curve that softens fits no law, and becomes a table of its own points.
    #[test]
    fn a_curve_that_no_law_fits_becomes_a_table() {
        let rows: Vec<[f64; 2]> =
            (0..=60).map(|i| f64::from(i) / 60.0).map(|e| [0.1 * e, 100.0 * e.sqrt()]).collect();
        let fit = fit_curve("a.csv", Direction::Weft, &rows).expect("a fit");
        let MembraneTension::Curve(curve) = &fit.tension else { panic!("{fit:?}") };
        let end = curve.points()[curve.points().len() - 1];
        assert!((end[0] - 0.1).abs() < 0.002 && (end[1] - 100.0).abs() < 1.0, "{end:?}");
        assert!(fit.outcome.notes[1].contains("linear law leaves a systematic"), "{:?}", fit.outcome.notes);
    }
}
