//! A number that was identified, and how well it is known.

use crate::statistics::student_t;

/// A value with its standard error and the interval that holds the true value with a probability of
/// [`CONFIDENCE`](crate::CONFIDENCE), by Student's t; without any where there was nothing to tell scatter from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The value, in SI units.
    pub value: f64,
    /// Standard error, in the unit of the value.
    pub standard_error: Option<f64>,
    /// Ends of the interval, in the unit of the value.
    pub interval: Option<[f64; 2]>,
}

impl Estimate {
    /// A value without scatter.
    #[must_use]
    pub fn exact(value: f64) -> Self {
        Self { value, standard_error: None, interval: None }
    }

    /// A value with a standard error, from data with so many degrees of freedom.
    pub(crate) fn linear(value: f64, standard_error: f64, freedom: usize) -> Self {
        let half = student_t(freedom) * standard_error;
        Self { value, standard_error: Some(standard_error), interval: Some([value - half, value + half]) }
    }

    /// The exponential of a logarithm with a standard error: an interval of positive ends, as far in parts on both sides.
    pub(crate) fn of_logarithm(logarithm: f64, standard_error: Option<f64>, freedom: usize) -> Self {
        let value = libm::exp(logarithm);
        let interval = |error: f64| {
            let half = student_t(freedom) * error;
            [libm::exp(logarithm - half), libm::exp(logarithm + half)]
        };
        Self {
            value,
            standard_error: standard_error.map(|error| value * error),
            interval: standard_error.map(interval),
        }
    }

    /// The same in another unit, `factor` of which are one.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        Self {
            value: factor * self.value,
            standard_error: self.standard_error.map(|error| factor * error),
            interval: self.interval.map(|ends| ends.map(|end| factor * end)),
        }
    }

    /// Standard error in parts of the value.
    #[must_use]
    pub fn relative_error(self) -> Option<f64> {
        self.standard_error.map(|error| (error / self.value).abs())
    }

    /// Whether the interval holds `value`.
    #[must_use]
    pub fn covers(self, value: f64) -> bool {
        self.interval.is_some_and(|[low, high]| low <= value && value <= high)
    }
}

/// An estimate with a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Letter of the law, such as `K`.
    pub symbol: &'static str,
    /// What it is, such as `modulus`.
    pub name: &'static str,
    /// Its unit, empty if it has none.
    pub unit: &'static str,
    /// The value.
    pub estimate: Estimate,
}

/// What the data do not say, and what would.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Undetermined {
    /// The quantity, such as `strain scale along the warp`.
    pub what: String,
    /// Why the data do not say it.
    pub why: String,
    /// What to measure.
    pub remedy: String,
}
