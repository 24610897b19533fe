//! `cloth.pins`: particles that are held, and how they move.

use std::collections::HashMap;

use super::cloth::coarse_positions;
use super::table::{Entry, Table};
use super::value::{NumberRule, Value, rounded};
use crate::scene::error::SceneErrorKind;
use crate::scene::{GridSettings, PinMotionSettings, PinPlace, PinSettings, SceneError};

pub(super) fn read(entry: Entry, grid: GridSettings) -> Result<Vec<PinSettings>, SceneError> {
    const HELP: &str = "write `pins = [{ column = 0, row = 0 }, { row = -1 }]`";
    let Some(value) = entry.optional() else {
        return Ok(Vec::new());
    };
    let pins = value.clone().tables(HELP)?.into_iter().map(|pin| read_pin(pin, grid));
    let pins = pins.collect::<Result<Vec<_>, _>>()?;
    check_motions(&value, &pins)?;
    Ok(pins)
}

fn read_pin(mut table: Table, grid: GridSettings) -> Result<PinSettings, SceneError> {
    let column = table.take("column");
    let row = table.take("row");
    let motion = table.take("motion");
    table.finish()?;

    let column = column.optional().map(|index| read_index(&index, "columns", grid.columns)).transpose()?;
    let row = row.optional().map(|index| read_index(&index, "rows", grid.rows)).transpose()?;
    let place = match (column, row) {
        (Some(column), Some(row)) => PinPlace::Particle { column, row },
        (None, Some(row)) => PinPlace::Row(row),
        (Some(column), None) => PinPlace::Column(column),
        (None, None) => {
            return Err(table.error(SceneErrorKind::Inconsistent {
                message: format!("`{}` names neither a column nor a row", table.path()),
                help: "write `{ column = 0, row = 0 }`, `{ row = 0 }` or `{ column = 0 }`".to_owned(),
            }));
        }
    };
    Ok(PinSettings { place, motion: motion.optional().map(|motion| read_motion(motion, grid)).transpose()? })
}

fn read_motion(value: Value, grid: GridSettings) -> Result<PinMotionSettings, SceneError> {
    const HELP: &str =
        "write `motion = { kind = \"sine\", axis = [0, 0, 1], amplitude = 0.1, frequency = 3.0 }`";
    let mut table = value.table(HELP)?;
    let kind = table.take("kind");
    if let Some(kind) = table.peek("kind").optional() {
        kind.reject_later(&[("keyframes", "a pin that follows keyframes")], "use `kind = \"sine\"`")?;
        kind.choice("is not a kind of motion", &[("sine", ())])?;
    }
    let axis = table.take("axis");
    let amplitude = table.take("amplitude");
    let frequency = table.take("frequency");
    let phase = table.take("phase");
    table.finish()?;

    kind.required("", HELP)?;
    let amplitude = amplitude.required("m", "write `amplitude = ...`")?;
    let axis = axis.direction()?;
    Ok(PinMotionSettings::Sine {
        axis,
        amplitude: read_amplitude(&amplitude, grid)?,
        frequency: frequency.number("1/s", NumberRule::NotNegative)?,
        phase: phase.optional().map_or(Ok(0.0), |phase| phase.number("rad", NumberRule::Finite))?,
    })
}

/// An amplitude [m] that does not carry a pin to where positions are too coarse for its springs.
fn read_amplitude(value: &Value, grid: GridSettings) -> Result<f64, SceneError> {
    let amplitude = value.number("m", NumberRule::NotNegative)?;
    match coarse_positions(amplitude, grid) {
        None => Ok(amplitude),
        Some((rounding, smallest)) => Err(value.error(SceneErrorKind::Inconsistent {
            message: format!(
                "`{}` is {} m, where positions are known to {rounding:.0e} m only, but particles are {} m apart",
                value.path,
                value.as_written(),
                rounded(smallest)
            ),
            help: "write a smaller amplitude".to_owned(),
        })),
    }
}

/// Checks that no particle has two different motions.
///
/// Rows and columns are compared first and single particles with them after, so that the effort grows as the number of
/// pins and not as its square or as the number of particles.
fn check_motions(value: &Value, pins: &[PinSettings]) -> Result<(), SceneError> {
    let (mut rows, mut columns, mut particles) = (HashMap::new(), HashMap::new(), HashMap::new());
    let check = |index: usize, other: Option<usize>| match other {
        Some(other) if pins[index].motion != pins[other].motion => {
            let (first, second) = (index.min(other), index.max(other));
            let (key, place) = (&value.path, value.elements("an array of tables", "")?);
            let kind = SceneErrorKind::Inconsistent {
                message: format!("`{key}.{second}` holds a particle of `{key}.{first}`, but moves otherwise"),
                help: "give both the same motion, or pin other particles".to_owned(),
            };
            Err(place.get(second).unwrap_or(value).error(kind))
        }
        _ => Ok(()),
    };
    let (mut first_row, mut first_column) = (None, None);
    for (index, pin) in pins.iter().enumerate() {
        match pin.place {
            PinPlace::Row(row) => {
                first_row.get_or_insert(index);
                check(index, Some(*rows.entry(row).or_insert(index)))?;
            }
            PinPlace::Column(column) => {
                first_column.get_or_insert(index);
                check(index, Some(*columns.entry(column).or_insert(index)))?;
            }
            PinPlace::Particle { .. } => {}
        }
    }
    for (index, pin) in pins.iter().enumerate() {
        match pin.place {
            // Every row crosses every column.
            PinPlace::Row(_) => check(index, first_column)?,
            PinPlace::Column(_) => check(index, first_row)?,
            PinPlace::Particle { column, row } => {
                check(index, Some(*particles.entry((column, row)).or_insert(index)))?;
                check(index, rows.get(&row).copied())?;
                check(index, columns.get(&column).copied())?;
            }
        }
    }
    Ok(())
}

/// An index below `count`; a negative one counts from the end.
fn read_index(value: &Value, what: &str, count: usize) -> Result<usize, SceneError> {
    let index = value.integer(i64::MIN, i64::MAX)?;
    let from_start = if index < 0 { index.checked_add_unsigned(count as u64) } else { Some(index) };
    match from_start.and_then(|index| usize::try_from(index).ok()) {
        Some(index) if index < count => Ok(index),
        _ => Err(value.out_of_range(
            "",
            &format!("be from 0 to {} or from -{count} to -1", count - 1),
            &format!("the grid has {count} {what}; negative indices count from the end"),
        )),
    }
}
