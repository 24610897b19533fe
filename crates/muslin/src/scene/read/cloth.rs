//! `[[cloth]]`: grids of particles, where they are and what holds them.

use std::collections::{BTreeMap, HashMap};

use super::table::{Entry, Table};
use super::value::{NumberRule, Value, rounded};
use super::{measured, pins};
use crate::scene::data::DataFiles;
use crate::scene::error::{SceneErrorKind, quoted};
use crate::scene::{ClothSettings, Fabric, GridSettings, MAX_PARTICLES, Placement, SceneError};

/// How far from perpendicular two unit axes may be: their scalar product, so an angle [rad].
const PERPENDICULAR_TOLERANCE: f64 = 1e-9;

pub(super) fn read(
    entry: Entry,
    fabrics: &BTreeMap<String, Fabric>,
    files: &mut DataFiles,
) -> Result<Vec<ClothSettings>, SceneError> {
    const HELP: &str = "add a table `[[cloth]]` with name, fabric, grid and place";
    let value = entry.required("", HELP)?;
    let tables = value.clone().tables("write `[[cloth]]`, one for each cloth")?;
    if tables.is_empty() {
        return Err(value.error(SceneErrorKind::Missing {
            key: "cloth.0".to_owned(),
            unit: "",
            help: HELP.to_owned(),
        }));
    }
    let mut paths_by_name = HashMap::new();
    let mut free_particles = MAX_PARTICLES;
    let mut cloths = Vec::with_capacity(tables.len());
    for table in tables {
        let path = table.path().to_owned();
        let name = table.peek("name");
        let cloth = read_cloth(table, fabrics, files, &mut free_particles)?;
        if let Some(other) = paths_by_name.insert(cloth.name.clone(), path) {
            let name = name.required("", "")?;
            let (key, value) = (name.path.clone(), quoted(&cloth.name));
            return Err(name.error(SceneErrorKind::DuplicateName { key, value, other }));
        }
        cloths.push(cloth);
    }
    Ok(cloths)
}

fn read_cloth(
    mut table: Table,
    fabrics: &BTreeMap<String, Fabric>,
    files: &mut DataFiles,
    free_particles: &mut u64,
) -> Result<ClothSettings, SceneError> {
    let name = table.take("name");
    let fabric = table.take("fabric");
    let grid = table.take("grid");
    let place = table.take("place");
    let pins = table.take("pins");
    table.finish()?;

    let name = name.required("", "write `name = \"...\"`")?;
    if name.string()?.is_empty() {
        return Err(name.out_of_range("", "have at least one character", ""));
    }
    let fabric = fabric.required("", "write `fabric = \"NAME\"` for a table `[fabric.NAME]`")?;
    let Some(known) = fabrics.get(fabric.string()?) else {
        let names = fabrics.keys().map(String::as_str);
        return Err(fabric.unknown_name("no fabric has that name", names));
    };
    let grid_value = grid.clone().optional();
    let grid = read_grid(grid, free_particles)?;
    if let Some(value) = grid_value {
        measured::check_grid(fabric.string()?, known, grid, &value)?;
    }
    Ok(ClothSettings {
        name: name.string()?.to_owned(),
        fabric: fabric.string()?.to_owned(),
        place: read_place(place, grid)?,
        pins: pins::read(pins, grid, files)?,
        grid,
    })
}

fn read_grid(entry: Entry, free_particles: &mut u64) -> Result<GridSettings, SceneError> {
    const HELP: &str = "write `grid = { columns = 10, rows = 10, width = 1.0, height = 1.0 }`";
    let mut table = entry.required("", HELP)?.table(HELP)?;
    let columns = table.take("columns");
    let rows = table.take("rows");
    let width = table.take("width");
    let height = table.take("height");
    table.finish()?;

    let count = |entry: Entry| -> Result<u64, SceneError> {
        let count = entry.required("", HELP)?.integer(1, MAX_PARTICLES.cast_signed())?;
        Ok(count.cast_unsigned())
    };
    let (columns, rows) = (count(columns)?, count(rows)?);
    // Neither is above MAX_PARTICLES, so that the product fits.
    let particles = columns * rows;
    let Some(free) = free_particles.checked_sub(particles) else {
        return Err(table.error(SceneErrorKind::Inconsistent {
            message: format!(
                "`{}` has {columns} x {rows} particles, but all cloths together must have at most {MAX_PARTICLES}",
                table.path()
            ),
            help: String::new(),
        }));
    };
    *free_particles = free;
    Ok(GridSettings {
        columns: columns as usize,
        rows: rows as usize,
        width: read_extent(width, columns)?,
        height: read_extent(height, rows)?,
    })
}

/// Distance [m] from the first to the last of `count` particles.
fn read_extent(entry: Entry, count: u64) -> Result<f64, SceneError> {
    if 1 < count {
        return entry.number("m", NumberRule::Positive);
    }
    if let Some(extent) = entry.optional() {
        extent.number("m", NumberRule::NotNegative)?;
    }
    Ok(0.0)
}

/// Rounding of positions relative to the distance of neighbours, at most.
const ROUNDING_TOLERANCE: f64 = 1e-9;

fn read_place(entry: Entry, grid: GridSettings) -> Result<Placement, SceneError> {
    const HELP: &str =
        "write `place = { origin = [0, 1, 0], width_axis = [1, 0, 0], height_axis = [0, 0, 1] }`";
    let mut table = entry.required("", HELP)?.table(HELP)?;
    let origin = table.take("origin");
    let width_axis = table.take("width_axis");
    let height_axis = table.take("height_axis");
    table.finish()?;

    let origin = origin.required("m", "write `origin = [x, y, z]`")?;
    check_rounding(&origin, grid)?;
    let height_axis = height_axis.required("", "write `height_axis = [x, y, z]`, of any length but zero")?;
    let place = Placement {
        origin: origin.vector("m")?,
        width_axis: width_axis.direction()?,
        height_axis: height_axis.direction()?,
    };
    let cosine = place.width_axis.dot(place.height_axis);
    if PERPENDICULAR_TOLERANCE < cosine.abs() {
        return Err(height_axis.error(SceneErrorKind::Inconsistent {
            message: format!(
                "`{}` is at {} degrees to the width axis, but must be perpendicular to it",
                height_axis.path,
                rounded(libm::acos(cosine.clamp(-1.0, 1.0)).to_degrees())
            ),
            help: perpendicular_help(place),
        }));
    }
    Ok(place)
}

/// Rounding of positions [m] up to `distance` [m] from the origin of space, and the smallest distance [m] of neighbours in
/// `grid`, if the one is too large for the other.
pub(super) fn coarse_positions(distance: f64, grid: GridSettings) -> Option<(f64, f64)> {
    let smallest = grid.smallest_spacing();
    let rounding = f64::EPSILON * (distance + grid.width + grid.height);
    (ROUNDING_TOLERANCE * smallest < rounding).then_some((rounding, smallest))
}

/// Checks that positions around `origin` are fine enough for the springs of `grid`.
fn check_rounding(origin: &Value, grid: GridSettings) -> Result<(), SceneError> {
    let distance = origin.vector("m")?.abs().max_element();
    let Some((rounding, smallest)) = coarse_positions(distance, grid) else {
        return Ok(());
    };
    Err(origin.error(SceneErrorKind::Inconsistent {
        message: format!(
            "`{}` is {distance:e} m from the origin of space, where positions are known to {rounding:.0e} m only, but \
             particles are {} m apart",
            origin.path,
            rounded(smallest)
        ),
        help: "place the cloth near [0, 0, 0]".to_owned(),
    }))
}

/// The height axis nearest to that of `place` which is perpendicular to its width axis, if there is one.
fn perpendicular_help(place: Placement) -> String {
    let across = place.height_axis - place.width_axis * place.width_axis.dot(place.height_axis);
    match across.try_normalize() {
        Some(axis) if axis.dot(place.width_axis).abs() <= PERPENDICULAR_TOLERANCE => {
            format!("the nearest is `height_axis = [{:?}, {:?}, {:?}]`", axis.x, axis.y, axis.z)
        }
        _ => "write two axes of different directions".to_owned(),
    }
}
