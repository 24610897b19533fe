//! The report as Markdown, which the book includes piece by piece: all but what depends on the machine.

use std::fmt::Write as _;

use super::report::{Content, Figure, Item, Report, Table};

/// Folder of the figures, relative to the page of the book that includes them.
const FOLDER: &str = "paper";

/// The pieces, each between anchors with the name of its figure or table, and the texts of a section with the section's.
pub(crate) fn markdown(report: &Report) -> String {
    let mut out =
        "<!-- Written by `muslin reproduce`; CI compares it with what the command writes. -->\n".to_owned();
    for section in &report.sections {
        let texts = section.items.iter().filter_map(|item| match item {
            Item::Text(text) => Some(text.as_str()),
            _ => None,
        });
        let texts: Vec<&str> = texts.collect();
        anchored(&mut out, section.name, &(texts.join("\n\n") + "\n"));
        for item in &section.items {
            match item {
                Item::Figure(figure) => anchored(&mut out, figure.name, &figure_text(figure)),
                Item::Table(table) => anchored(&mut out, table.name, &table_text(table)),
                Item::Text(_) | Item::Timed(_) => {}
            }
        }
    }
    out
}

fn anchored(out: &mut String, name: &str, text: &str) {
    let _ = write!(out, "\n<!-- ANCHOR: {name} -->\n{text}<!-- ANCHOR_END: {name} -->\n");
}

fn figure_text(figure: &Figure) -> String {
    let files: Vec<String> = match &figure.content {
        Content::Plot(_) | Content::Drawing(_) => vec![format!("{}.svg", figure.name)],
        Content::Pictures(pictures) => {
            (1..=pictures.len()).map(|number| format!("{}-{number}.png", figure.name)).collect()
        }
    };
    let images: Vec<String> = files.iter().map(|file| format!("![]({FOLDER}/{file})")).collect();
    format!("{}\n\n*{}*\n", images.join("\n"), figure.caption)
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
