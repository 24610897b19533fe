//! Tables of numbers in CSV files.
//!
//! A reader of its own, since an error must name the line and the column of a cell: general readers of CSV lose count of
//! lines at comments and know no columns. Nothing is lost by it: numbers need no quotes over several lines.

use std::ops::Range;

use super::listed;
use crate::scene::error::{Position, quoted, shortened};
use crate::scene::excerpt;

/// A column that a table must have.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// Name in the header.
    pub name: &'static str,
    /// Units that it may have in the header, each with how many of it are one in SI.
    pub units: &'static [(&'static str, f64)],
    /// What to do with another unit.
    pub hint: &'static str,
}

/// Numbers in SI units, a row per line, `N` columns in the order asked for.
#[derive(Clone, Debug)]
pub struct DataTable<const N: usize> {
    rows: Vec<[f64; N]>,
    /// Where the cells of each row are, as ranges of bytes of the text.
    cells: Vec<[Range<usize>; N]>,
}

/// What is wrong in a data file, and where.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
#[non_exhaustive]
pub struct CellError {
    /// The place, unless it is the whole file.
    pub position: Option<Position>,
    /// The line that it is in, empty if it is the whole file.
    pub line: String,
    /// Value and rule, beginning with a verb.
    pub message: String,
    /// What to do about it.
    pub help: String,
}

impl CellError {
    /// An error of a whole file.
    #[must_use]
    pub fn whole(message: &str, help: String) -> Self {
        Self { position: None, line: String::new(), message: message.to_owned(), help }
    }

    /// An error at a range of bytes of `text`.
    #[must_use]
    pub fn at(text: &str, span: Range<usize>, message: String, help: String) -> Self {
        let position = excerpt::position(text, span);
        Self { position: Some(position), line: excerpt::line(text, position.line), message, help }
    }

    /// The whole error for a person: message, place in the file `name`, its line with a caret, and help.
    ///
    /// Several lines, the last without a line break.
    #[must_use]
    pub fn render(&self, name: &str) -> String {
        excerpt::render_cell(self, name)
    }
}

/// The text of a data file.
///
/// # Errors
/// If it is not UTF-8: at the line of the first wrong byte.
pub fn text(bytes: &[u8]) -> Result<&str, CellError> {
    std::str::from_utf8(bytes).map_err(|error| {
        let valid = error.valid_up_to();
        // What is wrong becomes a replacement character, so that the rest can be shown.
        let lossy = String::from_utf8_lossy(bytes);
        let message = format!("is not UTF-8 text (byte {valid} of the file)");
        CellError::at(&lossy, valid..valid, message, "save the file as CSV in UTF-8".to_owned())
    })
}

/// Names of the columns in the header of a table, as they stand there; none if it has no header.
///
/// Which table a file holds can so be known before it is read.
#[must_use]
pub fn column_names(text: &str) -> Vec<&str> {
    let Some(header) = content_lines(text).next() else { return Vec::new() };
    let name = |cell: &'_ str| cell.split('[').next().unwrap_or_default().len();
    let cells = text[header].split(',').map(|cell| cell.trim().trim_matches('"').trim());
    cells.map(|cell| cell[..name(cell)].trim_end()).collect()
}

impl<const N: usize> DataTable<N> {
    /// Reads the table of `columns` from `text`: a header with names and units, then numbers. Empty lines and lines that
    /// start with `#` are passed over.
    ///
    /// # Errors
    /// The first rule that the text breaks.
    pub fn read(text: &str, columns: [Column; N]) -> Result<Self, CellError> {
        let mut lines = content_lines(text);
        let Some(header) = lines.next() else {
            return Err(CellError::whole(
                "holds no table",
                format!("begin with the header `{}`", header_of(&columns)),
            ));
        };
        let header = cells(text, header, &columns)?;
        let places = read_header(text, &header, &columns)?;
        let mut table = Self { rows: Vec::new(), cells: Vec::new() };
        for line in lines {
            let found = cells(text, line.clone(), &columns)?;
            if found.len() != header.len() {
                let message = format!("has {}, but the header has {}", counted(found.len()), header.len());
                let help = "write decimal points, not commas, and no text after the numbers".to_owned();
                return Err(CellError::at(text, line, message, help));
            }
            let mut row = [0.0; N];
            let mut spans = std::array::from_fn(|_| 0..0);
            for (column, &(place, parts)) in places.iter().enumerate() {
                spans[column] = found[place].clone();
                row[column] = number(text, spans[column].clone(), columns[column].name)? / parts;
            }
            table.rows.push(row);
            table.cells.push(spans);
        }
        if table.rows.is_empty() {
            let header = header[0].start..header[header.len() - 1].end;
            let message = "has a header, but no numbers below it".to_owned();
            return Err(CellError::at(text, header, message, "add a line for each point".to_owned()));
        }
        Ok(table)
    }

    /// All rows, in SI units.
    #[must_use]
    pub fn rows(&self) -> &[[f64; N]] {
        &self.rows
    }

    /// Where the cell of `column` in `row` is, as a range of bytes of the text.
    ///
    /// # Panics
    /// If there is no such cell.
    #[must_use]
    pub fn span(&self, row: usize, column: usize) -> Range<usize> {
        self.cells[row][column].clone()
    }
}

/// The lines of `text`, without space around them, that are neither empty nor comments.
fn content_lines(text: &str) -> impl Iterator<Item = Range<usize>> + '_ {
    let mut start = 0;
    let lines = text.split_inclusive('\n').map(move |line| {
        let line_start = start;
        start += line.len();
        trimmed(text, line_start..start)
    });
    lines.filter(|line| !line.is_empty() && !text[line.clone()].starts_with('#'))
}

/// A range of `text` without the space and byte order mark at its ends.
fn trimmed(text: &str, range: Range<usize>) -> Range<usize> {
    let is_space = |c: char| c.is_whitespace() || c == '\u{feff}';
    let part = &text[range.clone()];
    let start = range.start + (part.len() - part.trim_start_matches(is_space).len());
    start..start + part.trim_matches(is_space).len()
}

/// The cells of a line, without quotes and space around them.
fn cells<const N: usize>(
    text: &str,
    line: Range<usize>,
    columns: &[Column; N],
) -> Result<Vec<Range<usize>>, CellError> {
    let content = &text[line.clone()];
    if !content.contains(',') && content.contains([';', '\t']) {
        let help = format!("save the file with commas between cells, as in `{}`", header_of(columns));
        let separator = if content.contains(';') { "semicolons" } else { "tabs" };
        return Err(CellError::at(
            text,
            line,
            format!("has {separator} between its cells, but must have commas"),
            help,
        ));
    }
    let mut cells = Vec::new();
    let mut start = line.start;
    let mut is_quoted = false;
    for (index, character) in content.char_indices().chain([(content.len(), ',')]) {
        match character {
            '"' => is_quoted = !is_quoted,
            ',' if !is_quoted || index == content.len() => {
                let cell = trimmed(text, start..line.start + index);
                let is_in_quotes = 2 <= cell.len()
                    && text[cell.clone()].starts_with('"')
                    && text[cell.clone()].ends_with('"');
                cells.push(if is_in_quotes { trimmed(text, cell.start + 1..cell.end - 1) } else { cell });
                start = line.start + index + 1;
            }
            _ => {}
        }
    }
    Ok(cells)
}

/// For each of `columns` its place in the header and how many of its unit are one in SI.
fn read_header<const N: usize>(
    text: &str,
    header: &[Range<usize>],
    columns: &[Column; N],
) -> Result<[(usize, f64); N], CellError> {
    let mut places = [None; N];
    for (place, span) in header.iter().enumerate() {
        let cell = &text[span.clone()];
        let fault = |message: String, help: String| Err(CellError::at(text, span.clone(), message, help));
        let as_in = || format!("write the header `{}`", header_of(columns));
        if cell.parse::<f64>().is_ok() {
            return fault("has numbers, but the first line must be a header".to_owned(), as_in());
        }
        let (name, unit) = match cell.strip_suffix(']').and_then(|cell| cell.split_once('[')) {
            Some((name, unit)) => (name.trim_end(), Some(unit.trim())),
            None => (cell, None),
        };
        let Some(index) = columns.iter().position(|column| column.name == name) else {
            let names = listed(columns.iter().map(|column| column.name));
            return fault(format!("has the column {}, but must have {names} alone", quoted(cell)), as_in());
        };
        let units = columns[index].units;
        let known =
            || units.iter().map(|(unit, _)| format!("`{name} [{unit}]`")).collect::<Vec<_>>().join(" or ");
        let Some(&(_, parts)) = units.iter().find(|(known, _)| Some(*known) == unit) else {
            let found = unit.map_or("no unit".to_owned(), |unit| format!("the unit {}", quoted(unit)));
            return fault(
                format!("has {found} at the column {}, but must have {}", quoted(name), known()),
                columns[index].hint.to_owned(),
            );
        };
        if places[index].replace((place, parts)).is_some() {
            return fault(format!("has the column {} twice", quoted(name)), as_in());
        }
    }
    let line = header[0].start..header[header.len() - 1].end;
    let mut found = [(0, 1.0); N];
    for (index, place) in places.into_iter().enumerate() {
        let Some(place) = place else {
            let message = format!("has no column {}", quoted(columns[index].name));
            return Err(CellError::at(
                text,
                line,
                message,
                format!("write the header `{}`", header_of(columns)),
            ));
        };
        found[index] = place;
    }
    Ok(found)
}

/// The header that `columns` may have.
fn header_of(columns: &[Column]) -> String {
    let cell =
        |column: &Column| format!("{} [{}]", column.name, column.units.first().map_or("", |(unit, _)| unit));
    columns.iter().map(cell).collect::<Vec<_>>().join(",")
}

/// A number of cells, in words.
fn counted(cells: usize) -> String {
    if cells == 1 { "1 cell".to_owned() } else { format!("{cells} cells") }
}

/// The finite number in a cell.
fn number(text: &str, span: Range<usize>, name: &str) -> Result<f64, CellError> {
    let cell = &text[span.clone()];
    if let Some(number) = cell.parse().ok().filter(|number: &f64| number.is_finite()) {
        return Ok(number);
    }
    let value = if cell.is_empty() { "empty".to_owned() } else { quoted(&shortened(cell)) };
    let help = if cell.contains(',') {
        "write a decimal point, not a comma"
    } else if cell.contains(';') {
        "write commas between cells, not semicolons"
    } else {
        "leave out lines without a measured value"
    };
    let message = format!("{name} is {value}, but must be a finite number");
    Err(CellError::at(text, span, message, help.to_owned()))
}
