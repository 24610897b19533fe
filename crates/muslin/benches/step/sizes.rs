//! Sizes of grids, instruction sets and threads.

use std::cell::RefCell;
use std::io::{self, Write};
use std::num::NonZeroUsize;

use muslin::integrate::Workers;
use serde_json::json;

use super::clock::{Clock, Stopwatch};
use super::cloth::Cloth;
use super::floor::{particles_at_once, run_operations};
use super::instruction_set::InstructionSet;
use super::machine::cores;
use super::measure::{Budget, Competitor, Spread};
use super::stepper::{Stepper, instruction_sets};
use super::table::{Report, Row, Target};

const WIDTHS: [usize; 10] = [10, 16, 32, 64, 100, 128, 256, 512, 1024, 2048];

/// The width that the others are compared with.
const REFERENCE: usize = 256;

/// From this width on a second thread should nearly halve the time; below, it should do no harm.
const WIDE: usize = 128;

/// How much slower several threads may be on a small grid [1], where they must do no harm: what cannot be told from noise.
const NO_HARM: f64 = 0.97;

/// Instructions and threads.
#[derive(Clone, Copy)]
struct Way {
    instructions: InstructionSet,
    threads: usize,
}

/// Every set of instructions with every number of threads.
fn ways() -> Vec<Way> {
    let mut threads = vec![1, 2, cores()];
    threads.retain(|&count| count <= cores());
    threads.dedup();
    instruction_sets()
        .into_iter()
        .flat_map(|instructions| threads.iter().map(move |&threads| Way { instructions, threads }))
        .collect()
}

/// A cloth with all that moves it.
struct Bench {
    cloth: Cloth,
    steppers: Vec<Stepper>,
}

impl Bench {
    fn new(width: usize, ways: &[Way], workers: &[Workers]) -> Self {
        let cloth = Cloth::new(width);
        let scene = cloth.scene();
        let stepper =
            |(way, workers): (&Way, &Workers)| Stepper::new(&cloth, &scene, way.instructions, workers);
        let steppers = ways.iter().zip(workers).map(stepper).collect();
        Self { cloth, steppers }
    }
}

/// Measures grids of all widths.
pub(crate) fn by_size(report: &mut Report<impl Write>, budget: Budget) -> io::Result<()> {
    let budget = budget.with_long_turns();
    let ways = ways();
    let workers: Vec<Workers> = ways.iter().map(|way| workers(way.threads)).collect();
    let mut rows = Vec::new();
    if 1 < cores() {
        let label = "registers alone, 2 threads, times as fast as 1";
        rows.push(Row::ratio(label, two_threads(budget)));
    }
    for width in WIDTHS {
        // The reference takes part in every comparison, so that its ratios are of one round, too.
        let mut benches = [Bench::new(width, &ways, &workers), Bench::new(REFERENCE, &ways, &workers)];
        let starts = benches.each_ref().map(|bench| {
            let scene = bench.cloth.scene();
            bench.cloth.state(&scene, bench.steppers[0].model())
        });
        let memories = starts.each_ref().map(|start| RefCell::new(start.clone()));
        let mut competitors = Vec::new();
        for (bench, (start, memory)) in benches.iter_mut().zip(starts.iter().zip(&memories)) {
            let units = bench.cloth.particles() as f64;
            competitors.extend(bench.steppers.iter_mut().map(|stepper| {
                Competitor::new(units, move |count| {
                    stepper.run(Clock::Wall, start, &mut memory.borrow_mut(), count)
                })
            }));
        }
        let samples = budget.compare(competitors);
        for (index, way) in ways.iter().enumerate() {
            let name = way.instructions.name();
            let label = format!("{width}: {name}, {}", threads_text(way.threads));
            let about = json!({ "width": width, "instructions": name, "threads": way.threads });
            let row = Row::time(label, samples.time(index))
                .with_ratio(samples.ratio(index, ways.len() + index))
                .about(about);
            rows.push(row.with_target_if(width == 2048, Target::AtMost(1.5)));
            if width == WIDTHS[0] && way.threads == 1 && Some(way.instructions) == best() {
                let step = samples.time(index).times(1e-3 * (width * width) as f64);
                let row = Row::value(format!("{width}: {name}, a whole step"), step.median, "µs");
                rows.push(row.with_target(Target::AtMost(1.5)));
            }
            if 1 < way.threads {
                let one =
                    index - ways[..index].iter().rev().position(|way| way.threads == 1).unwrap_or(0) - 1;
                let label = format!("{width}: {name}, {} threads, times as fast as 1", way.threads);
                let row = Row::ratio(label, samples.ratio(one, index));
                let target = if width < WIDE { NO_HARM } else { 1.8 };
                rows.push(row.with_target_if(way.threads == 2 || width < WIDE, Target::AtLeast(target)));
            }
        }
    }
    let title =
        format!("linear springs, by width, instructions and threads, against {REFERENCE} in the same way");
    report.section("sizes", &title, ["a particle-step", "relative to 256"], &rows)
}

/// How many times as fast two threads do arithmetic on registers here: all that a step can hope for.
fn two_threads(budget: Budget) -> Spread {
    let instructions = InstructionSet::Baseline;
    let units = particles_at_once(instructions) as f64;
    let wall = |work: &dyn Fn()| {
        let stopwatch = Stopwatch::start(Clock::Wall);
        work();
        stopwatch.elapsed()
    };
    let workers = workers(2);
    let work = |count| {
        run_operations(instructions, true, count);
    };
    let one = move |count| wall(&|| work(count));
    let two = move |count| {
        wall(&|| {
            workers.install(|| rayon::join(|| work(count), || work(count)));
        })
    };
    let samples = budget.compare(vec![Competitor::new(units, one), Competitor::new(2.0 * units, two)]);
    samples.ratio(0, 1)
}

/// The widest instructions that the library can use here.
fn best() -> Option<InstructionSet> {
    instruction_sets().last().copied()
}

fn threads_text(count: usize) -> String {
    format!("{count} thread{}", if count == 1 { "" } else { "s" })
}

fn workers(threads: usize) -> Workers {
    let threads = NonZeroUsize::new(threads).unwrap_or(NonZeroUsize::MIN);
    Workers::new(threads).unwrap_or_else(|error| panic!("{error}"))
}
