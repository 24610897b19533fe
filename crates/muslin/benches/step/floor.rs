//! The machine's floor: what a step's arithmetic takes if nothing else has to be done, and what its memory takes.
//!
//! The arithmetic is done on registers, in several chains that do not wait for each other, so that the processor's units and
//! nothing else bound it. No chain has anything to do with springs, but the numbers of operations are those of a step.

#![allow(
    unsafe_code,
    reason = "a function for certain processors can only be called where one has asked for them"
)]

use std::hint::black_box;
use std::time::Duration;

use super::clock::{Clock, Stopwatch};
use super::instruction_set::InstructionSet;

/// Operations of one particle in one step, or of one spring.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Operations {
    /// Additions and subtractions.
    pub(crate) additions: usize,
    pub(crate) multiplications: usize,
    pub(crate) divisions: usize,
    pub(crate) square_roots: usize,
    /// Reciprocal square roots in half the digits, to begin with: each a square root and a division of `f32`, and a conversion
    /// there and back.
    pub(crate) seeds: usize,
}

impl Operations {
    /// What both ways have in common for one linear spring.
    ///
    /// | | + − | × |
    /// |---|---|---|
    /// | vector between its ends | 3 | |
    /// | its square | 2 | 3 |
    /// | coefficient of force, k − k L / ℓ, without 1 / ℓ | 1 | 1 |
    /// | force, coordinate by coordinate | | 3 |
    /// | added to both ends, where the weight is the first term | 6 | |
    const SPRING: Self = Self { additions: 12, multiplications: 7, divisions: 0, square_roots: 0, seeds: 0 };

    /// Reciprocal length from a seed y of 1/√s by one step of third order: with the error e = 1 − s y², it is
    /// y + y e (½ + ⅜ e).
    const BY_SEED: Self = Self { additions: 3, multiplications: 5, divisions: 0, square_roots: 0, seeds: 1 };

    /// Length by a square root, and its reciprocal by a division.
    const BY_ROOT: Self = Self { additions: 0, multiplications: 0, divisions: 1, square_roots: 1, seeds: 0 };

    /// Motion of one particle: velocity from velocity and force, position from velocity, three coordinates each. The
    /// factors of velocity and force are the same for all particles of a cloth and do not count.
    ///
    /// | | + − | × |
    /// |---|---|---|
    /// | velocity | 3 | 6 |
    /// | position | 3 | 3 |
    const MOTION: Self = Self { additions: 6, multiplications: 9, divisions: 0, square_roots: 0, seeds: 0 };

    /// Springs per particle, each once: 2 structural, 2 shear, 2 bend. A grid's edges have fewer, but not many.
    const SPRINGS: usize = 6;

    /// A particle's step with the reciprocal square root by a seed and multiplications.
    pub(crate) const SEED: Self = Self::MOTION.plus(Self::SPRING.plus(Self::BY_SEED).times(Self::SPRINGS));

    /// A particle's step with the processor's square root and division.
    pub(crate) const ROOT: Self = Self::MOTION.plus(Self::SPRING.plus(Self::BY_ROOT).times(Self::SPRINGS));

    const fn plus(self, other: Self) -> Self {
        Self {
            additions: self.additions + other.additions,
            multiplications: self.multiplications + other.multiplications,
            divisions: self.divisions + other.divisions,
            square_roots: self.square_roots + other.square_roots,
            seeds: self.seeds + other.seeds,
        }
    }

    const fn times(self, count: usize) -> Self {
        Self {
            additions: count * self.additions,
            multiplications: count * self.multiplications,
            divisions: count * self.divisions,
            square_roots: count * self.square_roots,
            seeds: count * self.seeds,
        }
    }
}

/// Chains of reciprocals that run beside the others.
const RECIPROCALS: usize = 5;

/// What the chains settle at, and what they are added to and multiplied by, hidden from the compiler.
const HALF: f64 = 0.5;

/// Time [s] of a particle's operations of [`Operations::SEED`] or, not `by_seed`, of [`Operations::ROOT`]; `count` times
/// [`particles_at_once`].
pub(crate) fn run_operations(instructions: InstructionSet, by_seed: bool, count: u64) -> Duration {
    let start = Stopwatch::start(Clock::Thread);
    match (instructions, by_seed) {
        // SAFETY: whoever has a set of instructions has it from `InstructionSet::available`.
        #[cfg(target_arch = "x86_64")]
        (InstructionSet::Avx512, true) => unsafe { seeds_avx512(count) },
        // SAFETY: as above.
        #[cfg(target_arch = "x86_64")]
        (InstructionSet::Avx512, false) => unsafe { roots_avx512(count) },
        // SAFETY: as above.
        #[cfg(target_arch = "x86_64")]
        (InstructionSet::Avx2, true) => unsafe { seeds_avx2(count) },
        // SAFETY: as above.
        #[cfg(target_arch = "x86_64")]
        (InstructionSet::Avx2, false) => unsafe { roots_avx2(count) },
        (_, true) => by_seeds::<10, 2, 4>(count),
        (_, false) => by_roots::<10, 2>(count),
    }
    start.elapsed()
}

/// Particles whose operations are done in one repetition: chains times lanes.
pub(crate) fn particles_at_once(instructions: InstructionSet) -> usize {
    match instructions {
        InstructionSet::Baseline => 10 * 2,
        InstructionSet::Avx2 => 10 * 4,
        InstructionSet::Avx512 => 10 * 8,
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn seeds_avx2(count: u64) {
    by_seeds::<10, 4, 4>(count);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn roots_avx2(count: u64) {
    by_roots::<10, 4>(count);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw")]
fn seeds_avx512(count: u64) {
    by_seeds::<10, 8, 8>(count);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw")]
fn roots_avx512(count: u64) {
    by_roots::<10, 8>(count);
}

/// Operations of [`Operations::SEED`], in `C` chains of `L` lanes, and seeds of `W` lanes.
#[inline(always)]
fn by_seeds<const C: usize, const L: usize, const W: usize>(count: u64) {
    let constant = black_box(HALF);
    let mut chains = black_box([[HALF; L]; C]);
    let mut reciprocals = black_box([[1.0_f32; W]; RECIPROCALS]);
    // A seed's way from and to `f64` has an addition in it, else the compiler would see that it leads nowhere.
    let additions = Operations::SEED.additions - Operations::SEED.seeds;
    let pairs = additions.min(Operations::SEED.multiplications);
    for _ in 0..count {
        for _ in 0..Operations::SEED.seeds {
            for _ in 0..C * L / (W * RECIPROCALS) {
                for reciprocal in &mut reciprocals {
                    for lane in reciprocal {
                        *lane = 1.0 / ((f64::from(*lane) + constant) as f32).sqrt();
                    }
                }
            }
            multiply_and_add(&mut chains, constant, pairs / Operations::SEED.seeds);
        }
        multiply_and_add(&mut chains, constant, pairs % Operations::SEED.seeds);
        for _ in pairs..additions {
            add(&mut chains, constant);
        }
        for _ in pairs..Operations::SEED.multiplications {
            multiply(&mut chains, constant);
        }
    }
    black_box((chains, reciprocals));
}

/// Operations of [`Operations::ROOT`], in `C` chains of `L` lanes.
#[inline(always)]
fn by_roots<const C: usize, const L: usize>(count: u64) {
    let constant = black_box(HALF);
    let mut chains = black_box([[HALF; L]; C]);
    let mut reciprocals = black_box([[1.0_f64; L]; RECIPROCALS]);
    let (additions, multiplications) = (Operations::ROOT.additions, Operations::ROOT.multiplications);
    let pairs = additions.min(multiplications);
    for _ in 0..count {
        for _ in 0..Operations::ROOT.divisions {
            for _ in 0..C / RECIPROCALS {
                for reciprocal in &mut reciprocals {
                    for lane in reciprocal {
                        *lane = constant / lane.sqrt();
                    }
                }
            }
            multiply_and_add(&mut chains, constant, pairs / Operations::ROOT.divisions);
        }
        multiply_and_add(&mut chains, constant, pairs % Operations::ROOT.divisions);
        for _ in pairs..additions {
            add(&mut chains, constant);
        }
        for _ in pairs..multiplications {
            multiply(&mut chains, constant);
        }
    }
    black_box((chains, reciprocals));
}

#[inline(always)]
fn multiply_and_add<const C: usize, const L: usize>(chains: &mut [[f64; L]; C], constant: f64, count: usize) {
    for _ in 0..count {
        multiply(chains, constant);
        add(chains, constant);
    }
}

#[inline(always)]
fn multiply<const C: usize, const L: usize>(chains: &mut [[f64; L]; C], constant: f64) {
    chains.iter_mut().flatten().for_each(|lane| *lane *= constant);
}

#[inline(always)]
fn add<const C: usize, const L: usize>(chains: &mut [[f64; L]; C], constant: f64) {
    chains.iter_mut().flatten().for_each(|lane| *lane += constant);
}

/// Arrays of as many bytes as a step reads and writes.
///
/// A step has to read positions and velocities and to write them: 48 bytes each way. What is constant is the same for all
/// particles of a cloth but the pins, and forces need never leave the caches.
pub(crate) struct Bytes {
    arrays: [Vec<f64>; 6],
}

impl Bytes {
    /// For `particles`.
    pub(crate) fn new(particles: usize) -> Self {
        Self { arrays: std::array::from_fn(|_| vec![0.0; particles]) }
    }

    /// Reads and writes all of them `count` times.
    pub(crate) fn run(&mut self, count: u64) {
        for _ in 0..count {
            for array in &mut self.arrays {
                // In place, as a step does it; a copy elsewhere would have to fetch what it overwrites.
                array.iter_mut().for_each(|value| *value += 1.0);
                black_box(array.as_mut_slice());
            }
        }
    }
}
