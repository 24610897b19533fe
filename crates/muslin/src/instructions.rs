//! Sets of vector instructions, chosen when the program runs.

#![allow(
    unsafe_code,
    reason = "a function compiled for instructions that not every processor has is unsafe to call"
)]

/// The instructions that loops over particles are compiled for.
///
/// The loops are written once, in plain arithmetic, and compiled once per set. Every set does the same operations on the
/// same numbers in the same order, and none fuses two of them into one, so that all give the same bits.
///
/// Invariant: the processor has them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InstructionSet(Level);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Level {
    Baseline,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

/// What is compiled apart for each set of instructions.
pub(crate) trait Vectorise {
    /// What it gives.
    type Output;

    /// Does it. Implementations are `#[inline(always)]`, and so is all that they call in a loop.
    fn run(self) -> Self::Output;
}

impl InstructionSet {
    /// What every processor has that the program was built for: SSE2 on x86-64.
    pub const BASELINE: Self = Self(Level::Baseline);

    /// The best that this processor has.
    #[must_use]
    pub fn best() -> Self {
        Self::available().last().unwrap_or(Self::BASELINE)
    }

    /// All that this processor has, the best last.
    pub fn available() -> impl Iterator<Item = Self> {
        let levels = [
            Some(Level::Baseline),
            #[cfg(target_arch = "x86_64")]
            is_x86_feature_detected!("avx2").then_some(Level::Avx2),
            #[cfg(target_arch = "x86_64")]
            (is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512vl")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512bw"))
            .then_some(Level::Avx512),
        ];
        levels.into_iter().flatten().map(Self)
    }

    /// Name of the set.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self.0 {
            Level::Baseline if cfg!(target_arch = "x86_64") => "SSE2",
            Level::Baseline => "baseline",
            #[cfg(target_arch = "x86_64")]
            Level::Avx2 => "AVX2",
            #[cfg(target_arch = "x86_64")]
            Level::Avx512 => "AVX-512",
        }
    }

    /// Runs what was compiled of `task` for these instructions.
    pub(crate) fn run<T: Vectorise>(self, task: T) -> T::Output {
        match self.0 {
            Level::Baseline => task.run(),
            // SAFETY: such a set exists only if the processor was found to have it.
            #[cfg(target_arch = "x86_64")]
            Level::Avx2 => unsafe { run_avx2(task) },
            #[cfg(target_arch = "x86_64")]
            Level::Avx512 => unsafe { run_avx512(task) },
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn run_avx2<T: Vectorise>(task: T) -> T::Output {
    task.run()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw")]
fn run_avx512<T: Vectorise>(task: T) -> T::Output {
    task.run()
}
