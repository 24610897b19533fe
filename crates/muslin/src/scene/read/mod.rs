//! From scene text to a checked [`Scene`].

mod cloth;
mod environment;
mod expect;
mod fabric;
mod pins;
mod run;
mod table;
mod value;

use toml::de::DeTable;

use self::table::Table;
pub(super) use self::table::joined;
use super::Fabric;
use super::error::{SceneError, SceneErrorKind};
use super::{MAX_SCENE_BYTES, Scene};

impl Scene {
    /// Reads a scene from TOML text.
    ///
    /// Nothing is taken on trust: an unknown key, a missing quantity, a wrong type or a value out of range is an error
    /// at its place.
    ///
    /// # Errors
    /// The first rule that the text breaks, see [`SceneErrorKind`].
    pub fn parse(text: &str) -> Result<Self, SceneError> {
        check_length(text)?;
        let entries = DeTable::parse(text).map_err(|error| not_toml(error.message(), error.span(), text))?;
        if entries.get_ref().is_empty() {
            return Err(SceneError::new(SceneErrorKind::Empty));
        }
        let mut scene = Table::new(text, String::new(), None, entries.get_ref());
        let title = scene.take("title");
        let run = scene.take("run");
        let environment = scene.take("environment");
        let fabrics = scene.take("fabric");
        let cloths = scene.take("cloth");
        let expectations = scene.take("expect");
        scene.finish()?;

        let title = title.string()?.to_owned();
        let run = run::read(run)?;
        let environment = environment::read(environment, run.duration)?;
        let fabrics = fabric::read(fabrics)?;
        let cloths = cloth::read(cloths, &fabrics)?;
        let has_structural_springs = cloths.iter().any(|cloth| {
            let Fabric::Springs(fabric) = &fabrics[&cloth.fabric];
            0.0 < fabric.structural.stiffness && 1 < cloth.grid.columns.max(cloth.grid.rows)
        });
        let expectations = expect::read(expectations, has_structural_springs)?;
        Ok(Self { title, run, environment, fabrics, cloths, expectations })
    }
}

/// Rejects a text that is too long to be a scene.
pub(super) fn check_length(text: &str) -> Result<(), SceneError> {
    if MAX_SCENE_BYTES < text.len() {
        return Err(SceneError::new(SceneErrorKind::TooLarge { bytes: text.len() }));
    }
    Ok(())
}

/// What the TOML parser says of `text`.
pub(super) fn not_toml(message: &str, span: Option<std::ops::Range<usize>>, text: &str) -> SceneError {
    let kind = SceneErrorKind::NotToml { message: message.to_owned() };
    match span {
        Some(span) => SceneError::at(kind, text, span),
        None => SceneError::new(kind),
    }
}
