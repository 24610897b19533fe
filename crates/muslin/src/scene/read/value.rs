//! A value of the scene text: its key path, its place, and its conversion into checked Rust values.

use std::ops::Range;

use glam::DVec3;
use toml::de::DeValue;

use super::table::Table;
use crate::scene::error::{SceneError, SceneErrorKind, closest, quoted, shortened};

/// A value with its key path and its place in the text.
#[derive(Clone)]
pub(super) struct Value<'t> {
    pub(super) text: &'t str,
    pub(super) path: String,
    pub(super) span: Range<usize>,
    pub(super) value: &'t DeValue<'t>,
}

/// The range that a number must lie in. Every number must be finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NumberRule {
    Finite,
    NotNegative,
    Positive,
}

/// Sizes between which quantities lie unless they are zero: their squares, quotients and sums stay numbers.
const SIZES: std::ops::RangeInclusive<f64> = 1e-30..=1e30;

impl<'t> Value<'t> {
    /// `kind` at this value's place.
    pub(super) fn error(&self, kind: SceneErrorKind) -> SceneError {
        SceneError::at(kind, self.text, self.span.clone())
    }

    /// The value as it stands in the text, on one line, cut if it is long.
    pub(super) fn as_written(&self) -> String {
        let written = self.text.get(self.span.clone()).unwrap_or_default();
        shortened(&written.split_whitespace().collect::<Vec<_>>().join(" "))
    }

    pub(super) fn out_of_range(&self, unit: &'static str, rule: &str, help: &str) -> SceneError {
        self.error(SceneErrorKind::OutOfRange {
            key: self.path.clone(),
            value: self.as_written(),
            unit,
            rule: rule.to_owned(),
            help: help.to_owned(),
        })
    }

    pub(super) fn wrong_type(&self, expected: &'static str, unit: &'static str, help: &str) -> SceneError {
        let found = match self.value {
            DeValue::String(_) => "a string",
            DeValue::Integer(_) => "an integer",
            DeValue::Float(_) => "a number",
            DeValue::Boolean(_) => "a boolean",
            DeValue::Datetime(_) => "a date or time",
            DeValue::Array(_) => "an array",
            DeValue::Table(_) => "a table",
        };
        let (key, help) = (self.path.clone(), help.to_owned());
        self.error(SceneErrorKind::WrongType { key, found, expected, unit, help })
    }

    /// A finite number [`unit`] within `rule` and, if it is a quantity, of a size within [`SIZES`]; never -0. Integers are
    /// numbers.
    pub(super) fn number(&self, unit: &'static str, rule: NumberRule) -> Result<f64, SceneError> {
        let number = match self.value {
            DeValue::Float(float) => float.as_str().parse::<f64>().ok(),
            DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str().parse::<f64>().ok(),
            DeValue::Integer(integer) => match i64::from_str_radix(integer.as_str(), integer.radix()) {
                Ok(integer) => Some(integer as f64),
                Err(_) => {
                    return Err(self.out_of_range(unit, "fit into 64 bits", "write it as a decimal number"));
                }
            },
            DeValue::String(string) if string.trim().parse::<f64>().is_ok() => {
                return Err(self.wrong_type("a number", unit, "write it without quotes"));
            }
            _ => return Err(self.wrong_type("a number", unit, "")),
        };
        let rule_text = match rule {
            NumberRule::Finite => "be finite",
            NumberRule::NotNegative => "be finite and not negative",
            NumberRule::Positive => "be finite and positive",
        };
        let Some(number) = number.filter(|number| number.is_finite()) else {
            return Err(self.out_of_range(unit, rule_text, ""));
        };
        let is_quantity = rule != NumberRule::Finite || !unit.is_empty();
        if is_quantity && *SIZES.end() < number.abs() {
            return Err(self.out_of_range(unit, "be at most 1e30 in size", ""));
        }
        if rule != NumberRule::Finite && 0.0 < number && number < *SIZES.start() {
            return Err(self.out_of_range(unit, "be at least 1e-30 in size", ""));
        }
        match rule {
            NumberRule::NotNegative if number < 0.0 => Err(self.out_of_range(unit, "not be negative", "")),
            NumberRule::Positive if number <= 0.0 => Err(self.out_of_range(unit, "be positive", "")),
            _ => Ok(number + 0.0),
        }
    }

    /// An integer from `smallest` to `largest`.
    pub(super) fn integer(&self, smallest: i64, largest: i64) -> Result<i64, SceneError> {
        let DeValue::Integer(integer) = self.value else {
            let help = if self.value.is_float() { "write it without a decimal point" } else { "" };
            return Err(self.wrong_type("an integer", "", help));
        };
        match i64::from_str_radix(integer.as_str(), integer.radix()) {
            Ok(integer) if (smallest..=largest).contains(&integer) => Ok(integer),
            Ok(integer) if integer < smallest => {
                Err(self.out_of_range("", &format!("be at least {smallest}"), ""))
            }
            Ok(_) => Err(self.out_of_range("", &format!("be at most {largest}"), "")),
            // More than 64 bits: the sign says on which side.
            Err(_) if integer.as_str().starts_with('-') => {
                Err(self.out_of_range("", &format!("be at least {smallest}"), ""))
            }
            Err(_) => Err(self.out_of_range("", &format!("be at most {largest}"), "")),
        }
    }

    pub(super) fn boolean(&self) -> Result<bool, SceneError> {
        let help = if self.value.is_str() { "write it without quotes" } else { "" };
        self.value.as_bool().ok_or_else(|| self.wrong_type("true or false", "", help))
    }

    pub(super) fn string(&self) -> Result<&'t str, SceneError> {
        self.value.as_str().ok_or_else(|| self.wrong_type("a string", "", "write it in quotes"))
    }

    /// Three finite numbers [`unit`].
    pub(super) fn vector(&self, unit: &'static str) -> Result<DVec3, SceneError> {
        let elements = self.elements("an array of 3 numbers", unit)?;
        let [x, y, z] = elements.as_slice() else {
            return Err(self.wrong_length(elements.len(), 3));
        };
        let number = |element: &Value| element.number(unit, NumberRule::Finite);
        Ok(DVec3::new(number(x)?, number(y)?, number(z)?))
    }

    /// Three finite numbers, not all zero, scaled to unit length.
    pub(super) fn direction(&self) -> Result<DVec3, SceneError> {
        let vector = self.vector("")?;
        let largest = vector.abs().max_element();
        if largest == 0.0 {
            return Err(self.out_of_range(
                "",
                "have a length other than zero",
                "write a direction such as [0, 0, 1]",
            ));
        }
        // Scaled where a square would be too large or too small for a number.
        let scaled = if (1e-150..1e150).contains(&largest) { vector } else { vector / largest };
        Ok(scaled / scaled.length() + DVec3::ZERO)
    }

    /// The elements of an array.
    pub(super) fn elements(
        &self,
        expected: &'static str,
        unit: &'static str,
    ) -> Result<Vec<Value<'t>>, SceneError> {
        let DeValue::Array(array) = self.value else {
            return Err(self.wrong_type(expected, unit, ""));
        };
        let element = |(index, element): (usize, &'t toml::Spanned<DeValue<'t>>)| Value {
            text: self.text,
            path: format!("{}.{index}", self.path),
            span: element.span(),
            value: element.get_ref(),
        };
        Ok(array.iter().enumerate().map(element).collect())
    }

    pub(super) fn wrong_length(&self, found: usize, expected: usize) -> SceneError {
        self.error(SceneErrorKind::Inconsistent {
            message: format!("`{}` has length {found}, but must have length {expected}", self.path),
            help: String::new(),
        })
    }

    pub(super) fn table(self, help: &str) -> Result<Table<'t>, SceneError> {
        match self.value {
            DeValue::Table(entries) => Ok(Table::new(self.text, self.path, Some(self.span), entries)),
            _ => Err(self.wrong_type("a table", "", help)),
        }
    }

    /// The tables of an array of tables.
    pub(super) fn tables(self, help: &str) -> Result<Vec<Table<'t>>, SceneError> {
        if !self.value.is_array() {
            return Err(self.wrong_type("an array of tables", "", help));
        }
        let elements = self.elements("an array of tables", "")?;
        elements.into_iter().map(|element| element.table(help)).collect()
    }

    /// The meaning of a name, from a list of names with meanings.
    pub(super) fn choice<T: Copy>(
        &self,
        rule: &'static str,
        choices: &[(&'static str, T)],
    ) -> Result<T, SceneError> {
        let name = self.string()?;
        let found = choices.iter().find(|(choice, _)| *choice == name).map(|(_, meaning)| *meaning);
        found.ok_or_else(|| self.unknown_name(rule, choices.iter().map(|(choice, _)| *choice)))
    }

    /// The error for a name that is none of `valid`.
    pub(super) fn unknown_name<'n>(
        &self,
        rule: &'static str,
        valid: impl IntoIterator<Item = &'n str>,
    ) -> SceneError {
        let name = self.value.as_str().unwrap_or_default();
        let valid: Vec<&str> = valid.into_iter().collect();
        self.error(SceneErrorKind::UnknownName {
            key: self.path.clone(),
            value: quoted(name),
            rule,
            closest: closest(name, &valid).map(quoted),
            valid: valid.into_iter().map(quoted).collect(),
        })
    }
}

/// `number` to 12 digits, for a message.
pub(in crate::scene) fn rounded(number: f64) -> String {
    format!("{:?}", with_decimals(number, 11))
}

/// The number nearest to `number` with so many decimals after the first digit.
pub(super) fn with_decimals(number: f64, decimals: usize) -> f64 {
    format!("{number:.decimals$e}").parse().unwrap_or(number)
}
