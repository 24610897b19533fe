//! The fabric as a table of a scene file.

use std::fmt::Write as _;

use muslin::scene::{MembraneTension, TensionCurve};

use crate::estimate::{Estimate, Parameter};
use crate::fit::{FabricFit, law_name};
use crate::friction::SlopeFit;
use crate::label::Direction;
use crate::outcome::Outcome;
use crate::tension::TensionFit;

/// Digits of a value: more than any measurement has.
const DIGITS: i32 = 6;

/// A table `[fabric.NAME]` with comments, and the files beside it that it names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FabricText {
    /// The table, in TOML.
    pub toml: String,
    /// Name and content of every table of tension, in CSV.
    pub tables: Vec<(String, String)>,
}

impl FabricText {
    /// The fabric `fit` under `name`, of letters, digits, `-` and `_`; `origin` says where the mass per area is from.
    ///
    /// Every value has its standard error and its file beside it. What is missing is said in comments, and the text is then no
    /// whole fabric.
    #[must_use]
    pub fn new(fit: &FabricFit, name: &str, origin: &str) -> Self {
        let mut text = Self { toml: format!("[fabric.{name}]\nkind = \"measured\"\n"), tables: Vec::new() };
        text.value("areal_density", fit.areal_density, &format!("kg/m²; {origin}"));
        text.line("drag = 0.0  # not measured: air acts as wind");
        for (direction, tension) in [(Direction::Warp, &fit.warp), (Direction::Weft, &fit.weft)] {
            text.tension(name, direction, tension.as_ref());
        }
        text.line(&format!("\n[fabric.{name}.shear]"));
        text.slope("modulus", "N/m per radian", fit.shear.as_ref().map(|fit| (fit.slope, &fit.outcome)));
        if let Some(shear) = &fit.shear
            && shear.shear_friction().is_some()
        {
            text.result("2hg", "N/m", "2HG", &shear.outcome);
            text.result("2hg5", "N/m", "2HG5", &shear.outcome);
        }
        text.line(&format!("\n[fabric.{name}.bend]"));
        for direction in [Direction::Warp, Direction::Weft] {
            text.bending(direction, fit.bending[direction as usize].as_ref());
        }
        match fit.bias() {
            Some(bias) => {
                let outcome = fit.bending[Direction::Bias as usize].as_ref().map(|fit| (bias, &fit.outcome));
                text.slope("bias", "N m", outcome);
            }
            None => text.line("# bias = ...  # not determined: see below"),
        }
        text.notes(fit);
        text
    }

    fn line(&mut self, line: &str) {
        self.toml.push_str(line);
        self.toml.push('\n');
    }

    fn value(&mut self, key: &str, value: f64, comment: &str) {
        self.line(&format!("{key} = {}  # {comment}", rounded(value)));
    }

    fn tension(&mut self, name: &str, direction: Direction, fit: Option<&TensionFit>) {
        self.line(&format!("\n[fabric.{name}.{direction}]"));
        let Some(fit) = fit else {
            self.line("# modulus = ...  # not determined: see below");
            return;
        };
        let TensionFit { tension, outcome } = fit;
        let has_friction = fit.friction().is_some();
        match tension {
            MembraneTension::Curve(curve) => {
                let table = format!("{name}-{direction}.csv");
                let points = curve.points().len();
                self.line(&format!("curve = \"{table}\"  # {points} points; from {}", outcome.file));
                self.tables.push((table, table_text(curve, outcome)));
            }
            MembraneTension::Tangent { .. } if has_friction => self.tangent_with_friction(fit),
            _ => self.parameters(&outcome.parameters, outcome),
        }
        if has_friction {
            self.result("rt", "", "RT", outcome);
        }
    }

    /// The tangent law by a point of it in place of its modulus: RT of a fabric that stiffens is that up to some tension.
    fn tangent_with_friction(&mut self, TensionFit { tension, outcome }: &TensionFit) {
        let [modulus, others @ ..] = &outcome.parameters[..] else { return };
        if let Some(extension) = outcome.parameter("EMT") {
            let force = tension.tension(extension.value);
            self.value("emt", extension.value, &format!("largest strain; from {}", outcome.file));
            self.value("force", force, "N/m, of the law there");
        }
        let estimate = modulus.estimate;
        self.line(&format!(
            "# modulus at rest {} {}",
            rounded(estimate.value),
            comment(modulus.unit, estimate, outcome)
        ));
        self.parameters(others, outcome);
    }

    fn parameters(&mut self, parameters: &[Parameter], outcome: &Outcome) {
        for Parameter { name, unit, estimate, .. } in parameters {
            self.value(&name.replace(' ', "_"), estimate.value, &comment(unit, *estimate, outcome));
        }
    }

    fn bending(&mut self, direction: Direction, fit: Option<&SlopeFit>) {
        let Some(fit) = fit.filter(|fit| fit.bending_friction().is_some()) else {
            self.slope(direction.name(), "N m", fit.map(|fit| (fit.slope, &fit.outcome)));
            return;
        };
        self.slope(&format!("{direction}.rigidity"), "N m", Some((fit.slope, &fit.outcome)));
        self.result(&format!("{direction}.2hb"), "N", "2HB", &fit.outcome);
    }

    /// What follows from the data under the letters `symbol`, if anything does.
    fn result(&mut self, key: &str, unit: &str, symbol: &str, outcome: &Outcome) {
        match outcome.parameter(symbol) {
            Some(result) => self.value(key, result.value, &comment(unit, result, outcome)),
            None => self.line(&format!("# {key} = ...  # not determined: see below")),
        }
    }

    fn slope(&mut self, key: &str, unit: &str, fit: Option<(Estimate, &Outcome)>) {
        match fit {
            Some((slope, outcome)) => self.value(key, slope.value, &comment(unit, slope, outcome)),
            None => self.line(&format!("# {key} = ...  # not determined: see below")),
        }
    }

    fn notes(&mut self, fit: &FabricFit) {
        self.line("\n# how the values were found");
        for (tension, outcome) in
            [&fit.warp, &fit.weft].into_iter().flatten().map(|fit| (law_name(&fit.tension), &fit.outcome))
        {
            self.outcome(outcome, Some(tension));
        }
        for SlopeFit { outcome, .. } in
            fit.shear.iter().chain(fit.bending.iter().flatten()).chain(&fit.checks)
        {
            self.outcome(outcome, None);
        }
        for warning in &fit.warnings {
            self.line(&format!("# warning: {warning}"));
        }
        if !fit.undetermined.is_empty() {
            self.line("\n# what the data do not determine");
            for undetermined in &fit.undetermined {
                let [what, why, remedy] = [&undetermined.what, &undetermined.why, &undetermined.remedy];
                self.line(&format!("#   {what}: {why}\n#     way out: {remedy}"));
            }
        }
    }

    fn outcome(&mut self, outcome: &Outcome, law: Option<&str>) {
        let law = law.map_or(String::new(), |law| format!(", {law}"));
        let mut line = format!("#   {}: {}{law}", outcome.file, outcome.subject());
        if let Some(scatter) = outcome.scatter {
            let largest =
                outcome.points.iter().fold(0.0_f64, |largest, point| largest.max(point.measured.abs()));
            let _ = write!(
                line,
                "; {} points, scatter {:.2} % of the largest value",
                outcome.points.len(),
                100.0 * scatter / largest
            );
        }
        self.line(&line);
        for note in &outcome.notes {
            self.line(&format!("#     {note}"));
        }
        if outcome.is_systematic {
            self.line("#     the rest is systematic, not scatter: standard errors count scatter alone");
        }
        // The first constant of a slope is a key of the fabric; others stand here.
        if law.is_empty() {
            for parameter in outcome.parameters.iter().skip(1) {
                let Parameter { symbol, name, unit, estimate } = parameter;
                let value = rounded(estimate.value);
                self.line(&format!(
                    "#     {symbol} ({name}) = {value} {}",
                    comment(unit, *estimate, outcome)
                ));
            }
        }
        if let (Some(Direction::Bias), Some(width)) = (outcome.direction, outcome.parameter("2HB")) {
            let [value, comment] = [rounded(width.value), comment("N", width, outcome)];
            self.line(&format!("#     2HB = {value} {comment}; a fabric has no key for it at 45 degrees"));
        }
        let pairs = outcome.correlations.iter().enumerate().flat_map(|(i, row)| {
            row.iter().enumerate().take(i).map(move |(j, correlation)| {
                let [first, second] = [j, i].map(|index| outcome.parameters[index].symbol);
                format!("{first} and {second} {correlation:.2}")
            })
        });
        let pairs: Vec<String> = pairs.collect();
        if !pairs.is_empty() {
            self.line(&format!("#     correlations: {}", pairs.join(", ")));
        }
    }
}

/// Unit, standard error, interval and file of a value.
fn comment(unit: &str, estimate: Estimate, outcome: &Outcome) -> String {
    let unit = if unit.is_empty() { String::new() } else { format!("{unit}; ") };
    let error = match (estimate.standard_error, estimate.interval) {
        (Some(error), Some([low, high])) => {
            // In parts of the value, unless that is lost in its error.
            let error = match estimate.relative_error() {
                Some(relative) if relative < 0.5 => format!("{:.2} %", 100.0 * relative),
                _ => shown(error),
            };
            let confidence = 100.0 * crate::CONFIDENCE;
            format!("standard error {error}, {confidence:.0} % interval {} to {}; ", shown(low), shown(high))
        }
        _ => "standard error unknown; ".to_owned(),
    };
    format!("{unit}{error}from {}", outcome.file)
}

/// `value` with [`DIGITS`] digits, as TOML has numbers.
fn rounded(value: f64) -> String {
    digits(value, DIGITS)
}

/// `value` with four digits, for a comment.
fn shown(value: f64) -> String {
    digits(value, 4)
}

fn digits(value: f64, digits: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value:?}");
    }
    let exponent = libm::floor(libm::log10(value.abs())) as i32;
    if (-3..6).contains(&exponent) {
        format!("{value:.*}", (digits - 1 - exponent).max(1) as usize)
    } else {
        format!("{value:.*e}", (digits - 1) as usize)
    }
}

/// The table of `curve` as a file.
fn table_text(curve: &TensionCurve, outcome: &Outcome) -> String {
    let mut text = format!("# {}, from {}\nstrain [1],tension [N/m]\n", outcome.subject(), outcome.file);
    for [strain, tension] in curve.points() {
        let _ = writeln!(text, "{},{}", digits(*strain, 8), digits(*tension, 8));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_their_digits_and_are_toml() {
        for (value, text) in [
            (3623.123456, "3623.12"),
            (0.0357951, "0.0357951"),
            (6.57e-6, "6.57000e-6"),
            (-1234567.0, "-1.23457e6"),
            (0.0, "0.0"),
            (123456.0, "123456.0"),
        ] {
            assert_eq!(rounded(value), text);
        }
    }
}
