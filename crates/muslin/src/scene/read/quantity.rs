//! Quantities that a table may give under one of several keys, each with its unit.

use super::table::{Entry, Table};
use super::value::{NumberRule, Value};
use crate::scene::SceneError;
use crate::scene::error::SceneErrorKind;

/// One of the keys of a quantity.
pub(super) struct Spelling {
    pub(super) key: &'static str,
    /// Unit of the number, as messages show it; empty if it has none.
    pub(super) unit: &'static str,
    /// The number in SI units.
    pub(super) to_si: fn(f64) -> f64,
    /// Whether the number may be one, and if not, what it must do and what to write: most numbers beyond are of another unit.
    pub(super) plausible: Option<Plausible>,
}

/// The numbers that a key may have.
pub(super) struct Plausible {
    pub(super) holds: fn(f64) -> bool,
    /// What the number must do, beginning with a verb.
    pub(super) rule: &'static str,
    pub(super) help: &'static str,
}

/// A quantity of a table, taken under all of its keys.
pub(super) struct Quantity<'t> {
    /// What it is, with an article.
    name: &'static str,
    rule: NumberRule,
    /// The entry of the first key, for messages of what is missing.
    first: Entry<'t>,
    keys: String,
    unit: &'static str,
    given: Vec<(&'static Spelling, Value<'t>)>,
}

/// A quantity that is given.
pub(super) struct Given<'t> {
    /// In SI units.
    pub(super) si: f64,
    /// As it stands in the text.
    pub(super) value: Value<'t>,
    /// Unit in the text.
    pub(super) unit: &'static str,
}

impl<'t> Quantity<'t> {
    /// The quantity called `name` under the keys of `spellings`, the first of them in SI units.
    pub(super) fn take(
        table: &mut Table<'t>,
        name: &'static str,
        rule: NumberRule,
        spellings: &'static [Spelling],
    ) -> Self {
        let [first, others @ ..] = spellings else { unreachable!("a quantity has a key") };
        let entry = table.take(first.key);
        let mut given: Vec<_> = entry.clone().optional().map(|value| (first, value)).into_iter().collect();
        given.extend(
            others.iter().filter_map(|other| table.take(other.key).optional().map(|value| (other, value))),
        );
        let keys = spellings.iter().map(|Spelling { key, unit, .. }| match *unit {
            "" => format!("`{key} = ...`"),
            unit => format!("`{key} = ...` [{unit}]"),
        });
        let keys = keys.collect::<Vec<_>>().join(" or ");
        Self { name, rule, first: entry, keys, unit: first.unit, given }
    }

    /// The value under whichever key it has.
    pub(super) fn value(&self) -> Option<&Value<'t>> {
        self.given.first().map(|(_, value)| value)
    }

    /// The quantity, if it is given; an error if it is given twice.
    pub(super) fn optional(self) -> Result<Option<Given<'t>>, SceneError> {
        let mut given = self.given.into_iter();
        let Some((spelling, value)) = given.next() else { return Ok(None) };
        if let Some((_, second)) = given.next() {
            return Err(twice(&value, &second, self.name));
        }
        let number = value.number(spelling.unit, self.rule)?;
        if let Some(plausible) = spelling.plausible.as_ref().filter(|plausible| !(plausible.holds)(number)) {
            return Err(value.out_of_range(spelling.unit, plausible.rule, plausible.help));
        }
        Ok(Some(Given { si: (spelling.to_si)(number), value, unit: spelling.unit }))
    }

    /// The quantity; an error if it is missing or given twice.
    pub(super) fn required(self) -> Result<Given<'t>, SceneError> {
        let help = format!("write {}", self.keys);
        self.required_with(&help)
    }

    /// The same with another way out if it is missing.
    pub(super) fn required_with(self, help: &str) -> Result<Given<'t>, SceneError> {
        let (first, unit) = (self.first.clone(), self.unit);
        self.optional()?.ok_or_else(|| first.missing(unit, help))
    }
}

/// The error of `second`, which gives `what` once more.
pub(super) fn twice(first: &Value, second: &Value, what: &str) -> SceneError {
    let message = format!("`{}` and `{}` both give {what}", first.path, second.path);
    second.error(SceneErrorKind::Inconsistent { message, help: "leave one of them out".to_owned() })
}
