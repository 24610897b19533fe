//! Whether a scene fits this machine.

use muslin::Scene;

use crate::error::CliError;

/// Memory per particle at the peak of a run [B]: about 220 without wind and 270 with it.
const BYTES_PER_PARTICLE: u64 = 300;

/// Refuses a scene that needs more memory than there is.
///
/// Systems that promise more memory than they have would else end this process or others in mid-run, without a word.
pub(crate) fn require_memory(scene: &Scene) -> Result<(), CliError> {
    let particles: usize = scene.cloths().iter().map(|cloth| cloth.grid.columns * cloth.grid.rows).sum();
    let needed = particles as u64 * BYTES_PER_PARTICLE;
    match available_memory() {
        Some(available) if available < needed => Err(too_large(particles, needed)),
        _ => Ok(()),
    }
}

fn too_large(particles: usize, needed: u64) -> CliError {
    CliError::input(
        format_args!(
            "the scene has {particles} particles, for which about {:.1} GB of memory are needed, more than are free",
            needed as f64 * 1e-9
        ),
        "lower `columns` and `rows` of the cloth's grid",
    )
}

/// Memory that can be had without swapping [B]; only Linux says so in a file.
fn available_memory() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}
