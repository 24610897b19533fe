//! Whether a scene fits this machine.

use muslin::Scene;

use crate::error::CliError;

/// Memory per particle at the peak of a run [B]: about 220 without wind and 270 with it.
const BYTES_PER_PARTICLE: u64 = 300;

/// Refuses a scene that needs more memory than there is.
///
/// Systems that promise more memory than they have would else end this process or others in mid-run, without a word.
pub(crate) fn require_memory(scene: &Scene) -> Result<(), CliError> {
    match available_memory() {
        Some(available) => require(scene.particle_count(), available),
        None => Ok(()),
    }
}

/// Refuses `particles` that do not fit `available` memory [B].
fn require(particles: usize, available: u64) -> Result<(), CliError> {
    let needed = particles as u64 * BYTES_PER_PARTICLE;
    if needed <= available {
        return Ok(());
    }
    Err(CliError::input(
        format_args!(
            "the scene has {particles} particles, for which about {:.1} GB of memory are needed, more than are free",
            needed as f64 * 1e-9
        ),
        "lower `columns` and `rows` of the cloth's grid",
    ))
}

/// Memory that can be had without swapping [B]; only Linux says so in a file.
fn available_memory() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_fit_is_refused() {
        require(1_000_000, 300_000_000).expect("it fits");
        let error = require(1_600_000_000, 300_000_000).expect_err("too large");
        assert_eq!(
            error.to_string(),
            "error: the scene has 1600000000 particles, for which about 480.0 GB of memory are needed, more than are \
             free\n  help: lower `columns` and `rows` of the cloth's grid"
        );
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn linux_says_how_much_memory_there_is() {
        assert!(available_memory().is_some_and(|bytes| 1 << 20 < bytes));
    }
}
