//! From scene text to a moving cloth: hangs a sheet by two corners and says how it comes to rest.
//!
//! `cargo run --release -p muslin --example hang_cloth`

use muslin::integrate::Workers;
use muslin::observe::{Recorder, relative_residual};
use muslin::{Scene, Simulation};

const SCENE: &str = r#"
title = "A sheet that comes to rest"

[run]
duration = 10.0
step = { constant = 1.666666666667e-3 } # [s], 10 per frame

[environment]
gravity = [0.0, -9.81, 0.0] # [m/s^2]

[fabric.stiff]
kind = "springs"
particle_mass = 0.002 # [kg]
drag = 0.02           # [kg/s]
structural = { stiffness = 200.0, law = "linear" } # [N/m]
shear      = { stiffness = 20.0, law = "linear" }
bend       = { stiffness = 2.0, law = "linear" }

[[cloth]]
name = "sheet"
fabric = "stiff"
grid = { columns = 10, rows = 10, width = 1.0, height = 1.0 } # [m]
place = { origin = [0.0, 1.0, 0.0], width_axis = [1, 0, 0], height_axis = [0, 0, 1] }
pins = [{ column = 0, row = 0 }, { column = -1, row = 0 }]
"#;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Scene::parse(SCENE)?;
    let mut simulation = Simulation::new(&scene, Simulation::integrator(&scene, Workers::single()))?;
    let mut recorder = Recorder::default();
    simulation.observe(&mut [&mut recorder]); // the first frame, which no step leads to
    while !simulation.is_finished() {
        simulation.advance(&mut [&mut recorder])?;
    }
    let frames = recorder.frames();
    let last = &frames[frames.len() - 1];
    assert!(last.energies.kinetic < 1e-6, "it is at rest: {:e} J", last.energies.kinetic);
    // It hangs from y = 1 m, 1 m long and a little stretched.
    assert!((-0.2..0.05).contains(&last.lowest_point), "lowest point {} m", last.lowest_point);
    assert!(relative_residual(frames.iter().map(|frame| &frame.energies)) < 1e-4);
    Ok(())
}
