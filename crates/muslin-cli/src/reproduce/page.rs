//! The page: one HTML file that needs no other.

use std::fmt::Write as _;

use super::report::{Cell, Content, Figure, Item, Report, Section, Table};
use crate::plot::{FIGURE_STYLE, escaped, svg_element};

/// How the page is laid out.
const PAGE_STYLE: &str = include_str!("page.css");

/// Title of the page.
const TITLE: &str = "The paper, recomputed";

/// The page of `report`, which took `wall_time` in words.
pub(crate) fn page(report: &Report, wall_time: &str) -> String {
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{TITLE}</title>\n\
         <style>\n{FIGURE_STYLE}{PAGE_STYLE}</style>\n</head>\n<body>\n<h1>{TITLE}</h1>\n"
    );
    out.push_str(
        "<p>Luo, Miyaki, Yamasaki and Aizawa, <cite>Dynamic 3D Simulation of Fabric Based on Improved Mass-Spring \
         Model</cite>: its figures, and its claims, computed anew. Every number on this page comes from the run that \
         wrote it.</p>\n",
    );
    if report.is_quick {
        out.push_str(
            "<p><strong>This is the quick version</strong>, with coarse grids: it shows that the command works. \
             Leave out <code>--quick</code> for the results.</p>\n",
        );
    }
    out.push_str("<dl>\n");
    for section in &report.sections {
        let (name, title, finding) = (section.name, escaped(section.title), with_code(&section.finding));
        let _ = writeln!(out, "<dt><a href=\"#{name}\">{title}</a></dt><dd>{finding}</dd>");
    }
    out.push_str("</dl>\n");
    for section in &report.sections {
        write_section(&mut out, section);
    }
    let _ = write!(
        out,
        "<footer>Written by muslin {} in {wall_time}. Every number with all its digits is in <code>figures.json</code>, and \
         figure by figure in the CSV files beside this page. All are the same on every machine, but the times.</footer>\n\
         </body>\n</html>\n",
        env!("CARGO_PKG_VERSION"),
    );
    out
}

fn write_section(out: &mut String, section: &Section) {
    let _ = writeln!(out, "<section id=\"{}\">\n<h2>{}</h2>", section.name, escaped(section.title));
    let mut is_in_figures = false;
    for item in section.items.iter().map(Item::untimed) {
        let is_figure = matches!(item, Item::Figure(_));
        // Figures that follow each other stand beside each other where there is room.
        if is_figure != is_in_figures {
            out.push_str(if is_figure { "<div class=\"figures\">\n" } else { "</div>\n" });
            is_in_figures = is_figure;
        }
        match item {
            Item::Text(text) => {
                let _ = writeln!(out, "<p>{}</p>", with_code(text));
            }
            Item::Terms(terms) => {
                out.push_str("<dl>\n");
                for (name, text) in terms {
                    let _ = writeln!(out, "<dt>{}</dt><dd>{}</dd>", escaped(name), with_code(text));
                }
                out.push_str("</dl>\n");
            }
            Item::Figure(figure) => write_figure(out, figure),
            Item::Table(table) => write_table(out, table),
            Item::Timed(_) => {}
        }
    }
    out.push_str(if is_in_figures { "</div>\n</section>\n" } else { "</section>\n" });
}

fn write_figure(out: &mut String, figure: &Figure) {
    let caption = with_code(&figure.caption);
    match &figure.content {
        Content::Plot(_) => {
            let _ = writeln!(out, "<figure>\n{}", svg(figure, false));
        }
        Content::Drawing(_) => {
            let _ = writeln!(out, "<figure class=\"wide\">\n{}", svg(figure, false));
        }
        Content::Pictures(pictures) => {
            out.push_str("<figure class=\"wide\">\n<div class=\"pictures\">\n");
            for picture in pictures {
                let label = escaped(&picture.label);
                let [width, height] = picture.size;
                let data = base64(&picture.png);
                let _ = writeln!(
                    out,
                    "<div><img alt=\"{label}\" width=\"{width}\" height=\"{height}\" \
                     src=\"data:image/png;base64,{data}\">{label}</div>"
                );
            }
            out.push_str("</div>\n");
        }
    }
    let _ = writeln!(out, "<figcaption>{caption}</figcaption>\n</figure>");
}

fn write_table(out: &mut String, table: &Table) {
    let caption = with_code(&table.caption);
    let _ = writeln!(out, "<p class=\"caption\">{caption}</p>\n<div class=\"scroll\"><table>\n<thead><tr>");
    for (index, column) in table.columns.iter().enumerate() {
        let class = word_class(table.rows.first().and_then(|row| row.get(index)));
        let _ = write!(out, "<th scope=\"col\"{class}>{}</th>", escaped(column.title));
    }
    out.push_str("</tr></thead>\n<tbody>\n");
    for row in &table.rows {
        out.push_str("<tr>");
        for cell in row {
            let _ = write!(out, "<td{}>{}</td>", word_class(Some(cell)), with_code(cell.shown()));
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</tbody>\n</table></div>\n");
}

/// The class attribute of a cell with words.
fn word_class(cell: Option<&Cell>) -> &'static str {
    if matches!(cell, Some(Cell::Text(_))) { " class=\"word\"" } else { "" }
}

/// The SVG element of a plot or a drawing, with a style of its own if it stands alone; nothing for pictures.
pub(crate) fn svg(figure: &Figure, stands_alone: bool) -> String {
    let ([width, height], elements) = match &figure.content {
        Content::Plot(plot) => (plot.size(), plot.elements(figure.name)),
        Content::Drawing(drawing) => (drawing.size, drawing.elements()),
        Content::Pictures(_) => return String::new(),
    };
    svg_element(&figure.caption, [width, height], &elements, stands_alone)
}

/// `text` for HTML, with what stands in backticks as code.
fn with_code(text: &str) -> String {
    let parts = text.split('`').map(escaped).enumerate();
    parts.map(|(index, part)| if index % 2 == 1 { format!("<code>{part}</code>") } else { part }).collect()
}

/// `bytes` in base 64, with padding.
fn base64(bytes: &[u8]) -> String {
    use base64::Engine as _;
    base64::engine::general_purpose::STANDARD.encode(bytes)
}
