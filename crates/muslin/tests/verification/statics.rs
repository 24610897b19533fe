//! Equilibrium of a hanging cloth, reached by waiting.
//!
//! Of n particles of mass m under each other, with springs of stiffness k and rest length L, the first pinned, the
//! spring below particle j carries all below it:
//!
//! ```text
//! k (ℓ_j − L) = (n − 1 − j) m g        printed, divided by the rest length:  k (ℓ_j − L) ℓ_j / L = (n − 1 − j) m g
//! ```

use crate::common::{ClothNumbers, SceneNumbers, finish};

#[test]
fn hanging_columns_stretch_under_their_weight() {
    for rest_length_direction in [false, true] {
        let (mass, stiffness, rows) = (0.002, 60.0, 10);
        let cloth = ClothNumbers {
            columns: 3,
            rows,
            height_axis: [0.0, -1.0, 0.0],
            pins: vec![(0, 0), (1, 0), (2, 0)],
            mass,
            drag: 0.05,
            rest_length_direction,
            stiffnesses: [stiffness, 0.0, 0.0],
            ..ClothNumbers::default()
        };
        // Swings of 29 rad/s and faster fade with k_d / 2m = 12.5/s: to e^-50 after 4 s.
        let numbers = SceneNumbers {
            frame_intervals: 4,
            frame_rate: 1.0,
            steps_per_frame: 500,
            cloths: vec![cloth],
            ..SceneNumbers::default()
        };
        let mut simulation = numbers.simulation();
        finish(&mut simulation, &mut muslin::observe::StrainMonitor::default());
        let positions = &simulation.frame().state.positions;
        let length = 1.0 / (rows - 1) as f64;
        for column in 0..3 {
            let mut height = 1.0;
            for row in 1..rows {
                let stretch = (rows - row) as f64 * mass * 9.81 / stiffness / length;
                height -= if rest_length_direction {
                    length * (0.5 + (0.25 + stretch).sqrt())
                } else {
                    length * (1.0 + stretch)
                };
                let error = (positions.y[3 * row + column] - height).abs();
                // A drift of a rounding of the height per step is lost. It goes with a drag of k_d ε |y| / h = 6e-15 N,
                // which moves the end of the chain by up to 9 + 8 + … + 1 springs' extension under it, 4e-15 m.
                assert!(error < 2e-14, "{error:e} m in row {row}");
            }
        }
    }
}
