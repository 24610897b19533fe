//! Scenes made of numbers, and observers, for the test binaries.
#![allow(dead_code, reason = "each test binary uses a part of it")]

mod measured;
pub(crate) mod random_scene;
pub(crate) mod setup;
pub(crate) mod spectrum;

use std::fmt::Write as _;

use muslin::integrate::Workers;
use muslin::observe::{Observer, StateHash};
use muslin::{Model, Points, Scene, Simulation, State};

/// Hooke's law, as in a scene file.
pub(crate) const LINEAR: &str = "law = \"linear\"";

/// The tabulated law: tension k L times [`CURVE_POINTS`], with the stiffness k and the smallest rest length L of the cloth.
pub(crate) const CURVE: &str = "law = \"curve\"";

/// Strain [1] and tension [k L] of a curve that stiffens: at rest by about k, and nowhere by more than 3 k.
pub(crate) const CURVE_POINTS: [[f64; 2]; 5] =
    [[0.05, 0.05], [0.1, 0.11], [0.2, 0.27], [0.4, 0.7], [0.8, 1.7]];

/// Names of spring families.
const FAMILIES: [&str; 3] = ["structural", "shear", "bend"];

/// A scene as numbers, of which tests make the text that the library reads, and the motion that it must have.
#[derive(Clone, Debug)]
pub(crate) struct SceneNumbers {
    pub(crate) frame_intervals: u32,
    pub(crate) frame_rate: f64,
    /// Of a constant step.
    pub(crate) steps_per_frame: u32,
    pub(crate) step_rule: StepNumbers,
    pub(crate) as_printed_start: bool,
    pub(crate) allow_unstable: bool,
    pub(crate) gravity: [f64; 3],
    pub(crate) winds: Vec<WindNumbers>,
    pub(crate) airs: Vec<AirNumbers>,
    pub(crate) cloths: Vec<ClothNumbers>,
}

/// How the step is chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum StepNumbers {
    /// As many as the scene has steps per frame.
    Constant,
    Adaptive,
    /// With this error [m] per frame.
    Tolerance(f64),
}

/// A wind F = [A sin(ω t + φ) + ε] d on every particle.
#[derive(Clone, Debug)]
pub(crate) struct WindNumbers {
    pub(crate) amplitude: f64,
    pub(crate) angular_frequency: f64,
    pub(crate) phase: f64,
    pub(crate) direction: [f64; 3],
    /// Standard deviation [N] and correlation time [s].
    pub(crate) noise: [f64; 2],
}

/// An aerodynamic wind.
#[derive(Clone, Debug)]
pub(crate) struct AirNumbers {
    pub(crate) velocity: [f64; 3],
    /// What comes on top, in m/s.
    pub(crate) gust: WindNumbers,
    pub(crate) density: f64,
    /// C_N and C_T.
    pub(crate) coefficients: [f64; 2],
}

/// A cloth with a fabric of its own.
#[derive(Clone, Debug)]
pub(crate) struct ClothNumbers {
    pub(crate) columns: usize,
    pub(crate) rows: usize,
    pub(crate) width: f64,
    pub(crate) height: f64,
    pub(crate) origin: [f64; 3],
    pub(crate) width_axis: [f64; 3],
    pub(crate) height_axis: [f64; 3],
    /// Column and row of every pin.
    pub(crate) pins: Vec<(usize, usize)>,
    /// How all of them move, if they do.
    pub(crate) motion: Option<SineNumbers>,
    pub(crate) mass: f64,
    pub(crate) drag: f64,
    pub(crate) rest_length_direction: bool,
    /// Structural, shear and bend stiffness [N/m].
    pub(crate) stiffnesses: [f64; 3],
    /// Their laws, as in a scene file.
    pub(crate) laws: [&'static str; 3],
    /// The limit, as in a scene file, if there is one.
    pub(crate) limit: Option<&'static str>,
    /// Damping [kg/s] along the springs of each family; of a measured fabric, the times by which it lags behind.
    pub(crate) dampings: [f64; 3],
    /// Whether a measured fabric has internal friction of all kinds, along yarns if they are linear.
    pub(crate) has_friction: bool,
    /// Whether the fabric is measured: one with these numbers inside of the grid. It has no limit.
    pub(crate) is_measured: bool,
}

/// A displacement A sin(2π f t + φ) along an axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SineNumbers {
    pub(crate) axis: [f64; 3],
    pub(crate) amplitude: f64,
    pub(crate) frequency: f64,
    pub(crate) phase: f64,
}

impl SineNumbers {
    /// The displacement [m] along the axis at `time` [s].
    pub(crate) fn displacement(&self, time: f64) -> f64 {
        self.amplitude * (std::f64::consts::TAU * self.frequency * time + self.phase).sin()
    }

    fn text(&self) -> String {
        let Self { axis, amplitude, frequency, phase } = self;
        format!(
            ", motion = {{ kind = \"sine\", axis = {axis:?}, amplitude = {amplitude:?}, \
             frequency = {frequency:?}, phase = {phase:?} }}"
        )
    }
}

impl Default for SceneNumbers {
    /// One second of the default cloth under gravity.
    fn default() -> Self {
        Self {
            frame_intervals: 50,
            frame_rate: 50.0,
            steps_per_frame: 20,
            step_rule: StepNumbers::Constant,
            as_printed_start: false,
            allow_unstable: false,
            gravity: [0.0, -9.81, 0.0],
            winds: Vec::new(),
            airs: Vec::new(),
            cloths: vec![ClothNumbers::default()],
        }
    }
}

impl Default for WindNumbers {
    /// None.
    fn default() -> Self {
        Self {
            amplitude: 0.0,
            angular_frequency: 0.0,
            phase: 0.0,
            direction: [1.0, 0.0, 0.0],
            noise: [0.0; 2],
        }
    }
}

impl AirNumbers {
    /// A steady wind.
    pub(crate) fn steady(velocity: [f64; 3], coefficients: [f64; 2]) -> Self {
        Self { velocity, gust: WindNumbers::default(), density: 1.2, coefficients }
    }
}

impl Default for ClothNumbers {
    /// The cloth of the paper's Fig. 3 with this project's constants: 10 x 10, horizontal, held by two corners.
    fn default() -> Self {
        Self {
            columns: 10,
            rows: 10,
            width: 1.0,
            height: 1.0,
            origin: [-0.5, 1.0, 0.0],
            width_axis: [1.0, 0.0, 0.0],
            height_axis: [0.0, 0.0, 1.0],
            pins: vec![(0, 0), (9, 0)],
            motion: None,
            mass: 0.002,
            drag: 0.002,
            rest_length_direction: false,
            stiffnesses: [60.0, 20.0, 2.0],
            laws: [LINEAR; 3],
            limit: None,
            dampings: [0.0; 3],
            has_friction: false,
            is_measured: false,
        }
    }
}

impl SceneNumbers {
    /// The constant step [s].
    pub(crate) fn step(&self) -> f64 {
        1.0 / (self.frame_rate * f64::from(self.steps_per_frame))
    }

    /// The step, as in a scene file.
    fn step_text(&self) -> String {
        match self.step_rule {
            StepNumbers::Constant => format!("{{ constant = {:?} }}", self.step()),
            StepNumbers::Adaptive => "\"adaptive\"".to_owned(),
            StepNumbers::Tolerance(tolerance) => format!("{{ tolerance = {tolerance:?} }}"),
        }
    }

    /// The scene's text.
    pub(crate) fn text(&self) -> String {
        let start = if self.as_printed_start { "as-printed" } else { "consistent" };
        let mut text = format!(
            "title = \"test\"\n\
             [run]\nduration = {:?}\nframe_rate = {:?}\nstep = {}\nstart = \"{start}\"\n\
             allow-unstable = {}\n\
             [environment]\ngravity = {:?}\n",
            f64::from(self.frame_intervals) / self.frame_rate,
            self.frame_rate,
            self.step_text(),
            self.allow_unstable,
            self.gravity,
        );
        for wind in &self.winds {
            let _ = write!(text, "[[environment.wind]]\nlaw = \"particle-force\"\n{}", wind.text());
        }
        for AirNumbers { velocity, gust, density, coefficients: [normal, tangential] } in &self.airs {
            let _ = write!(
                text,
                "[[environment.wind]]\nlaw = \"aerodynamic\"\nvelocity = {velocity:?}\n{}\
                 air_density = {density:?}\nnormal_coefficient = {normal:?}\n\
                 tangential_coefficient = {tangential:?}\n",
                gust.text(),
            );
        }
        for (index, cloth) in self.cloths.iter().enumerate() {
            cloth.add_text(index, &mut text);
        }
        text
    }

    /// The scene that the library reads.
    pub(crate) fn scene(&self) -> Scene {
        let text = self.text();
        let scene = Scene::parse_with(&text, &mut |name| self.data_file(name));
        scene.unwrap_or_else(|error| panic!("{}", error.render("test", &text)))
    }

    /// The data file that the text calls `name`.
    fn data_file(&self, name: &str) -> Result<Vec<u8>, String> {
        for (index, cloth) in self.cloths.iter().enumerate() {
            if let Some(bytes) = cloth.measured_file(index, name).filter(|_| cloth.is_measured) {
                return Ok(bytes);
            }
            if let Some(family) = (0..3).find(|&family| curve_name(index, family) == name) {
                let scale = cloth.stiffnesses[family] * cloth.smallest_rest_length();
                let lines =
                    CURVE_POINTS.map(|[strain, tension]| format!("{strain:?},{:?}\n", scale * tension));
                return Ok(format!("strain [1],tension [N]\n{}", lines.concat()).into_bytes());
            }
        }
        Err("no cloth has it".to_owned())
    }

    /// The scene at time zero on one thread.
    pub(crate) fn simulation(&self) -> Simulation {
        simulation(&self.scene(), Workers::single())
    }
}

impl WindNumbers {
    fn text(&self) -> String {
        let Self { amplitude, angular_frequency, phase, direction, noise: [noise, noise_time] } = self;
        format!(
            "amplitude = {amplitude:?}\nangular_frequency = {angular_frequency:?}\nphase = {phase:?}\n\
             direction = {direction:?}\nnoise = {noise:?}\nnoise_time = {noise_time:?}\n",
        )
    }
}

impl ClothNumbers {
    fn add_text(&self, index: usize, text: &mut String) {
        let Self { columns, rows, width, height, origin, width_axis, height_axis, .. } = self;
        let fabric = if self.is_measured { self.measured_text(index) } else { self.springs_text(index) };
        let motion = self.motion.as_ref().map(SineNumbers::text).unwrap_or_default();
        let pins =
            self.pins.iter().map(|(column, row)| format!("{{ column = {column}, row = {row}{motion} }}"));
        let pins: Vec<String> = pins.collect();
        let _ = write!(
            text,
            "[fabric.fabric{index}]\n{fabric}\
             [[cloth]]\nname = \"cloth{index}\"\nfabric = \"fabric{index}\"\n\
             grid = {{ columns = {columns}, rows = {rows}, width = {width:?}, height = {height:?} }}\n\
             place = {{ origin = {origin:?}, width_axis = {width_axis:?}, height_axis = {height_axis:?} }}\n\
             pins = [{}]\n",
            pins.join(", "),
        );
    }

    /// The table of a fabric of springs but for its name, as in a scene file.
    fn springs_text(&self, index: usize) -> String {
        let Self { mass, drag, .. } = self;
        let direction = if self.rest_length_direction { "rest-length" } else { "current-length" };
        let springs = [0, 1, 2].map(|family| {
            let law = match (self.stiffnesses[family], self.laws[family]) {
                (stiffness, CURVE) if 0.0 < stiffness => {
                    format!("{CURVE}, curve = \"{}\"", curve_name(index, family))
                }
                (stiffness, CURVE) => format!("stiffness = {stiffness:?}, {LINEAR}"),
                (stiffness, law) => format!("stiffness = {stiffness:?}, {law}"),
            };
            let damping = match self.dampings[family] {
                0.0 => String::new(),
                damping => format!(", damping = {damping:?}"),
            };
            format!("{} = {{ {law}{damping} }}", FAMILIES[family])
        });
        let limit = self.limit.map(|limit| format!("limit = {limit}\n")).unwrap_or_default();
        format!(
            "kind = \"springs\"\nparticle_mass = {mass:?}\ndrag = {drag:?}\n\
             force_direction = \"{direction}\"\n{}\n{limit}",
            springs.join("\n")
        )
    }

    /// The rest length [m] of the shortest spring.
    fn smallest_rest_length(&self) -> f64 {
        let extents = [(self.width, self.columns), (self.height, self.rows)];
        let spacings = extents
            .map(|(extent, count)| if count == 1 { f64::INFINITY } else { extent / (count - 1) as f64 });
        let smallest = spacings[0].min(spacings[1]);
        // A lone particle has no springs, but its table must be one.
        if smallest.is_finite() { smallest } else { 1.0 }
    }
}

/// The file with the curve of a family of springs of a cloth.
fn curve_name(cloth: usize, family: usize) -> String {
    format!("cloth{cloth}-{}.csv", FAMILIES[family])
}

/// Workers of so many threads.
pub(crate) fn workers(threads: usize) -> Workers {
    let threads = std::num::NonZeroUsize::new(threads).unwrap_or(std::num::NonZeroUsize::MIN);
    Workers::new(threads).unwrap_or_else(|error| panic!("{error}"))
}

/// `scene` at time zero on `workers`.
pub(crate) fn simulation(scene: &Scene, workers: Workers) -> Simulation {
    Simulation::new(scene, Simulation::integrator(scene, workers)).unwrap_or_else(|error| panic!("{error}"))
}

/// Moves `simulation` to its end, shown to `observer` from the first frame on.
pub(crate) fn finish(simulation: &mut Simulation, observer: &mut dyn Observer) {
    simulation.observe(&mut [&mut *observer]);
    while !simulation.is_finished() {
        simulation.advance(&mut [&mut *observer]).unwrap_or_else(|error| panic!("{error}"));
    }
}

/// The model of `numbers` and its state at time zero, to be moved by a method directly.
pub(crate) fn model_and_state(numbers: &SceneNumbers) -> (Model, State) {
    let scene = numbers.scene();
    let model = Model::new(&scene);
    let state = model.initial_state(&scene);
    (model, state)
}

/// The hash that the last frame of the scene called `name` must have; `found` goes into the message if there is none.
pub(crate) fn assert_golden(name: &str, found: StateHash) {
    let hashes = include_str!("../golden/hashes.txt").lines().filter_map(|line| line.split_once(' '));
    match hashes.into_iter().find(|(listed, _)| *listed == name) {
        Some((_, expected)) => assert_eq!(found.to_string(), expected, "last frame of `{name}`"),
        None => panic!("no golden hash for `{name}`; if the motion is right, add the line\n{name} {found}"),
    }
}

/// Hands every step's state to a function.
pub(crate) struct EachStep<F>(pub(crate) F);

impl<F: FnMut(&Model, &State) + Send> Observer for EachStep<F> {
    fn step(&mut self, model: &Model, state: &State) {
        (self.0)(model, state);
    }
}

/// Moves `numbers` to its end and hands every step's state, counted from 1, to `visit`.
pub(crate) fn for_each_step(numbers: &SceneNumbers, mut visit: impl FnMut(u32, &State) + Send) {
    let mut count = 0;
    let mut observer = EachStep(|_: &Model, state: &State| {
        count += 1;
        visit(count, state);
    });
    finish(&mut numbers.simulation(), &mut observer);
}

/// The larger of two errors, and NaN if either is: `f64::max` would pass over it, and a test with it.
pub(crate) fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b <= a { a } else { b }
}

/// The largest distance [m] of a point from the one of the same number.
pub(crate) fn max_distance(a: &Points, b: &Points) -> f64 {
    assert_eq!(a.len(), b.len(), "as many points");
    a.iter().zip(b.iter()).map(|(a, b)| a.distance(b)).fold(0.0, larger)
}

/// Numbers that look random and are the same for the same seed: xorshift (Marsaglia 2003).
pub(crate) struct Random(u64);

impl Random {
    /// The sequence of `seed`.
    pub(crate) fn new(seed: u64) -> Self {
        // Xorshift starts from anything but zero; small seeds must not give alike sequences.
        let mut random = Self((seed ^ 0x9e37_79b9_7f4a_7c15).max(1));
        (0..16).for_each(|_| {
            random.next();
        });
        random
    }

    /// The next number from -1 to 1.
    pub(crate) fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// The next number from `least` to `most`.
    pub(crate) fn between(&mut self, least: f64, most: f64) -> f64 {
        least + 0.5 * (most - least) * (1.0 + self.next())
    }

    /// The next whole number below `limit`.
    pub(crate) fn below(&mut self, limit: u32) -> u32 {
        self.between(0.0, f64::from(limit)) as u32 % limit
    }

    /// The next vector with coordinates from -`size` to `size`.
    pub(crate) fn vector(&mut self, size: f64) -> [f64; 3] {
        std::array::from_fn(|_| size * self.next())
    }

    /// The next `count` points with coordinates from -`size` to `size`.
    pub(crate) fn points(&mut self, count: usize, size: f64) -> Points {
        (0..count).map(|_| glam::DVec3::from_array(self.vector(size))).collect()
    }
}
