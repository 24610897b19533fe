//! Cholesky's factors of a banded symmetric matrix.

use crate::points::dot_in_lanes;

/// A symmetric matrix A whose entries farther than a half bandwidth from the diagonal are zero; its lower half, row by row.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct BandedMatrix {
    order: usize,
    half_bandwidth: usize,
    /// Row i holds the entries of columns i − half bandwidth to i, those before the first column zero.
    entries: Vec<f64>,
}

/// The factor L of A = L Lᵀ, banded as A is.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct BandedFactor(BandedMatrix);

impl BandedMatrix {
    pub(super) fn zeros(order: usize, half_bandwidth: usize) -> Self {
        Self { order, half_bandwidth, entries: vec![0.0; order * (half_bandwidth + 1)] }
    }

    /// Makes the entry of `row` and `column` `value`, if it is one of the lower half of the band.
    pub(super) fn set_lower(&mut self, row: usize, column: usize, value: f64) {
        if column <= row && row <= column + self.half_bandwidth {
            let place = self.place(row, column);
            self.entries[place] = value;
        }
    }

    pub(super) fn largest_diagonal(&self) -> f64 {
        (0..self.order).map(|row| self.entries[self.place(row, row)]).fold(0.0, f64::max)
    }

    fn place(&self, row: usize, column: usize) -> usize {
        row * (self.half_bandwidth + 1) + (column + self.half_bandwidth - row)
    }

    /// Columns of `row` that are in the band, but for the diagonal.
    fn first_column(&self, row: usize) -> usize {
        row.saturating_sub(self.half_bandwidth)
    }

    /// Entries of `row` from `first` to before `end`.
    fn entries(&self, row: usize, first: usize, end: usize) -> &[f64] {
        let start = self.place(row, first);
        &self.entries[start..start + (end - first)]
    }

    /// The factor of A + `shift` 1, or `None` if that is not positive definite.
    pub(super) fn factor(&self, shift: f64) -> Option<BandedFactor> {
        let mut lower = self.clone();
        for row in 0..self.order {
            let first = self.first_column(row);
            for column in first..=row {
                // Both rows have entries from here on.
                let common = first.max(self.first_column(column));
                let known =
                    dot_in_lanes(lower.entries(row, common, column), lower.entries(column, common, column));
                let place = lower.place(row, column);
                let rest = lower.entries[place] - known;
                lower.entries[place] = if column < row {
                    rest / lower.entries[lower.place(column, column)]
                } else {
                    // Written so that NaN is none either.
                    let square = rest + shift;
                    if !(0.0 < square && square.is_finite()) {
                        return None;
                    }
                    square.sqrt()
                };
            }
        }
        Some(BandedFactor(lower))
    }
}

impl BandedFactor {
    /// Overwrites b, `values`, with the solution x of A x = b.
    pub(super) fn solve(&self, values: &mut [f64]) {
        let lower = &self.0;
        for row in 0..lower.order {
            let first = lower.first_column(row);
            let known = dot_in_lanes(lower.entries(row, first, row), &values[first..row]);
            values[row] = (values[row] - known) / lower.entries[lower.place(row, row)];
        }
        for row in (0..lower.order).rev() {
            let first = lower.first_column(row);
            let value = values[row] / lower.entries[lower.place(row, row)];
            values[row] = value;
            let (before, entries) = (&mut values[first..row], lower.entries(row, first, row));
            before.iter_mut().zip(entries).for_each(|(before, entry)| *before -= entry * value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Second differences of a held line, 2 on the diagonal and −1 beside it: a load of one at each place gives the parabola
    /// ½ i (n + 1 − i).
    #[test]
    fn a_loaded_line_is_a_parabola() {
        let order = 37;
        let mut matrix = BandedMatrix::zeros(order, 3);
        for row in 0..order {
            matrix.set_lower(row, row, 2.0);
            matrix.set_lower(row, row.saturating_sub(1), if row == 0 { 2.0 } else { -1.0 });
            matrix.set_lower(row, row + 1, 99.0);
        }
        assert_eq!(matrix.largest_diagonal(), 2.0);
        let mut values = vec![1.0; order];
        matrix.factor(0.0).expect("positive definite").solve(&mut values);
        for (place, value) in (1..).zip(values) {
            let exact = 0.5 * f64::from(place) * f64::from(order as u32 + 1 - place);
            assert!((value - exact).abs() < 1e-10, "{value} at {place} for {exact}");
        }
    }

    /// The least eigenvalue of the line with −2 added is −2 cos(π / (n + 1)), so that a shift above 2 makes it definite.
    #[test]
    fn what_is_not_definite_has_no_factor_but_with_a_shift() {
        let mut matrix = BandedMatrix::zeros(5, 1);
        for row in 1..5 {
            matrix.set_lower(row, row - 1, -1.0);
        }
        assert_eq!(matrix.factor(0.0), None);
        assert_eq!(matrix.factor(1.7), None, "2 cos 30° is 1.732");
        assert!(matrix.factor(1.8).is_some());
        assert_eq!(matrix.factor(f64::NAN), None);
    }
}
