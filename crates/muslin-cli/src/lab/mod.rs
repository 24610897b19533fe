//! `muslin lab`: a fabric on a virtual instrument.
//!
//! The library measures; this reads the fabric and writes curve, values, plot and pictures.

mod fabric;
mod files;
mod sheet;

use std::fmt;
use std::io::{self, Write, stdout};
use std::path::{Path, PathBuf};

use muslin::lab::{Along, Instrument, LabError, Measurement, Resolution};

use crate::args::{InstrumentName, LabArguments, YarnName};
use crate::error::CliError;
use crate::folder::{Folder, Owner};
use crate::report::shell_word;
pub(crate) use fabric::NamedFabric;

/// The values, and the file that tells what the folder holds.
const VALUES: &str = "lab.json";

/// What the folder is.
const OWNER: Owner = Owner {
    partial: ".lab",
    file: VALUES,
    key: "what",
    value: WHAT,
    name: "a test",
    elsewhere: "choose another folder with `--out DIR`",
};

/// What `lab.json` says that it is.
const WHAT: &str = "a test on a virtual instrument of muslin";

/// A test: which fabric, how, and what came out.
struct Test {
    instrument: Instrument,
    fabric: NamedFabric,
    along: Along,
    resolution: Resolution,
    measurement: Measurement,
}

impl Test {
    /// The fabric and its yarns, in words.
    fn specimen(&self) -> String {
        match self.instrument.has_yarns() {
            true => format!("{} along the {}", self.fabric.name, self.along.name()),
            false => self.fabric.name.clone(),
        }
    }
}

/// Measures a fabric and writes the folder.
pub(crate) fn lab(arguments: &LabArguments) -> Result<(), CliError> {
    let resolution = resolution(arguments.cells)?;
    let fabric = NamedFabric::read(&arguments.fabric)?;
    let instrument = instrument(arguments.instrument);
    let along = arguments.along().into();
    let path = arguments.out.clone().unwrap_or_else(|| default_folder(instrument, &fabric.name, along));
    let folder = Folder::create(&path, arguments.force, &OWNER)?;
    let measured = instrument.measure(&fabric.fabric, along, resolution);
    let measurement = measured.map_err(|error| failed(&error, &error)).inspect_err(|_| folder.discard())?;
    let test = Test { instrument, fabric, along, resolution, measurement };
    let files = files::files(&test).map_err(|error| CliError::write(&path, &error));
    folder.write(&files.inspect_err(|_| folder.discard())?)?;
    CliError::print(report(&test, &path))
}

/// The resolution of `cells` between clamps.
pub(crate) fn resolution(cells: usize) -> Result<Resolution, CliError> {
    Resolution::new(cells).map_err(|error| CliError::input(error, "choose another number with `--cells N`"))
}

impl From<YarnName> for Along {
    fn from(name: YarnName) -> Self {
        match name {
            YarnName::Warp => Self::Warp,
            YarnName::Weft => Self::Weft,
        }
    }
}

fn instrument(name: InstrumentName) -> Instrument {
    match name {
        InstrumentName::Tensile => Instrument::Tensile,
        InstrumentName::Shear => Instrument::Shear,
        InstrumentName::Bend => Instrument::Bend,
        InstrumentName::Cantilever => Instrument::Cantilever,
        InstrumentName::Bias => Instrument::Bias,
        InstrumentName::PictureFrame => Instrument::PictureFrame,
    }
}

fn default_folder(instrument: Instrument, fabric: &str, along: Along) -> PathBuf {
    let name = format!("lab-{}-{fabric}", instrument.name());
    Path::new("out").join(if instrument.has_yarns() { format!("{name}-{}", along.name()) } else { name })
}

/// An error of an instrument, told as `message`: what is wrong with the fabric is bad input; a specimen that does not come to
/// rest is a failure.
pub(crate) fn failed(error: &LabError, message: impl fmt::Display) -> CliError {
    let help = match error {
        LabError::NotAtRest { .. } => "try another number of cells with `--cells N`",
        LabError::OutOfReach { .. } => {
            "a fabric that stretches so far needs another test; check the units of its tension"
        }
        LabError::ShearAboveStretch { .. } => "check the units of its shear and its tension",
        LabError::Nothing { .. } => "choose another instrument, or give the fabric a value",
        _ => "choose another fabric or instrument",
    };
    match error {
        LabError::NotAtRest { .. } => CliError::failed(message, help),
        _ => CliError::input(message, help),
    }
}

fn report(test: &Test, path: &Path) -> io::Result<()> {
    let mut out = stdout().lock();
    out.write_all(sheet::sheet(test).as_bytes())?;
    writeln!(out, "look at it: muslin view {}", shell_word(&path.display().to_string()))?;
    out.flush()
}
