//! What a file is said to hold: which test, along which yarns.

use std::fmt;

use crate::FitError;
use crate::columns::Kind;

/// Where a specimen was cut: what it is stretched or bent along.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Direction {
    /// Along the warp, the height of a cloth.
    Warp,
    /// Along the weft, the width of a cloth.
    Weft,
    /// At 45° to both.
    Bias,
}

impl Direction {
    /// All directions.
    pub const ALL: [Self; 3] = [Self::Warp, Self::Weft, Self::Bias];

    /// Its name in labels, comments of files and fabrics.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Warp => "warp",
            Self::Weft => "weft",
            Self::Bias => "bias",
        }
    }

    fn find(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|direction| direction.name() == name)
    }
}

impl fmt::Display for Direction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A test by its name, as labels have it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Test {
    /// Stretching.
    Tensile,
    /// Shearing.
    Shear,
    /// Bending with a measured moment.
    Bend,
    /// Bending under the own weight.
    Cantilever,
}

impl Test {
    const ALL: [Self; 4] = [Self::Tensile, Self::Shear, Self::Bend, Self::Cantilever];

    /// Its name in labels.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Tensile => "tensile",
            Self::Shear => "shear",
            Self::Bend => "bend",
            Self::Cantilever => "cantilever",
        }
    }
}

/// What stands before `=FILE`: a direction, a test, or both, as in `warp`, `shear` and `bend-warp`; empty if nothing does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Label {
    /// The test, which the columns of the file tell too.
    pub test: Option<Test>,
    /// The direction, which a comment of the file may tell too.
    pub direction: Option<Direction>,
}

impl Label {
    /// The label called `name`.
    ///
    /// # Errors
    /// If there is none.
    pub fn parse(name: &str) -> Result<Self, FitError> {
        let mut label = Self::default();
        for part in name.split('-') {
            let test = Test::ALL.into_iter().find(|test| test.name() == part);
            let direction = Direction::find(part);
            let is_new = (test.is_some() && label.test.is_none())
                || (direction.is_some() && label.direction.is_none());
            if !is_new {
                return Err(FitError::inconsistent(
                    format!("there is no label `{name}`"),
                    "write `warp=FILE`, `weft=FILE`, `shear=FILE`, or the test with its direction, as `bend-warp=FILE`: tests \
                     are tensile, shear, bend and cantilever, directions warp, weft and bias",
                ));
            }
            label.test = label.test.or(test);
            label.direction = label.direction.or(direction);
        }
        Ok(label)
    }

    /// The label completed by the comment `# direction: NAME` of `text`, and checked against the columns, which tell that the
    /// file called `file` holds a test of `kind`: its direction, of which a shear test has none.
    pub(crate) fn direction_of(
        self,
        file: &str,
        text: &str,
        kind: Kind,
    ) -> Result<Option<Direction>, FitError> {
        if let Some(test) = self.test.filter(|test| *test != kind.test()) {
            return Err(FitError::whole(
                file,
                format!("is labelled `{}`, but has the columns of {}", test.name(), kind.title()),
                format!(
                    "label it `{}`, or correct its header to `{}`",
                    kind.test().name(),
                    kind.header_for(test)
                ),
            ));
        }
        let written = direction_comment(file, text)?;
        if let (Some(label), Some(comment)) = (self.direction, written)
            && label != comment
        {
            return Err(FitError::whole(
                file,
                format!("is labelled `{label}`, but says `# direction: {comment}`"),
                "correct the one that is wrong",
            ));
        }
        let direction = self.direction.or(written);
        match (kind.test(), direction) {
            (Test::Shear, Some(direction)) => Err(FitError::whole(
                file,
                format!("is a shear test of direction {direction}, but a sheet has one resistance to shear"),
                "label it `shear`; of tests along both yarns give one, or the mean of both",
            )),
            (Test::Tensile, Some(Direction::Bias)) => Err(FitError::whole(
                file,
                "is a tensile test at 45 degrees, from which nothing is identified",
                "give a shear test; FAST's EB5 goes into the fabric as `shear = { eb5_percent = ... }`",
            )),
            (Test::Shear, None) => Ok(None),
            (test, None) => Err(FitError::whole(
                file,
                format!("is a {} test of an unknown direction", test.name()),
                format!(
                    "write `warp={file}` or `weft={file}`, or add the line `# direction: warp` to the file"
                ),
            )),
            (_, direction) => Ok(direction),
        }
    }
}

/// The direction in a line `# direction: NAME` of `text`.
fn direction_comment(file: &str, text: &str) -> Result<Option<Direction>, FitError> {
    let comments =
        text.lines().filter_map(|line| line.trim_start_matches('\u{feff}').trim().strip_prefix('#'));
    let mut values = comments.filter_map(|comment| comment.trim().strip_prefix("direction:"));
    let Some(name) = values.next().map(str::trim) else { return Ok(None) };
    match Direction::find(name) {
        Some(direction) => Ok(Some(direction)),
        None => Err(FitError::whole(
            file,
            format!("says `# direction: {name}`"),
            "directions are warp, weft and bias",
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_tests_and_directions_in_any_order() {
        let parse = |name| Label::parse(name).map(|label| (label.test, label.direction));
        assert_eq!(parse("warp"), Ok((None, Some(Direction::Warp))));
        assert_eq!(parse("shear"), Ok((Some(Test::Shear), None)));
        assert_eq!(parse("bend-bias"), Ok((Some(Test::Bend), Some(Direction::Bias))));
        assert_eq!(parse("weft-cantilever"), Ok((Some(Test::Cantilever), Some(Direction::Weft))));
        for name in ["", "wrap", "warp-weft", "bend-bend", "bend-", "bend-warp-x"] {
            assert!(parse(name).is_err(), "{name}");
        }
    }
}
