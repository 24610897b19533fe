//! `[environment]`: gravity and wind.

use super::table::{Entry, Table};
use super::value::NumberRule;
use crate::scene::{Environment, SceneError, WindSettings};

pub(super) fn read(entry: Entry) -> Result<Environment, SceneError> {
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
            tables.into_iter().map(read_wind).collect::<Result<_, _>>()?
        }
    };
    Ok(Environment { gravity, winds })
}

fn read_wind(mut table: Table) -> Result<WindSettings, SceneError> {
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
    let wind = WindSettings::ParticleForce {
        amplitude: amplitude.number("N", NumberRule::NotNegative)?,
        angular_frequency: angular_frequency.number("rad/s", NumberRule::NotNegative)?,
        phase: phase.number("rad", NumberRule::Finite)?,
        direction: direction.direction()?,
    };
    if let Some(noise) = noise.optional()
        && noise.number("N", NumberRule::NotNegative)? != 0.0
    {
        return Err(noise.not_available("wind noise", "write `noise = 0.0` or leave it out"));
    }
    if let Some(noise_time) = noise_time.optional() {
        noise_time.number("s", NumberRule::NotNegative)?;
    }
    Ok(wind)
}
