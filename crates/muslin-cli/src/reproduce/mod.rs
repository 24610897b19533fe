//! `muslin reproduce`: the paper's figures and claims, recomputed, on one page.
//!
//! Each section computes its numbers and puts them into a [`Report`](report::Report), from which page, tables and the book's
//! pieces are written.

mod accuracy;
mod book;
mod drawing;
mod extent;
mod hanging;
mod limit;
mod page;
mod particles;
mod progress;
mod refinement;
mod report;
mod springs;
mod stretch;
mod trial;

use std::io::{self, Write, stdout};
use std::path::Path;
use std::time::Duration;

use crate::args::ReproduceArguments;
use crate::error::CliError;
use crate::folder::{Folder, Owner};
use crate::progress::duration_text;
use crate::report::shell_word;
use crate::run::interruption;
use extent::Extent;
use progress::Progress;
use report::{Content, Item, REPRODUCTION, Report};

/// The page.
const PAGE: &str = "index.html";

/// Every number, and the file that tells what the folder holds.
const FIGURES: &str = "figures.json";

/// What the folder is.
const OWNER: Owner = Owner {
    partial: ".reproduction",
    file: FIGURES,
    key: "reproduction",
    value: REPRODUCTION,
    name: "a reproduction",
    elsewhere: "choose another folder",
};

/// The pieces of the book.
const BOOK: &str = "paper-figures.md";

/// Recomputes the paper and writes the folder.
pub(crate) fn reproduce(arguments: &ReproduceArguments) -> Result<(), CliError> {
    let interrupted = interruption()?;
    let folder = Folder::create(&arguments.dir, arguments.force, &OWNER)?;
    let extent = if arguments.quick { Extent::QUICK } else { Extent::FULL };
    let progress = Progress::new(&interrupted);
    let result = compute(&extent, &progress);
    let elapsed = progress.finish();
    let report = result.inspect_err(|_| folder.discard())?;
    let files = files(&report, elapsed);
    folder.write(&files)?;
    CliError::print(write_report(&arguments.dir, &files, elapsed))
}

/// Every section, in the order of the page. Each takes about its share of the time.
fn compute(extent: &Extent, progress: &Progress<'_>) -> Result<Report, CliError> {
    let sections = vec![
        springs::section(),
        stretch::section(),
        hanging::section(extent.is_quick, 0.02, progress)?,
        limit::section(extent, 0.06, progress)?,
        refinement::section(extent, 0.74, progress)?,
        particles::section(extent, 0.12, progress)?,
        accuracy::section(extent, 0.06, progress)?,
    ];
    Ok(Report { is_quick: extent.is_quick, sections })
}

/// Names and contents of all files, the page last.
fn files(report: &Report, elapsed: Duration) -> Vec<(String, Vec<u8>)> {
    let mut files: Vec<(String, Vec<u8>)> = Vec::new();
    for item in report.items() {
        match item {
            Item::Table(table) => files.push((format!("{}.csv", table.name), table.to_csv().into_bytes())),
            Item::Figure(figure) => match &figure.content {
                Content::Plot(plot) => {
                    files.push((format!("{}.svg", figure.name), page::svg(figure, true).into_bytes()));
                    files.push((format!("{}.csv", figure.name), plot.to_csv().into_bytes()));
                }
                Content::Drawing(_) => {
                    files.push((format!("{}.svg", figure.name), page::svg(figure, true).into_bytes()));
                }
                Content::Pictures(pictures) => {
                    for (number, picture) in (1..).zip(pictures) {
                        files.push((format!("{}-{number}.png", figure.name), picture.png.clone()));
                    }
                }
            },
            Item::Text(_) | Item::Terms(_) | Item::Timed(_) => {}
        }
    }
    files.push((BOOK.to_owned(), book::markdown(report).into_bytes()));
    files.push((FIGURES.to_owned(), format!("{:#}\n", report.to_json()).into_bytes()));
    files.push((PAGE.to_owned(), page::page(report, &duration_text(elapsed.as_secs_f64())).into_bytes()));
    files
}

fn write_report(dir: &Path, files: &[(String, Vec<u8>)], elapsed: Duration) -> io::Result<()> {
    let mut out = stdout().lock();
    let time = duration_text(elapsed.as_secs_f64());
    writeln!(out, "{}: {} files, computed in {time}", dir.display(), files.len())?;
    writeln!(out, "look at it: open {}", shell_word(&dir.join(PAGE).display().to_string()))?;
    out.flush()
}
