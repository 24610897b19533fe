//! Air on faces: closed forms of its force, what it may not depend on, and motion in it.
//!
//! ```text
//! F = ½ ρ A [C_N |u·n| (u·n) n + C_T |u| u_t]
//! ```

use glam::DVec3;
use muslin::force::{Configuration, Sweep};
use muslin::integrate::{CentralDifference, Integrator, Workers};
use muslin::observe::{Recorder, relative_residual};
use muslin::{Model, Points, State};

use crate::common::{
    AirNumbers, ClothNumbers, Random, SceneNumbers, WindNumbers, finish, for_each_step, larger, max_distance,
    model_and_state,
};

const DENSITY: f64 = 1.2;

/// Forces [N] of the air alone on all particles.
fn air_forces(model: &Model, time: f64, positions: &Points, velocities: &Points) -> Points {
    let at = Configuration { time, particles: model.particles(), positions, velocities, memory: &[] };
    let mut forces = Points::zeros(positions.len());
    let mut rest = forces.as_mut();
    for block in model.blocks() {
        let (mut own, others) = rest.split_at(block.len());
        for force in model.forces().iter().filter(|force| force.depends_on_velocity()) {
            force.add_forces(at, block, &mut own, &mut Sweep::default());
        }
        rest = others;
    }
    forces
}

/// Forces [N] of the air on the cloth of `numbers`, as it lies and at rest.
fn forces_at_rest(numbers: &SceneNumbers) -> Points {
    let (model, state) = model_and_state(numbers);
    air_forces(&model, 0.0, &state.positions, &state.velocities)
}

/// A sheet of 0.8 m x 0.5 m in the plane of x and y, in a steady wind.
fn plate(columns: usize, rows: usize, velocity: [f64; 3], coefficients: [f64; 2]) -> SceneNumbers {
    SceneNumbers {
        gravity: [0.0; 3],
        airs: vec![AirNumbers::steady(velocity, coefficients)],
        cloths: vec![ClothNumbers {
            columns,
            rows,
            width: 0.8,
            height: 0.5,
            height_axis: [0.0, 1.0, 0.0],
            pins: vec![],
            ..ClothNumbers::default()
        }],
        ..SceneNumbers::default()
    }
}

/// Sums of 20 particles are exact to some roundings.
const ROUNDING: f64 = 1e-14;

/// At an angle θ to the plate F_n = ½ ρ A C_N V² sin θ |sin θ| and F_t = ½ ρ A C_T V² cos θ. An inner particle has the
/// force of one cell of twelve, one on an edge half of that, one at a corner a quarter.
#[test]
fn plate_at_an_angle() {
    let (speed, normal, tangential) = (6.0, 1.7, 0.08);
    for degrees in [-90.0_f64, -35.0, 0.0, 5.0, 30.0, 45.0, 80.0, 90.0, 150.0] {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let wind = [speed * cosine, 0.0, speed * sine];
        let forces = forces_at_rest(&plate(5, 4, wind, [normal, tangential]));
        let pressure = 0.5 * DENSITY * 0.8 * 0.5 * speed * speed;
        let exact = DVec3::new(tangential * cosine, 0.0, normal * sine * sine.abs()) * pressure;
        let sum: DVec3 = forces.iter().sum();
        assert!((sum - exact).length() < ROUNDING * pressure, "{degrees} degrees: {sum} N for {exact} N");
        for (particle, cells) in [(0, 0.25), (2, 0.5), (5, 0.5), (6, 1.0), (12, 1.0), (19, 0.25)] {
            let error = (forces.get(particle) - exact * (cells / 12.0)).length();
            assert!(error < ROUNDING * pressure, "{degrees} degrees, particle {particle}");
        }
    }
}

/// Exactly nothing acts along a plate without friction, nor from air that moves with it.
#[test]
fn edge_on_without_friction_and_in_air_that_moves_along() {
    let edge_on = forces_at_rest(&plate(5, 4, [7.0, 2.0, 0.0], [1.5, 0.0]));
    assert_eq!(edge_on, Points::zeros(20));
    let (model, mut state) = model_and_state(&plate(5, 4, [1.0, -2.0, 3.0], [1.5, 0.1]));
    state.velocities = (0..20).map(|_| DVec3::new(1.0, -2.0, 3.0)).collect();
    assert_eq!(air_forces(&model, 0.0, &state.positions, &state.velocities), Points::zeros(20));
}

/// The paper's wind grows with the number of particles; this one does not.
#[test]
fn force_on_a_flat_sheet_is_that_of_its_area_at_any_resolution() {
    let wind = [3.0, 1.0, -4.0];
    let sum = |columns, rows| forces_at_rest(&plate(columns, rows, wind, [1.5, 0.05])).iter().sum::<DVec3>();
    let coarse = sum(10, 10);
    for fine in [sum(2, 2), sum(40, 40), sum(7, 300)] {
        // 2100 terms.
        assert!((fine - coarse).length() < 1e-12 * coarse.length(), "{fine} N for {coarse} N");
    }
}

/// Longer than the runs of cells that are worked on at a time, and than a block of particles.
#[test]
fn force_does_not_see_runs_and_blocks() {
    let forces = forces_at_rest(&plate(300, 40, [0.0, 0.0, 5.0], [1.5, 0.0]));
    let cell = 0.5 * DENSITY * 1.5 * 25.0 * 0.8 * 0.5 / (299.0 * 39.0);
    for (particle, force) in forces.iter().enumerate() {
        let (column, row) = (particle % 300, particle / 300);
        let half = |index: usize, count: usize| if index == 0 || index == count - 1 { 0.5 } else { 1.0 };
        let exact = cell * half(column, 300) * half(row, 40);
        assert!((force.z / exact - 1.0).abs() < 1e-12, "{column}, {row}: {force} N for {exact} N");
    }
}

/// A cloth of 7 x 5 in any shape and motion.
fn crumpled() -> (SceneNumbers, Model, State) {
    let mut numbers = plate(7, 5, [4.0, -1.0, 2.0], [1.5, 0.1]);
    numbers.cloths[0].pins = vec![(0, 0)];
    let (model, mut state) = model_and_state(&numbers);
    let mut random = Random::new(3);
    let offsets = random.points(35, 0.05);
    state.positions = state.positions.iter().zip(offsets.iter()).map(|(x, offset)| x + offset).collect();
    state.velocities = random.points(35, 3.0);
    (numbers, model, state)
}

/// Columns counted from the other end, as in a mirror, and rows for columns: no diagonal is preferred.
#[test]
fn mirrored_and_turned_grids_have_the_same_force() {
    let (numbers, model, state) = crumpled();
    let forces = air_forces(&model, 0.0, &state.positions, &state.velocities);
    let scale = forces.iter().map(DVec3::length).fold(0.0, f64::max);
    let mirror = |p: usize| p / 7 * 7 + 6 - p % 7;
    let mirrored = |points: &Points| (0..35).map(|p| points.get(mirror(p))).collect::<Points>();
    let found = air_forces(&model, 0.0, &mirrored(&state.positions), &mirrored(&state.velocities));
    let error = max_distance(&found, &mirrored(&forces));
    assert!(error < 1e-14 * scale, "{error:e} N");

    let mut turned = numbers;
    (turned.cloths[0].columns, turned.cloths[0].rows) = (5, 7);
    let (turned, _) = model_and_state(&turned);
    let transposed = |points: &Points| (0..35).map(|p| points.get(p % 5 * 7 + p / 5)).collect::<Points>();
    let found = air_forces(&turned, 0.0, &transposed(&state.positions), &transposed(&state.velocities));
    let error = max_distance(&found, &transposed(&forces));
    assert!(error < 1e-14 * scale, "{error:e} N");
}

/// Cells without extent, folded onto themselves or pressed to a point, feel nothing; a single row or column has no cells.
#[test]
fn degenerate_cells_feel_nothing() {
    let (model, mut state) = model_and_state(&plate(3, 3, [1.0, 2.0, 3.0], [1.5, 0.1]));
    for map in [|_: DVec3| DVec3::ONE, |x: DVec3| DVec3::new(x.x, 0.0, 0.0), |x: DVec3| x * 1e-200] {
        let positions = state.positions.iter().map(map).collect();
        let forces = air_forces(&model, 0.0, &positions, &state.velocities);
        assert_eq!(forces, Points::zeros(9));
    }
    // Each cell folded along its diagonal: corners (0, 1) and (1, 0) of each on one place.
    state.positions = (0..9).map(|p| DVec3::new((p % 3 + p / 3) as f64, 0.0, 0.0)).collect();
    assert_eq!(air_forces(&model, 0.0, &state.positions, &state.velocities), Points::zeros(9));
    for (columns, rows) in [(1, 9), (9, 1), (1, 1)] {
        let numbers = plate(columns, rows, [1.0, 2.0, 3.0], [1.5, 0.1]);
        assert_eq!(forces_at_rest(&numbers), Points::zeros(columns * rows));
        let [warning] = &numbers.scene().warnings()[..] else { panic!("one warning") };
        assert!(warning.contains("cloth `cloth0` has one row or column"), "{warning}");
    }
}

/// Wind on a cloth at rest is still air on a cloth that moves against it: over 200 steps, but for roundings of 4e-16 m/s
/// and their growth.
#[test]
fn only_relative_velocity_matters() {
    let wind = DVec3::new(4.0, -1.0, 2.0);
    let (mut numbers, _, mut at_rest) = crumpled();
    numbers.cloths[0].pins.clear();
    // The paper's drag is that of air at rest.
    numbers.cloths[0].drag = 0.0;
    let (windy, _) = model_and_state(&numbers);
    numbers.airs[0].velocity = [0.0; 3];
    let (still, _) = model_and_state(&numbers);
    let mut moving = at_rest.clone();
    moving.velocities = at_rest.velocities.iter().map(|v| v - wind).collect();
    let (mut first, mut second) =
        (CentralDifference::new(Workers::single()), CentralDifference::new(Workers::single()));
    let step = numbers.step();
    for _ in 0..200 {
        first.step(&windy, &mut at_rest, step).unwrap_or_else(|error| panic!("{error}"));
        second.step(&still, &mut moving, step).unwrap_or_else(|error| panic!("{error}"));
    }
    let offset = wind * at_rest.time;
    let found = moving.positions.iter().map(|x| x + offset).collect();
    let error = max_distance(&found, &at_rest.positions);
    assert!(error < 1e-11, "{error:e} m");
}

/// A horizontal sheet of four particles that falls in still air, 0.25 m² of 1.2 · 1.2 kg/m³: ½ ρ C_N A v² = 4 m g at 2 m/s.
fn falling(frame_rate: f64, steps_per_frame: u32, seconds: f64) -> SceneNumbers {
    SceneNumbers {
        frame_intervals: (seconds * frame_rate) as u32,
        frame_rate,
        steps_per_frame,
        gravity: [0.0, -10.0, 0.0],
        airs: vec![AirNumbers::steady([0.0; 3], [1.2, 0.0])],
        cloths: vec![ClothNumbers {
            columns: 2,
            rows: 2,
            width: 0.5,
            height: 0.5,
            origin: [0.0; 3],
            pins: vec![],
            mass: 0.018,
            drag: 0.0,
            ..ClothNumbers::default()
        }],
        ..SceneNumbers::default()
    }
}

/// Values of v = v_t tanh(g t / v_t) and of the drop v_t² / g ln cosh(g t / v_t), from the table of these closed forms that
/// was computed apart from the library, with g = 10 m/s² and v_t = 2 m/s: g t / v_t, v / v_t and drop · g / v_t².
const QUADRATIC_DRAG: [(f64, f64, f64); 8] = [
    (0.1, 0.099_667_994_625, 0.004_991_688_821_65),
    (0.25, 0.244_918_662_404, 0.030_929_803_620_2),
    (0.5, 0.462_117_157_26, 0.120_114_506_958),
    (1.0, 0.761_594_155_956, 0.433_780_830_483),
    (1.5, 0.905_148_253_645, 0.855_440_171_014),
    (2.0, 0.964_027_580_076, 1.325_002_747_36),
    (3.0, 0.995_054_753_687, 2.309_328_504_58),
    (5.0, 0.999_909_204_263, 4.306_898_218_34),
];

/// The errors of drop [m] and speed [m/s] at the times of the table, all frames of 0.01 s.
fn fall_errors(steps_per_frame: u32) -> Vec<[f64; 2]> {
    let mut simulation = falling(100.0, steps_per_frame, 1.0).simulation();
    let mut errors = Vec::new();
    for (time, speed, drop) in QUADRATIC_DRAG {
        while simulation.frame().state.time < 0.2 * time - 1e-9 {
            simulation.advance(&mut []).unwrap_or_else(|error| panic!("{error}"));
        }
        let frame = simulation.frame();
        errors.push([-frame.state.positions.y[0] - 0.4 * drop, -frame.velocities.y[0] - 2.0 * speed]);
    }
    errors
}

#[test]
fn falling_sheet_follows_quadratic_drag_at_second_order() {
    let runs = [4, 8, 16, 32].map(fall_errors);
    for quantity in [0, 1] {
        let largest =
            runs.each_ref().map(|run| run.iter().map(|errors| errors[quantity].abs()).fold(0.0, larger));
        let orders: Vec<f64> = largest.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect();
        assert!(orders.iter().all(|order| (order - 2.0).abs() < 0.05), "{orders:?} of {largest:?}");
        // Without the term in h² what is left is of the order of h⁴, and of the digits of the table.
        for (coarse, fine) in runs[2].iter().zip(&runs[3]) {
            let rest = (4.0 * fine[quantity] - coarse[quantity]) / 3.0;
            assert!(rest.abs() < 1e-9, "{rest:e} of {largest:?}");
        }
    }
}

/// Steps of any sizes in any order, here 3 : 1, keep the order of two.
#[test]
fn alternating_steps_in_air_are_of_second_order() {
    let errors = [100_u32, 200, 400, 800].map(|count| {
        let (model, mut state) = model_and_state(&falling(50.0, 1, 1.0));
        let mut method = CentralDifference::new(Workers::single());
        let mut error = 0.0_f64;
        for k in 0..count {
            let step = if k % 2 == 0 { 1.5 } else { 0.5 } / f64::from(count);
            method.step(&model, &mut state, step).unwrap_or_else(|error| panic!("{error}"));
            let exact = -0.4 * (5.0 * state.time).cosh().ln();
            error = larger(error, (state.positions.y[0] - exact).abs());
        }
        error
    });
    let orders: Vec<f64> = errors.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect();
    assert!(orders.iter().all(|order| (order - 2.0).abs() < 0.1), "{orders:?} of {errors:?}");
}

/// At 2 m/s air and gravity balance whatever the step: after 4 s, 40 times v_t / 2g, nothing but rounding is left.
#[test]
fn falling_sheet_reaches_its_terminal_speed_with_any_step() {
    for steps_per_frame in [1, 3, 10] {
        let mut simulation = falling(50.0, steps_per_frame, 4.0).simulation();
        finish(&mut simulation, &mut Recorder::default());
        for speed in &simulation.frame().velocities.y {
            assert!((speed + 2.0).abs() < 1e-13, "{speed} m/s");
        }
    }
}

/// Bounds on damping [kg/s] of all particles.
fn damping_bounds(model: &Model, state: &State) -> Vec<f64> {
    let at = Configuration {
        time: 0.0,
        particles: model.particles(),
        positions: &state.positions,
        velocities: &state.velocities,
        memory: &[],
    };
    let mut bounds = vec![0.0; state.positions.len()];
    for block in model.blocks() {
        model
            .forces()
            .iter()
            .for_each(|force| force.add_damping_bounds(at, block, &mut bounds[block.clone()]));
    }
    bounds
}

/// No change of velocities of up to δ each changes a force by more than δ times its bound, which rises by at most
/// ρ A (C_N + C_T) δ along the way.
#[test]
fn damping_bounds_are_bounds() {
    let (_, model, state) = crumpled();
    let bounds = damping_bounds(&model, &state);
    let (delta, mut random) = (1e-6, Random::new(5));
    let mut closest = 0.0_f64;
    for _ in 0..300 {
        let change: Points =
            random.points(35, 1.0).iter().map(|u| u.normalize_or(DVec3::X) * delta).collect();
        let moved = |sign: f64| {
            let velocities =
                state.velocities.iter().zip(change.iter()).map(|(v, dv)| v + dv * sign).collect();
            air_forces(&model, 0.0, &state.positions, &velocities)
        };
        let (behind, ahead) = (moved(-1.0), moved(1.0));
        for ((behind, ahead), bound) in behind.iter().zip(ahead.iter()).zip(&bounds) {
            let slope = (ahead - behind).length() / (2.0 * delta);
            assert!(slope < bound * (1.0 + 1e-5), "{slope} kg/s, but the bound is {bound} kg/s");
            closest = closest.max(slope / bound);
        }
    }
    assert!(0.5 < closest, "the bounds are {closest} of what they could be");
    // A plate in a wind that moves along its normal reaches it.
    let (model, state) = model_and_state(&plate(5, 4, [0.0, 0.0, 6.0], [1.5, 0.0]));
    let bound = damping_bounds(&model, &state)[6];
    let exact = DENSITY * 1.5 * 6.0 * (0.8 * 0.5 / 12.0);
    assert!((bound / exact - 1.0).abs() < 1e-14, "{bound} kg/s for {exact} kg/s");
}

/// Close to the terminal speed a deviation changes by 1 − z + z² / 2 a step, with z = h · bound / m: it fades as long as
/// z < 2. Here ρ C_N A v / 4 = 0.18 kg/s.
#[test]
fn a_step_is_stable_up_to_twice_the_mass_by_the_damping() {
    // Springs would be unstable with such steps.
    let mut numbers = falling(50.0, 1, 1.0);
    numbers.cloths[0].stiffnesses = [0.0; 3];
    for (z, factor) in [(0.5, 0.625_f64), (1.9, 0.905), (2.1, 1.105)] {
        let (model, mut state) = model_and_state(&numbers);
        state.velocities.y.fill(-2.0);
        let bound = damping_bounds(&model, &state)[0];
        assert!((bound - 0.18).abs() < 1e-12, "{bound} kg/s");
        let step = z * 0.018 / bound;
        state.velocities.y.fill(-2.0 - 1e-9);
        state.last_step = step;
        let mut method = CentralDifference::new(Workers::single());
        for _ in 0..10 {
            method.step(&model, &mut state, step).unwrap_or_else(|error| panic!("{error}"));
        }
        let found = (state.velocities.y[0] + 2.0) / -1e-9;
        // Roundings of 4e-16 in 1e-9, ten times.
        assert!((found / factor.powi(10) - 1.0).abs() < 1e-4, "z = {z}: {found}");
    }
}

/// Held along an edge in a wind with a sine and noise, whose straight parts of 10 ms begin and end with steps.
fn flag(steps_per_frame: u32) -> SceneNumbers {
    let gust = WindNumbers {
        amplitude: 1.0,
        angular_frequency: 8.0,
        phase: 0.5,
        direction: [0.3, 0.1, 1.0],
        noise: [0.5, 0.32],
    };
    SceneNumbers {
        frame_intervals: 10,
        frame_rate: 20.0,
        steps_per_frame,
        airs: vec![
            AirNumbers { gust, ..AirNumbers::steady([3.0, 0.0, 1.0], [1.5, 0.05]) },
            AirNumbers::steady([0.0, 0.5, 0.0], [1.5, 0.05]),
        ],
        cloths: vec![ClothNumbers {
            columns: 6,
            rows: 5,
            width: 0.5,
            height: 0.4,
            pins: (0..5).map(|row| (0, row)).collect(),
            ..ClothNumbers::default()
        }],
        ..SceneNumbers::default()
    }
}

/// Differences of runs with h, h/2, h/4, … fall like errors (Richardson): forces that depend on velocities, sine and noise
/// cost no order.
#[test]
fn cloth_in_air_is_of_second_order() {
    let run = |steps_per_frame: u32| {
        let mut frames = Vec::new();
        for_each_step(&flag(steps_per_frame), |n, state| {
            if n % steps_per_frame == 0 {
                frames.push(state.positions.clone());
            }
        });
        frames
    };
    let runs = [50, 100, 200, 400, 800].map(run);
    let differences: Vec<f64> = runs
        .windows(2)
        .map(|pair| pair[0].iter().zip(&pair[1]).map(|(a, b)| max_distance(a, b)).fold(0.0, larger))
        .collect();
    let orders: Vec<f64> = differences.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect();
    assert!(orders.iter().all(|order| (order - 2.0).abs() < 0.03), "{orders:?} of {differences:?}");
}

#[test]
fn residual_in_air_falls_as_the_step_squared() {
    let residuals = [50, 100, 200, 400].map(|steps_per_frame| {
        let mut recorder = Recorder::default();
        finish(&mut flag(steps_per_frame).simulation(), &mut recorder);
        relative_residual(recorder.frames().iter().map(|frame| &frame.energies))
    });
    let orders: Vec<f64> = residuals.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect();
    assert!(residuals[0] < 1e-3, "{residuals:?}");
    assert!(orders.iter().all(|order| (order - 2.0).abs() < 0.05), "{orders:?} of {residuals:?}");
}
