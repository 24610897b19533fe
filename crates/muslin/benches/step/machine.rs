//! Which machine it is.

use std::process::Command;

use serde_json::{Value, json};

use super::instruction_set::InstructionSet;

/// What times depend on.
pub(crate) struct Machine {
    processor: String,
    cores: usize,
    compiler: String,
}

impl Machine {
    /// This one. What cannot be found out is `unknown`.
    pub(crate) fn this() -> Self {
        let unknown = || "unknown".to_owned();
        // Only Linux has this file.
        let information = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let processor = information
            .lines()
            .find_map(|line| line.strip_prefix("model name")?.split_once(':'))
            .map_or_else(unknown, |(_, name)| name.trim().to_owned());
        let compiler = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
        let compiler = Command::new(compiler).arg("--version").output().ok();
        let compiler = compiler
            .and_then(|output| String::from_utf8(output.stdout).ok())
            .map_or_else(unknown, |text| text.trim().to_owned());
        Self { processor, cores: cores(), compiler }
    }

    /// For the head of the table.
    pub(crate) fn to_text(&self) -> String {
        let Self { processor, cores, compiler } = self;
        let sets: Vec<&str> = InstructionSet::available().map(InstructionSet::name).collect();
        format!("{processor}, {cores} threads at once, {}\n{compiler}", sets.join(", "))
    }

    /// For programs.
    pub(crate) fn to_json(&self) -> Value {
        json!({
            "processor": self.processor,
            "cores": self.cores,
            "compiler": self.compiler,
            "instruction_sets": InstructionSet::available().map(InstructionSet::name).collect::<Vec<_>>(),
        })
    }
}

/// Threads that run at once.
pub(crate) fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZeroUsize::get)
}
