//! The report as Markdown, which the book includes section by section: all but what depends on the machine.

use std::fmt::Write as _;

use super::report::{Content, Figure, Item, Report, Table};

/// Folder of the figures, relative to the page of the book that includes them.
const FOLDER: &str = "paper";

/// The sections, each between anchors with its name.
pub(crate) fn markdown(report: &Report) -> String {
    let mut out =
        "<!-- Written by `muslin reproduce`; CI compares it with what the command writes. -->\n".to_owned();
    for section in &report.sections {
        let pieces: Vec<String> = section.items.iter().filter_map(item_text).collect();
        let (name, pieces) = (section.name, pieces.join("\n"));
        let _ = write!(out, "\n<!-- ANCHOR: {name} -->\n{pieces}<!-- ANCHOR_END: {name} -->\n");
    }
    out
}

fn item_text(item: &Item) -> Option<String> {
    match item {
        Item::Text(text) => Some(format!("{text}\n")),
        Item::Terms(terms) => {
            let lines = terms.iter().map(|(name, text)| format!("- **{name}**: {text}\n"));
            Some(lines.collect())
        }
        Item::Figure(figure) => Some(figure_text(figure)),
        Item::Table(table) => Some(table_text(table)),
        Item::Timed(_) => None,
    }
}

fn figure_text(figure: &Figure) -> String {
    let (name, caption) = (figure.name, &figure.caption);
    let images = match &figure.content {
        Content::Plot(_) | Content::Drawing(_) => format!("![{caption}]({FOLDER}/{name}.svg)\n"),
        Content::Pictures(pictures) => {
            let numbered = (1..).zip(pictures);
            let images = numbered.map(|(number, picture)| {
                let label = &picture.label;
                format!("<img src=\"{FOLDER}/{name}-{number}.png\" alt=\"{label}\" title=\"{label}\" width=\"32%\">\n")
            });
            images.collect()
        }
    };
    format!("{images}\n*{caption}*\n")
}

fn table_text(table: &Table) -> String {
    let is_shown: Vec<bool> = table.columns.iter().map(|column| !column.is_timed).collect();
    let line = |cells: &mut dyn Iterator<Item = &str>| {
        let cells = cells.zip(&is_shown).filter_map(|(cell, is_shown)| is_shown.then_some(cell));
        format!("| {} |\n", cells.collect::<Vec<_>>().join(" | "))
    };
    let mut text = line(&mut table.columns.iter().map(|column| column.title));
    text += &line(&mut table.columns.iter().map(|_| "---"));
    for row in &table.rows {
        text += &line(&mut row.iter().map(super::report::Cell::shown));
    }
    format!("{text}\n*{}*\n", table.caption)
}
