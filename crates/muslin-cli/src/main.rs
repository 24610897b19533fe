//! The `muslin` command.
//!
//! It adapts the library to a shell: arguments, files, progress and exit codes. Exit codes: 0 done; 1 a run failed or
//! does not meet its `[expect]` table; 2 bad input.

mod args;
mod check;
mod error;
mod files;
mod frame_store;
mod memory;
mod new;
mod output;
mod progress;
mod report;
mod run;
mod scene_file;
mod summary;
mod timing;
mod verify;
mod view;

use std::io::{Write, stderr, stdout};
use std::process::ExitCode;

use args::{Arguments, Command};

fn main() -> ExitCode {
    let arguments = Arguments::parse_or_exit();
    let result = match &arguments.command {
        Command::Run(arguments) => run::run(arguments),
        Command::Check(arguments) => check::check(arguments),
        Command::Verify(arguments) => verify::verify(arguments),
        Command::View { dir } => view::view(dir),
        Command::New { name } => new::new(name.as_deref()),
        Command::Schema => {
            // A closed pipe is the reader's choice.
            let _ = stdout().write_all(muslin::scene::JSON_SCHEMA.as_bytes());
            Ok(())
        }
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            let _ = writeln!(stderr(), "{error}");
            error.exit_code()
        }
    }
}
