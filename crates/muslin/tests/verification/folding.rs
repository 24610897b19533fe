//! Measured cloth that is folded until its cells have no area left, where it has no normal.

use glam::DVec3;
use muslin::integrate::{Workers, block_stable_step};
use muslin::observe::Recorder;
use muslin::{Model, Points, Scene, Simulation};

use crate::common::finish;
use crate::common::setup::grid_points;

const SIDE: usize = 9;

/// A sheet with friction in bending, and cells of 2 cm, in the air.
fn sheet() -> Scene {
    let text = "
        title = 'sheet'
        run = { duration = 0.02, frame_rate = 50.0 }
        environment = { gravity = [0, 0, 0] }
        [fabric.cloth]
        kind = 'measured'
        areal_density = 0.16
        drag = 0.1
        warp = { modulus = 500.0 }
        weft = { modulus = 500.0 }
        shear = { modulus = 30.0 }
        bend = { warp = { rigidity = 7e-6, 2hb = 0.32e-3 }, weft = { rigidity = 7e-6, 2hb = 0.32e-3 } }
        [[cloth]]
        name = 'sheet'
        fabric = 'cloth'
        grid = { columns = 9, rows = 9, width = 0.16, height = 0.16 }
        place = { origin = [0, 0, 0], width_axis = [1, 0, 0], height_axis = [0, 1, 0] }
    ";
    Scene::parse(text).unwrap_or_else(|error| panic!("{}", error.render("test", text)))
}

/// Folded onto itself along its middle column, one half turned by `angle` [rad] in its plane: of the cells at the fold, lines
/// along the weft come back beside themselves, nearly along the fold.
fn folded(angle: f64) -> Points {
    let (sine, cosine) = libm::sincos(angle);
    grid_points(SIDE, SIDE, |i, j| {
        let (x, y) = (0.02 * (i as f64 - 4.0), 0.02 * (j as f64 - 4.0));
        if x < 0.0 {
            DVec3::new(-x, y, 0.0)
        } else {
            DVec3::new(x * cosine - y * sine, x * sine + y * cosine, 1e-6 * x)
        }
    })
}

/// The step is nearly that of the flat sheet, whatever area cells have left, and no step is taken back.
#[test]
fn cells_without_area_stop_no_run() {
    let scene = sheet();
    let model = Model::new(&scene);
    let flat_step = block_stable_step(&model, &model.initial_state(&scene));
    for angle in [0.0, 1e-6, 1e-3, 0.03] {
        let mut state = model.initial_state(&scene);
        state.positions = folded(angle);
        let step = block_stable_step(&model, &state);
        assert!(0.9 * flat_step < step, "{step:e} s at {angle} for {flat_step:e} s of the flat sheet");
        let method = Simulation::integrator(&scene, Workers::single());
        let mut simulation =
            Simulation::resume(&scene, method, state, 0).unwrap_or_else(|error| panic!("{error}"));
        let mut recorder = Recorder::default();
        finish(&mut simulation, &mut recorder);
        assert_eq!(recorder.steps().rejected, 0, "at {angle}");
    }
}
