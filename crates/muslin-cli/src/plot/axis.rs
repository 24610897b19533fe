//! Axes of plots: ranges, ticks and their labels.

use super::text::power_of_ten;

/// Ticks that a linear axis has about.
const TICKS: f64 = 5.0;

/// Decades from which on a logarithmic axis has a tick at powers of ten alone.
const MANY_DECADES: f64 = 2.0;

/// How values become places along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scale {
    Linear,
    /// By their logarithm; what is not positive has no place.
    Logarithmic,
}

/// An axis of a plot.
#[derive(Clone, Debug)]
pub(crate) struct Axis {
    /// What it measures, with its unit in brackets.
    pub(crate) label: String,
    pub(crate) scale: Scale,
    /// Ends; those of the data if none.
    pub(crate) range: Option<[f64; 2]>,
}

/// A tick: its value and what is written there.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tick {
    pub(crate) value: f64,
    pub(crate) text: String,
}

impl Axis {
    /// A linear axis that fits the data.
    pub(crate) fn linear(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Linear, range: None }
    }

    /// A logarithmic axis that fits the data.
    pub(crate) fn logarithmic(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Logarithmic, range: None }
    }

    /// The same axis from `low` to `high`.
    pub(crate) fn between(self, low: f64, high: f64) -> Self {
        Self { range: Some([low, high]), ..self }
    }

    /// Whether `value` has a place on an axis without ends.
    pub(crate) fn takes(&self, value: f64) -> bool {
        value.is_finite() && (self.scale == Scale::Linear || 0.0 < value)
    }

    /// The axis's ends for `values`, of which those that it does not take count for nothing.
    pub(crate) fn ends(&self, values: impl Iterator<Item = f64>) -> [f64; 2] {
        if let Some(range) = self.range {
            return range;
        }
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values.filter(|value| self.takes(*value)) {
            (low, high) = (low.min(value), high.max(value));
        }
        if high < low {
            return if self.scale == Scale::Linear { [0.0, 1.0] } else { [0.1, 1.0] };
        }
        match self.scale {
            Scale::Linear => {
                let margin = if low < high { 0.0 } else { low.abs().max(1.0) * 0.5 };
                let step = tick_step(low - margin, high + margin);
                [((low - margin) / step).floor() * step, ((high + margin) / step).ceil() * step]
            }
            // A little room, so that no point lies on the frame.
            Scale::Logarithmic => [low / 1.25, high * 1.25],
        }
    }

    /// Where `value` is between the `ends`: 0 at the first, 1 at the second.
    pub(crate) fn place(&self, value: f64, ends: [f64; 2]) -> f64 {
        match self.scale {
            Scale::Linear => (value - ends[0]) / (ends[1] - ends[0]),
            Scale::Logarithmic => libm::log(value / ends[0]) / libm::log(ends[1] / ends[0]),
        }
    }

    /// Ticks from the first to the second of `ends`.
    pub(crate) fn ticks(&self, ends: [f64; 2]) -> Vec<Tick> {
        match self.scale {
            Scale::Linear => linear_ticks(ends),
            Scale::Logarithmic => logarithmic_ticks(ends),
        }
    }
}

/// 1, 2 or 5 times a power of ten, about the `TICKS`-th part of the range.
fn tick_step(low: f64, high: f64) -> f64 {
    let rough = (high - low) / TICKS;
    let power = libm::pow(10.0, libm::floor(libm::log10(rough)));
    let factor = [1.0, 2.0, 5.0].into_iter().find(|factor| rough <= factor * power * 1.001).unwrap_or(10.0);
    factor * power
}

fn linear_ticks([low, high]: [f64; 2]) -> Vec<Tick> {
    let step = tick_step(low, high);
    let decimals = (-libm::floor(libm::log10(step * 1.001))).max(0.0) as usize;
    let first = (low / step - 1e-9).ceil() as i64;
    let last = (high / step + 1e-9).floor() as i64;
    (first..=last)
        .map(|index| {
            let value = index as f64 * step;
            Tick { value, text: format!("{value:.decimals$}").replace('-', "−") }
        })
        .collect()
}

fn logarithmic_ticks([low, high]: [f64; 2]) -> Vec<Tick> {
    let decades = libm::log10(high / low);
    let factors: &[f64] = if MANY_DECADES <= decades { &[1.0] } else { &[1.0, 2.0, 5.0] };
    let first = libm::floor(libm::log10(low)) as i32;
    let last = libm::floor(libm::log10(high)) as i32;
    // More than eight labels would not have room beside each other.
    let every = ((last - first) / 8 + 1).max(1);
    let mut ticks = Vec::new();
    for exponent in (first..=last).filter(|exponent| exponent % every == 0) {
        for factor in factors {
            let value = factor * libm::pow(10.0, f64::from(exponent));
            if (low..=high).contains(&value) {
                ticks.push(Tick { value, text: logarithmic_text(*factor, exponent) });
            }
        }
    }
    ticks
}

/// `factor` times ten to the power of `exponent`.
fn logarithmic_text(factor: f64, exponent: i32) -> String {
    match exponent {
        0..=3 => format!("{:.0}", factor * libm::pow(10.0, f64::from(exponent))),
        -2..0 => {
            format!("{:.*}", exponent.unsigned_abs() as usize, factor * libm::pow(10.0, f64::from(exponent)))
        }
        _ if factor == 1.0 => power_of_ten(&exponent.to_string()),
        _ => format!("{factor:.0}·{}", power_of_ten(&exponent.to_string())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(ticks: &[Tick]) -> Vec<&str> {
        ticks.iter().map(|tick| tick.text.as_str()).collect()
    }

    #[test]
    fn linear_axes_end_at_round_values() {
        let axis = Axis::linear("");
        let ends = axis.ends([0.013, 0.097, f64::NAN].into_iter());
        assert_eq!(texts(&axis.ticks(ends)), ["0.00", "0.02", "0.04", "0.06", "0.08", "0.10"]);
        let ends = axis.ends([-3.0, 4.0].into_iter());
        assert_eq!(texts(&axis.ticks(ends)), ["−4", "−2", "0", "2", "4"]);
    }

    #[test]
    fn logarithmic_axes_have_decades() {
        let axis = Axis::logarithmic("");
        let ends = axis.ends([0.0, 2e-5, 300.0].into_iter());
        let ticks = axis.ticks(ends);
        assert_eq!(texts(&ticks), ["10⁻⁴", "10⁻³", "0.01", "0.1", "1", "10", "100"]);
        assert!((axis.place(ticks[3].value, ends) - axis.place(0.1, ends)).abs() < 1e-12);
        let ticks = axis.ticks([8.0, 60.0]);
        assert_eq!(texts(&ticks), ["10", "20", "50"]);
    }

    /// A plot of nothing, or of one value, has axes all the same.
    #[test]
    fn axes_without_extent_have_ends() {
        for axis in [Axis::linear(""), Axis::logarithmic("")] {
            for values in [vec![], vec![3.0], vec![-1.0, f64::INFINITY]] {
                let [low, high] = axis.ends(values.into_iter());
                assert!(low < high, "{low} {high}");
                assert!(axis.ticks([low, high]).len() < 12);
            }
        }
    }
}
