//! The fabric that a command names: one of the library, or a file.

use std::path::Path;

use muslin::scene::{Fabric, LibraryFabric, MeasuredFabric};

use crate::error::CliError;
use crate::scene_file::{read_data, read_text};

/// A measured fabric and its name.
pub(crate) struct NamedFabric {
    pub(crate) name: String,
    pub(crate) fabric: MeasuredFabric,
}

impl NamedFabric {
    /// The fabric of the library that is called `fabric`, or else that of the file at that path.
    pub(crate) fn read(fabric: &str) -> Result<Self, CliError> {
        if let Some(found) = LibraryFabric::find(fabric) {
            return Ok(Self { name: fabric.to_owned(), fabric: found.fabric() });
        }
        let path = Path::new(fabric);
        if !path.exists() {
            let names = LibraryFabric::ALL.map(LibraryFabric::name).join(", ");
            return Err(CliError::input(
                format_args!("there is no fabric and no file `{fabric}`"),
                format_args!("name a TOML file with a measured fabric, or one of the library: {names}"),
            ));
        }
        let text = read_text(
            path,
            "fabric file",
            "name a TOML file with a fabric; `muslin fabric show NAME` prints one",
        )?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut load = |file: &str| read_data(&folder.join(file));
        match Fabric::parse_with(&text, &mut load) {
            Ok(Fabric::Measured(found)) => {
                let stem = path.file_stem().map_or("fabric".into(), |stem| stem.to_string_lossy());
                Ok(Self { name: stem.into_owned(), fabric: found })
            }
            Ok(Fabric::Springs(_)) => Err(CliError::input(
                format_args!(
                    "{fabric} has a fabric of kind \"springs\", but instruments measure per width and area"
                ),
                "give its values as kind \"measured\"; `muslin fabric show NAME` prints an example",
            )),
            Err(error) => Err(CliError::BadInput(error.render(fabric, &text))),
        }
    }
}
