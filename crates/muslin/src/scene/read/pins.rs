//! `cloth.pins`: particles that are held, and how they move.

use std::collections::HashMap;

use super::cloth::coarse_positions;
use super::data_file;
use super::table::{Entry, Table};
use super::value::{NumberRule, Value, rounded};
use crate::scene::data::{self, CellError, Column, DataFile, DataFiles, DataTable};
use crate::scene::error::SceneErrorKind;
use crate::scene::{GridSettings, Keyframes, PinMotionSettings, PinPlace, PinSettings, SceneError};

const COLUMNS: [Column; 4] = [
    Column { name: "time", units: &[("s", 1.0)], hint: "times are in seconds from the start of the run" },
    Column { name: "x", units: &[("m", 1.0)], hint: METRES },
    Column { name: "y", units: &[("m", 1.0)], hint: METRES },
    Column { name: "z", units: &[("m", 1.0)], hint: METRES },
];

const METRES: &str = "displacements are in metres";

pub(super) fn read(
    entry: Entry,
    grid: GridSettings,
    files: &mut DataFiles,
) -> Result<Vec<PinSettings>, SceneError> {
    const HELP: &str = "write `pins = [{ column = 0, row = 0 }, { row = -1 }]`";
    let Some(value) = entry.optional() else {
        return Ok(Vec::new());
    };
    let mut motions = Motions { grid, files, keyframes: HashMap::new() };
    let pins = value.clone().tables(HELP)?.into_iter().map(|pin| read_pin(pin, grid, &mut motions));
    let pins = pins.collect::<Result<Vec<_>, _>>()?;
    check_motions(&value, &pins)?;
    Ok(pins)
}

fn read_pin(mut table: Table, grid: GridSettings, motions: &mut Motions) -> Result<PinSettings, SceneError> {
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
    Ok(PinSettings { place, motion: motion.optional().map(|motion| motions.read(motion)).transpose()? })
}

/// Reads the motions of a cloth's pins, the keys of each file once.
struct Motions<'m, 'l> {
    grid: GridSettings,
    files: &'m mut DataFiles<'l>,
    keyframes: HashMap<String, Keyframes>,
}

impl Motions<'_, '_> {
    fn read(&mut self, value: Value) -> Result<PinMotionSettings, SceneError> {
        const HELP: &str =
            "write `motion = { kind = \"sine\", axis = [0, 0, 1], amplitude = 0.1, frequency = 3.0 }`";
        let mut table = value.table(HELP)?;
        let kind = table.take("kind");
        let axis = table.take("axis");
        let amplitude = table.take("amplitude");
        let frequency = table.take("frequency");
        let phase = table.take("phase");
        let file = table.take("file");
        table.finish()?;

        let kind = kind.required("", HELP)?;
        if kind.choice("is not a kind of motion", &[("sine", false), ("keyframes", true)])? {
            for constant in [axis, amplitude, frequency, phase] {
                reject_constant(constant, &kind, "sine")?;
            }
            let file = file.required("", "write `file = \"FILE.csv\"`")?;
            return self.read_keyframes(&file).map(PinMotionSettings::Keyframes);
        }
        reject_constant(file, &kind, "keyframes")?;
        let axis = axis.direction()?;
        let amplitude = amplitude.required("m", "write `amplitude = ...`")?;
        let largest = amplitude.number("m", NumberRule::NotNegative)?;
        self.check_reach(&amplitude, &format!("{} m", amplitude.as_written()), largest)?;
        Ok(PinMotionSettings::Sine {
            axis,
            amplitude: largest,
            frequency: frequency.number("1/s", NumberRule::NotNegative)?,
            phase: phase.optional().map_or(Ok(0.0), |phase| phase.number("rad", NumberRule::Finite))?,
        })
    }

    fn read_keyframes(&mut self, file: &Value) -> Result<Keyframes, SceneError> {
        let name = file.string()?;
        if let Some(known) = self.keyframes.get(name) {
            return Ok(known.clone());
        }
        let keyframes = data_file::read(file, self.files, parse_keyframes)?;
        let displacements = keyframes.keys().iter().map(|key| key.displacement.abs().max_element());
        let largest = displacements.fold(0.0, f64::max);
        self.check_reach(file, &format!("{}, which goes {largest:?} m far", file.as_written()), largest)?;
        self.keyframes.insert(name.to_owned(), keyframes.clone());
        Ok(keyframes)
    }

    /// Checks that displacements up to `largest` [m] do not carry a pin to where positions are too coarse for its springs.
    fn check_reach(&self, value: &Value, found: &str, largest: f64) -> Result<(), SceneError> {
        let Some((rounding, smallest)) = coarse_positions(largest, self.grid) else { return Ok(()) };
        Err(value.error(SceneErrorKind::Inconsistent {
            message: format!(
                "`{}` is {found}, where positions are known to {rounding:.0e} m only, but particles are {} m apart",
                value.path,
                rounded(smallest)
            ),
            help: "let the pin stay nearer to its place".to_owned(),
        }))
    }
}

fn parse_keyframes(file: &DataFile) -> Result<Keyframes, CellError> {
    let text = data::text(file.bytes())?;
    let table = DataTable::read(text, COLUMNS)?;
    Keyframes::new(table.rows()).map_err(|error| {
        let span = table.span(error.row, error.column);
        CellError::at(text, span, error.to_string(), error.help.to_owned())
    })
}

/// Rejects a constant of the motion `owner` in one of another `kind`.
fn reject_constant(constant: Entry, kind: &Value, owner: &str) -> Result<(), SceneError> {
    let Some(constant) = constant.optional() else { return Ok(()) };
    let message =
        format!("`{}` is of the motion \"{owner}\", but the kind is {}", constant.path, kind.as_written());
    let help = format!("leave it out, or write `kind = \"{owner}\"`");
    Err(constant.error(SceneErrorKind::Inconsistent { message, help }))
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
