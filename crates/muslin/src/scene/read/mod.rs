//! From scene text to a checked [`Scene`].

mod cloth;
mod curve;
mod data_file;
mod environment;
mod expect;
mod fabric;
mod limit;
mod measured;
mod pins;
mod quantity;
mod run;
mod table;
mod value;

use toml::de::DeTable;

pub(super) use self::fabric::read_library as read_library_fabric;
use self::table::Table;
pub(super) use self::table::joined;
pub(super) use self::value::rounded;
use super::data::DataFiles;
use super::error::{SceneError, SceneErrorKind};
use super::{Fabric, MAX_SCENE_BYTES, Scene};

impl Scene {
    /// Reads a scene from TOML text that names no files.
    ///
    /// Nothing is taken on trust: an unknown key, a missing quantity, a wrong type or a value out of range is an error
    /// at its place.
    ///
    /// # Errors
    /// The first rule that the text breaks, see [`SceneErrorKind`]; that it names a file is one of them.
    pub fn parse(text: &str) -> Result<Self, SceneError> {
        Self::read(text, DataFiles::new(None))
    }

    /// Reads a scene from TOML text, and the files that it names through `load`.
    ///
    /// `load` is given a name such as `data/warp.csv`: a path below the folder of the scene, with `/` between folders and
    /// without `..`. It returns the bytes of the file, or in lower case and without full stop why it cannot: "it could
    /// not be read: no such file". It need not read more than one byte beyond [`MAX_DATA_BYTES`](super::MAX_DATA_BYTES),
    /// and is asked once for each name. [`Scene::data_files`] gives back what was read.
    ///
    /// ```
    /// use muslin::Scene;
    ///
    /// let text = r#"
    ///     title = "A bead on a thread"
    ///     run = { duration = 0.5, step = { constant = 8.333333333333e-4 } }
    ///     environment = { gravity = [0.0, -9.81, 0.0] }
    ///
    ///     [fabric.thread]
    ///     kind = "springs"
    ///     particle_mass = 0.01
    ///     drag = 0.0
    ///     structural = { law = "curve", curve = "thread.csv" }
    ///     shear = { stiffness = 0.0, law = "linear" }
    ///     bend = { stiffness = 0.0, law = "linear" }
    ///
    ///     [[cloth]]
    ///     name = "thread"
    ///     fabric = "thread"
    ///     grid = { columns = 1, rows = 2, height = 1.0 }
    ///     place = { origin = [0, 0, 0], width_axis = [0, 0, 1], height_axis = [1, 0, 0] }
    ///     pins = [{ row = 0 }]
    /// "#;
    /// let mut load = |name: &str| match name {
    ///     "thread.csv" => Ok(b"strain [%],tension [N]\n0.01,0.05\n0.02,0.12\n".to_vec()),
    ///     _ => Err("there is no such file here".to_owned()),
    /// };
    /// let scene = Scene::parse_with(text, &mut load)?;
    /// assert_eq!(scene.data_files()[0].name(), "thread.csv");
    /// # Ok::<(), muslin::scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// As [`Scene::parse`]; and a file that cannot be read, or breaks a rule itself.
    pub fn parse_with(
        text: &str,
        load: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
    ) -> Result<Self, SceneError> {
        Self::read(text, DataFiles::new(Some(load)))
    }

    fn read(text: &str, mut files: DataFiles) -> Result<Self, SceneError> {
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
        let fabrics = fabric::read(fabrics, &mut files)?;
        let cloths = cloth::read(cloths, &fabrics, &mut files)?;
        let has_structural_springs = cloths.iter().any(|cloth| {
            fabrics[&cloth.fabric].has_structural_springs() && 1 < cloth.grid.columns.max(cloth.grid.rows)
        });
        let expectations = expect::read(expectations, has_structural_springs)?;
        let data_files = files.into_files();
        Ok(Self { title, run, environment, fabrics, cloths, expectations, data_files })
    }
}

impl Fabric {
    /// Reads a fabric from TOML text: its keys as they stand in a table `[fabric.NAME]` of a scene, or that table alone. The
    /// files that it names are read through `load`, as [`Scene::parse_with`] does.
    ///
    /// ```
    /// use muslin::scene::{Fabric, LibraryFabric};
    ///
    /// let suiting = LibraryFabric::find("typical-suiting").expect("a fabric of the library");
    /// let mut no_files = |_: &str| Err("there are none".to_owned());
    /// let fabric = Fabric::parse_with(suiting.text(), &mut no_files)?;
    /// assert_eq!(fabric, Fabric::Measured(suiting.fabric()));
    /// let table = format!("[fabric.suiting]\n{}", suiting.text());
    /// assert_eq!(Fabric::parse_with(&table, &mut no_files)?, fabric);
    /// # Ok::<(), muslin::scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// The first rule that the text breaks; that it has more than one fabric is one of them.
    pub fn parse_with(
        text: &str,
        load: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
    ) -> Result<Self, SceneError> {
        check_length(text)?;
        let entries = DeTable::parse(text).map_err(|error| not_toml(error.message(), error.span(), text))?;
        if entries.get_ref().is_empty() {
            return Err(SceneError::new(SceneErrorKind::Empty));
        }
        fabric::read_alone(text, entries.get_ref(), &mut DataFiles::new(Some(load)))
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
