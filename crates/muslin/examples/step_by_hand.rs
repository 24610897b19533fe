//! Stepping inside a game loop: the caller owns the clock, and steps as long as simulated time is behind its own.
//!
//! `cargo run --release -p muslin --example step_by_hand`

use glam::DVec3;
use muslin::integrate::{CentralDifference, Integrator, Workers, guaranteed_stable_step};
use muslin::scene::Start;
use muslin::{Model, Points, Scene};

const SCENE: &str = r#"
title = "A ribbon in free fall"
run = { duration = 1.0, step = { constant = 8.333333333333e-4 } } # the loop below takes steps of its own
environment = { gravity = [0.0, -9.81, 0.0] }

[fabric.silk]
kind = "springs"
particle_mass = 0.001
drag = 0.0
structural = { stiffness = 40.0, law = "linear" }
shear      = { stiffness = 10.0, law = "linear" }
bend       = { stiffness = 1.0, law = "linear" }

[[cloth]]
name = "ribbon"
fabric = "silk"
grid = { columns = 4, rows = 30, width = 0.1, height = 1.0 }
place = { origin = [0.0, 2.0, 0.0], width_axis = [1, 0, 0], height_axis = [0, 0, 1] }
"#;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Scene::parse(SCENE)?;
    let model = Model::new(&scene);
    let mut state = model.initial_state(&scene);
    // The game throws the ribbon upwards: positions and velocities are the caller's until the start.
    state.velocities = (0..model.particles().len()).map(|_| DVec3::new(0.0, 3.0, 0.0)).collect();
    let step = 0.9 * guaranteed_stable_step(&model, &state);
    CentralDifference::start(Start::Consistent, &mut state, step);
    let mut integrator = CentralDifference::new(Workers::single());

    let mut velocities = Points::default();
    for picture in 1..=30 {
        let now = f64::from(picture) / 60.0;
        while state.time < now {
            // The last step before a picture is shorter, so that the picture shows this very moment.
            let step = step.min(now - state.time);
            integrator.step(&model, &mut state, step)?;
        }
        integrator.eval_velocities(&model, &state, &mut velocities); // at `now`, for motion blur
    }
    // Without drag every particle flies as a thrown stone does: y = 2 + 3 t − g t² / 2, v = 3 − g t, at t = 0.5 s.
    let (height, speed) = (2.0 + 1.5 - 0.5 * 9.81 * 0.25, 3.0 - 9.81 * 0.5);
    let error = state.positions.y.iter().map(|y| (y - height).abs()).fold(0.0, f64::max);
    assert!(error < 1e-12, "positions are off by {error:e} m");
    let error = velocities.y.iter().map(|v| (v - speed).abs()).fold(0.0, f64::max);
    assert!(error < 1e-12, "velocities are off by {error:e} m/s");
    Ok(())
}
