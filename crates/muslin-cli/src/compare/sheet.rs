//! What a comparison says on the terminal.

use std::fmt::Write as _;

use super::Comparison;
use super::table::Row;

/// All tables, a quantity a line.
pub(super) fn sheet(comparison: &Comparison) -> String {
    let Comparison { names: [first, second], resolution, sections, .. } = comparison;
    let mut out = format!("A: {first}\nB: {second}\n{} cells between clamps\n", resolution.cells());
    let rows = || sections.iter().flat_map(|section| &section.rows);
    let mut widths = HEAD.map(|text| text.chars().count());
    for cells in rows().map(Row::cells) {
        for (width, cell) in widths.iter_mut().zip(&cells) {
            *width = cell.chars().count().max(*width);
        }
    }
    write_line(&mut out, &HEAD.map(str::to_owned), &widths);
    for section in sections.iter().filter(|section| !section.rows.is_empty()) {
        let _ = writeln!(out, "{}", section.title());
        for row in &section.rows {
            write_line(&mut out, &row.cells(), &widths);
        }
    }
    out
}

/// Heads of the columns; those of A, B and their ratio have numbers.
const HEAD: [&str; 7] = ["", "", "", "A", "B", "unit", "B / A"];
const NUMBERS: [usize; 3] = [3, 4, 6];

fn write_line(out: &mut String, cells: &[String; 7], widths: &[usize; 7]) {
    let mut line = String::new();
    for (column, (cell, &width)) in cells.iter().zip(widths).enumerate() {
        let _ = match NUMBERS.contains(&column) {
            true => write!(line, "  {cell:>width$}"),
            false => write!(line, "  {cell:<width$}"),
        };
    }
    let _ = writeln!(out, "{}", line.trim_end());
}
