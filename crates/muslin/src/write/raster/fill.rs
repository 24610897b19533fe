//! Which samples of a raster a triangle covers.

use std::ops::Range;

/// How far outside a triangle, as a share of its barycentric coordinates, a sample still counts as inside.
///
/// Rounding then opens no cracks between neighbours; a sample on a shared edge may belong to both.
const TOLERANCE: f64 = 1e-9;

/// Calls `visit(x, y, weights)` for the samples of columns `0..width` and rows `rows` in a triangle.
///
/// Samples lie at whole numbers plus one half. `weights` are the barycentric coordinates [1] of the sample; they sum
/// to one. A triangle without area or with a non-finite corner covers nothing.
pub(super) fn fill_triangle(
    corners: [[f64; 2]; 3],
    width: usize,
    rows: Range<usize>,
    mut visit: impl FnMut(usize, usize, [f64; 3]),
) {
    let Some(plane) = Barycentric::new(corners) else { return };
    let [top, bottom] = bounds(corners.map(|corner| corner[1]));
    let first_row = sample_at_or_after(top).max(rows.start);
    let end_row = sample_at_or_after(bottom + 1.0).min(rows.end);
    let [left, right] = bounds(corners.map(|corner| corner[0]));
    for y in first_row..end_row {
        let sample_y = y as f64 + 0.5;
        let at_left = plane.weights([0.0, sample_y]);
        let [mut from, mut to] = [left - 0.01, right + 0.01];
        for (weight, slope) in at_left.into_iter().zip(plane.slopes_x) {
            if 0.0 < slope {
                from = from.max((-TOLERANCE - weight) / slope);
            } else if slope < 0.0 {
                to = to.min((-TOLERANCE - weight) / slope);
            } else if weight < -TOLERANCE {
                to = f64::NEG_INFINITY;
            }
        }
        // The whole part of what is positive; nothing where it is not.
        let end = ((to + 0.5) as usize).min(width);
        for x in sample_at_or_after(from)..end {
            let sample_x = x as f64 + 0.5;
            let weights = std::array::from_fn(|k| at_left[k] + plane.slopes_x[k] * sample_x);
            visit(x, y, weights);
        }
    }
}

/// The barycentric coordinates of a triangle in the plane, as linear functions of place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Barycentric {
    /// Change of each weight per unit along x.
    slopes_x: [f64; 3],
    /// Change of each weight per unit along y.
    slopes_y: [f64; 3],
    /// Corner 0, where the weights are 1, 0, 0.
    origin: [f64; 2],
}

impl Barycentric {
    /// The coordinates of the triangle of `corners`; `None` if it has no area or a non-finite corner.
    pub(super) fn new(corners: [[f64; 2]; 3]) -> Option<Self> {
        let [a, b, c] = corners;
        let twice_area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        let inverse = 1.0 / twice_area;
        if !inverse.is_finite() || inverse == 0.0 {
            return None;
        }
        let slopes_x = [(b[1] - c[1]) * inverse, (c[1] - a[1]) * inverse, (a[1] - b[1]) * inverse];
        let slopes_y = [(c[0] - b[0]) * inverse, (a[0] - c[0]) * inverse, (b[0] - a[0]) * inverse];
        Some(Self { slopes_x, slopes_y, origin: a })
    }

    /// The weights of the three corners at `place`.
    pub(super) fn weights(&self, place: [f64; 2]) -> [f64; 3] {
        let [dx, dy] = [place[0] - self.origin[0], place[1] - self.origin[1]];
        let weight = |k: usize| self.slopes_x[k] * dx + self.slopes_y[k] * dy;
        [1.0 + weight(0), weight(1), weight(2)]
    }
}

/// Index of the first sample whose place is at or after `place`, never below 0.
fn sample_at_or_after(place: f64) -> usize {
    // The cast takes the whole part and saturates, which is what a raster's border needs.
    let whole = (place - 0.5) as usize;
    if (whole as f64) < place - 0.5 { whole.saturating_add(1) } else { whole }
}

fn bounds(values: [f64; 3]) -> [f64; 2] {
    [values[0].min(values[1]).min(values[2]), values[0].max(values[1]).max(values[2])]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn covered(corners: [[f64; 2]; 3]) -> Vec<[usize; 2]> {
        let mut samples = Vec::new();
        fill_triangle(corners, 8, 0..8, |x, y, weights| {
            assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            let place: [f64; 2] =
                std::array::from_fn(|axis| (0..3).map(|k| weights[k] * corners[k][axis]).sum());
            assert!((place[0] - x as f64 - 0.5).abs() < 1e-12 && (place[1] - y as f64 - 0.5).abs() < 1e-12);
            samples.push([x, y]);
        });
        samples
    }

    #[test]
    fn a_triangle_covers_the_samples_inside() {
        assert_eq!(covered([[0.0, 0.0], [2.9, 0.0], [0.0, 2.9]]), [[0, 0], [1, 0], [0, 1]]);
        assert_eq!(covered([[0.0, 0.0], [0.0, 2.9], [2.9, 0.0]]), [[0, 0], [1, 0], [0, 1]]);
        assert_eq!(covered([[0.6, 0.6], [0.9, 0.6], [0.6, 0.9]]), [[0; 2]; 0]);
    }

    #[test]
    fn two_triangles_cover_a_rectangle_without_a_crack() {
        let [a, b, c, d] = [[-3.3, -1.7], [11.1, -1.7], [11.1, 9.3], [-3.3, 9.3]];
        let mut samples = covered([a, b, c]);
        samples.extend(covered([a, c, d]));
        samples.sort_unstable();
        samples.dedup();
        assert_eq!(samples.len(), 64);
    }

    #[test]
    fn degenerate_triangles_cover_nothing() {
        assert!(covered([[1.0, 1.0], [1.0, 1.0], [5.0, 5.0]]).is_empty());
        assert!(covered([[0.0, 0.0], [8.0, 8.0], [4.0, 4.0]]).is_empty());
        assert!(covered([[f64::NAN, 1.0], [1.0, 3.0], [5.0, 5.0]]).is_empty());
        assert!(covered([[f64::INFINITY, 1.0], [1.0, 3.0], [5.0, 5.0]]).is_empty());
    }
}
