//! `muslin fit`.

mod figures;
mod report;

use std::fs;
use std::path::Path;

use muslin::Scene;
use muslin::scene::MAX_DATA_BYTES;
use muslin_fit::{FabricFit, FabricText, FitError, Label, Measurement, parse_areal_density};

use crate::args::FitArguments;
use crate::error::CliError;
use crate::folder::{Folder, Owner};
use crate::print_text;
use crate::scene_file::read_data;
use report::{FORMAT, NUMBERS, PAGE};

/// What the folder is.
const OWNER: Owner = Owner {
    partial: ".fit",
    file: NUMBERS,
    key: "fit",
    value: FORMAT,
    name: "a fit",
    elsewhere: "choose another folder with `--out DIR`",
};

impl From<FitError> for CliError {
    fn from(error: FitError) -> Self {
        Self::BadInput(error.render())
    }
}

/// Identifies a fabric from measurements, and prints or writes it.
pub(crate) fn fit(arguments: &FitArguments) -> Result<(), CliError> {
    require_bare(&arguments.fabric)?;
    let areal_density = parse_areal_density(&arguments.areal_density)?;
    let measurements: Result<Vec<_>, CliError> = arguments.data.iter().map(|data| read(data)).collect();
    let fit = FabricFit::new(areal_density, &measurements?)?;
    let origin = format!("given as {}", arguments.areal_density.trim());
    let text = FabricText::new(&fit, &arguments.fabric, &origin);
    if let Some(ratio) = fit.cell_ratio() {
        require_readable(&text, &arguments.fabric, ratio)?;
    }
    let Some(dir) = &arguments.out else {
        require_no_table(&text)?;
        return print_text(&text.toml);
    };
    let folder = Folder::create(dir, arguments.force, &OWNER)?;
    let replaced = report::recorded_files(&dir.join(NUMBERS));
    let files = report::files(&fit, &text, &arguments.fabric);
    folder.write(&files)?;
    // Plots of an earlier fit beside this one would pass for its own.
    for name in replaced.iter().filter(|old| files.iter().all(|(name, _)| name != *old)) {
        let _ = fs::remove_file(dir.join(name));
    }
    print_text(&format!(
        "{}\n# written to {}: {}.toml, {PAGE} with plots, {NUMBERS}\n",
        text.toml,
        dir.display(),
        arguments.fabric
    ))
}

/// Refuses to print a fabric with a table of tension, which is a file of its own.
fn require_no_table(text: &FabricText) -> Result<(), CliError> {
    let Some((table, _)) = text.tables.first() else { return Ok(()) };
    Err(CliError::input(
        format_args!("no law fits the tension, so that the fabric needs its table in a file, {table}"),
        "give a folder for both with `--out DIR`",
    ))
}

/// Refuses a name that would need quotes in a scene, or in the name of a file.
fn require_bare(name: &str) -> Result<(), CliError> {
    let is_bare = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    if !name.is_empty() && name.chars().all(is_bare) {
        return Ok(());
    }
    Err(CliError::input(
        format_args!("the fabric's name is {name:?}, but must have letters, digits, `-` and `_` alone"),
        "take a name such as `wool-tropical`",
    ))
}

/// Reads what an argument `[LABEL=]FILE` names.
fn read(argument: &str) -> Result<Measurement, CliError> {
    // A path with a folder before its `=` is no label.
    let (label, file) = match argument.split_once('=') {
        Some((label, file)) if !label.contains(['/', '\\', '.']) => (Label::parse(label)?, file),
        _ => (Label::default(), argument),
    };
    let bytes = read_bytes(Path::new(file))?;
    Ok(Measurement::read(file, &bytes, label)?)
}

/// The bytes of a data file.
fn read_bytes(path: &Path) -> Result<Vec<u8>, CliError> {
    let help = "name the CSV file of a test, as `warp=tensile-warp.csv`";
    let bytes = read_data(path).map_err(|reason| CliError::input(reason, help))?;
    if bytes.len() <= MAX_DATA_BYTES {
        return Ok(bytes);
    }
    Err(CliError::input(
        format_args!("{} is longer than {} MiB", path.display(), MAX_DATA_BYTES >> 20),
        "thin it out: some hundreds of points tell as much",
    ))
}

/// Makes sure that a scene can have the fabric called `name` in cells `ratio` times as wide as high: muslin reads what it writes.
fn require_readable(text: &FabricText, name: &str, ratio: f64) -> Result<(), CliError> {
    let mut load = |name: &str| {
        let table = text.tables.iter().find(|(known, _)| known == name);
        table.map(|(_, content)| content.clone().into_bytes()).ok_or_else(|| format!("there is no {name}"))
    };
    let scene = format!(
        "title = \"sheet\"\nrun = {{ duration = 1.0 }}\nenvironment = {{ gravity = [0, 0, 0] }}\n{}\n\
         [[cloth]]\nname = \"sheet\"\nfabric = \"{name}\"\n\
         grid = {{ columns = 2, rows = 2, width = {ratio:?}, height = 1.0 }}\n\
         place = {{ origin = [0, 0, 0], width_axis = [1, 0, 0], height_axis = [0, 1, 0] }}\n",
        text.toml
    );
    match Scene::parse_with(&scene, &mut load) {
        Ok(_) => Ok(()),
        Err(error) => Err(CliError::failed(
            format_args!("the fabric that was found is none that a scene can have: {error}"),
            error.help().unwrap_or_default(),
        )),
    }
}
