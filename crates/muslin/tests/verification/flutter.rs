//! A flag flutters in air, and does not in the paper's wind.

use muslin::{Model, State};

use crate::common::{AirNumbers, ClothNumbers, EachStep, SceneNumbers, WindNumbers, finish};

/// A flag of 0.6 m x 0.4 m and 0.124 kg/m² in eight seconds of no wind.
fn flag() -> SceneNumbers {
    SceneNumbers {
        frame_intervals: 400,
        frame_rate: 50.0,
        steps_per_frame: 100,
        cloths: vec![ClothNumbers {
            columns: 13,
            rows: 9,
            width: 0.6,
            height: 0.4,
            height_axis: [0.0, 1.0, 0.0],
            pins: (0..9).map(|row| (0, row)).collect(),
            mass: 3.1e-4,
            drag: 0.0,
            stiffnesses: [500.0, 40.0, 2.0],
            ..ClothNumbers::default()
        }],
        ..SceneNumbers::default()
    }
}

/// Largest less smallest place [m] across the wind of the middle of the free edge, over the last two seconds.
fn last_swing(numbers: &SceneNumbers) -> f64 {
    let (mut smallest, mut largest) = (f64::MAX, f64::MIN);
    let mut observer = EachStep(|model: &Model, state: &State| {
        if 6.0 <= state.time {
            let place = state.positions.z[model.cloths()[0].grid.particle(12, 4)];
            (smallest, largest) = (smallest.min(place), largest.max(place));
        }
    });
    finish(&mut numbers.simulation(), &mut observer);
    largest - smallest
}

/// A third of its length and more, to and fro, long after it has forgotten how it started.
#[test]
fn flag_in_air_flutters() {
    let air = AirNumbers::steady([3.0, 0.0, 0.3], [1.5, 0.05]);
    let swing = last_swing(&SceneNumbers { airs: vec![air], ..flag() });
    assert!(0.2 < swing && swing < 1.2, "{swing} m");
}

/// The paper's wind in the same direction, five times the weight of the flag, and a drag that takes its swing off in half a
/// second: it streams and comes to rest.
#[test]
fn flag_in_the_papers_wind_comes_to_rest() {
    let wind = WindNumbers {
        amplitude: 5.0 * 3.1e-4 * 9.81,
        phase: std::f64::consts::FRAC_PI_2,
        direction: [3.0, 0.0, 0.3],
        ..WindNumbers::default()
    };
    let mut numbers = SceneNumbers { winds: vec![wind], ..flag() };
    numbers.cloths[0].drag = 3.1e-4 * 4.0;
    let swing = last_swing(&numbers);
    assert!(swing < 1e-3, "{swing} m");
}
