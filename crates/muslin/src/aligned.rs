//! Arrays that begin where a line of the cache does.

use std::fmt;
use std::ops::{Deref, DerefMut};

/// Numbers in a line of the cache: 64 bytes, as long as the longest vectors.
const LINE: usize = 8;

/// Lines in a page of memory.
const LINES: usize = 64;

/// Numbers from which on it matters where in a page an array begins.
const LONG: usize = 2 * LINE * LINES;

/// Zeros that follow on the last number.
const ZEROS: usize = 272;

/// A fixed number of `f64` that begin where a line of the cache does, so that no vector of a row needs two.
///
/// Long arrays begin in different lines of their pages. Where all begin in the same line, as those of a system's allocator
/// do, the lines of arrays that are gone through together push each other out of the first-level cache, and a processor
/// takes a load from one for what it has just stored to another.
///
/// A slice otherwise, with its equality.
#[derive(Default)]
pub struct AlignedArray {
    /// With room before, and zeros behind.
    values: Vec<f64>,
    start: usize,
    len: usize,
}

impl AlignedArray {
    /// `len` zeros.
    #[must_use]
    pub fn zeros(len: usize) -> Self {
        if len == 0 {
            return Self::default();
        }
        let room = if len < LONG { LINE } else { LINE * LINES };
        let values = vec![0.0; room + len + ZEROS];
        // Neighbours in memory are at different pages; 27 lines apart, any three of them are far from each other.
        let page = values.as_ptr().addr() / (8 * LINE * LINES);
        let line = if len < LONG { 0 } else { 27 * page % (LINES - 1) };
        let start = values.as_ptr().align_offset(8 * LINE).min(LINE - 1) + LINE * line;
        Self { values, start, len }
    }

    /// Its numbers and [`ZEROS`] behind them, none if it is empty: loops that run past the end need no copy.
    #[inline(always)]
    pub(crate) fn with_zeros_behind(&self) -> &[f64] {
        // As many for every array of its length, wherever it begins.
        let end = self.start + self.len + ZEROS;
        &self.values[self.start..end.min(self.values.len())]
    }
}

impl Deref for AlignedArray {
    type Target = [f64];

    #[inline(always)]
    fn deref(&self) -> &[f64] {
        &self.values[self.start..self.start + self.len]
    }
}

impl DerefMut for AlignedArray {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [f64] {
        &mut self.values[self.start..self.start + self.len]
    }
}

impl From<&[f64]> for AlignedArray {
    fn from(values: &[f64]) -> Self {
        let mut array = Self::zeros(values.len());
        array.copy_from_slice(values);
        array
    }
}

impl FromIterator<f64> for AlignedArray {
    fn from_iter<I: IntoIterator<Item = f64>>(values: I) -> Self {
        Self::from(values.into_iter().collect::<Vec<f64>>().as_slice())
    }
}

impl<'a> IntoIterator for &'a AlignedArray {
    type Item = &'a f64;
    type IntoIter = std::slice::Iter<'a, f64>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl Clone for AlignedArray {
    fn clone(&self) -> Self {
        Self::from(&**self)
    }

    /// Keeps the memory of `self` if both are of the same length.
    fn clone_from(&mut self, source: &Self) {
        if self.len == source.len {
            self.copy_from_slice(source);
        } else {
            *self = source.clone();
        }
    }
}

impl PartialEq for AlignedArray {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

impl fmt::Debug for AlignedArray {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        (**self).fmt(formatter)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_begin_with_a_line_and_are_slices() {
        for len in [0, 1, 7, 8, 100, 1023, 1024, 5000] {
            let values: Vec<f64> = (0..len).map(|index| index as f64).collect();
            let array: AlignedArray = values.iter().copied().collect();
            assert_eq!(*array, *values);
            assert!(len == 0 || array.as_ptr().addr().is_multiple_of(64), "{len} numbers");
            let mut copy = AlignedArray::zeros(len);
            copy.clone_from(&array);
            assert_eq!(copy, array);
            assert_eq!(copy.clone(), array.iter().copied().collect());
        }
    }

    /// Arrays of the same length have as many zeros, wherever they begin.
    #[test]
    fn zeros_follow_on_the_last_number() {
        for len in [1, 100, 1023, 1024, 5000] {
            let arrays: Vec<AlignedArray> = (0..5).map(|_| std::iter::repeat_n(1.0, len).collect()).collect();
            for array in &arrays {
                let values = array.with_zeros_behind();
                assert_eq!(values.len(), len + ZEROS);
                let (own, zeros) = values.split_at(len);
                assert!(own.iter().all(|&value| value == 1.0) && zeros.iter().all(|&value| value == 0.0));
            }
        }
        assert!(AlignedArray::zeros(0).with_zeros_behind().is_empty());
    }

    #[test]
    fn long_arrays_begin_in_different_lines_of_their_pages() {
        let arrays: Vec<AlignedArray> = (0..3).map(|_| AlignedArray::zeros(1 << 16)).collect();
        let lines: Vec<usize> = arrays.iter().map(|array| array.as_ptr().addr() / 64 % LINES).collect();
        assert!(lines[0] != lines[1] && lines[1] != lines[2] && lines[0] != lines[2], "{lines:?}");
    }
}
