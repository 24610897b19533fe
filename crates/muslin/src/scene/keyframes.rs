//! Displacements at given times.

use std::sync::Arc;

use glam::DVec3;

/// The least time [s] from one key to the next: velocities between them stay numbers.
const LEAST_INTERVAL: f64 = 1e-9;

/// Times [s] and displacements [m] at most.
const LARGEST: f64 = 1e30;

/// Names of the columns, with the unit after each.
const COLUMNS: [(&str, &str); 4] = [("time", "s"), ("x", "m"), ("y", "m"), ("z", "m")];

/// One key of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Keyframe {
    /// Time [s].
    pub time: f64,
    /// Displacement [m] from the place at time zero.
    pub displacement: DVec3,
}

/// Displacements at given times, of pins that move alike.
///
/// Invariants: at least two keys; the first at time zero without displacement; times ascend by at least 1e-9 s; no number
/// is above 1e30 in size. A clone shares the keys.
#[derive(Clone, Debug)]
pub struct Keyframes {
    keys: Arc<[Keyframe]>,
}

/// Which row of a table breaks which rule.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{} is {value}, but {rule}", COLUMNS[*.column].0)]
pub struct KeyframesError {
    /// Number of the row, from zero.
    pub row: usize,
    /// Which of its numbers: 0 for the time, 1 to 3 for the coordinates.
    pub column: usize,
    /// What it is, with its unit.
    pub value: String,
    /// What it must be.
    pub rule: String,
    /// What to do about it.
    pub help: &'static str,
}

impl Keyframes {
    /// The keys in `rows` of time [s] and displacement x, y, z [m].
    ///
    /// # Errors
    /// The first rule of the invariants that a row breaks.
    pub fn new(rows: &[[f64; 4]]) -> Result<Self, KeyframesError> {
        let mut before = None;
        for (row, numbers) in rows.iter().enumerate() {
            check_row(row, *numbers, before)?;
            before = Some(numbers[0]);
        }
        if rows.len() < 2 {
            let rule = "must be followed by a later one".to_owned();
            let help = "add a line for each time at which the displacement is known";
            return Err(KeyframesError { row: 0, column: 0, value: "the only one".to_owned(), rule, help });
        }
        // −0 is 0.
        let key = |[time, x, y, z]: &[f64; 4]| Keyframe {
            time: time + 0.0,
            displacement: DVec3::new(*x, *y, *z) + DVec3::ZERO,
        };
        Ok(Self { keys: rows.iter().map(key).collect() })
    }

    /// The keys, times ascending.
    #[must_use]
    pub fn keys(&self) -> &[Keyframe] {
        &self.keys
    }
}

impl PartialEq for Keyframes {
    fn eq(&self, other: &Self) -> bool {
        // Many pins may share keys, of which there may be many.
        Arc::ptr_eq(&self.keys, &other.keys) || self.keys == other.keys
    }
}

/// Checks one row, which follows one at the time `before` [s].
fn check_row(row: usize, numbers: [f64; 4], before: Option<f64>) -> Result<(), KeyframesError> {
    let fault = |column: usize, rule: &str, help: &'static str| {
        let value = format!("{:?} {}", numbers[column], COLUMNS[column].1);
        Err(KeyframesError { row, column, value, rule: rule.to_owned(), help })
    };
    // A range does not hold what is not a number.
    if let Some(column) = (0..4).find(|&column| !(0.0..=LARGEST).contains(&numbers[column].abs())) {
        return fault(column, "must be at most 1e30 in size", "write it in metres and seconds");
    }
    let Some(before) = before else {
        if numbers[0] != 0.0 {
            return fault(0, "must be 0 in the first row", "begin with the line `0,0,0,0`");
        }
        return match (1..4).find(|&column| numbers[column] != 0.0) {
            Some(column) => fault(
                column,
                "must be 0 at time 0: displacements are from where the scene places the pin",
                "take the first position from all of them",
            ),
            None => Ok(()),
        };
    };
    if numbers[0] - before < LEAST_INTERVAL {
        let rule = format!("must be above the {before:?} s before it, by at least {LEAST_INTERVAL:?} s");
        return fault(0, &rule, "sort the rows by time, and write each time once");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_a_number_is_no_key() {
        for column in 0..4 {
            for value in [f64::NAN, f64::INFINITY, -2e30] {
                let mut rows = [[0.0; 4], [1.0, 0.1, 0.2, 0.3]];
                assert!(Keyframes::new(&rows).is_ok());
                rows[1][column] = value;
                let error = Keyframes::new(&rows).expect_err("no number");
                assert_eq!((error.row, error.column), (1, column));
            }
        }
        assert_eq!(Keyframes::new(&[[0.0; 4]]).expect_err("one key").row, 0);
        assert!(Keyframes::new(&[]).is_err());
    }
}
