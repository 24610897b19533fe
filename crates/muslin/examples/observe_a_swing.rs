//! An observer of one's own: measures the period of a pendulum, which is known in closed form.
//!
//! `cargo run --release -p muslin --example observe_a_swing`

use muslin::integrate::Workers;
use muslin::observe::Observer;
use muslin::{Model, Scene, Simulation, State};

const SCENE: &str = r#"
title = "A pendulum of 1 m, let go at 20 degrees"
run = { duration = 5.0, step = { constant = 1.666666666667e-4 } }
environment = { gravity = [0.0, -9.81, 0.0] }
fabric.rod = { kind = "springs", particle_mass = 0.1, drag = 0.0, structural = { stiffness = 1e6, law = "linear" }, shear = { stiffness = 0.0, law = "linear" }, bend = { stiffness = 0.0, law = "linear" } }

[[cloth]]
name = "rod"
fabric = "rod"
grid = { columns = 1, rows = 2, height = 1.0 }
place = { origin = [0, 0, 0], width_axis = [0, 0, 1], height_axis = [0.3420201433256687, -0.9396926207859084, 0] }
pins = [{ row = 0 }]
"#;

/// Times [s] at which particle 1 passes below the pin, to the right.
#[derive(Default)]
struct Passages {
    last: Option<(f64, f64)>,
    times: Vec<f64>,
}

impl Observer for Passages {
    fn step(&mut self, _model: &Model, state: &State) {
        let (time, x) = (state.time, state.positions.x[1]);
        if let Some((time_before, before)) = self.last
            && before < 0.0
            && 0.0 <= x
        {
            // The motion is straight to second order within a step.
            self.times.push(time_before + (time - time_before) * before / (before - x));
        }
        self.last = Some((time, x));
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Scene::parse(SCENE)?;
    let mut simulation = Simulation::new(&scene, Simulation::integrator(&scene, Workers::single()))?;
    let mut passages = Passages::default();
    while !simulation.is_finished() {
        simulation.advance(&mut [&mut passages])?;
    }
    let [first, second] = passages.times[..] else { return Err("it swings to the right twice".into()) };
    // T = 4 K(sin(θ₀ / 2)) √(l / g) for θ₀ = 20°; the rod stretches by m g / k = 1e-6, and more where it swings.
    let exact = 2.0 * std::f64::consts::PI * 1.007_669_025_791_545 * (1.0_f64 / 9.81).sqrt();
    let error = (second - first) / exact - 1.0;
    assert!(error.abs() < 1e-5, "the period is off by {error:e}");
    Ok(())
}
