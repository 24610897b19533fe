//! The particles' constants.

use std::ops::Range;

/// Mass, drag and pins of all particles.
///
/// Invariants: the arrays have the same length; masses are positive and drags not negative.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Particles {
    masses: Vec<f64>,
    drags: Vec<f64>,
    pinned: Vec<bool>,
    free_runs: Vec<FreeRun>,
}

/// Consecutive particles that are free and have the same mass and drag.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeRun {
    /// The particles.
    pub particles: Range<usize>,
    /// Mass m [kg] of each.
    pub mass: f64,
    /// Linear drag k_d [kg/s] of each.
    pub drag: f64,
}

impl Particles {
    /// Number of particles.
    #[must_use]
    pub fn len(&self) -> usize {
        self.masses.len()
    }

    /// Whether there are no particles.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.masses.is_empty()
    }

    /// Masses m [kg], one per particle.
    #[must_use]
    pub fn masses(&self) -> &[f64] {
        &self.masses
    }

    /// Linear drags k_d [kg/s], one per particle.
    #[must_use]
    pub fn drags(&self) -> &[f64] {
        &self.drags
    }

    /// Whether a particle is held, or moved along a path, whatever acts on it; one per particle.
    #[must_use]
    pub fn pinned(&self) -> &[bool] {
        &self.pinned
    }

    /// The pinned particles, ascending.
    pub fn pins(&self) -> impl Iterator<Item = usize> + '_ {
        self.pinned.iter().enumerate().filter_map(|(particle, &pinned)| pinned.then_some(particle))
    }

    /// The free particles of `block`, in runs of equal ones.
    pub fn free_runs(&self, block: &Range<usize>) -> impl Iterator<Item = FreeRun> + '_ {
        let block = block.clone();
        let first = self.free_runs.partition_point(|run| run.particles.end <= block.start);
        let runs = self.free_runs[first..].iter().take_while(move |run| run.particles.start < block.end);
        runs.map(move |run| FreeRun {
            particles: run.particles.start.max(block.start)..run.particles.end.min(block.end),
            ..*run
        })
    }

    /// Finds the runs of equal free particles, once all particles and pins are there.
    pub(crate) fn find_runs(&mut self) {
        self.free_runs.clear();
        for particle in (0..self.len()).filter(|&particle| !self.pinned[particle]) {
            let (mass, drag) = (self.masses[particle], self.drags[particle]);
            match self.free_runs.last_mut() {
                Some(run) if run.particles.end == particle && run.mass == mass && run.drag == drag => {
                    run.particles.end += 1;
                }
                _ => self.free_runs.push(FreeRun { particles: particle..particle + 1, mass, drag }),
            }
        }
    }

    /// Appends `count` free particles of `mass` [kg] and `drag` [kg/s].
    pub(crate) fn extend(&mut self, count: usize, mass: f64, drag: f64) {
        let len = self.len() + count;
        self.masses.resize(len, mass);
        self.drags.resize(len, drag);
        self.pinned.resize(len, false);
    }

    /// Pins `particle`; whether it was free.
    pub(crate) fn pin(&mut self, particle: usize) -> bool {
        !std::mem::replace(&mut self.pinned[particle], true)
    }
}
