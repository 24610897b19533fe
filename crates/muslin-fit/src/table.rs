//! Tables of tension from measured points, where no law fits.

use muslin::scene::TensionCurve;

/// The most points of a table: a curve has no more to say.
const MOST_POINTS: usize = 40;

/// The curve nearest to `rows` of strain and tension, of strains from zero up, whose tension never falls: means over groups of
/// neighbours, and then the means of those that would fall (the pooling of adjacent violators, Barlow and others 1972).
///
/// `None` where too little is left for a curve.
pub(crate) fn monotone_table(rows: &[[f64; 2]]) -> Option<TensionCurve> {
    let mut rows: Vec<[f64; 2]> = rows.iter().copied().filter(|row| 0.0 < row[0]).collect();
    rows.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let groups = rows.len().min(MOST_POINTS);
    let group = |index: usize| &rows[index * rows.len() / groups..(index + 1) * rows.len() / groups];
    let mut pools: Vec<Pool> = Vec::new();
    for rows in (0..groups).map(group) {
        let mut pool = Pool::of(rows);
        while let Some(last) =
            pools.pop_if(|last| pool.tension() <= last.tension() || pool.strain() <= last.strain())
        {
            pool = pool.and(last);
        }
        pools.push(pool);
    }
    let mut points: Vec<[f64; 2]> = pools.iter().map(|pool| [pool.strain(), pool.tension()]).collect();
    // Tension rises from rest: what scatters about zero says nothing of it.
    points.retain(|point| 0.0 < point[1]);
    points.dedup_by(|next, kept| next[0] - kept[0] < 1e-8);
    (2 <= points.len()).then(|| TensionCurve::per_width(&points).ok()).flatten()
}

/// The tension of `curve` at `strain`, straight from point to point and beyond the last.
pub(crate) fn interpolated(curve: &TensionCurve, strain: f64) -> f64 {
    let points = curve.points();
    let next = points.partition_point(|point| point[0] < strain).clamp(1, points.len() - 1);
    let [[x, y], [x_next, y_next]] = [points[next - 1], points[next]];
    y + (y_next - y) * (strain - x) / (x_next - x)
}

/// Sums over rows that become one point.
#[derive(Clone, Copy)]
struct Pool {
    count: f64,
    sums: [f64; 2],
}

impl Pool {
    fn of(rows: &[[f64; 2]]) -> Self {
        let sum = |index: usize| rows.iter().map(|row| row[index]).sum();
        Self { count: rows.len() as f64, sums: [sum(0), sum(1)] }
    }

    fn and(self, other: Self) -> Self {
        let sums = [self.sums[0] + other.sums[0], self.sums[1] + other.sums[1]];
        Self { count: self.count + other.count, sums }
    }

    fn strain(self) -> f64 {
        self.sums[0] / self.count
    }

    fn tension(self) -> f64 {
        self.sums[1] / self.count
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_that_fall_become_their_mean() {
        let curve = monotone_table(&[[0.0, 0.0], [0.01, 1.0], [0.02, 3.0], [0.03, 2.0], [0.04, 4.0]])
            .expect("a curve");
        let expected = [[0.0, 0.0], [0.01, 1.0], [0.025, 2.5], [0.04, 4.0]];
        assert_eq!(curve.points().len(), expected.len());
        for (found, expected) in curve.points().iter().zip(expected) {
            assert!((found[0] - expected[0]).abs() < 1e-15 && (found[1] - expected[1]).abs() < 1e-15);
        }
        assert!((interpolated(&curve, 0.005) - 0.5).abs() < 1e-12);
        assert!((interpolated(&curve, 0.05) - 5.0).abs() < 1e-12);
    }

    #[test]
    fn many_points_become_few_and_none_becomes_none() {
        let many: Vec<[f64; 2]> = (0..1000).map(f64::from).map(|i| [1e-4 * i, i]).collect();
        assert_eq!(monotone_table(&many).expect("a curve").points().len(), MOST_POINTS + 1);
        assert_eq!(monotone_table(&[[0.1, -1.0], [0.2, -2.0]]), None);
    }
}
