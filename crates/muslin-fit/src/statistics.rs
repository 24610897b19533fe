//! What a spread of values says about their mean, and residuals about a law.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// The probability with which an interval is to hold the true value.
pub const CONFIDENCE: f64 = 0.95;

/// Where Student's t with `freedom` degrees of freedom leaves 2.5 % above it; infinite without any freedom.
#[must_use]
pub(crate) fn student_t(freedom: usize) -> f64 {
    let distribution = StudentsT::new(0.0, 1.0, freedom as f64);
    distribution.map_or(f64::INFINITY, |distribution| distribution.inverse_cdf(0.5 + 0.5 * CONFIDENCE))
}

/// Mean and standard error of the mean; no standard error of fewer than two values.
pub(crate) fn mean(values: &[f64]) -> (f64, Option<f64>) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    if values.len() < 2 {
        return (mean, None);
    }
    let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
    (mean, Some((squares / (count - 1.0) / count).sqrt()))
}

/// Root of the mean square of `values`, with `freedom` in place of their number.
pub(crate) fn scatter(values: &[f64], freedom: usize) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / freedom.max(1) as f64).sqrt()
}

/// Whether residuals keep their sign for longer than chance does: the test of runs by Wald and Wolfowitz (1940), one-sided
/// at 1 %, by its normal approximation.
///
/// ```text
/// μ = 2 a b / n + 1    σ² = (μ − 1)(μ − 2) / (n − 1)    z = (runs + ½ − μ) / σ < −2.326
/// ```
///
/// with a positive and b negative ones of n. Fewer than 5 of either sign say nothing.
pub(crate) fn is_systematic(residuals: &[f64]) -> bool {
    let signs: Vec<bool> =
        residuals.iter().filter(|value| **value != 0.0).map(|value| 0.0 < *value).collect();
    let positive = signs.iter().filter(|sign| **sign).count();
    let negative = signs.len() - positive;
    if positive.min(negative) < 5 {
        return false;
    }
    let runs = 1 + signs.windows(2).filter(|pair| pair[0] != pair[1]).count();
    let count = signs.len() as f64;
    let expected = 2.0 * positive as f64 * negative as f64 / count + 1.0;
    let deviation = ((expected - 1.0) * (expected - 2.0) / (count - 1.0)).sqrt();
    (runs as f64 + 0.5 - expected) / deviation < -2.326
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The table of every textbook, to its three decimals.
    #[test]
    fn quantiles_are_those_of_the_table() {
        for (freedom, t) in [(1, 12.706), (2, 4.303), (4, 2.776), (10, 2.228), (30, 2.042), (100, 1.984)] {
            let found = student_t(freedom);
            assert!((found - t).abs() < 6e-4, "{found} for {freedom}");
        }
        assert_eq!(student_t(0), f64::INFINITY);
    }

    /// By hand: 1, 2, 3, 6 have the mean 3, the variance 14/3 and the standard error √(14/12).
    #[test]
    fn a_mean_has_the_error_of_its_spread() {
        let (found, error) = mean(&[1.0, 2.0, 3.0, 6.0]);
        assert_eq!(found, 3.0);
        assert!((error.expect("of four values") - (14.0_f64 / 12.0).sqrt()).abs() < 1e-15);
        assert_eq!(mean(&[5.0]), (5.0, None));
    }

    #[test]
    fn residuals_that_keep_their_sign_are_systematic() {
        let wave =
            |period: f64| (0..60).map(move |i| (std::f64::consts::TAU * (f64::from(i) + 0.5) / period).sin());
        assert!(is_systematic(&wave(30.0).collect::<Vec<_>>()));
        assert!(!is_systematic(&wave(4.0).collect::<Vec<_>>()));
        assert!(!is_systematic(&wave(8.0).take(8).collect::<Vec<_>>()), "too few to say");
    }
}
