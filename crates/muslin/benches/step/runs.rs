//! Whole runs, and the memory of a step.

use std::fs::File;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::time::{Duration, Instant};

use muslin::integrate::Workers;
use muslin::observe::{Frame, Observer, Recorder};
use muslin::scene::set_value;
use muslin::write::write_points;
use muslin::{Model, Scene, Simulation};
use serde_json::json;

use super::clock::Clock;
use super::cloth::Cloth;
use super::measure::{Budget, Competitor};
use super::memory::live_bytes;
use super::stepper::{Stepper, instruction_sets};
use super::table::{Report, Row, Target};

const HANGING: &str = include_str!("../../../../scenes/hanging.toml");

const WIDTHS: [usize; 6] = [10, 32, 64, 100, 128, 256];

/// The width of the grid for the memory of a step, and for what writing may cost.
const WIDE: usize = 256;

/// The cloth of `hanging` with `width` x `width` particles: of the same size, mass and springs, and as far below the largest
/// stable step.
fn hanging(width: usize) -> Scene {
    let share = 100.0 / (width * width) as f64;
    let steps_per_frame = 2 * width;
    let changes = [
        format!("cloth.0.grid.columns={width}"),
        format!("cloth.0.grid.rows={width}"),
        format!("fabric.paper.particle_mass={:e}", 0.002 * share),
        format!("fabric.paper.drag={:e}", 0.002 * share),
        format!("run.step.constant={:e}", 1.0 / (60 * steps_per_frame) as f64),
        "run.duration=1e4".to_owned(), // which no measurement reaches
    ];
    let text = changes.iter().try_fold(HANGING.to_owned(), |text, change| set_value(&text, change));
    let text = text.unwrap_or_else(|error| panic!("{error}"));
    Scene::parse(&text).unwrap_or_else(|error| panic!("{}", error.render("hanging", &text)))
}

/// Writes each frame over the one before, so that a file stays small.
struct FrameWriter(BufWriter<File>);

impl Observer for FrameWriter {
    fn frame(&mut self, _model: &Model, frame: &Frame<'_>) {
        let mut write = || {
            self.0.seek(SeekFrom::Start(0))?;
            write_points(&mut self.0, &frame.state.positions)?;
            write_points(&mut self.0, frame.velocities)?;
            self.0.flush()
        };
        write().unwrap_or_else(|error| panic!("a frame cannot be written: {error}"));
    }
}

/// Advances `simulation` by `count` frames under `observers`.
fn advance(simulation: &mut Simulation, observers: &mut [&mut dyn Observer], count: u64) -> Duration {
    let start = Instant::now();
    for _ in 0..count {
        simulation.advance(observers).unwrap_or_else(|error| panic!("{error}"));
    }
    start.elapsed()
}

/// Measures whole runs: steps alone, with the record of every run, and with frames written as well.
pub(crate) fn whole_runs(report: &mut Report<impl Write>, budget: Budget) -> io::Result<()> {
    let mut rows = Vec::new();
    let path = std::env::temp_dir().join(format!("muslin-bench-{}", std::process::id()));
    for width in WIDTHS {
        let scene = hanging(width);
        let start = || {
            let method = Simulation::integrator(&scene, Workers::single());
            Simulation::new(&scene, method).unwrap_or_else(|error| panic!("{error}"))
        };
        let [mut alone, mut recorded, mut written] = [start(), start(), start()];
        let [mut recorder, mut other_recorder] = [Recorder::default(), Recorder::default()];
        recorded.observe(&mut [&mut recorder]);
        written.observe(&mut [&mut other_recorder]);
        let mut writer = FrameWriter(BufWriter::with_capacity(1 << 20, File::create(&path)?));
        let samples = budget.compare(vec![
            Competitor::new(1.0, |count| advance(&mut alone, &mut [], count)),
            Competitor::new(1.0, |count| advance(&mut recorded, &mut [&mut recorder], count)),
            Competitor::new(1.0, |count| {
                advance(&mut written, &mut [&mut other_recorder, &mut writer], count)
            }),
        ]);
        let frame_rate = scene.run().frame_rate;
        let names = ["steps alone", "recorded", "recorded and frames written"];
        for (index, name) in names.into_iter().enumerate() {
            let speed = samples.time(index).times(1e-9 * frame_rate).inverse().median;
            let row = Row::value(format!("{width}: {name}"), speed, "s/s")
                .about(json!({ "width": width, "run": name }));
            rows.push(match index {
                0 => row,
                1 => row.with_ratio(samples.ratio(1, 0)),
                _ => row.with_ratio(samples.ratio(2, 1)).with_target_if(width == WIDE, Target::AtMost(1.11)),
            });
        }
    }
    std::fs::remove_file(&path)?;
    let title =
        "the cloth of `hanging` by width, one thread, 60 frames a second; frames go to a temporary file";
    report.section("runs", title, ["simulated", "time relative to the line above"], &rows)
}

/// Measures the memory of a model, a state and what moves it.
pub(crate) fn memory(report: &mut Report<impl Write>, _budget: Budget) -> io::Result<()> {
    let cloth = Cloth::new(WIDE);
    let scene = cloth.scene();
    let mut rows = Vec::new();
    for set in instruction_sets() {
        let before = live_bytes();
        let mut stepper = Stepper::new(&cloth, &scene, set, &Workers::single());
        let start = cloth.state(&scene, stepper.model());
        let with_one_state = live_bytes();
        let mut state = start.clone();
        let of_state = live_bytes() - with_one_state;
        stepper.run(Clock::Thread, &start, &mut state, 2);
        let bytes = (live_bytes() - before - of_state) as f64 / cloth.particles() as f64;
        let row = Row::value(format!("{}: model, state, scratch", set.name()), bytes, "B");
        rows.push(row.with_target(Target::AtMost(160.0)).about(json!({ "instructions": set.name() })));
    }
    report.section("memory", &format!("what a step keeps, {WIDE} x {WIDE}"), ["a particle", ""], &rows)
}
