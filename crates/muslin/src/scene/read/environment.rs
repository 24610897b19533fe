//! `[environment]`: gravity and wind.

use super::table::{Entry, Table};
use super::value::NumberRule;
use crate::scene::{Environment, NoiseSettings, SceneError, WindSettings};

/// Shortest correlation time of noise but zero, relative to the duration of the run.
const SHORTEST_NOISE_TIME: f64 = 1e-5;

pub(super) fn read(entry: Entry, duration: f64) -> Result<Environment, SceneError> {
    let help = "add a table `[environment]` with `gravity = [0.0, -9.81, 0.0]`";
    let mut table = entry.required("", help)?.table("write `[environment]`")?;
    let gravity = table.take("gravity");
    let winds = table.take("wind");
    table.finish()?;

    let gravity = gravity.vector("m/s^2")?;
    let winds = match winds.optional() {
        None => Vec::new(),
        Some(winds) => {
            let tables = winds.tables("write `[[environment.wind]]`, one for each wind")?;
            tables.into_iter().map(|table| read_wind(table, duration)).collect::<Result<_, _>>()?
        }
    };
    Ok(Environment { gravity, winds })
}

fn read_wind(mut table: Table, duration: f64) -> Result<WindSettings, SceneError> {
    let law = table.take("law");
    if let Some(law) = table.peek("law").optional() {
        law.reject_later(&[("aerodynamic", "aerodynamic wind")], "use `law = \"particle-force\"`")?;
        law.choice("is not the law of a wind", &[("particle-force", ())])?;
    }
    let amplitude = table.take("amplitude");
    let angular_frequency = table.take("angular_frequency");
    let phase = table.take("phase");
    let direction = table.take("direction");
    let noise = table.take("noise");
    let noise_time = table.take("noise_time");
    table.finish()?;

    law.required("", "write `law = \"particle-force\"`")?;
    Ok(WindSettings::ParticleForce {
        amplitude: amplitude.number("N", NumberRule::NotNegative)?,
        angular_frequency: angular_frequency.number("rad/s", NumberRule::NotNegative)?,
        phase: phase.number("rad", NumberRule::Finite)?,
        direction: direction.direction()?,
        noise: read_noise(noise, noise_time, duration)?,
    })
}

/// A deviation of zero is no noise, whatever its time.
fn read_noise(deviation: Entry, time: Entry, duration: f64) -> Result<Option<NoiseSettings>, SceneError> {
    let deviation = match deviation.optional() {
        None => 0.0,
        Some(value) => value.number("N", NumberRule::NotNegative)?,
    };
    if deviation == 0.0 {
        if let Some(value) = time.optional() {
            value.number("s", NumberRule::NotNegative)?;
        }
        return Ok(None);
    }
    let value = time.required(
        "s",
        "write `noise_time = ...`, or 0 for a new value at each step, as the paper prints it",
    )?;
    let time = value.number("s", NumberRule::NotNegative)?;
    let shortest = SHORTEST_NOISE_TIME * duration;
    if 0.0 < time && time < shortest {
        let rule = format!("be 0 or at least {shortest:e} s, a hundred-thousandth of the run");
        return Err(value.out_of_range("s", &rule, ""));
    }
    Ok(Some(NoiseSettings { deviation, time }))
}
