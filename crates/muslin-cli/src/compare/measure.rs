//! The tests that two fabrics go through, on all threads of the machine.

use std::num::NonZeroUsize;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use muslin::lab::{Along, Column, Instrument, LabError, Reading, Resolution};

use crate::error::CliError;
use crate::lab::{NamedFabric, failed};
use crate::progress::terminal_line;

/// A test that both fabrics go through.
#[derive(Clone, Copy, Debug)]
pub(super) struct Test {
    pub(super) instrument: Instrument,
    /// The yarns along the specimen, if that makes a difference.
    pub(super) along: Option<Along>,
}

/// What an instrument measured on one fabric.
pub(super) struct Measured {
    pub(super) columns: Vec<Column>,
    pub(super) readings: Vec<Reading>,
    /// States at rest.
    pub(super) states: usize,
    /// The largest force left on a free particle, relative to that on a clamp.
    pub(super) relative_residual: f64,
}

/// What an instrument measured, or what the fabric lacks for it.
pub(super) type Outcome = Result<Measured, String>;

/// A test, and what came of it for both fabrics.
pub(super) struct Trial {
    pub(super) test: Test,
    pub(super) outcomes: [Outcome; 2],
}

impl Test {
    /// The tests of `instrument`: along warp and weft if that makes a difference.
    pub(super) fn of(instrument: Instrument) -> Vec<Self> {
        match instrument.has_yarns() {
            true => Along::ALL.map(|along| Self { instrument, along: Some(along) }).to_vec(),
            false => vec![Self { instrument, along: None }],
        }
    }

    /// The tests of all instruments, along the yarns `along` alone if there are any.
    pub(super) fn all(along: Option<Along>) -> Vec<Self> {
        let is_wanted = |test: &Self| test.along.is_none() || along.is_none() || test.along == along;
        Instrument::ALL.into_iter().flat_map(Self::of).filter(is_wanted).collect()
    }

    /// Name of its files without ending: "tensile-warp".
    pub(super) fn file_name(&self) -> String {
        let along = self.along.map_or(String::new(), |along| format!("-{}", along.name()));
        format!("{}{along}", self.instrument.name())
    }

    /// In words: "tensile test of KES-FB1 along the warp".
    pub(super) fn title(&self) -> String {
        let along = self.along.map_or(String::new(), |along| format!(" along the {}", along.name()));
        format!("{}{along}", self.instrument.title())
    }

    fn measure(&self, fabric: &NamedFabric, resolution: Resolution) -> Result<Outcome, CliError> {
        let along = self.along.unwrap_or(Along::Warp);
        match self.instrument.measure(&fabric.fabric, along, resolution) {
            Ok(measurement) => Ok(Ok(Measured {
                columns: measurement.columns,
                readings: measurement.readings,
                states: measurement.record.frames.len(),
                relative_residual: measurement.record.relative_residual,
            })),
            Err(error) => {
                let told = || failed(&error, format_args!("{}, {}: {error}", fabric.name, self.title()));
                lacking(&error).map(Err).ok_or_else(told)
            }
        }
    }
}

/// What the fabric lacks for a test, in a few words, if that is why there is no result.
fn lacking(error: &LabError) -> Option<String> {
    match error {
        // The yarns are told beside it.
        LabError::Nothing { what } => {
            Some(format!("no {}", what.strip_suffix(" along these yarns").unwrap_or(what)))
        }
        LabError::OutOfReach { .. } => Some("stretches too far".to_owned()),
        _ => None,
    }
}

/// Both `fabrics` go through all `tests`.
///
/// Each has a place of its own for what comes out, so that nothing depends on which thread takes it, or on when it ends.
pub(super) fn measure(
    tests: Vec<Test>,
    fabrics: &[NamedFabric; 2],
    resolution: Resolution,
) -> Result<Vec<Trial>, CliError> {
    let outcomes: Vec<OnceLock<Result<Outcome, CliError>>> =
        (0..2 * tests.len()).map(|_| OnceLock::new()).collect();
    let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let line = terminal_line();
    let work = || {
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(place) = outcomes.get(index) else { return };
            place.get_or_init(|| tests[index / 2].measure(&fabrics[index % 2], resolution));
            let count = done.fetch_add(1, Ordering::Relaxed) + 1;
            if let Some(line) = &line {
                line.set_message(format!("{count} of {} tests", outcomes.len()));
            }
        }
    };
    let threads = thread::available_parallelism().map_or(1, NonZeroUsize::get).min(outcomes.len());
    thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(work);
        }
    });
    if let Some(line) = &line {
        line.finish_and_clear();
    }
    let outcomes: Result<Vec<Outcome>, CliError> =
        outcomes.into_iter().map(|outcome| outcome.into_inner().expect("all were taken")).collect();
    let mut outcomes = outcomes?.into_iter();
    let mut both = || [outcomes.next(), outcomes.next()].map(|outcome| outcome.expect("two for each test"));
    Ok(tests.into_iter().map(|test| Trial { test, outcomes: both() }).collect())
}
