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

impl Workers {
    /// Calls `work` with bands of consecutive blocks, one for each thread at most, with what belongs to a band of `arrays`, and
    /// with one of `helpers`; combines its results, or `None` without blocks.
    ///
    /// `combine` must not mind in what groups results come, as a maximum does not.
    ///
    /// # Panics
    /// If there are fewer `helpers` than threads.
    pub fn for_bands<A: SplitArrays, H: Send, R: Send>(
        &self,
        blocks: &[Range<usize>],
        arrays: A,
        helpers: &mut [H],
        work: &(impl Fn(&[Range<usize>], A, &mut H) -> R + Sync),
        combine: &(impl Fn(R, R) -> R + Sync),
    ) -> Option<R> {
        let helpers = &mut helpers[..self.count()];
        (!blocks.is_empty()).then(|| self.install(|| for_bands(blocks, arrays, helpers, work, combine)))
    }
}

/// [`Workers::for_bands`] on the pool that this thread belongs to, or alone with one helper.
fn for_bands<A: SplitArrays, H: Send, R: Send>(
    blocks: &[Range<usize>],
    arrays: A,
    helpers: &mut [H],
    work: &(impl Fn(&[Range<usize>], A, &mut H) -> R + Sync),
    combine: &(impl Fn(R, R) -> R + Sync),
) -> R {
    if helpers.len() <= 1 || blocks.len() <= 1 {
        return work(blocks, arrays, &mut helpers[0]);
    }
    let (first_helpers, second_helpers) = helpers.split_at_mut(helpers.len() / 2);
    let (start, end) = (blocks[0].start, blocks[blocks.len() - 1].end);
    let middle = start + (end - start) * first_helpers.len() / (first_helpers.len() + second_helpers.len());
    // The end of a block that is nearest to the middle.
    let after = blocks.partition_point(|block| block.start + block.len() / 2 < middle);
    let (first, second) = blocks.split_at(after.clamp(1, blocks.len() - 1));
    let (first_arrays, second_arrays) = arrays.split_arrays(second[0].start - start);
    let (first, second) = rayon::join(
        || for_bands(first, first_arrays, first_helpers, work, combine),
        || for_bands(second, second_arrays, second_helpers, work, combine),
    );
    combine(first, second)
}

/// Calls `work` with each of `blocks` and what belongs to it of `arrays`, in ascending order; combines its results, beginning
/// with the default.
pub(super) fn for_each_block<A: SplitArrays, R: Default>(
    blocks: &[Range<usize>],
    mut arrays: A,
    mut work: impl FnMut(&Range<usize>, A) -> R,
    combine: impl Fn(R, R) -> R,
) -> R {
    let mut result = R::default();
    for block in blocks {
        let (own, rest) = arrays.split_arrays(block.len());
        result = combine(result, work(block, own));
        arrays = rest;
    }
    result
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
