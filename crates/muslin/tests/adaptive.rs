//! Adaptive runs of scenes in which something grows at once, however short the step.

mod common;

use common::finish;
use muslin::integrate::Workers;
use muslin::observe::Recorder;
use muslin::{Scene, Simulation};

/// A run in adaptive steps of a cloth of 5 x 5 with the `environment` beside gravity, the fabric's springs and `limit`.
fn run(environment: &str, [structural, shear, bend]: [&str; 3], limit: &str, pins: &str) -> Recorder {
    let text = format!(
        "title = ''\n[run]\nduration = 0.3\nframe_rate = 60.0
        [environment]\ngravity = [0, -9.81, 0]\n{environment}
        [fabric.f]\nkind = 'springs'\nparticle_mass = 2e-3\ndrag = 0
        structural = {{ {structural} }}\nshear = {{ {shear} }}\nbend = {{ {bend} }}\n{limit}
        [[cloth]]\nname = 'c'\nfabric = 'f'\ngrid = {{ columns = 5, rows = 5, width = 0.5, height = 0.5 }}
        place = {{ origin = [0, 0, 0], width_axis = [1, 0, 0], height_axis = [0, 0, 1] }}\npins = {pins}"
    );
    let scene = Scene::parse(&text).unwrap_or_else(|error| panic!("{}", error.render("test", &text)));
    let integrator = Simulation::integrator(&scene, Workers::single());
    let mut simulation = Simulation::new(&scene, integrator).unwrap_or_else(|error| panic!("{error}"));
    let mut recorder = Recorder::default();
    finish(&mut simulation, &mut recorder);
    recorder
}

const NONE: &str = "stiffness = 0, law = 'linear'";

/// In still air damping begins at nothing, so that in the first step it grows beyond all bounds.
#[test]
fn a_cloth_without_springs_falls_through_still_air() {
    let air = "[[environment.wind]]\nlaw = 'aerodynamic'\nvelocity = [0, 0, 0]\nair_density = 1.2
        normal_coefficient = 1.2\ntangential_coefficient = 0.1";
    let recorder = run(air, [NONE; 3], "", "[]");
    assert_eq!(recorder.frames().len(), 19);
}

/// A cut-off moves particles by as much in the shortest step as in a long one, and with them what shear springs feel.
#[test]
fn springs_that_stiffen_go_on_under_a_cut_off() {
    let springs = [
        "stiffness = 60.0, law = 'tangent', strain_scale = 0.06",
        "stiffness = 20.0, law = 'tangent', strain_scale = 0.01",
        NONE,
    ];
    let limit = "limit = { kind = 'cut-off', strain = 0.0, passes = 1 }";
    let recorder = run("", springs, limit, "[{ column = 0, row = 0 }, { column = -1, row = 0 }]");
    assert_eq!(recorder.frames().len(), 19);
}
