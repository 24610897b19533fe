//! `[environment]`: gravity and wind.

use glam::DVec3;

use super::table::{Entry, Table};
use super::value::{NumberRule, Value};
use crate::scene::error::SceneErrorKind;
use crate::scene::{AirSettings, Environment, GustSettings, NoiseSettings, SceneError, WindSettings};

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
            let mut constants = None;
            let winds = tables.into_iter().map(|table| read_wind(table, duration, &mut constants));
            winds.collect::<Result<_, _>>()?
        }
    };
    Ok(Environment { gravity, winds })
}

/// Density and coefficients of the first aerodynamic wind, with which those of all others must agree.
type AirConstants<'t> = Option<[(Value<'t>, f64); 3]>;

/// `constants` are those of earlier winds.
fn read_wind<'t>(
    mut table: Table<'t>,
    duration: f64,
    constants: &mut AirConstants<'t>,
) -> Result<WindSettings, SceneError> {
    // The law first: which keys there are depends on it.
    let help = "write `law = \"particle-force\"` or `law = \"aerodynamic\"`";
    let law = table.take("law").required("", help)?;
    let laws = [("particle-force", false), ("aerodynamic", true)];
    let pushes_faces = law.choice("is not the law of a wind", &laws)?;
    if pushes_faces {
        read_air(table, duration, constants).map(WindSettings::Aerodynamic)
    } else {
        read_particle_force(table, duration).map(WindSettings::ParticleForce)
    }
}

fn read_particle_force(mut table: Table, duration: f64) -> Result<GustSettings, SceneError> {
    let amplitude = table.take("amplitude");
    let angular_frequency = table.take("angular_frequency");
    let phase = table.take("phase");
    let direction = table.take("direction");
    let noise = table.take("noise");
    let noise_time = table.take("noise_time");
    table.finish()?;

    Ok(GustSettings {
        amplitude: amplitude.number("N", NumberRule::NotNegative)?,
        angular_frequency: angular_frequency.number("rad/s", NumberRule::NotNegative)?,
        phase: phase.number("rad", NumberRule::Finite)?,
        direction: direction.direction()?,
        noise: read_noise(noise, noise_time, &NoiseRules { unit: "N", may_be_white: true, duration })?,
    })
}

fn read_air<'t>(
    mut table: Table<'t>,
    duration: f64,
    constants: &mut AirConstants<'t>,
) -> Result<AirSettings, SceneError> {
    let velocity = table.take("velocity");
    let amplitude = table.take("amplitude");
    let angular_frequency = table.take("angular_frequency");
    let phase = table.take("phase");
    let direction = table.take("direction");
    let noise = table.take("noise");
    let noise_time = table.take("noise_time");
    let entries = ["air_density", "normal_coefficient", "tangential_coefficient"].map(|key| table.take(key));
    table.finish()?;

    let velocity = velocity.vector("m/s")?;
    // The sine is given whole or not at all.
    let has_sine = [&amplitude, &angular_frequency, &phase].into_iter().any(Entry::is_given);
    let [amplitude, angular_frequency, phase] = if has_sine {
        [
            amplitude.number("m/s", NumberRule::NotNegative)?,
            angular_frequency.number("rad/s", NumberRule::NotNegative)?,
            phase.number("rad", NumberRule::Finite)?,
        ]
    } else {
        [0.0; 3]
    };
    let noise = read_noise(noise, noise_time, &NoiseRules { unit: "m/s", may_be_white: false, duration })?;
    let is_gusty = 0.0 < amplitude || noise.is_some();
    let direction = read_air_direction(direction, velocity, is_gusty)?;
    let gust = is_gusty.then_some(GustSettings { amplitude, angular_frequency, phase, direction, noise });
    let [air_density, normal_coefficient, tangential_coefficient] = read_air_constants(entries, constants)?;
    Ok(AirSettings { velocity, gust, air_density, normal_coefficient, tangential_coefficient })
}

/// The direction of sine and noise: along the mean velocity unless it is given, and zero where none is needed.
fn read_air_direction(entry: Entry, velocity: DVec3, is_gusty: bool) -> Result<DVec3, SceneError> {
    let speed = velocity.length();
    if is_gusty && speed == 0.0 {
        let help = "write `direction = [x, y, z]`: without a mean velocity, sine and noise have none";
        return entry.required("", help)?.direction();
    }
    match entry.optional() {
        Some(direction) => direction.direction(),
        None if speed == 0.0 => Ok(DVec3::ZERO),
        None => Ok(velocity / speed + DVec3::ZERO),
    }
}

/// Density and coefficients; the velocities of all winds make up one, so there is one air and one law of its force.
fn read_air_constants<'t>(
    entries: [Entry<'t>; 3],
    constants: &mut AirConstants<'t>,
) -> Result<[f64; 3], SceneError> {
    let read = |entry: Entry<'t>, unit, rule, help| {
        let value = entry.required(unit, help)?;
        let number = value.number(unit, rule)?;
        Ok((value, number))
    };
    let not_negative = NumberRule::NotNegative;
    let [density, normal, tangential] = entries;
    let found = [
        read(density, "kg/m^3", NumberRule::Positive, "write `air_density = 1.2`, that of air in a room")?,
        read(normal, "", not_negative, "write `normal_coefficient = ...`; 1.2 to 2 for flat plates")?,
        read(tangential, "", not_negative, "write `tangential_coefficient = ...`; 0 for no friction")?,
    ];
    let first = constants.get_or_insert_with(|| found.clone());
    for ((value, number), (first, expected)) in found.iter().zip(first.iter()) {
        if number != expected {
            let message = format!(
                "`{}` is {number:?}, but `{}` is {expected:?}, and there is only one air",
                value.path, first.path
            );
            let help = "write the same in every aerodynamic wind: their velocities add up to one".to_owned();
            return Err(value.error(SceneErrorKind::Inconsistent { message, help }));
        }
    }
    Ok(found.map(|(_, number)| number))
}

/// What the noise of a wind must be like.
struct NoiseRules {
    /// Unit of its deviation.
    unit: &'static str,
    /// Whether its time may be zero.
    may_be_white: bool,
    /// Duration of the run [s].
    duration: f64,
}

/// A deviation of zero is no noise, whatever its time.
fn read_noise(
    deviation: Entry,
    time: Entry,
    rules: &NoiseRules,
) -> Result<Option<NoiseSettings>, SceneError> {
    let deviation = match deviation.optional() {
        None => 0.0,
        Some(value) => value.number(rules.unit, NumberRule::NotNegative)?,
    };
    if deviation == 0.0 {
        if let Some(value) = time.optional() {
            value.number("s", NumberRule::NotNegative)?;
        }
        return Ok(None);
    }
    let help = if rules.may_be_white {
        "write `noise_time = ...`, or 0 for a new value at each step, as the paper prints it"
    } else {
        "write `noise_time = ...`, the time over which a gust lasts"
    };
    let value = time.required("s", help)?;
    let time = value.number("s", NumberRule::NotNegative)?;
    let shortest = SHORTEST_NOISE_TIME * rules.duration;
    if time < shortest && !(rules.may_be_white && time == 0.0) {
        let zero = if rules.may_be_white { "0 or " } else { "" };
        let rule = format!("be {zero}at least {shortest:e} s, a hundred-thousandth of the run");
        return Err(value.out_of_range("s", &rule, ""));
    }
    Ok(Some(NoiseSettings { deviation, time }))
}
