//! Steps whose instructions somebody else counts: a given number of them, and nothing else that depends on it.

use muslin::integrate::Workers;
use muslin::{Model, Simulation};

use super::clock::Clock;
use super::cloth::Cloth;
use super::laws::StepCount;
use super::stepper::{Stepper, instruction_sets};

/// Names of what can be counted.
pub(crate) const CASES: [&str; 6] =
    ["linear-100", "linear-10", "measured-100", "friction-100", "linear-adaptive-60", "tangent-adaptive-32"];

/// Takes `count` steps of the case `name`, or those of as many frames where the step is adaptive. Says with which instructions,
/// and how many steps of a particle that were; `None` if there is no such case.
pub(crate) fn run(name: &str, count: u64) -> Option<String> {
    let instructions = instruction_sets().pop()?;
    let particle_steps = match name {
        "linear-100" => constant_steps(&Cloth::new(100), count),
        "linear-10" => constant_steps(&Cloth::new(10), count),
        "measured-100" => constant_steps(&Cloth { measured: true, ..Cloth::new(100) }, count),
        "friction-100" => constant_steps(&Cloth { measured: true, friction: true, ..Cloth::new(100) }, count),
        "linear-adaptive-60" => adaptive_steps(Cloth::LINEAR, 60, count),
        "tangent-adaptive-32" => adaptive_steps(Cloth::TANGENT, 32, count),
        _ => return None,
    };
    Some(format!("{} {particle_steps}", instructions.name()))
}

fn constant_steps(cloth: &Cloth, count: u64) -> u64 {
    let scene = cloth.scene();
    let Some(instructions) = instruction_sets().pop() else { return 0 };
    let mut stepper = Stepper::new(cloth, &scene, instructions, &Workers::single());
    let start = cloth.state(&scene, stepper.model());
    // Nobody looks at the time, and rustix has no thread's time under valgrind.
    stepper.run(Clock::Wall, &start, &mut start.clone(), count);
    count * cloth.particles() as u64
}

fn adaptive_steps(law: &'static str, width: usize, frames: u64) -> u64 {
    let cloth = Cloth { law, adaptive: true, ..Cloth::new(width) };
    let scene = cloth.scene();
    let state = cloth.state(&scene, &Model::new(&scene));
    let method = Simulation::integrator(&scene, Workers::single());
    let mut steps = StepCount::default();
    let mut simulation =
        Simulation::resume(&scene, method, state, 0).unwrap_or_else(|error| panic!("{error}"));
    for _ in 0..frames {
        simulation.advance(&mut [&mut steps]).unwrap_or_else(|error| panic!("{error}"));
    }
    steps.0 * cloth.particles() as u64
}
