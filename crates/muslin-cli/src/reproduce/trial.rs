//! Single runs: the scene of a hanging cloth with some of its values changed, and what is measured of it.

use muslin::integrate::{Workers, guaranteed_stable_step, largest_stable_step};
use muslin::observe::{EnergyTerms, FrameRecord, Observer, Recorder, StepCounts, relative_residual};
use muslin::scene::set_value;
use muslin::{Model, Points, Scene, Simulation, State};

use super::progress::Progress;
use crate::error::CliError;
use crate::timing::{SteppingTime, TimedIntegrator};

/// The scene that all runs start from: the paper's Fig. 3.
pub(crate) const SCENE: &str = include_str!("../../../../scenes/hanging.toml");

/// Mass of the cloth of [`SCENE`] [kg].
const MASS: f64 = 0.2;

/// Drag of all its particles together [kg/s].
const DRAG: f64 = 0.2;

/// Frames written per simulated second [1/s].
pub(crate) const FRAME_RATE: f64 = 60.0;

/// A way to keep springs from stretching too far, or not to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reading {
    /// Short name in tables and legends.
    pub(crate) name: &'static str,
    /// How the scene changes, as by `--set`.
    pub(crate) assignments: &'static [&'static str],
    /// What it takes the paper's curve for.
    pub(crate) meaning: &'static str,
    /// Number of its colour in every figure.
    pub(crate) colour: usize,
    /// Steps per frame on a grid of 10 x 10 that leave no doubt about stability.
    pub(crate) steps_per_frame: u64,
    /// Whether the motion tends to a limit as the step gets shorter, so that steps may be chosen freely.
    pub(crate) converges: bool,
}

/// The readings that are compared.
pub(crate) const READINGS: [Reading; 5] = [
    Reading {
        name: "none",
        assignments: &[],
        meaning: "No limit: Hooke's law.",
        colour: 0,
        steps_per_frame: 20,
        converges: true,
    },
    Reading {
        name: "cut-off",
        assignments: &["fabric.paper.limit={ kind = \"cut-off\", strain = 0.1 }"],
        meaning: "Fig. 4 (a), the earlier method: after each step, what is longer than 1.1 L is shortened to that, spring after \
                  spring, up to eight times.",
        colour: 3,
        steps_per_frame: 20,
        converges: false,
    },
    Reading {
        name: "projection",
        assignments: &["fabric.paper.limit={ kind = \"arctangent-projection\" }"],
        meaning: "The curve to the letter, as a length: after each step every spring is given the elongation y for its x. That adds \
                  a stiffness of (1 / 0.3π − 1) m / h² to a mass m, which grows without end as the step h gets shorter.",
        colour: 4,
        steps_per_frame: 20,
        converges: false,
    },
    Reading {
        name: "tangent",
        assignments: &[
            "fabric.paper.structural={ stiffness = 60.0, law = \"tangent\", strain_scale = 0.06 }",
        ],
        meaning: "The curve turned round into a law of tension, f = k x where the elongation is y.",
        colour: 1,
        steps_per_frame: 60,
        converges: true,
    },
    Reading {
        name: "softening",
        assignments: &["fabric.paper.structural.law=arctangent-force"],
        meaning: "The curve as the elongation in Hooke's law, f = k y: a spring that carries no load above 0.03π k L.",
        colour: 2,
        steps_per_frame: 20,
        converges: true,
    },
];

/// The reading `name`.
pub(crate) fn reading(name: &str) -> Reading {
    let found = READINGS.into_iter().find(|reading| reading.name == name);
    found.unwrap_or_else(|| panic!("there is a reading `{name}`"))
}

/// A run to make.
#[derive(Clone, Debug)]
pub(crate) struct Trial {
    /// What progress says of it.
    pub(crate) name: String,
    /// How much work it is about, to tell progress.
    pub(crate) work: f64,
    /// How [`SCENE`] changes, as by `--set`.
    pub(crate) assignments: Vec<String>,
    /// Whether positions of every frame are kept.
    pub(crate) keeps_positions: bool,
    /// Whether the stability is watched along the way.
    pub(crate) watches_stability: bool,
    /// Whether the mean of the fastest frequency is found, which costs much on a fine grid.
    pub(crate) watches_frequency: bool,
}

/// How steps are chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Steps {
    /// So many between two frames.
    PerFrame(u64),
    /// As long as stability allows.
    Adaptive,
    /// As long as stability and an error per frame [m] allow.
    Tolerance(f64),
}

impl Trial {
    /// The hanging cloth with `side` x `side` particles of the same total mass and drag, under `reading`.
    pub(crate) fn new(reading: Reading, side: usize, duration: f64, steps: Steps) -> Self {
        let particles = (side * side) as f64;
        let (mass, drag) = (MASS / particles, DRAG / particles);
        let mut assignments = vec![
            format!("run.duration={duration}"),
            format!("cloth.0.grid.columns={side}"),
            format!("cloth.0.grid.rows={side}"),
            format!("fabric.paper.particle_mass={mass:e}"),
            format!("fabric.paper.drag={drag:e}"),
        ];
        match steps {
            Steps::PerFrame(count) => {
                assignments
                    .push(format!("run.step={{ constant = {:.15e} }}", 1.0 / (FRAME_RATE * count as f64)));
            }
            Steps::Adaptive => assignments.push("run.step=adaptive".to_owned()),
            Steps::Tolerance(tolerance) => {
                assignments.push(format!("run.step={{ tolerance = {tolerance:e} }}"));
            }
        }
        assignments.extend(reading.assignments.iter().map(|assignment| (*assignment).to_owned()));
        Self {
            name: format!("{} on {side} x {side}", reading.name),
            work: duration * particles * particles.sqrt() * reading.steps_per_frame as f64,
            assignments,
            keeps_positions: false,
            watches_stability: false,
            watches_frequency: false,
        }
    }

    /// The same run with the positions of its frames kept.
    pub(crate) fn keeping_positions(self) -> Self {
        Self { keeps_positions: true, ..self }
    }

    /// The same run with its fastest frequency watched.
    pub(crate) fn watching_frequency(self) -> Self {
        Self { watches_frequency: true, ..self }
    }

    /// The same run with its stability watched.
    pub(crate) fn watching_stability(self) -> Self {
        Self { watches_stability: true, ..self }
    }

    /// The scene.
    pub(crate) fn scene(&self) -> Scene {
        let text = self.assignments.iter().fold(SCENE.to_owned(), |text, assignment| {
            set_value(&text, assignment)
                .unwrap_or_else(|error| panic!("{}", error.render(assignment, assignment)))
        });
        // A slip in a list above, which any run of the command shows.
        Scene::parse(&text).unwrap_or_else(|error| panic!("{}", error.render(&self.name, &text)))
    }
}

/// What came out of a run.
#[derive(Clone, Debug)]
pub(crate) struct Outcome {
    /// Frames up to the end, or to where the run failed.
    pub(crate) frames: Vec<FrameRecord>,
    /// Positions [m] of every frame, if they were to be kept.
    pub(crate) positions: Vec<Points>,
    /// Largest strain [1] of a structural spring over all steps.
    pub(crate) max_strain: f64,
    pub(crate) steps: StepCounts,
    /// Wall time [s] of the steps alone.
    pub(crate) stepping_seconds: f64,
    /// Largest stable step [s] in the stiffest state on the way, if it was watched.
    pub(crate) stable_step: f64,
    /// Mean of the largest stable frequency 2/h [rad/s] over the run, if it was watched.
    pub(crate) mean_frequency: f64,
    /// Why it ended early, if it did.
    pub(crate) failure: Option<String>,
}

impl Outcome {
    /// Largest residual of the energy ledger, relative to the largest change of any term.
    pub(crate) fn residual(&self) -> f64 {
        relative_residual(self.frames.iter().map(|frame| &frame.energies))
    }

    /// Terms of the energy ledger in every frame.
    pub(crate) fn energies(&self) -> impl Iterator<Item = (f64, &EnergyTerms)> {
        self.frames.iter().map(|frame| (frame.time, &frame.energies))
    }

    /// Largest change [J] of any term of the energy ledger but its residual.
    pub(crate) fn largest_change(&self) -> f64 {
        let Some(first) = self.frames.first() else { return f64::NAN };
        let names = EnergyTerms::NAMES;
        let terms = (0..names.len()).filter(|term| names[*term] != "residual");
        let changes = terms.flat_map(|term| {
            let start = first.energies.values()[term];
            self.frames.iter().map(move |frame| (frame.energies.values()[term] - start).abs())
        });
        changes.fold(0.0, f64::max)
    }

    /// Largest structural strain [1] in every frame, against time [s].
    pub(crate) fn strains(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.frames.iter().map(|frame| [frame.time, frame.strains[0].map_or(f64::NAN, |strain| strain.max)])
    }

    /// Largest distance [m] of any particle in any frame from where it is in `other`.
    pub(crate) fn distance_to(&self, other: &Self) -> f64 {
        if self.positions.len() != other.positions.len() {
            return f64::INFINITY;
        }
        let frames = self.positions.iter().zip(&other.positions);
        let squares = frames.flat_map(|(a, b)| a.iter().zip(b.iter()).map(|(a, b)| a.distance_squared(b)));
        squares.fold(0.0, f64::max).sqrt()
    }
}

/// Runs `trial` on one thread.
pub(crate) fn run(trial: &Trial, progress: &Progress<'_>) -> Result<Outcome, CliError> {
    let scene = trial.scene();
    let time = SteppingTime::default();
    let integrator = Simulation::integrator(&scene, Workers::single());
    let integrator = Box::new(TimedIntegrator::new(integrator, time.clone()));
    let mut simulation = Simulation::new(&scene, integrator).map_err(|error| crate::run::unstable(&error))?;
    let mut recorder = Recorder::default();
    let mut watch = StabilityWatch::new(trial, scene.run().duration);
    let mut ticker = Ticker { progress, trial, duration: scene.run().duration };
    let mut positions = Vec::new();
    simulation.observe(&mut [&mut recorder]);
    let mut failure = None;
    loop {
        if trial.keeps_positions {
            positions.push(simulation.frame().state.positions.clone());
        }
        if simulation.is_finished() || failure.is_some() {
            break;
        }
        progress.require_going_on()?;
        if let Err(error) = simulation.advance(&mut [&mut recorder, &mut watch, &mut ticker]) {
            failure = Some(crate::run::failure(simulation.model(), &error));
        }
    }
    progress.finished(trial);
    Ok(Outcome {
        stable_step: watch.stable_step(simulation.model()),
        mean_frequency: watch.mean_frequency(),
        max_strain: recorder.max_strains()[0].unwrap_or(f64::NAN),
        steps: *recorder.steps(),
        frames: recorder.frames().to_vec(),
        stepping_seconds: time.seconds(),
        positions,
        failure,
    })
}

/// Simulated time [s] between two looks at the stability.
const WATCH_INTERVAL: f64 = 2e-3;

/// How often in a run its fastest frequency is looked at for the mean.
const FREQUENCY_SAMPLES: f64 = 60.0;

/// Keeps the stiffest state of a run, and the mean of its fastest frequency.
struct StabilityWatch {
    is_watching: bool,
    is_sampling: bool,
    sample_interval: f64,
    next_sample: f64,
    /// 2/h [rad/s] of the largest stable step h at evenly spaced times.
    frequencies: Vec<f64>,
    next_time: f64,
    smallest: f64,
    stiffest: Option<State>,
}

impl StabilityWatch {
    fn new(trial: &Trial, duration: f64) -> Self {
        let (is_watching, is_sampling) = (trial.watches_stability, trial.watches_frequency);
        let (sample_interval, frequencies) = (duration / FREQUENCY_SAMPLES, Vec::new());
        let next_sample = 0.5 * sample_interval;
        Self {
            is_watching,
            is_sampling,
            sample_interval,
            next_sample,
            frequencies,
            next_time: 0.0,
            smallest: f64::INFINITY,
            stiffest: None,
        }
    }

    /// The mean of 2/h [rad/s]; not a number where there is none.
    fn mean_frequency(&self) -> f64 {
        self.frequencies.iter().sum::<f64>() / self.frequencies.len() as f64
    }

    /// The largest stable step [s] in the stiffest state.
    fn stable_step(&self, model: &Model) -> f64 {
        self.stiffest.as_ref().map_or(f64::NAN, |state| largest_stable_step(model, state, &Workers::single()))
    }
}

impl Observer for StabilityWatch {
    fn step(&mut self, model: &Model, state: &State) {
        if self.is_sampling && self.next_sample <= state.time {
            self.next_sample += self.sample_interval;
            self.frequencies.push(2.0 / largest_stable_step(model, state, &Workers::single()));
        }
        if !self.is_watching || state.time < self.next_time {
            return;
        }
        self.next_time = state.time + WATCH_INTERVAL;
        // The cheap bound finds the state; the costly one is then asked once.
        let step = guaranteed_stable_step(model, state);
        if step < self.smallest {
            self.smallest = step;
            self.stiffest = Some(state.clone());
        }
    }
}

/// Tells progress of every step.
struct Ticker<'a, 'p> {
    progress: &'a Progress<'p>,
    trial: &'a Trial,
    duration: f64,
}

impl Observer for Ticker<'_, '_> {
    fn step(&mut self, _model: &Model, state: &State) {
        self.progress.reached(self.trial, state.time / self.duration);
    }
}
