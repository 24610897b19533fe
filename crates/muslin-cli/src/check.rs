//! `muslin check`.

use std::io::{self, Write, stdout};
use std::time::{Duration, Instant};

use muslin::force::Family;
use muslin::integrate::{Workers, guaranteed_stable_step, largest_stable_step};
use muslin::scene::{Fabric, StepRule};
use muslin::{Model, Scene, Simulation, State, initial_step, suggested_step};

use crate::args::CheckArguments;
use crate::error::CliError;
use crate::fabric;
use crate::progress::{duration_text, significant};
use crate::run::{timed_integrator, unstable};
use crate::scene_file::SceneFile;
use crate::timing::SteppingTime;

/// How long the cost of a step is measured.
const MEASURED_TIME: Duration = Duration::from_millis(200);

/// Builds a scene and says what a run of it would be.
pub(crate) fn check(arguments: &CheckArguments) -> Result<(), CliError> {
    let SceneFile { scene, .. } = SceneFile::read(&arguments.scene, &arguments.assignments)?;
    let model = Model::new(&scene);
    let state = model.initial_state(&scene);
    let integrator = timed_integrator(&scene, None, &SteppingTime::default())?;
    CliError::print(write_check(&mut stdout().lock(), &scene, &model, &state, integrator.workers()))?;
    // The run's own check has the last word on the step.
    Simulation::new(&scene, integrator).map_err(|error| unstable(&error))?;
    let step = initial_step(&scene, &model, &state);
    let cost = measured_step_cost(&scene, &model, state)?;
    CliError::print(write_cost(&mut stdout().lock(), &scene, &model, step, cost))
}

fn write_check(
    out: &mut impl Write,
    scene: &Scene,
    model: &Model,
    state: &State,
    workers: &Workers,
) -> io::Result<()> {
    let particles = model.particles();
    writeln!(out, "{}", scene.title())?;
    for cloth in model.cloths() {
        let grid = cloth.grid;
        let mass: f64 = particles.masses()[grid.first_particle..][..grid.particle_count()].iter().sum();
        writeln!(
            out,
            "  cloth `{}`: {} x {} particles, {} kg together",
            cloth.name,
            grid.columns,
            grid.rows,
            significant(mass)
        )?;
    }
    for (name, fabric) in scene.fabrics() {
        if let Fabric::Measured(fabric) = fabric {
            writeln!(out, "  fabric `{name}`")?;
            for (what, value) in fabric::lines(fabric) {
                writeln!(out, "    {what:<18} {value}")?;
            }
        }
    }
    writeln!(out, "  particles            {}, {} of them pinned", particles.len(), particles.pins().count())?;
    for (family, count) in Family::ALL.iter().zip(model.spring_counts()) {
        writeln!(out, "  {:<20} {count}", format!("{} springs", family.name()))?;
    }
    let settings = scene.run();
    let step = initial_step(scene, model, state);
    let steps = (settings.duration / step).round();
    match settings.step {
        StepRule::Constant { .. } => {
            writeln!(out, "  step                 {} ({step:.12e} s), {steps} of them", duration_text(step))?;
        }
        StepRule::Adaptive { tolerance } => {
            let tolerance =
                tolerance.map_or_else(String::new, |e| format!(", or less for a tolerance of {e:?} m"));
            let step = duration_text(step);
            writeln!(out, "  step                 adaptive: {step} in the initial shape{tolerance}")?;
        }
    }
    let largest = largest_stable_step(model, state, workers);
    if largest.is_finite() {
        let guaranteed = guaranteed_stable_step(model, state);
        writeln!(out, "  largest stable step  {} in the initial shape", duration_text(largest))?;
        writeln!(out, "  stable for certain   {} (Gershgorin)", duration_text(guaranteed))?;
        if matches!(settings.step, StepRule::Constant { .. }) {
            let suggestion = suggested_step(settings.frame_rate, largest);
            writeln!(
                out,
                "  suggested            step = {{ constant = {suggestion:.12e} }}, or \"adaptive\""
            )?;
        }
    } else {
        writeln!(out, "  largest stable step  any: nothing is stiff")?;
    }
    out.flush()
}

/// Wall time [s] of one step on this machine.
fn measured_step_cost(scene: &Scene, model: &Model, mut state: State) -> Result<f64, CliError> {
    let mut integrator = timed_integrator(scene, None, &SteppingTime::default())?;
    // A step so short that nothing can go wrong costs as much as any other.
    let step = 1e-12;
    let start = Instant::now();
    let mut count = 0_u32;
    while start.elapsed() < MEASURED_TIME {
        integrator
            .step(model, &mut state, step)
            .map_err(|error| CliError::input(error, "check the quantities of the scene"))?;
        count += 1;
    }
    Ok(start.elapsed().as_secs_f64() / f64::from(count.max(1)))
}

fn write_cost(out: &mut impl Write, scene: &Scene, model: &Model, step: f64, cost: f64) -> io::Result<()> {
    let settings = scene.run();
    let steps = settings.duration / step;
    let bytes = (settings.frame_intervals + 1) as f64 * model.particles().len() as f64 * 48.0;
    writeln!(
        out,
        "  estimated cost       {} for the steps{}",
        duration_text(steps * cost),
        match settings.step {
            StepRule::Constant { .. } => "",
            StepRule::Adaptive { tolerance: None } => ", more if springs stiffen",
            StepRule::Adaptive { tolerance: Some(_) } =>
                ", more if springs stiffen or the tolerance asks for it",
        }
    )?;
    writeln!(out, "  estimated size       {} MB for trajectory.npz", significant(bytes * 1e-6))?;
    for warning in scene.warnings() {
        writeln!(out, "warning: {warning}")?;
    }
    out.flush()
}
