//! The `muslin` command.
//!
//! It adapts the library to a shell: arguments, files, progress and exit codes. Exit codes: 0 done; 1 a run failed or
//! does not meet its `[expect]` table; 2 bad input.

mod args;
mod check;
mod compare;
mod error;
mod fabric;
mod fabric_import;
mod file_progress;
mod files;
mod fit;
mod folder;
mod frame_store;
mod lab;
mod memory;
mod new;
mod output;
mod plot;
mod progress;
mod report;
mod reproduce;
mod run;
mod scene_file;
mod summary;
mod timing;
mod verify;
mod view;

use std::io::{Write, stderr, stdout};
use std::process::ExitCode;

use args::{Arguments, Command, FabricCommand};
use error::CliError;

fn main() -> ExitCode {
    let arguments = Arguments::parse_or_exit();
    let result = match &arguments.command {
        Command::Run(arguments) => run::run(arguments),
        Command::Check(arguments) => check::check(arguments),
        Command::Verify(arguments) => verify::verify(arguments),
        Command::View { dir } => view::view(dir),
        Command::New { name } => new::new(name.as_deref()),
        Command::Schema => print_text(muslin::scene::JSON_SCHEMA),
        Command::Fabric(FabricCommand::List) => fabric::list(),
        Command::Fabric(FabricCommand::Show { name }) => fabric::show(name),
        Command::Fabric(FabricCommand::Import { file, name }) => fabric_import::import(file, name.as_deref()),
        Command::Fit(arguments) => fit::fit(arguments),
        Command::Lab(arguments) => lab::lab(arguments),
        Command::Compare(arguments) => compare::compare(arguments),
        Command::Reproduce(arguments) => reproduce::reproduce(arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            let _ = writeln!(stderr(), "{error}");
            error.exit_code()
        }
    }
}

/// Prints `text` as it is.
fn print_text(text: &str) -> Result<(), CliError> {
    let mut out = stdout().lock();
    CliError::print(out.write_all(text.as_bytes()).and_then(|()| out.flush()))
}
