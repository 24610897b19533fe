//! The way that a test takes: out, back, and where it turns.

/// How far a path must come back to have turned, in parts of its range: less is scatter.
const TURN: f64 = 0.03;

/// The rows at which a path turns back.
pub(crate) fn turning_points(path: impl Iterator<Item = f64> + Clone) -> Vec<usize> {
    let (low, high) = path.clone().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
    let margin = TURN * (high - low);
    let mut turns = Vec::new();
    // The way is known once the path has left its first value.
    let mut way = 0.0;
    let mut farthest = (0, 0.0);
    for (row, x) in path.enumerate() {
        if row == 0 {
            farthest = (row, x);
        } else if way == 0.0 {
            if margin < (x - farthest.1).abs() {
                way = (x - farthest.1).signum();
                farthest = (row, x);
            }
        } else if 0.0 <= way * (x - farthest.1) {
            farthest = (row, x);
        } else if margin < way * (farthest.1 - x) {
            turns.push(farthest.0);
            way = -way;
            farthest = (row, x);
        }
    }
    turns
}

/// For each row of a path the way that it is on there, 1 for up and −1 for down, and the row where it last turned; none before
/// it first does.
pub(crate) fn ways(path: &[f64]) -> Vec<(f64, Option<usize>)> {
    let turns = turning_points(path.iter().copied());
    let first_end = turns.first().copied().unwrap_or(path.len().saturating_sub(1));
    let first_way = if path[0] <= path[first_end] { 1.0 } else { -1.0 };
    let way_after = |count: usize| if count.is_multiple_of(2) { first_way } else { -first_way };
    (0..path.len())
        .map(|row| {
            let count = turns.partition_point(|turn| *turn < row);
            (way_after(count), count.checked_sub(1).map(|last| turns[last]))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_loop_turns_where_it_is_farthest_and_scatter_does_not_turn_it() {
        let path = [0.0, 1.0, 0.99, 2.0, 3.0, 2.98, 2.0, 0.0, -3.0, -2.99, 0.0];
        assert_eq!(turning_points(path.into_iter()), [4, 8]);
        let ways = ways(&path);
        assert_eq!(ways[2], (1.0, None));
        assert_eq!(ways[4], (1.0, None));
        assert_eq!(ways[6], (-1.0, Some(4)));
        assert_eq!(ways[10], (1.0, Some(8)));
    }

    #[test]
    fn a_way_down_alone_goes_down() {
        let path = [0.0, -1.0, -2.0];
        assert!(turning_points(path.into_iter()).is_empty());
        assert_eq!(ways(&path), [(-1.0, None); 3]);
    }
}
