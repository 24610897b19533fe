//! The `muslin` command from outside: its messages, files and exit codes.

mod bad_output;
mod bad_scene;
mod comparison;
mod data_files;
mod fitting;
mod interruptions;
mod lab;
mod other_commands;
mod reproduction;
mod runs;
mod unstable;
mod verification;
mod work;
