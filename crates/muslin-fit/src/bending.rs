//! Bending rigidity from the overhang of a strip, and from single values.

use muslin::scene::{rigidity_from_bending_length, units::STANDARD_GRAVITY};

use crate::FitError;
use crate::columns::Kind;
use crate::elastica::load_of_chord;
use crate::estimate::{Estimate, Parameter};
use crate::friction::SlopeFit;
use crate::label::Direction;
use crate::measurement::RIGIDITIES;
use crate::outcome::{FittedPoint, Outcome};
use crate::statistics::{is_systematic, mean, scatter};
use crate::tension::no_scatter;

/// Rigidity from overhangs L [m] and angles of the chord [rad], with the mass per area [kg/m²].
///
/// ```text
/// c = L / Γ(angle)^(1/3)    B = ρ g c³
/// ```
///
/// with the load Γ of the heavy elastica. Every row is a bending length c: least squares of ln L have the mean of ln c in closed form.
pub(crate) fn fit_cantilever(
    file: &str,
    direction: Direction,
    rows: &[[f64; 2]],
    areal_density: f64,
) -> Result<SlopeFit, FitError> {
    let roots: Vec<f64> = rows.iter().map(|[_, angle]| libm::cbrt(load_of_chord(*angle))).collect();
    let lengths: Vec<f64> = rows.iter().zip(&roots).map(|([overhang, _], root)| overhang / root).collect();
    let mut fit = of_lengths(file, direction, Kind::Cantilever, &lengths, areal_density)?;
    let length = fit.outcome.parameter("c").map_or(f64::NAN, |length| length.value);
    let mut points: Vec<FittedPoint> = rows
        .iter()
        .zip(&roots)
        .map(|([overhang, angle], root)| FittedPoint {
            at: *angle,
            measured: *overhang,
            fitted: length * root,
        })
        .collect();
    points.sort_by(|a, b| a.at.total_cmp(&b.at));
    let residuals: Vec<f64> = points.iter().map(|point| point.fitted - point.measured).collect();
    fit.outcome.scatter = (2 <= rows.len()).then(|| scatter(&residuals, rows.len() - 1));
    fit.outcome.is_systematic = is_systematic(&residuals);
    fit.outcome.points = points;
    fit.outcome.notes = vec![
        "every row is a bending length, by the exact curve of a heavy strip; mass per area counts as exact"
            .to_owned(),
    ];
    Ok(fit)
}

/// Rigidity from bending lengths [m], one a specimen.
pub(crate) fn fit_bending_lengths(
    file: &str,
    direction: Direction,
    lengths: &[f64],
    areal_density: f64,
) -> Result<SlopeFit, FitError> {
    of_lengths(file, direction, Kind::BendingLength, lengths, areal_density)
}

fn of_lengths(
    file: &str,
    direction: Direction,
    kind: Kind,
    lengths: &[f64],
    areal_density: f64,
) -> Result<SlopeFit, FitError> {
    let logarithms: Vec<f64> = lengths.iter().map(|length| libm::log(*length)).collect();
    let (mean, error) = mean(&logarithms);
    let length = Estimate::of_logarithm(mean, error, lengths.len() - 1);
    // ln B = ln ρ g + 3 ln c: errors in parts are three times as large.
    let logarithm = libm::log(areal_density * STANDARD_GRAVITY) + 3.0 * mean;
    let rigidity = Estimate::of_logarithm(logarithm, error.map(|error| 3.0 * error), lengths.len() - 1);
    debug_assert!(
        (rigidity.value / rigidity_from_bending_length(areal_density, length.value) - 1.0).abs() < 1e-9
    );
    let mut fit = of_values(file, Some(direction), kind, rigidity, lengths.len())?;
    fit.outcome.results.push(Parameter { symbol: "c", name: "bending length", unit: "m", estimate: length });
    fit.outcome.notes = vec!["the mean of bending lengths; mass per area counts as exact".to_owned()];
    Ok(fit)
}

/// Rigidity from values of B [N m], one a specimen.
pub(crate) fn fit_rigidities(file: &str, direction: Direction, values: &[f64]) -> Result<SlopeFit, FitError> {
    of_values(file, Some(direction), Kind::Rigidity, geometric_mean(values), values.len())
}

/// The geometric mean of positive values.
pub(crate) fn geometric_mean(values: &[f64]) -> Estimate {
    let logarithms: Vec<f64> = values.iter().map(|value| libm::log(*value)).collect();
    let (mean, error) = mean(&logarithms);
    Estimate::of_logarithm(mean, error, values.len() - 1)
}

fn of_values(
    file: &str,
    direction: Option<Direction>,
    kind: Kind,
    rigidity: Estimate,
    count: usize,
) -> Result<SlopeFit, FitError> {
    check_rigidity(file, rigidity.value)?;
    let mut outcome = single_values(file, direction, kind, count);
    outcome.parameters.push(Parameter { symbol: "B", name: "rigidity", unit: "N m", estimate: rigidity });
    Ok(SlopeFit { slope: rigidity, outcome })
}

/// What was found from `count` values, one a specimen, before their mean is in it.
pub(crate) fn single_values(file: &str, direction: Option<Direction>, kind: Kind, count: usize) -> Outcome {
    let mut outcome = Outcome {
        file: file.to_owned(),
        kind,
        direction,
        parameters: Vec::new(),
        correlations: vec![vec![1.0]],
        condition: 1.0,
        results: Vec::new(),
        points: Vec::new(),
        scatter: None,
        is_systematic: false,
        notes: vec!["the mean of the values given".to_owned()],
        undetermined: Vec::new(),
    };
    if count < 2 {
        let row = if kind == Kind::Cantilever { "overhang" } else { "specimen" };
        outcome.undetermined.push(no_scatter(&outcome.subject(), row));
    }
    outcome
}

/// Refuses a rigidity that no cloth has.
pub(crate) fn check_rigidity(file: &str, rigidity: f64) -> Result<(), FitError> {
    if RIGIDITIES.contains(&rigidity) {
        return Ok(());
    }
    Err(FitError::whole(
        file,
        format!("gives a bending rigidity of {rigidity:.3e} N m, which no cloth has"),
        "see that the units are those of the numbers, and that the columns stand below their names",
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 150 g/m² and 20 mm are 11.768 µN m; half of 40.007 mm at 41.5° is 20 mm by the exact curve.
    #[test]
    fn an_overhang_at_the_standard_angle_is_two_bending_lengths() {
        let rows = [[2.0 * 0.02 / 0.99982518, 41.5_f64.to_radians()]; 3];
        let fit = fit_cantilever("a.csv", Direction::Warp, &rows, 0.15).expect("a fit");
        assert!((fit.slope.value / 11.767_98e-6 - 1.0).abs() < 1e-6, "{fit:?}");
        let by_length = fit_bending_lengths("a.csv", Direction::Warp, &[0.02], 0.15).expect("a fit");
        assert!((by_length.slope.value / 11.767_98e-6 - 1.0).abs() < 1e-6);
        assert_eq!(by_length.slope.standard_error, None);
        assert_eq!(by_length.outcome.undetermined.len(), 1);
    }
}
