//! What a step costs: against a plain scalar loop, against the machine's floor, and of what it depends on.
//!
//! `cargo bench` prints all sections in a few minutes; `cargo bench -- --quick` in half a minute, with more noise.
//! `cargo bench -- textbook sizes` prints the named ones, and `--json FILE` writes what was measured. Times change from machine
//! to machine and from minute to minute; the ratios are of competitors that took turns, medians with quartiles in brackets.
//! `--steps CASE COUNT` measures nothing but takes steps, whose instructions another program counts.

mod clock;
mod cloth;
mod counted;
mod floor;
mod instruction_set;
mod laws;
mod machine;
mod measure;
mod memory;
mod rivals;
mod runs;
mod sizes;
mod stepper;
mod table;
mod textbook;

use std::io::{self, Write};

use machine::Machine;
use measure::Budget;
use table::Report;

/// Measures and reports a section.
type Section<W> = fn(&mut Report<W>, Budget) -> io::Result<()>;

/// What the command line asks for.
struct Arguments {
    budget: Budget,
    json: Option<String>,
    /// Names of sections; all if there are none.
    sections: Vec<String>,
    /// A case, and how many steps of it to take, in place of measuring.
    steps: Option<(String, u64)>,
}

impl Arguments {
    fn read(mut words: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut arguments = Self { budget: Budget::FULL, json: None, sections: Vec::new(), steps: None };
        while let Some(word) = words.next() {
            match word.as_str() {
                "--bench" => {} // which Cargo adds
                "--quick" => arguments.budget = Budget::QUICK,
                "--json" => arguments.json = Some(words.next().ok_or("`--json` needs a file")?),
                "--steps" => {
                    let case = words.next().filter(|case| counted::CASES.contains(&case.as_str()));
                    let count = words.next().and_then(|count| count.parse().ok());
                    let steps = case.zip(count).ok_or_else(|| {
                        format!("`--steps` needs one of {}, and a number", counted::CASES.join(", "))
                    })?;
                    arguments.steps = Some(steps);
                }
                option if option.starts_with('-') => {
                    return Err(format!(
                        "`{option}` is none of `--quick`, `--json FILE`, `--steps CASE COUNT`"
                    ));
                }
                _ => arguments.sections.push(word),
            }
        }
        Ok(arguments)
    }

    fn has(&self, name: &str) -> bool {
        self.sections.is_empty() || self.sections.iter().any(|section| section == name)
    }
}

fn sections<W: Write>() -> [(&'static str, Section<W>); 7] {
    [
        ("textbook", rivals::against_the_textbook),
        ("floor", rivals::against_the_floor),
        ("sizes", sizes::by_size),
        ("laws", laws::by_law),
        ("adaptive", laws::adaptive),
        ("memory", runs::memory),
        ("runs", runs::whole_runs),
    ]
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments = Arguments::read(std::env::args().skip(1))?;
    if let Some((case, count)) = &arguments.steps {
        let steps = counted::run(case, *count).unwrap_or_default();
        return Ok(writeln!(io::stdout(), "{steps}")?);
    }
    let sections = sections();
    for name in &arguments.sections {
        if sections.iter().all(|(known, _)| known != name) {
            let known: Vec<&str> = sections.iter().map(|(known, _)| *known).collect();
            return Err(format!("there is no section `{name}`, but {}", known.join(", ")).into());
        }
    }
    let machine = Machine::this();
    let mut report = Report::new(io::stdout());
    report.note(&machine.to_text())?;
    for (name, section) in sections {
        if arguments.has(name) {
            section(&mut report, arguments.budget)?;
        }
    }
    let measured = report.finish(machine.to_json())?;
    if let Some(path) = &arguments.json {
        std::fs::write(path, format!("{measured:#}\n"))?;
    }
    Ok(())
}
