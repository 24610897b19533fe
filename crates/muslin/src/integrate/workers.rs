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

    /// Calls `work` with every block and what belongs to it of each of `arrays`, in any order; whether all calls gave
    /// `true`.
    ///
    /// `blocks` must cover the arrays in ascending order without gaps.
    pub fn all_blocks<const N: usize>(
        &self,
        blocks: &[Range<usize>],
        arrays: [PointsMut<'_>; N],
        work: &(impl Fn(&Range<usize>, [PointsMut<'_>; N]) -> bool + Sync),
    ) -> bool {
        self.install(|| all_blocks(blocks, arrays, self.pool.is_some(), work))
    }
}

/// [`Workers::all_blocks`] on this thread, or in `parallel` on the pool that it belongs to.
fn all_blocks<const N: usize>(
    blocks: &[Range<usize>],
    arrays: [PointsMut<'_>; N],
    parallel: bool,
    work: &(impl Fn(&Range<usize>, [PointsMut<'_>; N]) -> bool + Sync),
) -> bool {
    match blocks {
        [] => true,
        [block] => work(block, arrays),
        _ => {
            let (first, second) = blocks.split_at(blocks.len() / 2);
            let count = first.iter().map(ExactSizeIterator::len).sum();
            let (first_arrays, second_arrays) = split_arrays(arrays, count);
            let do_first = || all_blocks(first, first_arrays, parallel, work);
            let do_second = || all_blocks(second, second_arrays, parallel, work);
            let (first, second) =
                if parallel { rayon::join(do_first, do_second) } else { (do_first(), do_second()) };
            first && second
        }
    }
}

/// The first `count` points of each array and the rest of each.
fn split_arrays<const N: usize>(
    arrays: [PointsMut<'_>; N],
    count: usize,
) -> ([PointsMut<'_>; N], [PointsMut<'_>; N]) {
    let mut rests = std::array::from_fn(|_| PointsMut::default());
    let mut rest = rests.iter_mut();
    let firsts = arrays.map(|array| {
        let (first, second) = array.split_at(count);
        if let Some(rest) = rest.next() {
            *rest = second;
        }
        first
    });
    (firsts, rests)
}
