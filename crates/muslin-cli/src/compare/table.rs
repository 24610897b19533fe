//! Quantities of two fabrics, side by side.

use muslin::lab::{Along, Instrument, Reading, Unit};

use super::measure::{Outcome, Trial};
use super::properties;
use crate::lab::NamedFabric;
use crate::progress::rounded;

/// What belongs together: the fabrics' own quantities, or those of one instrument.
pub(super) struct Section {
    /// The instrument, if it is not the fabrics' own.
    pub(super) instrument: Option<Instrument>,
    pub(super) rows: Vec<Row>,
}

/// A quantity of both fabrics.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Row {
    /// The yarns that it belongs to, if any.
    pub(super) along: Option<Along>,
    /// Its symbol, or its name on the instrument: "EMT".
    pub(super) name: &'static str,
    /// What it is, in words.
    pub(super) what: &'static str,
    pub(super) unit: Unit,
    /// Of A and B.
    pub(super) values: [Value; 2],
}

/// A value of one fabric.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    /// In SI.
    Number(f64),
    /// What the fabric lacks to have one: "no friction".
    Lacking(String),
}

impl Value {
    /// The number [SI], if there is one.
    pub(super) fn number(&self) -> Option<f64> {
        match self {
            Self::Number(number) => Some(*number),
            Self::Lacking(_) => None,
        }
    }

    /// A number, or zero told as what the fabric is `lacking`.
    pub(super) fn positive(number: f64, lacking: &str) -> Self {
        if number == 0.0 { Self::Lacking(lacking.to_owned()) } else { Self::Number(number) }
    }
}

impl Section {
    /// Its heading.
    pub(super) fn title(&self) -> &'static str {
        self.instrument.map_or("the fabrics themselves", Instrument::title)
    }
}

impl Row {
    /// B / A [1], if both are numbers and A is not zero.
    pub(super) fn ratio(&self) -> Option<f64> {
        let [first, second] = [0, 1].map(|fabric| self.values[fabric].number());
        Some(second? / first.filter(|first| *first != 0.0)?)
    }

    /// What the row shows: yarns, name, what it is, A, B, the instrument's unit, and B / A.
    pub(super) fn cells(&self) -> [String; 7] {
        let along = self.along.map_or("", Along::name);
        let [first, second] = [0, 1].map(|fabric| match &self.values[fabric] {
            Value::Number(number) => shown(number / self.unit.size),
            Value::Lacking(lacking) => lacking.clone(),
        });
        let ratio = self.ratio().map_or_else(|| "–".to_owned(), shown);
        let [along, name, what, unit] = [along, self.name, self.what, self.unit.symbol].map(str::to_owned);
        [along, name, what, first, second, unit, ratio]
    }
}

/// Four digits of `number`; rounded before, so that 0.99999 has no digit more than 1.
fn shown(number: f64) -> String {
    let number: f64 = format!("{number:.3e}").parse().unwrap_or(number);
    rounded(number, 4)
}

/// All sections: the fabrics' own, and one for each instrument.
pub(super) fn sections(fabrics: &[NamedFabric; 2], trials: &[Trial]) -> Vec<Section> {
    let own = Section { instrument: None, rows: properties::rows(fabrics) };
    let instruments = Instrument::ALL.into_iter().map(|instrument| {
        let trials = trials.iter().filter(|trial| trial.test.instrument == instrument);
        Section { instrument: Some(instrument), rows: trials.flat_map(rows).collect() }
    });
    [own].into_iter().chain(instruments).collect()
}

/// What the instrument says, in the order of its readings; one row of what both lack if there are none.
fn rows(trial: &Trial) -> Vec<Row> {
    let along = trial.test.along;
    let Some(measured) = trial.outcomes.iter().find_map(|outcome| outcome.as_ref().ok()) else {
        let values = [0, 1].map(|fabric| value(&trial.outcomes[fabric], 0));
        return vec![Row { along, name: "", what: "no result", unit: Unit::plain(""), values }];
    };
    let readings = measured.readings.iter().enumerate();
    let row = |(index, reading): (usize, &Reading)| {
        let values = [0, 1].map(|fabric| value(&trial.outcomes[fabric], index));
        Row { along, name: reading.name, what: reading.what, unit: reading.unit, values }
    };
    readings.map(row).collect()
}

/// The reading at `index`. Only loops have zero as input: what is read of a fabric without friction is rounding.
fn value(outcome: &Outcome, index: usize) -> Value {
    match outcome {
        Ok(measured) => match measured.readings[index] {
            Reading { input: Some(0.0), .. } => Value::Lacking("no friction".to_owned()),
            reading => Value::Number(reading.measured),
        },
        Err(lacking) => Value::Lacking(lacking.clone()),
    }
}
