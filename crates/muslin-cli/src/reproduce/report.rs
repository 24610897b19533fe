//! What was found, section by section, in the form from which page, tables and book are written.

use serde_json::{Value, json};

use super::drawing::Drawing;
use crate::plot::{Plot, csv_field, power_of_ten};

/// Everything that one reproduction found.
#[derive(Clone, Debug)]
pub(crate) struct Report {
    /// Whether the grids and durations are the small ones of `--quick`.
    pub(crate) is_quick: bool,
    pub(crate) sections: Vec<Section>,
}

/// One section of the page.
#[derive(Clone, Debug)]
pub(crate) struct Section {
    /// Its name in links and in the book.
    pub(crate) name: &'static str,
    pub(crate) title: &'static str,
    /// What came out, in a sentence or two for the top of the page; nothing in it depends on the machine.
    pub(crate) finding: String,
    pub(crate) items: Vec<Item>,
}

/// A piece of a section.
#[derive(Clone, Debug)]
pub(crate) enum Item {
    /// A paragraph: plain text with `code` in backticks.
    Text(String),
    /// Names, and a text on each.
    Terms(Vec<(String, String)>),
    Figure(Figure),
    Table(Table),
    /// What depends on the machine and its load, which the book does not repeat.
    Timed(Box<Item>),
}

/// A figure with its caption.
#[derive(Clone, Debug)]
pub(crate) struct Figure {
    /// Name of its files, without ending.
    pub(crate) name: &'static str,
    pub(crate) caption: String,
    pub(crate) content: Content,
}

/// What a figure shows.
#[derive(Clone, Debug)]
pub(crate) enum Content {
    Plot(Plot),
    Drawing(Drawing),
    Pictures(Vec<Picture>),
}

/// A PNG picture.
#[derive(Clone, Debug)]
pub(crate) struct Picture {
    pub(crate) png: Vec<u8>,
    /// What it shows.
    pub(crate) label: String,
    /// Pixels across and down.
    pub(crate) size: [u32; 2],
}

/// A table of numbers and words.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    /// Name of its file, without ending.
    pub(crate) name: &'static str,
    pub(crate) caption: String,
    pub(crate) columns: Vec<Column>,
    pub(crate) rows: Vec<Vec<Cell>>,
}

/// A column of a table.
#[derive(Clone, Debug)]
pub(crate) struct Column {
    /// What it holds, with its unit in brackets if it has one.
    pub(crate) title: &'static str,
    /// Whether it depends on the machine and its load.
    pub(crate) is_timed: bool,
}

/// A cell of a table.
#[derive(Clone, Debug)]
pub(crate) enum Cell {
    Text(String),
    /// A number in the unit of its column, and as a reader sees it.
    Number {
        value: f64,
        shown: String,
    },
    /// There is no such number.
    None,
}

impl Item {
    /// A paragraph.
    pub(crate) fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }

    /// What depends on the machine and its load.
    pub(crate) fn timed(item: Self) -> Self {
        Self::Timed(Box::new(item))
    }

    /// The figure or table, timed or not.
    pub(crate) fn untimed(&self) -> &Self {
        match self {
            Self::Timed(item) => item.untimed(),
            other => other,
        }
    }
}

impl Column {
    /// A column that is the same on every machine.
    pub(crate) fn new(title: &'static str) -> Self {
        Self { title, is_timed: false }
    }

    /// A column that depends on the machine and its load.
    pub(crate) fn timed(title: &'static str) -> Self {
        Self { title, is_timed: true }
    }
}

impl Cell {
    /// Words.
    pub(crate) fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }

    /// `value` shown as `shown`; nothing if it is no finite number.
    pub(crate) fn number(value: f64, shown: impl Into<String>) -> Self {
        if value.is_finite() { Self::Number { value, shown: shown.into() } } else { Self::None }
    }

    /// A whole number.
    pub(crate) fn count(count: u64) -> Self {
        Self::number(count as f64, grouped(count))
    }

    /// A share [1], shown in per cent.
    pub(crate) fn per_cent(share: f64) -> Self {
        Self::number(share, per_cent(share))
    }

    /// A number with three significant digits.
    pub(crate) fn rounded(value: f64) -> Self {
        Self::number(value, rounded(value, 3))
    }

    /// What a reader sees.
    pub(crate) fn shown(&self) -> &str {
        match self {
            Self::Text(shown) | Self::Number { shown, .. } => shown,
            Self::None => "—",
        }
    }

    /// Its value with all digits, or its words.
    fn exact(&self) -> Value {
        match self {
            Self::Text(text) => json!(text),
            Self::Number { value, .. } => json!(value),
            Self::None => Value::Null,
        }
    }
}

impl Report {
    /// All items with what they hold, section by section.
    pub(crate) fn items(&self) -> impl Iterator<Item = &Item> {
        self.sections.iter().flat_map(|section| &section.items).map(Item::untimed)
    }

    /// `figures.json`: every number with all its digits.
    pub(crate) fn to_json(&self) -> Value {
        let tables = self.items().filter_map(|item| match item {
            Item::Table(table) => Some((table.name.to_owned(), table.to_json())),
            _ => None,
        });
        let figures = self.items().filter_map(|item| match item {
            Item::Figure(Figure { name, caption, content: Content::Plot(plot) }) => {
                Some(((*name).to_owned(), plot.to_json(caption)))
            }
            _ => None,
        });
        json!({
            "muslin": env!("CARGO_PKG_VERSION"),
            "reproduction": REPRODUCTION,
            "quick": self.is_quick,
            "tables": tables.collect::<serde_json::Map<_, _>>(),
            "figures": figures.collect::<serde_json::Map<_, _>>(),
        })
    }
}

/// What `figures.json` says that it is of.
pub(crate) const REPRODUCTION: &str =
    "Luo, Miyaki, Yamasaki, Aizawa: Dynamic 3D Simulation of Fabric Based on Improved Mass-Spring Model";

impl Table {
    fn to_json(&self) -> Value {
        let rows = self.rows.iter().map(|row| {
            let cells = self.columns.iter().zip(row);
            cells.map(|(column, cell)| (column.title.to_owned(), cell.exact())).collect::<Value>()
        });
        json!({ "caption": self.caption, "rows": rows.collect::<Vec<_>>() })
    }

    /// The table as comma-separated values with all digits.
    pub(crate) fn to_csv(&self) -> String {
        let header: Vec<String> = self.columns.iter().map(|column| csv_field(column.title)).collect();
        let rows = self.rows.iter().map(|row| {
            let cells = row.iter().map(|cell| match cell {
                Cell::Text(text) => csv_field(text),
                Cell::Number { value, .. } => format!("{value:?}"),
                Cell::None => String::new(),
            });
            cells.collect::<Vec<_>>().join(",")
        });
        let lines: Vec<String> = std::iter::once(header.join(",")).chain(rows).collect();
        lines.join("\n") + "\n"
    }
}

/// A whole number in groups of three digits, with narrow spaces that do not break.
pub(crate) fn grouped(count: u64) -> String {
    let digits = count.to_string();
    if digits.len() < 5 {
        return digits;
    }
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index != 0 && (digits.len() - index).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

/// A number with so many significant digits; powers of ten with superscripts where plain digits get long.
pub(crate) fn rounded(value: f64, digits: u8) -> String {
    let text = crate::progress::rounded(value, digits);
    let text = match text.split_once('e') {
        Some((mantissa, exponent)) => format!("{mantissa} · {}", power_of_ten(exponent)),
        None => text,
    };
    text.replace('-', "−")
}

/// A share [1] in per cent.
pub(crate) fn per_cent(share: f64) -> String {
    format!("{}\u{a0}%", rounded(100.0 * share, 3))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_for_readers() {
        assert_eq!(
            [1234, 12345, 1_234_567].map(grouped),
            ["1234", "12\u{202f}345", "1\u{202f}234\u{202f}567"]
        );
        assert_eq!([0.0123, -1.5e-9].map(|value| rounded(value, 3)), ["0.0123", "−1.50 · 10⁻⁹"]);
        assert_eq!(Cell::per_cent(0.2327).shown(), "23.3\u{a0}%");
        assert_eq!(Cell::rounded(f64::NAN).shown(), "—");
    }

    #[test]
    fn tables_are_read_back_from_their_values() {
        let table = Table {
            name: "table",
            caption: String::new(),
            columns: vec![Column::new("what"), Column::new("value [m]")],
            rows: vec![vec![Cell::text("a, \"b\""), Cell::rounded(1.0 / 3.0)]],
        };
        assert_eq!(table.to_csv(), "what,value [m]\n\"a, \"\"b\"\"\",0.3333333333333333\n");
    }
}
