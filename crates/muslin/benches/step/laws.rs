//! Spring laws, forces that may be absent or added, and the adaptive step.

use std::cell::RefCell;
use std::io::{self, Write};
use std::time::Duration;

use muslin::integrate::Workers;
use muslin::observe::Observer;
use muslin::{Model, Scene, Simulation, State};
use serde_json::json;

use super::clock::{Clock, Stopwatch};
use super::cloth::Cloth;
use super::measure::{Budget, Competitor};
use super::stepper::{Stepper, instruction_sets};
use super::table::{Report, Row, Target};

/// Width of the cloths whose laws are compared.
const WIDTH: usize = 100;

/// Width of those that move adaptively, which have to fall first.
const ADAPTIVE_WIDTH: usize = 60;

const PARTICLE_WIND: &str = "[[environment.wind]]
law = 'particle-force'
amplitude = 1e-5
angular_frequency = 6.0
phase = 0.0
noise = 1e-6
noise_time = 0.05
direction = [0.0, 0.0, 1.0]";

const AERODYNAMIC_WIND: &str = "[[environment.wind]]
law = 'aerodynamic'
velocity = [3.0, 0.0, 0.3]
air_density = 1.2
normal_coefficient = 1.5
tangential_coefficient = 0.05";

/// Measures one cloth under every law, and with other forces; the first is what the others are compared with.
pub(crate) fn by_law(report: &mut Report<impl Write>, budget: Budget) -> io::Result<()> {
    let linear = Cloth::new(WIDTH);
    let law = |law| Cloth { law, ..linear.clone() };
    let mut rows = Vec::new();
    for set in instruction_sets() {
        let cloths = [
            ("linear", linear.clone(), None),
            ("tangent", law(Cloth::TANGENT), Some(Target::AtMost(2.0))),
            ("arctangent-force", law(Cloth::ARCTANGENT), None),
            ("curve", law(Cloth::CURVE), None),
            (
                "linear, measured: bending by second differences",
                Cloth { measured: true, ..linear.clone() },
                Some(Target::AtMost(1.0)),
            ),
            (
                "linear, measured, with friction in tension, shear and bending",
                Cloth { measured: true, friction: true, ..linear.clone() },
                None,
            ),
            ("linear, no gravity", Cloth { gravity: false, ..linear.clone() }, None),
            ("linear, no drag", Cloth { drag: false, ..linear.clone() }, None),
            ("linear, wind on particles", Cloth { wind: PARTICLE_WIND, ..linear.clone() }, None),
            ("linear, aerodynamic wind", Cloth { wind: AERODYNAMIC_WIND, ..linear.clone() }, None),
        ];
        let scenes = cloths.each_ref().map(|(_, cloth, _)| cloth.scene());
        let mut steppers: Vec<Stepper> = cloths
            .iter()
            .zip(&scenes)
            .map(|((_, cloth, _), scene)| Stepper::new(cloth, scene, set, &Workers::single()))
            .collect();
        let start = linear.state(&scenes[0], steppers[0].model());
        let memory = RefCell::new(start.clone());
        let competitors = steppers.iter_mut().map(|stepper| {
            let (start, memory) = (&start, &memory);
            let step = move |count| stepper.run(Clock::Thread, start, &mut memory.borrow_mut(), count);
            Competitor::new(linear.particles() as f64, step)
        });
        let samples = budget.compare(competitors.collect());
        for (index, (name, _, target)) in cloths.iter().enumerate() {
            let row = Row::time(format!("{}: {name}", set.name()), samples.time(index))
                .with_ratio(samples.ratio(index, 0))
                .about(json!({ "law": name, "instructions": set.name() }));
            rows.push(match target {
                Some(target) => row.with_target(*target),
                None => row,
            });
        }
    }
    let title = format!("laws of structural springs, and other forces, {WIDTH} x {WIDTH}, one thread");
    report.section("laws", &title, ["a particle-step", "relative to linear"], &rows)
}

/// Counts steps, those that were taken back, too.
#[derive(Default)]
pub(crate) struct StepCount(pub(crate) u64);

impl Observer for StepCount {
    fn step(&mut self, _model: &Model, _state: &State) {
        self.0 += 1;
    }

    fn refused_step(&mut self, _model: &Model, _state: &State) {
        self.0 += 1;
    }
}

/// Some frames of a run, again and again, so that there is the same to do in every round.
struct Excerpt {
    scene: Scene,
    /// Where it begins.
    first: State,
    simulation: Simulation,
}

/// Frame at which an [`Excerpt`] begins: the cloth falls and begins to pull at its pins.
const FIRST_FRAME: u64 = 12;
const LAST_FRAME: u64 = 15;

impl Excerpt {
    fn new(cloth: &Cloth) -> Self {
        let scene = cloth.scene();
        let method = Simulation::integrator(&scene, Workers::single());
        let mut simulation = Simulation::new(&scene, method).unwrap_or_else(|error| panic!("{error}"));
        for _ in 0..FIRST_FRAME {
            simulation.advance(&mut []).unwrap_or_else(|error| panic!("{error}"));
        }
        let first = simulation.frame().state.clone();
        Self { scene, first, simulation }
    }

    /// Steps to the end of the frame that holds step `count`, and the time of `count` steps.
    fn run(&mut self, count: u64) -> Duration {
        let (mut steps, mut time) = (StepCount::default(), Duration::ZERO);
        while steps.0 < count {
            if LAST_FRAME <= self.simulation.frame().index {
                let method = Simulation::integrator(&self.scene, Workers::single());
                let again = Simulation::resume(&self.scene, method, self.first.clone(), FIRST_FRAME);
                self.simulation = again.unwrap_or_else(|error| panic!("{error}"));
            }
            let start = Stopwatch::start(Clock::Thread);
            self.simulation.advance(&mut [&mut steps]).unwrap_or_else(|error| panic!("{error}"));
            time += start.elapsed();
        }
        time.mul_f64(count as f64 / steps.0 as f64)
    }
}

/// Measures what choosing the step adds to a step.
pub(crate) fn adaptive(report: &mut Report<impl Write>, budget: Budget) -> io::Result<()> {
    let mut rows = Vec::new();
    for (name, law) in [("linear", Cloth::LINEAR), ("tangent", Cloth::TANGENT)] {
        let cloth = Cloth { law, ..Cloth::new(ADAPTIVE_WIDTH) };
        let units = cloth.particles() as f64;
        let runs = [cloth.clone(), Cloth { adaptive: true, ..cloth }].map(|cloth| Excerpt::new(&cloth));
        let competitors = runs.map(|mut run| Competitor::new(units, move |count| run.run(count)));
        let samples = budget.compare(competitors.into());
        rows.push(Row::time(format!("{name}, constant step"), samples.time(0)));
        let row = Row::time(format!("{name}, adaptive step"), samples.time(1))
            .with_ratio(samples.ratio(1, 0))
            .with_target(Target::AtMost(1.15))
            .about(json!({ "law": name }));
        rows.push(row);
    }
    let title = format!(
        "adaptive against constant steps, {ADAPTIVE_WIDTH} x {ADAPTIVE_WIDTH}, one thread, steps taken back included"
    );
    report.section("adaptive", &title, ["a particle-step", "relative to constant"], &rows)
}
