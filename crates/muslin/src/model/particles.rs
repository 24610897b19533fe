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
    stretches: Vec<Stretch>,
    /// Of all stretches, ascending.
    others: Vec<OtherParticle>,
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

/// Consecutive particles of which all but a few have the same constants.
#[derive(Clone, Debug, PartialEq)]
pub struct ParticleStretch<'a> {
    /// The particles.
    pub particles: Range<usize>,
    /// Mass m [kg] of all but the others.
    pub mass: f64,
    /// Linear drag k_d [kg/s] of all but the others.
    pub drag: f64,
    /// Whether all but the others are pinned.
    pub is_pinned: bool,
    /// The others in ascending order, [`MAX_OTHERS`](Self::MAX_OTHERS) at most.
    pub others: &'a [OtherParticle],
}

/// A particle whose constants are not those of its stretch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OtherParticle {
    /// Its index.
    pub particle: usize,
    /// Mass m [kg].
    pub mass: f64,
    /// Linear drag k_d [kg/s].
    pub drag: f64,
    /// Whether it is pinned.
    pub is_pinned: bool,
}

/// Particles that are alike but for `others`, whose places in the list of all of them these are.
#[derive(Clone, Debug, PartialEq)]
struct Stretch {
    alike: ParticleRun,
    others: Range<usize>,
}

impl ParticleStretch<'_> {
    /// Most others in one.
    pub const MAX_OTHERS: usize = 32;
}

impl ParticleRun {
    /// Whether its constants are those of `other`.
    fn is_like(&self, other: &Self) -> bool {
        self.mass == other.mass && self.drag == other.drag && self.is_pinned == other.is_pinned
    }

    /// Its particles as others of a stretch.
    fn others(&self) -> impl Iterator<Item = OtherParticle> + use<> {
        let Self { mass, drag, is_pinned, .. } = *self;
        self.particles.clone().map(move |particle| OtherParticle { particle, mass, drag, is_pinned })
    }
}

impl Particles {
    /// Shortest run that is no exception in another one.
    const LONG_RUN: usize = 8;

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

    /// The particles of `block` in ascending order, in stretches of mostly equal ones: longer than runs where edges of a
    /// cloth or pins lie between.
    pub fn stretches(&self, block: &Range<usize>) -> impl Iterator<Item = ParticleStretch<'_>> + '_ {
        let Range { start, end } = *block;
        let first = self.stretches.partition_point(|stretch| stretch.alike.particles.end <= start);
        let stretches = self.stretches[first..].iter();
        let stretches = stretches.take_while(move |stretch| stretch.alike.particles.start.max(start) < end);
        stretches.map(move |Stretch { alike, others }| {
            let ParticleRun { mass, drag, is_pinned, particles } = alike;
            let mut others = &self.others[others.clone()];
            // Most blocks have all of a stretch, or at least its beginning.
            if particles.start < start {
                others = &others[others.partition_point(|other| other.particle < start)..];
            }
            if end < particles.end {
                others = &others[..others.partition_point(|other| other.particle < end)];
            }
            let particles = particles.start.max(start)..particles.end.min(end);
            ParticleStretch { particles, mass: *mass, drag: *drag, is_pinned: *is_pinned, others }
        })
    }

    /// Finds the runs and stretches, once all particles and pins are there.
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
        self.find_stretches();
    }

    /// Finds the stretches, once the runs are there.
    fn find_stretches(&mut self) {
        self.stretches.clear();
        self.others.clear();
        for run in &self.runs {
            let (count, known) = (run.particles.len(), self.others.len());
            match self.stretches.last_mut() {
                Some(Stretch { alike, .. }) if run.is_like(alike) => alike.particles.end = run.particles.end,
                Some(Stretch { alike, others })
                    if count < Self::LONG_RUN
                        && others.len() + count <= ParticleStretch::MAX_OTHERS
                        && 3 * (others.len() + count) <= alike.particles.len() + count =>
                {
                    self.others.extend(run.others());
                    others.end = self.others.len();
                    alike.particles.end = run.particles.end;
                }
                // A few come before those that are like most.
                Some(Stretch { alike, others })
                    if alike.particles.len() < Self::LONG_RUN
                        && others.start == others.end
                        && 2 * alike.particles.len() <= count =>
                {
                    self.others.extend(alike.others());
                    others.end = self.others.len();
                    *alike = ParticleRun { particles: alike.particles.start..run.particles.end, ..*run };
                }
                _ => self.stretches.push(Stretch { alike: run.clone(), others: known..known }),
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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::scene::GridSettings;

    /// Runs of particles of a few kinds, most of them of one, with pins among them.
    fn random_particles() -> impl Strategy<Value = Particles> {
        let kinds = prop_oneof![4 => Just((1e-3, 0.0)), 1 => Just((2e-3, 0.0)), 1 => Just((1e-3, 0.5))];
        let run = (kinds, prop_oneof![1..4_usize, 1..100_usize], prop::bool::weighted(0.2));
        prop::collection::vec(run, 0..60).prop_map(|runs| {
            let mut particles = Particles::default();
            for ((mass, drag), count, is_pinned) in runs {
                let first = particles.len();
                particles.extend(count, mass, drag);
                (first..first + count).filter(|_| is_pinned).for_each(|particle| {
                    particles.pin(particle);
                });
            }
            particles.find_runs();
            particles
        })
    }

    proptest! {
        /// Of every particle they say what the arrays say, for any block.
        #[test]
        fn stretches_and_runs_are_what_the_arrays_are(
            particles in random_particles(),
            cuts in prop::collection::vec(any::<prop::sample::Index>(), 0..6),
        ) {
            let count = particles.len();
            let mut cuts: Vec<usize> = cuts.into_iter().map(|cut| cut.index(count + 1)).collect();
            cuts.extend([0, count]);
            cuts.sort_unstable();
            let constants =
                |index: usize| (particles.masses[index], particles.drags[index], particles.pinned[index]);
            for block in cuts.windows(2).map(|ends| ends[0]..ends[1]) {
                let mut next = block.start;
                for stretch in particles.stretches(&block) {
                    prop_assert!(stretch.particles.start == next && next < stretch.particles.end);
                    prop_assert!(stretch.others.len() <= ParticleStretch::MAX_OTHERS);
                    let mut others = stretch.others.iter().peekable();
                    for particle in stretch.particles.clone() {
                        let found = match others.next_if(|other| other.particle == particle) {
                            Some(other) => (other.mass, other.drag, other.is_pinned),
                            None => (stretch.mass, stretch.drag, stretch.is_pinned),
                        };
                        prop_assert_eq!(found, constants(particle), "particle {}", particle);
                    }
                    prop_assert!(others.next().is_none(), "others out of order or of another stretch");
                    next = stretch.particles.end;
                }
                prop_assert_eq!(next, block.end);
                let of_runs: Vec<_> = particles
                    .runs(&block)
                    .flat_map(|run| run.particles.clone().map(move |_| (run.mass, run.drag, run.is_pinned)))
                    .collect();
                prop_assert_eq!(of_runs, block.map(constants).collect::<Vec<_>>());
            }
            // Few enough that it costs little to treat them apart.
            let others: usize = particles.stretches(&(0..count)).map(|stretch| stretch.others.len()).sum();
            prop_assert!(3 * others <= count, "{others} others of {count}");
        }
    }

    /// Inner rows are one stretch, though their ends are lighter: its pieces have as many others as there is room for.
    #[test]
    fn a_sheet_has_few_stretches() {
        let grid = Grid::new(0, GridSettings { columns: 40, rows: 40, width: 1.0, height: 1.0 });
        let mut particles = Particles::default();
        particles.extend_by_area(&grid, 0.1, 0.0);
        particles.pin(grid.particle(20, 20));
        particles.find_runs();
        let all = 0..particles.len();
        let others: Vec<usize> = particles.stretches(&all).map(|stretch| stretch.others.len()).collect();
        // The first row with its corners, and the end below, which is like it; sixteen ends of two rows each with the inner rows
        // between, fifteen with the pin, six with a lone end and a corner; the last row with a corner.
        assert_eq!(others, [2, 32, 30 + 1, 12 + 2, 1], "of {} runs", particles.runs(&all).count());
    }
}
