//! The particles' constants.

use std::ops::Range;

use super::Grid;

/// Mass, drag and pins of all particles.
///
/// Invariants: the arrays have the same length; masses are positive and drags not negative.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Particles {
    masses: Vec<f64>,
    drags: Vec<f64>,
    pinned: Vec<bool>,
    runs: Vec<ParticleRun>,
}

/// Consecutive particles with the same constants.
#[derive(Clone, Debug, PartialEq)]
pub struct ParticleRun {
    /// The particles.
    pub particles: Range<usize>,
    /// Mass m [kg] of each.
    pub mass: f64,
    /// Linear drag k_d [kg/s] of each.
    pub drag: f64,
    /// Whether they are pinned.
    pub is_pinned: bool,
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

    /// The particles of `block` in ascending order, in runs of equal ones.
    pub fn runs(&self, block: &Range<usize>) -> impl Iterator<Item = ParticleRun> + '_ {
        let block = block.clone();
        let first = self.runs.partition_point(|run| run.particles.end <= block.start);
        let runs = self.runs[first..].iter().take_while(move |run| run.particles.start < block.end);
        runs.map(move |run| ParticleRun {
            particles: run.particles.start.max(block.start)..run.particles.end.min(block.end),
            ..*run
        })
    }

    /// Finds the runs, once all particles and pins are there.
    pub(crate) fn find_runs(&mut self) {
        self.runs.clear();
        for particle in 0..self.len() {
            let (mass, drag) = (self.masses[particle], self.drags[particle]);
            let is_pinned = self.pinned[particle];
            match self.runs.last_mut() {
                Some(run) if run.mass == mass && run.drag == drag && run.is_pinned == is_pinned => {
                    run.particles.end += 1;
                }
                _ => {
                    let particles = particle..particle + 1;
                    self.runs.push(ParticleRun { particles, mass, drag, is_pinned });
                }
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

    /// Appends the free particles of `grid`, with masses and drags of a sheet of `areal_density` [kg/m²] and `areal_drag`
    /// [kg/(s m²)]: of a cell's area each, of half of it along an edge and a quarter at a corner.
    pub(crate) fn extend_by_area(&mut self, grid: &Grid, areal_density: f64, areal_drag: f64) {
        let share = |index: usize, count: usize| if index == 0 || index + 1 == count { 0.5 } else { 1.0 };
        for row in 0..grid.rows {
            for column in 0..grid.columns {
                let width = share(column, grid.columns) * grid.column_spacing;
                let area = width * (share(row, grid.rows) * grid.row_spacing);
                self.extend(1, areal_density * area, areal_drag * area);
            }
        }
    }

    /// Pins `particle`; whether it was free.
    pub(crate) fn pin(&mut self, particle: usize) -> bool {
        !std::mem::replace(&mut self.pinned[particle], true)
    }
}
