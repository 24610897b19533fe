//! Data files of instruments, read and checked.

use muslin::scene::{CellError, Column, DataTable, KesTensile, column_names, data_text};

use crate::FitError;
use crate::columns::{
    BEND, BENDING_LENGTH, CANTILEVER, KES_TENSILE, Kind, RIGIDITY, SHEAR, SHEAR_MODULUS, TENSILE,
};
use crate::label::{Direction, Label};

/// The fewest points of a curve that scatter can be told from.
pub(crate) const LEAST_POINTS: usize = 5;

/// How far the strain of a tensile test, or the path of a loop, may step back by scatter, in parts of its range.
const STEP_BACK: f64 = 0.01;

/// A data file, in SI units. Rows keep their order.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// Name of the file, without control characters.
    pub file: String,
    /// What the specimen was stretched or bent along; none of a shear test.
    pub direction: Option<Direction>,
    /// What was measured.
    pub data: Data,
}

/// Values of one test.
#[derive(Clone, Debug, PartialEq)]
pub enum Data {
    /// Strain [1] and tension per width [N/m]: out to the largest strain, and back if measured.
    Tensile(Vec<[f64; 2]>),
    /// Values of KES, one a specimen.
    KesTensile(Vec<KesTensile>),
    /// Angle [rad] and force per width [N/m], in the order of time.
    Shear(Vec<[f64; 2]>),
    /// G [N/m], one a specimen.
    ShearModulus(Vec<f64>),
    /// Curvature [1/m] and moment per width [N], in the order of time.
    Bend(Vec<[f64; 2]>),
    /// B [N m], one a specimen.
    Rigidity(Vec<f64>),
    /// Overhang [m] and angle of the chord [rad].
    Cantilever(Vec<[f64; 2]>),
    /// Bending length [m], one a specimen.
    BendingLength(Vec<f64>),
}

impl Measurement {
    /// Reads the file called `file`, which `label` says more of.
    ///
    /// # Errors
    /// The first rule that it breaks, with its line and a way out.
    pub fn read(file: &str, bytes: &[u8], label: Label) -> Result<Self, FitError> {
        let data_error = |error| FitError::at_cell(file, error);
        let text = data_text(bytes).map_err(data_error)?;
        let names = column_names(text);
        let Some(kind) = Kind::of_columns(&names) else {
            let message = match names.first() {
                None => "holds no table",
                Some(name) if name.parse::<f64>().is_ok() => {
                    "has numbers, but the first line must be a header"
                }
                Some(_) => "has no column of a test",
            };
            let help = "begin with a header such as `strain [%],tension [gf/cm]`, `angle [deg],force [gf/cm]`, \
                        `curvature [1/cm],moment [gf cm/cm]`, `overhang [mm],angle [deg]`, `bending_length [mm]`, \
                        `emt [%],lt [1],force [gf/cm]`, `g [gf/(cm deg)]` or `b [gf cm^2/cm]`";
            return Err(FitError::whole(file, message, help));
        };
        let direction = label.direction_of(file, text, kind)?;
        let data = read_data(text, kind).map_err(data_error)?;
        // The name stands in comments, where a line break would end them.
        let file = file.replace(char::is_control, "\u{fffd}");
        Ok(Self { file, direction, data })
    }

    /// What the table holds.
    #[must_use]
    pub fn kind(&self) -> Kind {
        match self.data {
            Data::Tensile(_) => Kind::Tensile,
            Data::KesTensile(_) => Kind::KesTensile,
            Data::Shear(_) => Kind::Shear,
            Data::ShearModulus(_) => Kind::ShearModulus,
            Data::Bend(_) => Kind::Bend,
            Data::Rigidity(_) => Kind::Rigidity,
            Data::Cantilever(_) => Kind::Cantilever,
            Data::BendingLength(_) => Kind::BendingLength,
        }
    }
}

fn read_data(text: &str, kind: Kind) -> Result<Data, CellError> {
    Ok(match kind {
        Kind::Tensile => Data::Tensile(read_tensile(text)?),
        Kind::KesTensile => Data::KesTensile(read_kes_tensile(text)?),
        Kind::Shear => Data::Shear(read_loop(text, SHEAR, &SHEAR_RULE, &ANGLE_REACH)?),
        Kind::Bend => Data::Bend(read_loop(text, BEND, &BEND_RULE, &CURVATURE_REACH)?),
        Kind::Cantilever => Data::Cantilever(read_cantilever(text)?),
        Kind::ShearModulus => Data::ShearModulus(read_values(text, SHEAR_MODULUS, &SHEAR_MODULUS_RULE)?),
        Kind::Rigidity => Data::Rigidity(read_values(text, RIGIDITY, &RIGIDITY_RULE)?),
        Kind::BendingLength => Data::BendingLength(read_values(text, BENDING_LENGTH, &LENGTH_RULE)?),
    })
}

/// What the values of a column must be.
struct Rule {
    holds: fn(f64) -> bool,
    rule: &'static str,
    help: &'static str,
}

/// How far a column must reach, in SI units, for its unit to be that of the numbers.
struct Reach {
    least: f64,
    rule: &'static str,
    help: &'static str,
}

const STRAIN_REACH: Reach = Reach {
    least: 0.001,
    rule: "reach 0.1 %",
    help: "head the column `strain [1]` if it is a fraction of the length; see that the columns stand below their names",
};

const ANGLE_REACH: Reach = Reach {
    least: 0.5 * std::f64::consts::PI / 180.0,
    rule: "reach 0.5 degrees",
    help: "head the column `angle [rad]` if it is in radians; see that the columns stand below their names",
};

const CURVATURE_REACH: Reach = Reach {
    least: 5.0,
    rule: "reach 0.05 per centimetre",
    help: "see that the unit is that of the numbers, and that the columns stand below their names",
};

impl Reach {
    /// Checks the first column of `table` of `text`.
    fn check(&self, text: &str, table: &DataTable<2>, columns: &[Column; 2]) -> Result<(), CellError> {
        let rows = table.rows();
        let farther =
            |best: usize, row: usize| if rows[best][0].abs() < rows[row][0].abs() { row } else { best };
        let farthest = (0..rows.len()).fold(0, farther);
        if self.least <= rows[farthest][0].abs() {
            return Ok(());
        }
        let span = table.span(farthest, 0);
        let message = format!(
            "{} is {} where it is largest, but must {}",
            columns[0].name,
            &text[span.clone()],
            self.rule
        );
        Err(CellError::at(text, span, message, self.help.to_owned()))
    }
}

const STRAIN_RULE: Rule = Rule {
    holds: |strain| strain <= 1.0,
    rule: "be at most 1 (100 %)",
    help: "head the column `strain [%]` if it is in per cent; see that the columns stand below their names",
};

const SHEAR_RULE: Rule = Rule {
    holds: |angle| angle.abs() < std::f64::consts::FRAC_PI_3,
    rule: "be below 60 degrees",
    help: "head the column `angle [deg]` if it is in degrees; see that the columns stand below their names",
};

const BEND_RULE: Rule = Rule {
    holds: |curvature| curvature.abs() <= 2000.0,
    rule: "be at most 20 per centimetre",
    help: "see that the unit is that of the numbers, and that the columns stand below their names",
};

const CHORD_RULE: Rule = Rule {
    holds: |angle| (0.0174..1.4836).contains(&angle),
    rule: "be from 1 to 85 degrees",
    help: "head the column `angle [deg]` if it is in degrees; see that the columns stand below their names; take another \
           overhang",
};

const LENGTH_RULE: Rule = Rule {
    holds: |length| (0.0005..2.0).contains(&length),
    rule: "be from 0.5 mm to 2 m",
    help: "see that the unit is that of the numbers, and that the columns stand below their names",
};

const SHEAR_MODULUS_RULE: Rule = Rule {
    holds: |modulus| (0.1..=10_000.0).contains(&modulus),
    rule: "be from 0.1 to 10000 N/m (0.0018 to 178 gf/(cm deg))",
    help: "see that the unit is that of the numbers; woven fabrics have some 0.3 to 2 gf/(cm deg)",
};

pub(crate) const RIGIDITIES: std::ops::RangeInclusive<f64> = 1e-8..=2e-3;

const RIGIDITY_RULE: Rule = Rule {
    holds: |rigidity| RIGIDITIES.contains(&rigidity),
    rule: "be from 1e-8 to 2e-3 N m (1e-4 to 20 gf cm^2/cm)",
    help: "see that the unit is that of the numbers; clothing has some 0.01 to 1 gf cm^2/cm",
};

const EMT_RULE: Rule = Rule {
    holds: |strain| (0.001..1.0).contains(&strain),
    rule: "be from 0.1 to 100 %",
    help: "head the column `emt [%]` if it is in per cent and `emt [1]` if it is a fraction; see that the columns stand below their \
           names",
};

const POSITIVE_RULE: Rule = Rule {
    holds: |force| 0.0 < force,
    rule: "be positive",
    help: "500 gf/cm is the greatest force of the standard test",
};

impl Rule {
    /// Checks the values of `column` in `table` of `text`.
    fn check<const N: usize>(
        &self,
        text: &str,
        table: &DataTable<N>,
        columns: &[Column; N],
        column: usize,
    ) -> Result<(), CellError> {
        let Some(row) = table.rows().iter().position(|row| !(self.holds)(row[column])) else { return Ok(()) };
        let span = table.span(row, column);
        let message = format!("{} is {}, but must {}", columns[column].name, &text[span.clone()], self.rule);
        Err(CellError::at(text, span, message, self.help.to_owned()))
    }
}

/// Checks that a curve has points enough, and that neither of its columns is constant.
fn check_extent(text: &str, table: &DataTable<2>, columns: &[Column; 2]) -> Result<(), CellError> {
    let rows = table.rows();
    let last = rows.len() - 1;
    if rows.len() < LEAST_POINTS {
        let message = format!("ends after {} points, but a law needs at least {LEAST_POINTS}", rows.len());
        let help = "add measured points: scatter is told from what a law leaves over".to_owned();
        return Err(CellError::at(text, table.span(last, 0), message, help));
    }
    for (index, column) in columns.iter().enumerate() {
        if rows.iter().all(|row| row[index] == rows[0][index]) {
            let message = format!("{} is the same in all rows", column.name);
            let help = "give the measured curve; see that the right column was exported".to_owned();
            return Err(CellError::at(text, table.span(last, index), message, help));
        }
    }
    // The covariance of both columns is positive for anything that resists.
    let mean = |index: usize| rows.iter().map(|row| row[index]).sum::<f64>() / rows.len() as f64;
    let (x, y) = (mean(0), mean(1));
    if rows.iter().map(|row| (row[0] - x) * (row[1] - y)).sum::<f64>() <= 0.0 {
        let message = format!("{} does not rise with {}", columns[1].name, columns[0].name);
        let help =
            "give both the same sign where the fabric resists; see that the right columns were exported"
                .to_owned();
        return Err(CellError::at(text, table.span(last, 1), message, help));
    }
    Ok(())
}

fn read_tensile(text: &str) -> Result<Vec<[f64; 2]>, CellError> {
    let table = DataTable::read(text, TENSILE)?;
    STRAIN_RULE.check(text, &table, &TENSILE, 0)?;
    check_extent(text, &table, &TENSILE)?;
    STRAIN_REACH.check(text, &table, &TENSILE)?;
    let rows = table.rows();
    let top = crate::tension::turning_point(rows);
    let margin = STEP_BACK * rows[top][0];
    for (row, &[strain, _]) in rows.iter().enumerate() {
        let shown = &text[table.span(row, 0)];
        if strain < -margin {
            let message = format!("strain is {shown}, but must not be below 0");
            let help =
                "count strain from where the fabric is taut, and leave out what comes before".to_owned();
            return Err(CellError::at(text, table.span(row, 0), message, help));
        }
        let Some(before) = row.checked_sub(1) else { continue };
        let back = if row <= top { rows[before][0] - strain } else { strain - rows[before][0] };
        if margin < back {
            let rule = if row <= top { "rise row by row up to" } else { "fall row by row after" };
            let [before, largest] = [before, top].map(|row| &text[table.span(row, 0)]);
            let message = format!("strain is {shown} after {before}, but must {rule} the largest, {largest}");
            let help =
                "give one way out, and one back if measured, in the order of time; one specimen a file"
                    .to_owned();
            return Err(CellError::at(text, table.span(row, 0), message, help));
        }
    }
    if top + 1 < LEAST_POINTS {
        let message = format!(
            "has its largest strain in row {}, but a law needs at least {LEAST_POINTS} on the way there",
            top + 1
        );
        let help = "give the way out, not the way back alone".to_owned();
        return Err(CellError::at(text, table.span(top, 0), message, help));
    }
    Ok(rows.to_vec())
}

fn read_kes_tensile(text: &str) -> Result<Vec<KesTensile>, CellError> {
    let table = DataTable::read(text, KES_TENSILE)?;
    EMT_RULE.check(text, &table, &KES_TENSILE, 0)?;
    POSITIVE_RULE.check(text, &table, &KES_TENSILE, 2)?;
    let tests =
        table.rows().iter().map(|&[extension, linearity, force]| KesTensile { extension, linearity, force });
    let tests: Vec<KesTensile> = tests.collect();
    for (row, test) in tests.iter().enumerate() {
        if let Err(error) = test.tension() {
            let span = table.span(row, 1);
            let message = format!("lt is {}, but {error}", &text[span.clone()]);
            let help = "see that the columns stand below their names; or give the measured curve, `strain [%],tension [gf/cm]`";
            return Err(CellError::at(text, span, message, help.to_owned()));
        }
    }
    Ok(tests)
}

/// Rows of a shear or bending test.
fn read_loop(
    text: &str,
    columns: [Column; 2],
    rule: &Rule,
    reach: &Reach,
) -> Result<Vec<[f64; 2]>, CellError> {
    let table = DataTable::read(text, columns)?;
    rule.check(text, &table, &columns, 0)?;
    check_extent(text, &table, &columns)?;
    reach.check(text, &table, &columns)?;
    let turns = crate::path::turning_points(table.rows().iter().map(|row| row[0]));
    // A closed loop turns twice, and a few loops may follow each other.
    const MOST_TURNS: usize = 20;
    if let Some(row) = turns.get(MOST_TURNS) {
        let name = columns[0].name;
        let message =
            format!("{name} turns back for the {}st time, as if rows were out of order", MOST_TURNS + 1);
        let help =
            format!("keep the rows in the order of time: friction is known from where {name} comes from");
        return Err(CellError::at(text, table.span(*row, 0), message, help));
    }
    Ok(table.rows().to_vec())
}

fn read_cantilever(text: &str) -> Result<Vec<[f64; 2]>, CellError> {
    let table = DataTable::read(text, CANTILEVER)?;
    LENGTH_RULE.check(text, &table, &CANTILEVER, 0)?;
    CHORD_RULE.check(text, &table, &CANTILEVER, 1)?;
    Ok(table.rows().to_vec())
}

/// The values of a table of one column.
fn read_values(text: &str, columns: [Column; 1], rule: &Rule) -> Result<Vec<f64>, CellError> {
    let table = DataTable::read(text, columns)?;
    rule.check(text, &table, &columns, 0)?;
    Ok(table.rows().iter().map(|[value]| *value).collect())
}
