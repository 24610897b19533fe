//! Series short enough to send and to draw.

/// Samples that a series keeps at most: more than any screen has columns to draw them in.
const SAMPLES: usize = 4096;

/// `times` and `columns` with at most [`SAMPLES`] samples each, values in single precision.
///
/// Longer columns are cut into equal buckets. Each bucket gives two samples, the smallest and the largest of its
/// values in the order in which they come, so that no peak is lost. A bucket without finite values stays a gap.
pub(super) fn thin_series<'a>(
    times: &[f64],
    columns: impl Iterator<Item = &'a [f64]>,
) -> (Vec<f64>, Vec<Vec<f32>>) {
    if times.len() <= SAMPLES {
        let columns = columns.map(|values| values.iter().map(|&value| value as f32).collect());
        return (times.to_vec(), columns.collect());
    }
    let buckets = SAMPLES / 2;
    let start = |bucket: usize| bucket * times.len() / buckets;
    // The first and the last bucket end in the first and the last time, so that the plot spans the run.
    let bucket_times = |bucket: usize| {
        let (first, next) = (start(bucket), start(bucket + 1));
        [times[first], times[if next == times.len() { next - 1 } else { first + (next - first) / 2 }]]
    };
    let thinned_times = (0..buckets).flat_map(bucket_times).collect();
    let thin_column = |values: &[f64]| {
        (0..buckets).flat_map(|bucket| extremes(&values[start(bucket)..start(bucket + 1)])).collect()
    };
    (thinned_times, columns.map(thin_column).collect())
}

/// The smallest and the largest finite value in the order in which they come; NaN if there is none.
fn extremes(values: &[f64]) -> [f32; 2] {
    let finite = || values.iter().enumerate().filter(|(_, value)| value.is_finite());
    let smallest = finite().min_by(|a, b| a.1.total_cmp(b.1));
    let largest = finite().max_by(|a, b| a.1.total_cmp(b.1));
    match (smallest, largest) {
        (Some(small), Some(large)) if small.0 <= large.0 => [*small.1 as f32, *large.1 as f32],
        (Some(small), Some(large)) => [*large.1 as f32, *small.1 as f32],
        _ => [f32::NAN; 2],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_series_stays_as_it_is() {
        let (times, columns) = thin_series(&[0.0, 0.5], [&[1.0, f64::NAN][..]].into_iter());
        assert_eq!(times, [0.0, 0.5]);
        assert_eq!(columns[0][0], 1.0);
        assert!(columns[0][1].is_nan());
    }

    #[test]
    fn a_long_series_keeps_its_ends_its_order_and_its_peaks() {
        let count = 100_003;
        let times: Vec<f64> = (0..count).map(|sample| f64::from(sample) * 0.25).collect();
        let mut values: Vec<f64> = times.iter().map(|time| (time * 0.01).sin()).collect();
        values[77_777] = 9.0;
        values[33_333] = -7.0;
        values[500..1500].fill(f64::INFINITY);
        let (thinned, columns) = thin_series(&times, [&values[..]].into_iter());
        assert_eq!(thinned.len(), SAMPLES);
        assert_eq!(columns[0].len(), SAMPLES);
        assert_eq!((thinned[0], thinned[SAMPLES - 1]), (times[0], times[times.len() - 1]));
        assert!(thinned.windows(2).all(|pair| pair[0] < pair[1]));
        assert!(columns[0].contains(&9.0) && columns[0].contains(&-7.0));
        assert!(columns[0].iter().any(|value| value.is_nan()), "the gap is lost");
    }
}
