//! A chain hung between two pins at the same height.
//!
//! With N links of rest length l = L / N, stiffness k = E A / l and masses m = w L / N g between them, the tension has
//! the same horizontal part H in all links and the vertical part V_j = (j − ½ (N + 1)) m g in link j = 1 … N:
//!
//! ```text
//! link j    (H, V_j) (l / f_j + 1 / k)    f_j = √(H² + V_j²)        Σ H (l / f_j + 1 / k) = D        (discrete)
//!
//! D = H L / EA + (2 H / w) asinh(w L / 2 H)    sag = V² / (2 EA w) + (√(H² + V²) − H) / w    V = ½ w L    (continuous)
//! ```
//!
//! The first is exact, the second its limit. Equal masses are right here: the halves at the ends lie on the pins.

use std::sync::LazyLock;

use glam::DVec3;

use crate::common::model_and_state;
use crate::common::setup::{GRAVITY, chain, extrapolated, forces, grid_points, root, settle, table};
use crate::report::{Problem, Row, order};

/// Distance of the pins [m].
const SPAN: f64 = 1.0;

/// Weight per length w [N/m].
const WEIGHT: f64 = 0.2;

/// Sag and horizontal tension as sag / D and H / w D.
type Shape = [f64; 2];

/// A hanging chain in numbers: links N, L / D and E A / w L.
#[derive(Clone, Copy)]
struct Chain {
    links: usize,
    length: f64,
    stiffness: f64,
}

impl Chain {
    /// The shape in which a motion with drag ends.
    ///
    /// The motion ends below accelerations of `rest` g, which leaves about `rest` D of the way.
    fn simulated(self, rest: f64) -> Shape {
        let Self { links, length, stiffness } = self;
        let mass = WEIGHT * length * SPAN / (links as f64 * GRAVITY);
        let spring = stiffness * WEIGHT * links as f64;
        let mut numbers = chain(links, length * SPAN, mass, spring);
        numbers.cloths[0].pins.push((0, links));
        // Near critical for the slowest swings, at about 2 √(g / D).
        numbers.cloths[0].drag = 4.0 * mass * (GRAVITY / SPAN).sqrt();
        let (model, mut state) = model_and_state(&numbers);
        // A polygon of two straight halves of about the right length.
        let depth = 0.5 * (length * length - 1.0).sqrt();
        state.positions = grid_points(1, links + 1, |_, j| {
            let share = j as f64 / links as f64;
            DVec3::new(share, -depth * (1.0 - (2.0 * share - 1.0).abs()), 0.0) * SPAN
        });
        settle(&model, &mut state, 0.5 * (mass / spring).sqrt(), rest * GRAVITY);
        let lowest = state.positions.y.iter().copied().fold(0.0, f64::min);
        let pull = forces(&model, &state.positions).x[0];
        [-lowest / SPAN, pull / (WEIGHT * SPAN)]
    }

    /// The exact shape of the discrete chain.
    fn discrete(self) -> Shape {
        let Self { links, length, stiffness } = self;
        let n = links as f64;
        let link = |horizontal: f64, j: usize| {
            let vertical = (j as f64 - 0.5 * (n + 1.0)) * length / n;
            let tension = (horizontal * horizontal + vertical * vertical).sqrt();
            let length = length / n * (1.0 / tension + 1.0 / (stiffness * length));
            [horizontal * length, vertical * length]
        };
        let span = |horizontal: f64| (1..=links).map(|j| link(horizontal, j)[0]).sum::<f64>();
        let horizontal = root(0.0, 100.0, |horizontal| span(horizontal) - 1.0);
        let sag = (1..=links / 2).map(|j| -link(horizontal, j)[1]).sum();
        [sag, horizontal]
    }

    /// The shape of the continuous elastic catenary.
    fn continuous(self) -> Shape {
        let Self { length, stiffness, .. } = self;
        let span = |h: f64| h / stiffness + 2.0 * h * libm::asinh(0.5 * length / h);
        let h = root(1e-6, 100.0, |h| span(h) - 1.0);
        let v = 0.5 * length;
        [v * v / (2.0 * stiffness * length) + (h * h + v * v).sqrt() - h, h]
    }
}

/// Ten times what is left of the way to rest.
const DISCRETE_TOLERANCE: f64 = 1e-10;

/// What is asked of 40 links. Their own error is (w l / H)² / 24 and the like, up to 6e-4 for the longest chain;
/// extrapolation to rigid links leaves (1 / 1000)³ / 8 = 1e-10 times a factor of up to 5000, for the shortest chain,
/// whose sag is the most sensitive to its length.
const TOLERANCE: f64 = 1e-3;

pub(crate) static PROBLEM: LazyLock<Problem> = LazyLock::new(|| {
    let mut rows = Vec::new();
    for length in [1.05, 1.2, 2.0] {
        let chains = [10, 20, 40].map(|links| Chain { links, length, stiffness: 10.0 });
        let (continuous, found) = (chains[0].continuous(), chains.map(|chain| chain.simulated(1e-11)));
        for (i, what) in ["sag / D", "H / wD"].into_iter().enumerate() {
            let label = format!("elastic, L / D = {length}, EA = 10 wL: {what}");
            let discrete = chains[0].discrete()[i];
            rows.push(Row::new(
                format!("{label}, N = 10, discrete"),
                discrete,
                found[0][i],
                DISCRETE_TOLERANCE,
            ));
            let order = order(found[1][i] - continuous[i], found[2][i] - continuous[i], 2.0);
            rows.push(
                Row::new(format!("{label}, N = 40"), continuous[i], found[2][i], TOLERANCE)
                    .with_order(order, 2.0, 0.05),
            );
        }
    }
    for exact in table(include_str!("reference/catenary.csv")) {
        let [coarse, fine] = [20, 40].map(|links| {
            let shapes = [1000.0, 2000.0, 4000.0]
                .map(|stiffness| Chain { links, length: exact[0], stiffness }.simulated(1e-7));
            [0, 1].map(|i| extrapolated(shapes.map(|shape| shape[i])))
        });
        for (i, what) in ["sag / D", "H / wD"].into_iter().enumerate() {
            let exact_value = exact[1 + i];
            let order = order(coarse[i] - exact_value, fine[i] - exact_value, 2.0);
            let label = format!("rigid links, L / D = {}: {what}, N = 40", exact[0]);
            rows.push(Row::new(label, exact_value, fine[i], TOLERANCE).with_order(order, 2.0, 0.05));
        }
    }
    Problem {
        title: "Catenary",
        text: "A chain of rest length L between two pins at the same height, a distance D apart: its sag, and the \
               horizontal pull H on a pin, after drag has brought it to rest. With w its weight per length, exact are \
               the closed form of the elastic catenary and, for N = 10, the equilibrium of the discrete chain; for \
               rigid links the common catenary, against the extrapolation from EA = 1000, 2000 and 4000 wL. Orders are \
               in the spacing, from 20 and 40 links.",
        rows,
    }
});

#[test]
fn chain_hangs_as_it_must() {
    PROBLEM.assert();
}
