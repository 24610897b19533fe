//! The page: one HTML file that needs no other.

use std::fmt::Write as _;

use super::figures::Figure;
use super::table::Section;
use super::{Comparison, VALUES};
use crate::plot::{FIGURE_STYLE, escaped, svg_element};

/// How pages with figures and tables are laid out.
const PAGE_STYLE: &str = include_str!("../reproduce/page.css");

/// Heads of a table's columns.
const HEAD: [&str; 7] = ["along", "name", "what", "A", "B", "unit", "B / A"];

/// Columns of words.
const WORDS: [usize; 4] = [0, 1, 2, 5];

/// The page of `comparison`, whose tests have these `figures`.
pub(super) fn page(comparison: &Comparison, figures: &[Option<Figure>]) -> String {
    let Comparison { names, resolution, sections, trials } = comparison;
    let [first, second] = names.each_ref().map(|name| escaped(name));
    let title = format!("{first} and {second}, compared");
    let cells = resolution.cells();
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n\
         <style>\n{FIGURE_STYLE}{PAGE_STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n\
         <p>A is <strong>{first}</strong>, B is <strong>{second}</strong>. Both were measured on the same virtual instruments, on \
         specimens of {cells} cells between clamps.</p>\n"
    );
    for section in sections {
        let title = escaped(section.title());
        let _ = writeln!(out, "<section>\n<h2>{}</h2>", capitalised(&title));
        let figures =
            trials.iter().zip(figures).filter(|(trial, _)| Some(trial.test.instrument) == section.instrument);
        let figures: Vec<&Figure> = figures.filter_map(|(_, figure)| figure.as_ref()).collect();
        write_figures(&mut out, &figures);
        write_table(&mut out, section);
        out.push_str("</section>\n");
    }
    let _ = write!(
        out,
        "<footer>Written by muslin {}. Every value with all its digits is in <code>{VALUES}</code>, the curves are in the \
         CSV files beside this page.</footer>\n</body>\n</html>\n",
        env!("CARGO_PKG_VERSION")
    );
    out
}

fn write_figures(out: &mut String, figures: &[&Figure]) {
    if figures.is_empty() {
        return;
    }
    out.push_str("<div class=\"figures\">\n");
    for figure in figures {
        let caption = capitalised(&escaped(&figure.caption));
        let _ =
            writeln!(out, "<figure>\n{}<figcaption>{caption}</figcaption>\n</figure>", svg(figure, false));
    }
    out.push_str("</div>\n");
}

fn write_table(out: &mut String, section: &Section) {
    let class = |column: usize| if WORDS.contains(&column) { " class=\"word\"" } else { "" };
    out.push_str("<div class=\"scroll\"><table>\n<thead><tr>");
    for (column, head) in HEAD.into_iter().enumerate() {
        let _ = write!(out, "<th scope=\"col\"{}>{head}</th>", class(column));
    }
    out.push_str("</tr></thead>\n<tbody>\n");
    for row in &section.rows {
        out.push_str("<tr>");
        for (column, cell) in row.cells().iter().enumerate() {
            let _ = write!(out, "<td{}>{}</td>", class(column), escaped(cell));
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</tbody>\n</table></div>\n");
}

/// The SVG element of a plot, with a style of its own if it stands alone.
pub(super) fn svg(figure: &Figure, stands_alone: bool) -> String {
    let Figure { name, caption, plot } = figure;
    svg_element(caption, plot.size(), &plot.elements(name), stands_alone)
}

/// `text` with a capital letter at its beginning.
fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
