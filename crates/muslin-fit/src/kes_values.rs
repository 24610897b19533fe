//! What KES reads of a tensile curve: EMT, LT and RT.

use muslin::scene::KesTensile;

use crate::estimate::{Estimate, Parameter};

/// The share of the work that a way back may lack at its end, below the line to zero, for RT to be that of the loop.
const LARGEST_OMISSION: f64 = 0.01;

/// EMT and LT, as KES has them.
pub(crate) fn summary(rows: &[[f64; 2]], top: usize, scatter: f64) -> Vec<Parameter> {
    let [extension, force] = rows[top];
    let (work, squares) = area(&rows[..=top]);
    let work_error = scatter * squares.sqrt();
    let linearity = KesTensile::linearity_of_work(work, extension, force);
    let linearity_error = linearity * libm::hypot(work_error / work, scatter / force);
    let freedom = top.max(1);
    vec![
        Parameter { symbol: "EMT", name: "largest strain", unit: "", estimate: Estimate::exact(extension) },
        Parameter {
            symbol: "LT",
            name: "linearity",
            unit: "",
            estimate: Estimate::linear(linearity, linearity_error, freedom),
        },
    ]
}

/// RT, the share of the work that the way back returns, as KES has it; or why there is none.
pub(crate) fn resilience(rows: &[[f64; 2]], top: usize, scatter: f64) -> Result<Estimate, String> {
    let back = &rows[top..];
    if back.len() < 3 {
        return Err("the data have no way back".to_owned());
    }
    let (work, squares) = area(&rows[..=top]);
    let work_error = scatter * squares.sqrt();
    let (returned, squares) = area(back);
    let [strain, tension] = rows[rows.len() - 1];
    if LARGEST_OMISSION * work < 0.5 * strain * tension {
        return Err(format!("the way back ends at {tension:.3} N/m, before all work is given back"));
    }
    let resilience = -returned / work;
    let error = resilience * libm::hypot(scatter * squares.sqrt() / returned, work_error / work);
    Ok(Estimate::linear(resilience, error.abs(), top.max(1)))
}

/// The area under `rows` by trapezes, and the sum of the squares of the weights that each value has in it.
pub(crate) fn area(rows: &[[f64; 2]]) -> (f64, f64) {
    let width = |row: usize| rows.get(row + 1).map_or(0.0, |next| next[0] - rows[row][0]);
    let weights = (0..rows.len()).map(|row| 0.5 * (width(row) + row.checked_sub(1).map_or(0.0, width)));
    let (mut sum, mut squares) = (0.0, 0.0);
    for (weight, row) in weights.zip(rows) {
        sum += weight * row[1];
        squares += weight * weight;
    }
    (sum, squares)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: trapezes over (0, 0), (1, 2), (3, 4) have the area 1 + 6 and the weights ½, 1½, 1.
    #[test]
    fn areas_are_those_of_trapezes() {
        let (sum, squares) = area(&[[0.0, 0.0], [1.0, 2.0], [3.0, 4.0]]);
        assert_eq!(sum, 7.0);
        assert_eq!(squares, 0.25 + 2.25 + 1.0);
    }

    /// A curve out along T = 1000 e and back along 800 e, less what stays: RT is the ratio of the areas.
    #[test]
    fn a_way_back_gives_the_resilience() {
        let mut rows: Vec<[f64; 2]> = (0..=20).map(|i| [f64::from(i) * 0.002, f64::from(i) * 2.0]).collect();
        rows.extend((0..20).rev().map(|i| [f64::from(i) * 0.002, f64::from(i) * 1.6]));
        // The trapeze at the turn has 40 on its outer side.
        let back = 0.8 * 0.5 * 0.038 * 38.0 + 0.5 * 0.002 * (40.0 + 0.8 * 38.0);
        let exact = back / (0.5 * 0.04 * 40.0);
        let found = resilience(&rows, 20, 0.0).expect("a way back");
        assert!((found.value - exact).abs() < 1e-12, "{found:?} {exact}");
    }

    /// A way back that stops at 40 % of the strain lacks 16 % of the work, and one of two points is none.
    #[test]
    fn a_way_back_that_stops_gives_no_resilience() {
        let way = |strain: i32| [0.01 * f64::from(strain), f64::from(strain)];
        let rows: Vec<[f64; 2]> = (0..=10).chain((4..10).rev()).map(way).collect();
        let why = resilience(&rows, 10, 0.0).expect_err("the end is missing");
        assert_eq!(why, "the way back ends at 4.000 N/m, before all work is given back");
        assert_eq!(resilience(&rows[..12], 10, 0.0).expect_err("one point"), "the data have no way back");
    }
}
