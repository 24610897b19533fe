//! Natural cubic splines: smooth curves and surfaces through the particles of a grid.

use glam::DVec3;

/// Points on the natural cubic spline through `knots`, `steps` per interval, the last knot included.
///
/// With second differences `m` at the knots, the curve on the interval from knot k to k + 1 is
///
/// ```text
/// x(t) = (1 − t) x_k + t x_{k+1} − t (1 − t) / 6 [(2 − t) m_k + (1 + t) m_{k+1}]
/// m_{k−1} + 4 m_k + m_{k+1} = 6 (x_{k−1} − 2 x_k + x_{k+1})        m_first = m_last = 0
/// ```
///
/// It passes through every knot and its second derivative is continuous, so that shading shows no facets.
///
/// # Panics
/// If there are no knots or `steps` is zero.
pub(super) fn refine_curve(knots: &[DVec3], steps: usize) -> Vec<DVec3> {
    assert!(!knots.is_empty() && 0 < steps, "a curve has knots and steps");
    let second = second_differences(knots);
    let mut curve = Vec::with_capacity((knots.len() - 1) * steps + 1);
    for k in 1..knots.len() {
        for step in 0..steps {
            let t = step as f64 / steps as f64;
            let chord = knots[k - 1] * (1.0 - t) + knots[k] * t;
            let bend = second[k - 1] * (2.0 - t) + second[k] * (1.0 + t);
            curve.push(chord - bend * (t * (1.0 - t) / 6.0));
        }
    }
    curve.push(knots[knots.len() - 1]);
    curve
}

/// Points on the tensor-product spline through a grid of `knots`, row by row with `columns` in a row.
///
/// Each cell is divided into `steps[0]` x `steps[1]`; the result has `(columns − 1) steps[0] + 1` points in a row.
pub(super) fn refine_grid(knots: &[DVec3], columns: usize, steps: [usize; 2]) -> Vec<DVec3> {
    let fine_columns = (columns - 1) * steps[0] + 1;
    let fine_rows = (knots.len() / columns - 1) * steps[1] + 1;
    let rows: Vec<DVec3> = knots.chunks(columns).flat_map(|row| refine_curve(row, steps[0])).collect();
    let mut grid = vec![DVec3::ZERO; fine_columns * fine_rows];
    for column in 0..fine_columns {
        let knots: Vec<DVec3> = rows.iter().skip(column).step_by(fine_columns).copied().collect();
        for (row, point) in refine_curve(&knots, steps[1]).into_iter().enumerate() {
            grid[row * fine_columns + column] = point;
        }
    }
    grid
}

/// The second differences `m` of [`refine_curve`], by elimination along the tridiagonal system.
fn second_differences(knots: &[DVec3]) -> Vec<DVec3> {
    let mut second = vec![DVec3::ZERO; knots.len()];
    let mut factors = vec![0.0; knots.len()];
    for k in 1..knots.len().saturating_sub(1) {
        let pivot = 4.0 - factors[k - 1];
        factors[k] = 1.0 / pivot;
        let right_side = (knots[k - 1] - knots[k] * 2.0 + knots[k + 1]) * 6.0;
        second[k] = (right_side - second[k - 1]) / pivot;
    }
    for k in (1..knots.len().saturating_sub(1)).rev() {
        let next = second[k + 1];
        second[k] -= next * factors[k];
    }
    second
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sine over a half period has no curvature at its ends, as a natural spline; the error of cubic spline
    /// interpolation is then at most 5/384 h⁴ max|x⁗|.
    #[test]
    fn spline_follows_a_sine_to_fourth_order() {
        for count in [8, 16, 32] {
            let step = std::f64::consts::PI / count as f64;
            let knots: Vec<DVec3> =
                (0..=count).map(|k| DVec3::new(k as f64, libm::sin(step * k as f64), 0.0)).collect();
            let bound = 5.0 / 384.0 * step * step * step * step;
            for point in refine_curve(&knots, 7) {
                let error = (point.y - libm::sin(step * point.x)).abs();
                assert!(error < 1.01 * bound, "{count} intervals at {}: {error:e} above {bound:e}", point.x);
            }
        }
    }

    #[test]
    fn spline_passes_through_its_knots() {
        let knots = [DVec3::ZERO, DVec3::new(1.0, 2.0, 0.0), DVec3::new(0.0, 5.0, -1.0), DVec3::X];
        let curve = refine_curve(&knots, 5);
        assert_eq!(curve.len(), 16);
        assert_eq!(curve.iter().step_by(5).copied().collect::<Vec<_>>(), knots);
        assert_eq!(refine_curve(&knots[..1], 3), [DVec3::ZERO]);
        assert_eq!(refine_curve(&[DVec3::ZERO, DVec3::X], 2)[1], DVec3::X * 0.5);
    }

    /// Splines reproduce linear functions, so that a bilinear grid refines to itself.
    #[test]
    fn grid_keeps_a_plane() {
        let knots: Vec<DVec3> = (0..12).map(|v| DVec3::new((v % 4) as f64, (v / 4) as f64, 0.0)).collect();
        let grid = refine_grid(&knots, 4, [2, 3]);
        assert_eq!(grid.len(), 7 * 7);
        for (index, point) in grid.iter().enumerate() {
            let exact = DVec3::new((index % 7) as f64 / 2.0, (index / 7) as f64 / 3.0, 0.0);
            assert!((*point - exact).length() < 1e-14, "{index}: {point} against {exact}");
        }
    }
}
