//! The step against the plain scalar loop, and against the machine's floor.

use std::cell::RefCell;
use std::io::{self, Write};

use glam::DVec3;
use muslin::integrate::Workers;
use serde_json::json;

use super::clock::Clock;
use super::cloth::Cloth;
use super::floor::{Bytes, Operations, particles_at_once, run_operations};
use super::instruction_set::InstructionSet;
use super::measure::{Budget, Competitor};
use super::stepper::{Stepper, instruction_sets};
use super::table::{Report, Row, Target};
use super::textbook::{Loop, Textbook};

/// Widths of the grids that are compared; the targets hold for all but the first.
const WIDTHS: [usize; 5] = [10, 64, 128, 256, 512];

/// The width at which the operations on registers are reported, to which no width matters.
const REGISTERS: usize = 64;

/// How far the library's positions may be from those of the plain loop after [`SAME_STEPS`] [m]. Both do the same in another
/// order, and one rounding is 1e-16 of a metre.
const SAME: f64 = 1e-9;
const SAME_STEPS: u64 = 200;

/// Stiffnesses [N/m] of the families of [`Cloth::LINEAR`].
const STIFFNESSES: [f64; 3] = [500.0, 150.0, 60.0];

const GRAVITY: DVec3 = DVec3::new(0.0, -9.81, 0.0);

/// How many times as fast as the plain loop the step should be.
fn least_speed(instructions: InstructionSet) -> f64 {
    match instructions {
        InstructionSet::Baseline => 1.8,
        InstructionSet::Avx2 => 3.5,
        InstructionSet::Avx512 => 6.0,
    }
}

/// Measures the step against the plain loop, width by width.
pub(crate) fn against_the_textbook(report: &mut Report<impl Write>, budget: Budget) -> io::Result<()> {
    let mut rows = vec![Row::value("largest difference of positions", check_motion(), "m")];
    for width in WIDTHS {
        let cloth = Cloth::new(width);
        let scene = cloth.scene();
        let sets = instruction_sets();
        let mut steppers: Vec<Stepper> =
            sets.iter().map(|&set| Stepper::new(&cloth, &scene, set, &Workers::single())).collect();
        let start = cloth.state(&scene, steppers[0].model());
        let memory = RefCell::new(start.clone());
        let textbook = |kind| {
            let (model, step) = (steppers[0].model(), steppers[0].step());
            Textbook::new(model, &start, STIFFNESSES, GRAVITY, step, kind)
        };
        let [mut by_neighbours, mut by_list] = [Loop::Neighbours, Loop::List].map(textbook);
        let units = cloth.particles() as f64;
        let mut competitors = vec![
            Competitor::of(units, move |count| by_neighbours.run(count)),
            Competitor::of(units, move |count| by_list.run(count)),
        ];
        competitors.extend(steppers.iter_mut().map(|stepper| {
            let (start, memory) = (&start, &memory);
            Competitor::new(units, move |count| {
                stepper.run(Clock::Thread, start, &mut memory.borrow_mut(), count)
            })
        }));
        let samples = budget.compare(competitors);
        rows.push(Row::time(format!("{width}: plain loop over neighbours"), samples.time(0)));
        rows.push(Row::time(format!("{width}: plain loop over a list"), samples.time(1)));
        for (index, set) in sets.into_iter().enumerate() {
            let name = set.name();
            rows.push(Row::time(format!("{width}: muslin, {name}"), samples.time(2 + index)));
            for (rival, what) in ["neighbours", "list"].into_iter().enumerate() {
                let row = Row::ratio(
                    format!("{width}: muslin, {name}, against {what}"),
                    samples.ratio(rival, 2 + index),
                )
                .about(json!({ "width": width, "instructions": name, "rival": what }));
                rows.push(row.with_target_if(width != WIDTHS[0], Target::AtLeast(least_speed(set))));
            }
        }
    }
    let title = "linear springs, one thread, against a plain scalar loop over an array of structures";
    report.section("textbook", title, ["a particle-step", "times as fast"], &rows)
}

/// The largest difference [m] of the library's positions to those of both plain loops, over all particles and coordinates.
///
/// # Panics
/// If it is too large for the same motion.
fn check_motion() -> f64 {
    let cloth = Cloth::new(33);
    let scene = cloth.scene();
    let mut largest = 0.0_f64;
    for set in instruction_sets() {
        let mut stepper = Stepper::new(&cloth, &scene, set, &Workers::single());
        let start = cloth.state(&scene, stepper.model());
        let mut state = start.clone();
        stepper.run(Clock::Thread, &start, &mut state, SAME_STEPS);
        for kind in [Loop::Neighbours, Loop::List] {
            let (model, step) = (stepper.model(), stepper.step());
            let mut textbook = Textbook::new(model, &start, STIFFNESSES, GRAVITY, step, kind);
            textbook.run(SAME_STEPS);
            let moved = start.positions.iter().zip(textbook.positions()).map(|(a, b)| a.distance(b));
            assert!(moved.fold(0.0, f64::max) > 1e3 * SAME, "the cloth moves");
            let differences =
                state.positions.iter().zip(textbook.positions()).map(|(a, b)| (a - b).abs().max_element());
            let difference = differences.fold(0.0, |a, b| if b <= a { a } else { b });
            assert!(difference < SAME, "{kind:?}: positions differ by {difference:e} m");
            largest = largest.max(difference);
        }
    }
    largest
}

/// Measures the step against the same arithmetic on registers, and the same bytes of memory.
pub(crate) fn against_the_floor(report: &mut Report<impl Write>, budget: Budget) -> io::Result<()> {
    let (mut registers, mut rows) = (Vec::new(), Vec::new());
    for width in WIDTHS {
        let cloth = Cloth::new(width);
        let scene = cloth.scene();
        let units = cloth.particles() as f64;
        for set in InstructionSet::available() {
            let is_usable = instruction_sets().contains(&set);
            let used = if is_usable { set } else { InstructionSet::Baseline };
            let mut stepper = Stepper::new(&cloth, &scene, used, &Workers::single());
            let start = cloth.state(&scene, stepper.model());
            let (mut memory, mut bytes) = (start.clone(), Bytes::new(cloth.particles()));
            let operations = |by_seed| {
                let units = particles_at_once(set) as f64;
                Competitor::new(units, move |count| run_operations(set, by_seed, count))
            };
            let mut competitors = vec![
                operations(true),
                operations(false),
                Competitor::of(units, move |count| bytes.run(count)),
            ];
            if is_usable {
                let step = |count| stepper.run(Clock::Thread, &start, &mut memory, count);
                competitors.push(Competitor::new(units, step));
            }
            let samples = budget.compare(competitors);
            let name = set.name();
            if width == REGISTERS {
                for (index, what) in ["operations", "operations with √ and ÷"].into_iter().enumerate() {
                    registers.push(Row::time(format!("{name}, {what}"), samples.time(index)));
                }
            }
            if is_usable {
                rows.push(Row::time(format!("{width}: {name}, bytes"), samples.time(2)));
                let row = Row::time(format!("{width}: {name}, muslin"), samples.time(3))
                    .with_ratio(samples.ratio_to_largest(3, &[0, 2]))
                    .about(json!({ "width": width, "instructions": name }));
                rows.push(row.with_target_if(width != WIDTHS[0], Target::AtMost(1.5)));
            }
        }
    }
    registers.append(&mut rows);
    let Operations { additions, multiplications, seeds, .. } = Operations::SEED;
    let root = Operations::ROOT;
    report.note(&format!(
        "\nfloors per particle: {additions} + −, {multiplications} ×, {seeds} seeds of 1/√; or {} + −, {} ×, {} ÷, {} √; \
         or 48 bytes read and written",
        root.additions, root.multiplications, root.divisions, root.square_roots
    ))?;
    let title = "linear springs, one thread, against the same operations on registers and the same bytes";
    report.section("floor", title, ["a particle-step", "times the higher floor"], &registers)
}
