//! What must hold for every scene: symmetries of the motion, and relations of forces, energies and stable steps.

mod common;

use common::random_scene::{random_law_scene, random_limit_scene};
use common::{
    AirNumbers, CURVE, EachStep, Random, SceneNumbers, StepNumbers, finish, max_distance, model_and_state,
};
use glam::{DQuat, DVec3};
use muslin::force::{Configuration, PotentialEnergies, Sweep};
use muslin::integrate::{
    CentralDifference, Integrator, Workers, block_stable_step, guaranteed_stable_step, largest_stable_step,
};
use muslin::observe::StrainMonitor;
use muslin::{Model, Points, State};
use proptest::prelude::*;

/// Of positions [m] of the same motion computed in another order or place, over a tenth of a second.
///
/// At most 200 steps carry roundings of 1e-15 m on as velocities, to 200^1.5 times as much: 3e-12 m; neighbouring
/// motions part by a factor of 10 at most in so short a time.
const TOLERANCE: f64 = 1e-10;

/// The positions [m] at the last frame.
fn last_positions(numbers: &SceneNumbers) -> Points {
    let mut simulation = numbers.simulation();
    finish(&mut simulation, &mut StrainMonitor::default());
    simulation.frame().state.positions.clone()
}

/// A tenth of a second of any scene.
fn short_scene() -> impl Strategy<Value = SceneNumbers> {
    random_limit_scene().prop_map(|numbers| SceneNumbers { frame_intervals: 2, ..numbers })
}

/// The same with an adaptive step or a tolerance.
fn adaptive_scene() -> impl Strategy<Value = SceneNumbers> {
    let rules = prop_oneof![Just(StepNumbers::Adaptive), (-5.0..-2.0).prop_map(tolerance)];
    (random_limit_scene(), rules).prop_map(|(numbers, step_rule)| {
        let mut numbers = SceneNumbers { step_rule, ..numbers };
        // Limits correct positions by as much however short the step is, so that no error estimate holds for them.
        if step_rule != StepNumbers::Adaptive {
            numbers.cloths[0].limit = None;
        }
        numbers
    })
}

fn tolerance(exponent: f64) -> StepNumbers {
    StepNumbers::Tolerance(10.0_f64.powf(exponent))
}

/// Steps [s] of an adaptive run, which has finite positions and hits all frames.
fn adaptive_steps(numbers: &SceneNumbers) -> Result<Vec<f64>, TestCaseError> {
    let mut simulation = numbers.simulation();
    let mut steps = Vec::new();
    let mut each = EachStep(|_: &Model, state: &State| steps.push(state.last_step));
    while !simulation.is_finished() {
        if let Err(error) = simulation.advance(&mut [&mut each]) {
            return Err(TestCaseError::fail(error.to_string()));
        }
        let frame = simulation.frame();
        prop_assert_eq!(frame.state.time, frame.index as f64 / numbers.frame_rate);
        prop_assert!(frame.state.positions.is_finite() && frame.velocities.is_finite());
    }
    let (time, sum) = (simulation.frame().state.time, steps.iter().sum::<f64>());
    prop_assert!((sum - time).abs() < 1e-12, "{} s for {} s", sum, time);
    Ok(steps)
}

fn mapped(points: &Points, map: impl Fn(DVec3) -> DVec3) -> Points {
    points.iter().map(map).collect()
}

/// Changes every vector of `numbers`; `place` those that are places.
fn with_vectors(
    numbers: &SceneNumbers,
    vector: impl Fn(DVec3) -> DVec3,
    place: impl Fn(DVec3) -> DVec3,
) -> SceneNumbers {
    let apply = |value: &mut [f64; 3], map: &dyn Fn(DVec3) -> DVec3| {
        *value = map(DVec3::from_array(*value)).to_array();
    };
    let mut changed = numbers.clone();
    apply(&mut changed.gravity, &vector);
    changed.winds.iter_mut().for_each(|wind| apply(&mut wind.direction, &vector));
    for air in &mut changed.airs {
        apply(&mut air.velocity, &vector);
        apply(&mut air.gust.direction, &vector);
    }
    for cloth in &mut changed.cloths {
        apply(&mut cloth.width_axis, &vector);
        apply(&mut cloth.height_axis, &vector);
        apply(&mut cloth.origin, &place);
        if let Some(motion) = &mut cloth.motion {
            apply(&mut motion.axis, &vector);
        }
    }
    changed
}

/// The positions [m] of particles that are counted along columns, counted along rows of `columns`.
fn transposed(points: &Points, columns: usize) -> Points {
    let rows = points.len() / columns;
    (0..points.len()).map(|p| points.get(p % columns * rows + p / columns)).collect()
}

fn config() -> ProptestConfig {
    ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn moving_the_scene_moves_the_motion(numbers in short_scene(), seed in any::<u64>()) {
        let offset = DVec3::from_array(Random::new(seed).vector(3.0));
        let moved = last_positions(&with_vectors(&numbers, |v| v, |place| place + offset));
        let error = max_distance(&moved, &mapped(&last_positions(&numbers), |x| x + offset));
        prop_assert!(error < TOLERANCE, "{error:e} m");
    }

    #[test]
    fn turning_the_scene_turns_the_motion(numbers in short_scene(), seed in any::<u64>()) {
        let axis = DVec3::from_array(Random::new(seed).vector(1.0)).normalize_or(DVec3::X);
        let rotation = DQuat::from_axis_angle(axis, seed as f64);
        let turned = last_positions(&with_vectors(&numbers, |v| rotation * v, |place| rotation * place));
        let error = max_distance(&turned, &mapped(&last_positions(&numbers), |x| rotation * x));
        prop_assert!(error < TOLERANCE, "{error:e} m");
    }

    /// The first sixty steps: later, roundings that have grown decide whether a step is refused. They reach the steps through the
    /// change of the forces' power, a small difference of large numbers.
    #[test]
    fn adaptive_steps_are_the_same_elsewhere(numbers in adaptive_scene(), seed in any::<u64>()) {
        let steps = adaptive_steps(&numbers)?;
        let offset = DVec3::from_array(Random::new(seed).vector(3.0));
        let axis = DVec3::from_array(Random::new(seed).vector(1.0)).normalize_or(DVec3::X);
        let rotation = DQuat::from_axis_angle(axis, seed as f64);
        let moved = with_vectors(&numbers, |v| rotation * v, |place| rotation * place + offset);
        let others = adaptive_steps(&moved)?;
        let (mut time, mut other_time) = (0.0, 0.0);
        for (step, other) in steps.iter().zip(&others).take(60) {
            time += step;
            other_time += other;
            let error = (time - other_time).abs();
            prop_assert!(error <= 1e-3 * time, "steps to {time:e} s and {other_time:e} s");
        }
    }

    /// A mirror changes no rounding, so the mirrored motion has the same bits.
    #[test]
    fn a_mirrored_scene_moves_as_the_mirror_image(numbers in short_scene()) {
        let mirror = |v: DVec3| DVec3::new(-v.x, v.y, v.z);
        let mirrored = last_positions(&with_vectors(&numbers, mirror, mirror));
        prop_assert_eq!(mirrored, mapped(&last_positions(&numbers), mirror));
    }

    /// Not with a limit, which corrects along columns first and from there along rows.
    #[test]
    fn columns_and_rows_can_be_swapped(numbers in short_scene()) {
        let mut numbers = numbers;
        numbers.cloths[0].limit = None;
        let mut swapped = numbers.clone();
        let cloth = &mut swapped.cloths[0];
        std::mem::swap(&mut cloth.columns, &mut cloth.rows);
        std::mem::swap(&mut cloth.width, &mut cloth.height);
        std::mem::swap(&mut cloth.width_axis, &mut cloth.height_axis);
        cloth.pins.iter_mut().for_each(|(column, row)| std::mem::swap(column, row));
        let found = transposed(&last_positions(&swapped), numbers.cloths[0].columns);
        let error = max_distance(&found, &last_positions(&numbers));
        prop_assert!(error < TOLERANCE, "{error:e} m");
    }

    #[test]
    fn columns_and_rows_can_be_counted_from_the_other_end(numbers in short_scene()) {
        let mut reversed = numbers.clone();
        let cloth = &mut reversed.cloths[0];
        let unit = |axis: [f64; 3]| DVec3::from_array(axis).normalize();
        // A single column or row has no extent, whatever the numbers say.
        let extent = |extent: f64, count: usize| if count == 1 { 0.0 } else { extent };
        let across = unit(cloth.width_axis) * extent(cloth.width, cloth.columns);
        let along = unit(cloth.height_axis) * extent(cloth.height, cloth.rows);
        cloth.origin = (DVec3::from_array(cloth.origin) + across + along).to_array();
        cloth.width_axis = cloth.width_axis.map(|value| -value);
        cloth.height_axis = cloth.height_axis.map(|value| -value);
        let (columns, rows) = (cloth.columns, cloth.rows);
        cloth.pins.iter_mut().for_each(|pin| *pin = (columns - 1 - pin.0, rows - 1 - pin.1));
        let found = last_positions(&reversed);
        let found = (0..found.len()).rev().map(|p| found.get(p)).collect();
        let error = max_distance(&found, &last_positions(&numbers));
        prop_assert!(error < TOLERANCE, "{error:e} m");
    }

    /// Other units of mass, length and time, each a power of two, change no rounding: no hidden constant has a unit.
    #[test]
    fn other_units_give_the_same_bits(numbers in short_scene()) {
        // Friction in bending holds up to a curvature that instruments do not resolve, and that has a unit.
        let numbers = without_friction(numbers);
        let (mass, length, time) = (8.0, 4.0, 2.0);
        let mut other = with_vectors(&numbers, |v| v, |place| place * length);
        other.gravity = other.gravity.map(|g| g * length / (time * time));
        other.frame_rate /= time;
        for wind in &mut other.winds {
            wind.amplitude *= mass * length / (time * time);
            wind.angular_frequency /= time;
        }
        for AirNumbers { velocity, gust, density, .. } in &mut other.airs {
            *velocity = velocity.map(|velocity| velocity * length / time);
            gust.amplitude *= length / time;
            gust.angular_frequency /= time;
            gust.noise = [gust.noise[0] * length / time, gust.noise[1] * time];
            *density *= mass / (length * length * length);
        }
        for cloth in &mut other.cloths {
            cloth.width *= length;
            cloth.height *= length;
            if let Some(motion) = &mut cloth.motion {
                motion.amplitude *= length;
                motion.frequency /= time;
            }
            cloth.mass *= mass;
            cloth.drag *= mass / time;
            cloth.dampings = cloth.dampings.map(|damping| damping * mass / time);
            cloth.stiffnesses = cloth.stiffnesses.map(|stiffness| stiffness * mass / (time * time));
        }
        prop_assert_eq!(last_positions(&other), mapped(&last_positions(&numbers), |x| x * length));
    }
}

/// The same of a cloth whose forces all have a potential, or depend on velocities.
fn without_friction(mut numbers: SceneNumbers) -> SceneNumbers {
    numbers.cloths[0].has_friction = false;
    numbers
}

/// A cloth in any shape: every particle moved by up to a fifth of the smallest rest length.
fn crumpled(numbers: &SceneNumbers) -> (Model, State, f64) {
    let (model, mut state) = model_and_state(numbers);
    let grid = model.cloths()[0].grid;
    let spacings = [grid.column_spacing, grid.row_spacing].into_iter().filter(|spacing| *spacing > 0.0);
    let size = spacings.fold(1.0, f64::min);
    let offsets = Random::new(state.positions.len() as u64).points(state.positions.len(), 0.2 * size);
    state.positions = state.positions.iter().zip(offsets.iter()).map(|(x, offset)| x + offset).collect();
    (model, state, size)
}

fn at<'a>(model: &'a Model, positions: &'a Points, velocities: &'a Points) -> Configuration<'a> {
    Configuration { time: 0.3, particles: model.particles(), positions, velocities, memory: &[] }
}

/// Forces [N] on all particles at rest.
fn forces(model: &Model, positions: &Points) -> Points {
    forces_in_motion(model, positions, &Points::zeros(positions.len()))
}

/// Forces [N] on all particles.
fn forces_in_motion(model: &Model, positions: &Points, velocities: &Points) -> Points {
    let mut forces = Points::zeros(positions.len());
    let mut rest = forces.as_mut();
    for block in model.blocks() {
        let (mut own, others) = rest.split_at(block.len());
        model.forces().iter().for_each(|force| {
            force.add_forces(at(model, positions, velocities), block, &mut own, &mut Sweep::default());
        });
        rest = others;
    }
    forces
}

/// K u [N] for all particles.
fn tangent_products(model: &Model, positions: &Points, displacements: &Points) -> Points {
    let (mut products, none) = (Points::zeros(positions.len()), Points::default());
    let mut rest = products.as_mut();
    for block in model.blocks() {
        let (mut own, others) = rest.split_at(block.len());
        for force in model.forces() {
            force.add_tangent_products(at(model, positions, &none), displacements, block, &mut own);
        }
        rest = others;
    }
    products
}

/// Potential energy [J] of everything.
fn energy(model: &Model, positions: &Points) -> f64 {
    let (mut energies, none) = (PotentialEnergies::default(), Points::default());
    model.forces().iter().for_each(|force| force.add_energies(at(model, positions, &none), &mut energies));
    energies.elastic.iter().sum::<f64>() + energies.gravitational
}

fn dot(a: &Points, b: &Points) -> f64 {
    a.iter().zip(b.iter()).map(|(a, b)| a.dot(b)).sum()
}

/// The stiffness [N/m] that a particle feels from all its springs together, and more.
fn stiffness(numbers: &SceneNumbers) -> f64 {
    // The tangent law stiffens up to 1 + tan²(0.8 / 0.9) = 2.5 times at the largest strain of a crumpled cloth. Friction adds as
    // much as twice the stiffness.
    10.0 * numbers.cloths[0].stiffnesses.iter().sum::<f64>()
}

proptest! {
    #![proptest_config(config())]

    /// F = −∂E/∂x for every coordinate of every particle. A difference over 2 δ is wrong by δ² E''' ~ k δ² / ℓ, 1e-10 of
    /// k ℓ for δ = 1e-5 ℓ, and by the rounding of the energy, ε E / δ; the energy of 64 particles is below 64 k ℓ² + m g x.
    #[test]
    fn forces_are_the_gradient_of_the_energy(numbers in random_law_scene()) {
        let numbers = without_friction(SceneNumbers { winds: Vec::new(), airs: Vec::new(), ..numbers });
        let (model, state, size) = crumpled(&numbers);
        let forces = forces(&model, &state.positions);
        let delta = 1e-5 * size;
        let weight = numbers.cloths[0].mass * DVec3::from_array(numbers.gravity).length();
        let scale = stiffness(&numbers) * size + weight / size;
        let mut positions = state.positions;
        for particle in 0..positions.len() {
            let place = positions.get(particle);
            for axis in DVec3::AXES {
                let mut energy_at = |offset: f64| {
                    positions.set(particle, place + axis * offset);
                    energy(&model, &positions)
                };
                let difference = (energy_at(-delta) - energy_at(delta)) / (2.0 * delta);
                let error = (difference - forces.get(particle).dot(axis)).abs() / scale;
                prop_assert!(error < 1e-8, "{error:e} at particle {particle}");
            }
            positions.set(particle, place);
        }
    }

    /// K u = −dF(x + s u)/ds, by central differences with the errors above. A tabulated law bends at its points: its
    /// second derivative jumps there by up to 20 k, and a difference across is wrong by a quarter of that times the change of
    /// strain, 2 √3 1e-5: 1.7e-5 of the stiffness for one spring. Three at once are allowed for.
    #[test]
    fn tangents_are_the_derivatives_of_the_forces(numbers in random_law_scene()) {
        // Air has no tangent: it is not stiff, and its derivative is not symmetric. That of friction leaves out how it turns.
        let numbers = without_friction(SceneNumbers { airs: Vec::new(), ..numbers });
        let (model, state, size) = crumpled(&numbers);
        let direction = Random::new(8).points(state.positions.len(), 1.0);
        let products = tangent_products(&model, &state.positions, &direction);
        let delta = 1e-5 * size;
        let moved = |s: f64| -> Points {
            state.positions.iter().zip(direction.iter()).map(|(x, u)| x + u * s).collect()
        };
        let (behind, ahead) = (forces(&model, &moved(-delta)), forces(&model, &moved(delta)));
        let differences = behind.iter().zip(ahead.iter()).map(|(b, a)| (b - a) / (2.0 * delta)).collect();
        let error = max_distance(&products, &differences) / stiffness(&numbers);
        let tolerance = if numbers.cloths[0].laws.contains(&CURVE) { 5e-5 } else { 1e-8 };
        prop_assert!(error < tolerance, "{error:e} of the stiffness");
    }

    /// u · K v = v · K u to the rounding of sums of 64 particles.
    #[test]
    fn tangents_are_symmetric(numbers in random_law_scene()) {
        let (model, state, _) = crumpled(&numbers);
        let mut random = Random::new(9);
        let [u, v] = [0; 2].map(|_| random.points(state.positions.len(), 1.0));
        let [ku, kv] = [&u, &v].map(|u| tangent_products(&model, &state.positions, u));
        let error = (dot(&u, &kv) - dot(&v, &ku)).abs() / (stiffness(&numbers) * u.len() as f64);
        prop_assert!(error < 1e-13, "{error:e} of the stiffness");
    }

    /// Without gravity and wind nothing but springs acts: neither a net force nor a net moment.
    #[test]
    fn springs_exert_no_net_force(numbers in random_law_scene()) {
        let numbers = SceneNumbers { gravity: [0.0; 3], winds: Vec::new(), airs: Vec::new(), ..numbers };
        let (model, state, size) = crumpled(&numbers);
        let forces = forces(&model, &state.positions);
        let sum: DVec3 = forces.iter().sum();
        let moment: DVec3 = state.positions.iter().zip(forces.iter()).map(|(x, force)| x.cross(force)).sum();
        let scale = stiffness(&numbers) * size * forces.len() as f64;
        prop_assert!(sum.length() < 1e-14 * scale, "{sum} N");
        // Places are within 5 m of the origin.
        prop_assert!(moment.length() < 5e-14 * scale, "{moment} N m");
    }

    /// The guaranteed steps are no larger than the largest stable one, the one by blocks is the larger of them, and no displacement is stiffer than the latter says.
    #[test]
    fn stable_steps_bound_every_displacement(numbers in random_law_scene()) {
        let (model, state, _) = crumpled(&numbers);
        let guaranteed = guaranteed_stable_step(&model, &state);
        let largest = largest_stable_step(&model, &state, &Workers::single());
        let by_blocks = block_stable_step(&model, &state);
        // An eigenvalue may be taken for larger by 2e-6 of it.
        prop_assert!(guaranteed * (1.0 - 1e-6) <= by_blocks, "{guaranteed:e} s and {by_blocks:e} s");
        prop_assert!(by_blocks <= largest * (1.0 + 1e-12), "{by_blocks:e} s and {largest:e} s");
        let mut u = Random::new(10).points(state.positions.len(), 1.0);
        model.particles().pins().for_each(|pin| u.set(pin, DVec3::ZERO));
        let masses = model.particles().masses();
        for _ in 0..20 {
            let product = tangent_products(&model, &state.positions, &u);
            let norm: f64 = u.iter().zip(masses).map(|(u, mass)| mass * u.length_squared()).sum();
            let square = if norm > 0.0 { dot(&u, &product) / norm } else { 0.0 };
            let bound = (2.0 / largest).powi(2) * (1.0 + 1e-9);
            prop_assert!(square <= bound, "a mode of {} rad/s for {largest:e} s", square.sqrt());
            let length = dot(&product, &product).sqrt();
            u = product.iter().map(|v| if length > 0.0 { v / length } else { v }).collect();
            model.particles().pins().for_each(|pin| u.set(pin, DVec3::ZERO));
        }
    }

    /// With no pins, drag, gravity or wind, linear momentum stays: a few roundings of its terms per step.
    #[test]
    fn momentum_stays(numbers in random_law_scene()) {
        let mut numbers = SceneNumbers { gravity: [0.0; 3], winds: Vec::new(), airs: Vec::new(), ..numbers };
        numbers.cloths[0].pins.clear();
        numbers.cloths[0].drag = 0.0;
        let (model, mut state, size) = crumpled(&numbers);
        // Springs that stiffen are stretched no further by speed: by a tenth of their length in 100 steps. Their step is that
        // of the crumpled shape, and a tenth of it, since they may share out their energy otherwise later.
        let step = (0.5 * numbers.step()).min(0.1 * guaranteed_stable_step(&model, &state));
        state.velocities = Random::new(11).points(state.positions.len(), 1e-3 * size / step);
        let momentum = |velocities: &Points| -> DVec3 {
            velocities.iter().zip(model.particles().masses()).map(|(v, mass)| v * *mass).sum()
        };
        let before = momentum(&state.velocities);
        let mut method = CentralDifference::new(Workers::single());
        let mut scale = 0.0_f64;
        for _ in 0..100 {
            if method.step(&model, &mut state, step).is_err() {
                return Err(TestCaseError::fail("unstable"));
            }
            let sizes = state.velocities.iter().zip(model.particles().masses());
            scale = scale.max(sizes.map(|(v, mass)| mass * v.length()).sum());
        }
        let after = momentum(&state.velocities);
        prop_assert!((after - before).length() < 100.0 * 4.0 * f64::EPSILON * scale, "{before} to {after}");
    }
}
