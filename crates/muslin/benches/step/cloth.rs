//! The cloths that are measured.

use std::f64::consts::PI;

use glam::DVec3;
use muslin::integrate::guaranteed_stable_step;
use muslin::{Model, Points, Scene, State};

/// Length of the cloths' edges [m].
const EDGE: f64 = 1.0;

/// A square cloth in a scene, in the words of scene files.
#[derive(Clone, Debug)]
pub(crate) struct Cloth {
    /// Particles along each edge.
    pub(crate) width: usize,
    /// What follows the stiffness of structural springs: their law.
    pub(crate) law: &'static str,
    pub(crate) gravity: bool,
    pub(crate) drag: bool,
    /// Tables `[[environment.wind]]`.
    pub(crate) wind: &'static str,
    /// Whether the step is adaptive.
    pub(crate) adaptive: bool,
    /// Whether the fabric is measured, with the same linear springs of two families, and bends by second differences in
    /// place of springs.
    pub(crate) measured: bool,
    /// Whether the yarns of a measured fabric rub on each other, in tension, shear and bending.
    pub(crate) friction: bool,
}

impl Cloth {
    /// The law that all others are compared with.
    pub(crate) const LINEAR: &'static str = "stiffness = 500.0, law = \"linear\"";
    /// The paper's law that stiffens.
    pub(crate) const TANGENT: &'static str = "stiffness = 500.0, law = \"tangent\", strain_scale = 0.06";
    /// The law that softens.
    pub(crate) const ARCTANGENT: &'static str = "stiffness = 500.0, law = \"arctangent-force\"";
    /// A law from a table of five points.
    pub(crate) const CURVE: &'static str = "law = \"curve\", curve = \"curve.csv\"";

    /// A cloth of `width` x `width` with linear springs, under gravity and drag, at constant steps.
    pub(crate) fn new(width: usize) -> Self {
        Self {
            width,
            law: Self::LINEAR,
            gravity: true,
            drag: true,
            wind: "",
            adaptive: false,
            measured: false,
            friction: false,
        }
    }

    /// Number of particles.
    pub(crate) fn particles(&self) -> usize {
        self.width * self.width
    }

    /// The scene: that of `hanging-100` at another resolution, held by two particles of an edge.
    pub(crate) fn scene(&self) -> Scene {
        let Self { width, law, wind, .. } = self;
        let share = 1.0 / self.particles() as f64;
        let (mass, drag) = (0.2 * share, if self.drag { 0.3 * share } else { 0.0 });
        let gravity = if self.gravity { -9.81 } else { 0.0 };
        // The largest stable step goes with the width of the cells; this is about a sixth of it, as
        // laws that stiffen need a shorter one.
        let step = 1.0 / (60 * 6 * width) as f64;
        let step =
            if self.adaptive { "\"adaptive\"".to_owned() } else { format!("{{ constant = {step:e} }}") };
        let fabric = if self.measured {
            // Square cells have k_d = G and k = K - G.
            let drag = drag / share;
            let [rt, hysteresis, bent] = if self.friction {
                [", rt = 0.6", ", 2hg = 1.0, 2hg5 = 2.0", ", 2hb = 4e-4"]
            } else {
                [""; 3]
            };
            format!(
                "kind = 'measured'
                areal_density = 0.2
                drag = {drag:e}
                warp = {{ modulus = 650.0{rt} }}
                weft = {{ modulus = 650.0{rt} }}
                shear = {{ modulus = 150.0{hysteresis} }}
                bend = {{ warp = {{ rigidity = 1e-5{bent} }}, weft = {{ rigidity = 1e-5{bent} }} }}"
            )
        } else {
            format!(
                "kind = 'springs'
                particle_mass = {mass:e}
                drag = {drag:e}
                structural = {{ {law} }}
                shear = {{ stiffness = 150.0, law = 'linear' }}
                bend = {{ stiffness = 60.0, law = 'linear' }}"
            )
        };
        let text = format!(
            "title = 'Cloth to measure'
            run = {{ duration = 100.0, frame_rate = 60.0, step = {step} }}
            [environment]
            gravity = [0.0, {gravity:?}, 0.0]
            {wind}
            [fabric.cotton]
            {fabric}
            [[cloth]]
            name = 'sheet'
            fabric = 'cotton'
            grid = {{ columns = {width}, rows = {width}, width = {EDGE:?}, height = {EDGE:?} }}
            place = {{ origin = [0, 0, 0], width_axis = [1, 0, 0], height_axis = [0, 0, 1] }}
            pins = [{{ column = 0, row = 0 }}, {{ column = -1, row = 0 }}]"
        );
        let curve = b"strain [%],tension [N]\n1,0.05\n2,0.12\n3,0.22\n4,0.4\n5,0.8\n";
        Scene::parse_with(&text, &mut |_| Ok(curve.to_vec()))
            .unwrap_or_else(|error| panic!("{}", error.render("benchmark", &text)))
    }

    /// A state at time zero in which the cloth is in use: flat it would be at the rest lengths, where some laws are cheaper.
    ///
    /// It is stretched by 1 % and lies in waves; all springs between neighbours are stretched, by 3 % at most.
    pub(crate) fn state(&self, scene: &Scene, model: &Model) -> State {
        let mut state = model.initial_state(scene);
        let wave = |p: DVec3| {
            let height = 0.015 * EDGE * (4.0 * PI * p.x / EDGE).sin() * (2.0 * PI * p.z / EDGE).cos();
            DVec3::new(1.01 * p.x, height, 1.01 * p.z)
        };
        state.positions = state.positions.iter().map(wave).collect::<Points>();
        state
    }

    /// A step [s] with which it stays stable.
    pub(crate) fn step(&self, model: &Model, state: &State) -> f64 {
        0.5 * guaranteed_stable_step(model, state)
    }
}
