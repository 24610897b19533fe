//! Threads that share the blocks of a model.

use std::num::NonZeroUsize;
use std::ops::Range;
use std::sync::Arc;

use crate::PointsMut;

/// A fixed number of threads that work on a model's blocks.
///
/// What is computed for a block does not depend on other blocks, so the number of threads changes no bit of any result.
#[derive(Clone, Debug)]
pub struct Workers {
    pool: Option<Arc<rayon::ThreadPool>>,
}

impl Workers {
    /// `threads` threads; one means the caller's own.
    ///
    /// # Errors
    /// If the system refuses to start that many.
    pub fn new(threads: NonZeroUsize) -> Result<Self, rayon::ThreadPoolBuildError> {
        let pool = match threads.get() {
            1 => None,
            count => Some(Arc::new(rayon::ThreadPoolBuilder::new().num_threads(count).build()?)),
        };
        Ok(Self { pool })
    }

    /// The caller's thread alone.
    #[must_use]
    pub const fn single() -> Self {
        Self { pool: None }
    }

    /// Number of threads.
    #[must_use]
    pub fn count(&self) -> usize {
        self.pool.as_ref().map_or(1, |pool| pool.current_num_threads())
    }

    /// Runs `work` on one of the threads, so that the calls below need not change threads each time.
    pub fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        match &self.pool {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }

    /// Calls `work` with every block and what belongs to it of `arrays`, in any order, and combines its results by twos in
    /// an order that depends on the blocks alone; `None` without blocks.
    ///
    /// `blocks` must cover the arrays in ascending order without gaps.
    pub fn for_blocks<A: SplitArrays, R: Send>(
        &self,
        blocks: &[Range<usize>],
        arrays: A,
        work: &(impl Fn(&Range<usize>, A) -> R + Sync),
        combine: &(impl Fn(R, R) -> R + Sync),
    ) -> Option<R> {
        self.install(|| for_blocks(blocks, arrays, self.pool.is_some(), work, combine))
    }
}

/// Mutable arrays with one entry per particle, which are cut into blocks.
pub trait SplitArrays: Send + Sized {
    /// The first `count` entries of each array, and the rest.
    fn split_arrays(self, count: usize) -> (Self, Self);
}

impl SplitArrays for PointsMut<'_> {
    fn split_arrays(self, count: usize) -> (Self, Self) {
        self.split_at(count)
    }
}

impl SplitArrays for &mut [f64] {
    fn split_arrays(self, count: usize) -> (Self, Self) {
        self.split_at_mut(count)
    }
}

impl<A: SplitArrays, B: SplitArrays> SplitArrays for (A, B) {
    fn split_arrays(self, count: usize) -> (Self, Self) {
        let (first_a, rest_a) = self.0.split_arrays(count);
        let (first_b, rest_b) = self.1.split_arrays(count);
        ((first_a, first_b), (rest_a, rest_b))
    }
}

/// [`Workers::for_blocks`] on this thread, or in `parallel` on the pool that it belongs to.
fn for_blocks<A: SplitArrays, R: Send>(
    blocks: &[Range<usize>],
    arrays: A,
    parallel: bool,
    work: &(impl Fn(&Range<usize>, A) -> R + Sync),
    combine: &(impl Fn(R, R) -> R + Sync),
) -> Option<R> {
    match blocks {
        [] => None,
        [block] => Some(work(block, arrays)),
        _ => {
            let (first, second) = blocks.split_at(blocks.len() / 2);
            let count = first.iter().map(ExactSizeIterator::len).sum();
            let (first_arrays, second_arrays) = arrays.split_arrays(count);
            let do_first = || for_blocks(first, first_arrays, parallel, work, combine);
            let do_second = || for_blocks(second, second_arrays, parallel, work, combine);
            let results = if parallel { rayon::join(do_first, do_second) } else { (do_first(), do_second()) };
            match results {
                (Some(first), Some(second)) => Some(combine(first, second)),
                (first, second) => first.or(second),
            }
        }
    }
}
