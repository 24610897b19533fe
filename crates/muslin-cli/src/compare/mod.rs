//! `muslin compare`: two fabrics on all virtual instruments, side by side.
//!
//! Both go through the same tests; what the instruments say becomes tables, and their curves become plots.

mod figures;
mod files;
mod measure;
mod page;
mod properties;
mod sheet;
mod table;

use std::fs;
use std::io::{self, Write, stdout};
use std::path::{Path, PathBuf};

use muslin::lab::{Instrument, Resolution};

use crate::args::CompareArguments;
use crate::error::CliError;
use crate::folder::{Folder, Owner};
use crate::lab::{NamedFabric, resolution};
use crate::report::shell_word;
use measure::{Test, Trial};
use table::Section;

/// All values, and the file that tells what the folder holds.
const VALUES: &str = "compare.json";

/// The page.
const PAGE: &str = "index.html";

/// What the folder is.
const OWNER: Owner = Owner {
    partial: ".compare",
    file: VALUES,
    key: "what",
    value: WHAT,
    name: "a comparison",
    elsewhere: "choose another folder with `--out DIR`",
};

/// What `compare.json` says that it is.
const WHAT: &str = "a comparison of two fabrics by muslin";

/// Two fabrics, A and B, and what came out.
struct Comparison {
    names: [String; 2],
    resolution: Resolution,
    trials: Vec<Trial>,
    sections: Vec<Section>,
}

/// Measures two fabrics and writes the folder.
pub(crate) fn compare(arguments: &CompareArguments) -> Result<(), CliError> {
    let resolution = resolution(arguments.cells)?;
    let fabrics = [NamedFabric::read(&arguments.first)?, NamedFabric::read(&arguments.second)?];
    let tests = Test::all(arguments.along.map(Into::into));
    let path = arguments.out.clone().unwrap_or_else(|| default_folder(&fabrics));
    let folder = Folder::create(&path, arguments.force, &OWNER)?;
    let trials = measure::measure(tests, &fabrics, resolution).inspect_err(|_| folder.discard())?;
    let sections = table::sections(&fabrics, &trials);
    let names = fabrics.map(|fabric| fabric.name);
    let comparison = Comparison { names, resolution, trials, sections };
    let files = files::files(&comparison);
    folder.write(&files)?;
    remove_others(&path, &files);
    CliError::print(report(&comparison, &path))
}

fn default_folder(fabrics: &[NamedFabric; 2]) -> PathBuf {
    let [first, second] = fabrics;
    Path::new("out").join(format!("compare-{}-{}", first.name, second.name))
}

/// Removes the curves of an earlier comparison along other yarns, which would pass for this one's.
fn remove_others(path: &Path, files: &[(String, Vec<u8>)]) {
    let tests = Instrument::ALL.into_iter().flat_map(Test::of);
    let names = tests.flat_map(|test| ["svg", "csv"].map(|ending| format!("{}.{ending}", test.file_name())));
    for name in names.filter(|name| files.iter().all(|(file, _)| file != name)) {
        let _ = fs::remove_file(path.join(name));
    }
}

fn report(comparison: &Comparison, path: &Path) -> io::Result<()> {
    let mut out = stdout().lock();
    out.write_all(sheet::sheet(comparison).as_bytes())?;
    writeln!(out, "look at it: open {}", shell_word(&path.join(PAGE).display().to_string()))?;
    out.flush()
}
