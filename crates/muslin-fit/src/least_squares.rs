//! Least squares on a few bounded parameters, and what the data say about them.

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::{DMatrix, DVector, Dyn, Owned};

/// Half-width of the differences that stand for derivatives, in parameters of size one: the cube root of the rounding error.
const DIFFERENCE: f64 = 6e-6;

/// How near to a bound a parameter lies at it, in parts of the range.
const AT_BOUND: f64 = 1e-4;

/// A sum of squares to be made small. Parameters are logarithms, or of a size about one.
pub(crate) struct Problem<'p> {
    /// Where to start, within the bounds.
    pub(crate) start: Vec<f64>,
    /// Least and largest value of each parameter.
    pub(crate) bounds: Vec<[f64; 2]>,
    /// Residuals, all finite, for parameters within the bounds.
    pub(crate) residuals: &'p dyn Fn(&[f64]) -> Vec<f64>,
}

/// The parameters of the least sum, and how well they are known.
#[derive(Clone, Debug)]
pub(crate) struct Solution {
    pub(crate) parameters: Vec<f64>,
    pub(crate) residuals: Vec<f64>,
    /// Covariance of the parameters, from residuals of any size each.
    pub(crate) covariance: DMatrix<f64>,
    /// Points less parameters.
    pub(crate) freedom: usize,
    /// Ratio of the largest to the least singular value of the derivatives, each parameter's scaled to one.
    pub(crate) condition: f64,
    /// For each parameter whether it ended at its lower or upper bound.
    pub(crate) at_bound: Vec<[bool; 2]>,
}

impl Solution {
    pub(crate) fn squares(&self) -> f64 {
        self.residuals.iter().map(|residual| residual * residual).sum()
    }

    /// Correlations of the parameters; 0 with one that has no spread.
    pub(crate) fn correlations(&self) -> Vec<Vec<f64>> {
        let deviation = |i: usize| self.covariance[(i, i)].sqrt();
        let entry = |i: usize, j: usize| {
            let product = deviation(i) * deviation(j);
            if i == j {
                1.0
            } else if 0.0 < product {
                self.covariance[(i, j)] / product
            } else {
                0.0
            }
        };
        let count = self.parameters.len();
        (0..count).map(|i| (0..count).map(|j| entry(i, j)).collect()).collect()
    }
}

impl Problem<'_> {
    /// The least sum of squares, by the method of Levenberg and Marquardt as MINPACK has it.
    ///
    /// A bounded parameter p is q ↦ low + (high − low) / (1 + e^−q) of a free one. `None` if no minimum was found.
    pub(crate) fn solve(self) -> Option<Solution> {
        let free: Vec<f64> =
            self.start.iter().zip(&self.bounds).map(|(p, range)| to_free(*p, *range)).collect();
        let search = Search { problem: &self, free: DVector::from_vec(free) };
        let (search, report) = LevenbergMarquardt::new().with_patience(200).minimize(search);
        let ended = &report.termination;
        // At the accuracy of rounding there is nothing left to improve, which is as good as a minimum.
        let has_minimum = ended.was_successful()
            || matches!(ended, levenberg_marquardt::TerminationReason::NoImprovementPossible(_));
        has_minimum.then(|| self.solution(search.parameters()))
    }

    /// What holds at `parameters`.
    ///
    /// The covariance is that of MacKinnon and White (1985), HC3, which takes residuals to be independent but not of the same
    /// size: an instrument's scatter may be constant or in proportion to what it measures.
    ///
    /// ```text
    /// C = (JᵀJ)⁻¹ Jᵀ diag(r² / (1 − h)²) J (JᵀJ)⁻¹    h = diag(J (JᵀJ)⁻¹ Jᵀ)
    /// ```
    fn solution(&self, parameters: Vec<f64>) -> Solution {
        let residuals = (self.residuals)(&parameters);
        let jacobian = self.derivatives(&parameters);
        let scales: Vec<f64> = jacobian.column_iter().map(|column| column.norm()).collect();
        let mut scaled = jacobian;
        for (mut column, scale) in scaled.column_iter_mut().zip(&scales) {
            column /= scale.max(f64::MIN_POSITIVE);
        }
        let singular = scaled.singular_values();
        let condition = singular.max() / singular.min();
        let normal = scaled.tr_mul(&scaled);
        let count = parameters.len();
        let inverse = normal.pseudo_inverse(1e-14).unwrap_or_else(|_| DMatrix::zeros(count, count));
        let influence = &scaled * &inverse;
        let mut weighted = influence.clone();
        for (row, residual) in residuals.iter().enumerate() {
            let leverage: f64 = influence.row(row).dot(&scaled.row(row));
            // A point that the law is bound to go through says nothing about scatter.
            let rest = (1.0 - leverage).max(1e-6);
            weighted.row_mut(row).scale_mut(residual / rest);
        }
        let mut covariance = weighted.tr_mul(&weighted);
        for i in 0..count {
            for j in 0..count {
                covariance[(i, j)] /= (scales[i] * scales[j]).max(f64::MIN_POSITIVE);
            }
        }
        let at_bound = parameters.iter().zip(&self.bounds).map(|(p, [low, high])| {
            let margin = AT_BOUND * (high - low);
            [*p < low + margin, high - margin < *p]
        });
        Solution {
            at_bound: at_bound.collect(),
            freedom: residuals.len().saturating_sub(count),
            parameters,
            residuals,
            covariance,
            condition,
        }
    }

    /// Derivatives of the residuals by the parameters, by central differences within the bounds.
    fn derivatives(&self, parameters: &[f64]) -> DMatrix<f64> {
        let columns = (0..parameters.len()).map(|index| {
            let [low, high] = self.bounds[index];
            let [below, above] =
                [-DIFFERENCE, DIFFERENCE].map(|step| (parameters[index] + step).clamp(low, high));
            let at = |value: f64| {
                let mut moved = parameters.to_vec();
                moved[index] = value;
                DVector::from_vec((self.residuals)(&moved))
            };
            (at(above) - at(below)) / (above - below)
        });
        DMatrix::from_columns(&columns.collect::<Vec<_>>())
    }
}

/// The problem in free parameters, where the search is.
struct Search<'p> {
    problem: &'p Problem<'p>,
    free: DVector<f64>,
}

impl Search<'_> {
    fn parameters(&self) -> Vec<f64> {
        self.free.iter().zip(&self.problem.bounds).map(|(q, range)| to_bounded(*q, *range)).collect()
    }
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Search<'_> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn>;

    fn set_params(&mut self, free: &DVector<f64>) {
        self.free.copy_from(free);
    }

    fn params(&self) -> DVector<f64> {
        self.free.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        Some(DVector::from_vec((self.problem.residuals)(&self.parameters())))
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let parameters = self.parameters();
        let mut derivatives = self.problem.derivatives(&parameters);
        for (index, mut column) in derivatives.column_iter_mut().enumerate() {
            let [low, high] = self.problem.bounds[index];
            column *= (parameters[index] - low) * (high - parameters[index]) / (high - low);
        }
        Some(derivatives)
    }
}

fn to_bounded(free: f64, [low, high]: [f64; 2]) -> f64 {
    low + (high - low) / (1.0 + libm::exp(-free))
}

/// The free parameter of a bounded one, which is moved off its bounds: there it would be infinite.
fn to_free(bounded: f64, [low, high]: [f64; 2]) -> f64 {
    let part = ((bounded - low) / (high - low)).clamp(1e-3, 1.0 - 1e-3);
    libm::log(part / (1.0 - part))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(points: &[[f64; 2]], bounds: Vec<[f64; 2]>) -> Solution {
        let residuals = |p: &[f64]| points.iter().map(|[x, y]| p[0] + p[1] * x - y).collect();
        Problem { start: vec![0.5, 0.5], bounds, residuals: &residuals }.solve().expect("a minimum")
    }

    /// A straight line through 0, 1, 1, 2, 6 at 0 to 4: by hand the slope is 1.3 and the intercept −0.6; by HC3 in exact fractions
    /// the variance of the slope is Σ (x − x̄)² (r / (1 − h))² / (Σ (x − x̄)²)², with h = 1/5 + (x − x̄)²/10.
    #[test]
    fn a_line_has_the_values_of_the_textbook() {
        let points = [[0.0, 0.0], [1.0, 1.0], [2.0, 1.0], [3.0, 2.0], [4.0, 6.0]];
        let solution = line(&points, vec![[-10.0, 10.0]; 2]);
        assert!((solution.parameters[0] + 0.6).abs() < 1e-6, "{:?}", solution.parameters);
        assert!((solution.parameters[1] - 1.3).abs() < 1e-6);
        assert_eq!(solution.freedom, 3);
        let variance: f64 = points
            .iter()
            .map(|[x, y]| {
                let (off, residual) = (x - 2.0, y - (1.3 * x - 0.6));
                let rest = 1.0 - (0.2 + off * off / 10.0);
                off * off * (residual / rest) * (residual / rest) / 100.0
            })
            .sum();
        assert!((solution.covariance[(1, 1)] / variance - 1.0).abs() < 1e-5);
        assert!(solution.at_bound.iter().flatten().all(|at| !at));
    }

    #[test]
    fn a_parameter_that_wants_out_ends_at_its_bound() {
        let points = [[0.0, 0.0], [1.0, 3.0], [2.0, 6.0], [3.0, 9.0]];
        let solution = line(&points, vec![[-10.0, 10.0], [0.0, 1.0]]);
        assert_eq!(solution.at_bound[1], [false, true]);
    }

    /// Two parameters that do the same cannot be told apart, and the condition says so.
    #[test]
    fn parameters_that_do_the_same_have_no_condition() {
        let residuals = |p: &[f64]| (0..9).map(|i| (p[0] + p[1] - 1.0) * f64::from(i)).collect();
        let problem = Problem { start: vec![0.1, 0.2], bounds: vec![[-5.0, 5.0]; 2], residuals: &residuals };
        assert!(1e8 < problem.solve().expect("a minimum").condition);
    }
}
