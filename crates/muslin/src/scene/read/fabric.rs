//! `[fabric.NAME]`: what a cloth is made of.

use std::collections::BTreeMap;

use super::table::Entry;
use super::value::{NumberRule, Value};
use crate::scene::error::SceneErrorKind;
use crate::scene::{
    Fabric, ForceDirection, LimitSettings, SceneError, SpringLawSettings, SpringSettings, SpringsFabric,
};

pub(super) fn read(entry: Entry) -> Result<BTreeMap<String, Fabric>, SceneError> {
    let help = "add a table `[fabric.NAME]` with `kind = \"springs\"`";
    let table = entry.required("", help)?.table("write `[fabric.NAME]`")?;
    let fabrics = table.into_named_values();
    fabrics.into_iter().map(|(name, fabric)| Ok((name.to_owned(), read_fabric(fabric)?))).collect()
}

fn read_fabric(value: Value) -> Result<Fabric, SceneError> {
    let mut table = value.table("write `[fabric.NAME]`")?;
    let kind = table.take("kind");
    if let Some(kind) = table.peek("kind").optional() {
        kind.reject_later(&[("measured", "a measured fabric")], "use `kind = \"springs\"`")?;
        kind.choice("is not a kind of fabric", &[("springs", ())])?;
    }
    let particle_mass = table.take("particle_mass");
    let drag = table.take("drag");
    let force_direction = table.take("force_direction");
    let structural = table.take("structural");
    let shear = table.take("shear");
    let bend = table.take("bend");
    let limit = table.take("limit");
    table.finish()?;

    kind.required("", "write `kind = \"springs\"`")?;
    let (structural, shear) = (read_springs(structural)?, read_springs(shear)?);
    Ok(Fabric::Springs(SpringsFabric {
        particle_mass: particle_mass.number("kg", NumberRule::Positive)?,
        drag: drag.number("kg/s", NumberRule::NotNegative)?,
        force_direction: match force_direction.optional() {
            None => ForceDirection::CurrentLength,
            Some(name) => name.choice(
                "is not a force direction",
                &[
                    ("current-length", ForceDirection::CurrentLength),
                    ("rest-length", ForceDirection::RestLength),
                ],
            )?,
        },
        bend: read_springs(bend)?,
        limit: limit.optional().map(|limit| read_limit(limit, structural, shear)).transpose()?,
        structural,
        shear,
    }))
}

fn read_springs(entry: Entry) -> Result<SpringSettings, SceneError> {
    const HELP: &str = "write `{ stiffness = k, law = \"linear\" }` with k in N/m; k = 0 for no springs";
    let mut table = entry.required("", HELP)?.table(HELP)?;
    let law = table.take("law");
    if let Some(law) = table.peek("law").optional() {
        law.reject_later(&[("curve", "the spring law \"curve\"")], "use `law = \"linear\"`")?;
    }
    let stiffness = table.take("stiffness");
    let strain_scale = table.take("strain_scale");
    table.finish()?;

    let known = [
        ("linear", SpringLawSettings::Linear),
        ("tangent", SpringLawSettings::Tangent { strain_scale: 1.0 }),
        ("arctangent-force", SpringLawSettings::ArctangentForce),
    ];
    let law_value = law.required("", "write `law = \"linear\"`")?;
    let mut law = law_value.choice("is not the law of a spring", &known)?;
    if let SpringLawSettings::Tangent { strain_scale: scale } = &mut law {
        *scale = strain_scale.number("", NumberRule::Positive)?;
    } else if let Some(scale) = strain_scale.optional() {
        let message =
            format!("`{}` is of the law \"tangent\", but the law is {}", scale.path, law_value.as_written());
        let help = "leave it out, or write `law = \"tangent\"`".to_owned();
        return Err(scale.error(SceneErrorKind::Inconsistent { message, help }));
    }
    Ok(SpringSettings { stiffness: stiffness.number("N/m", NumberRule::NotNegative)?, law })
}

/// Passes of a cut-off after each step, unless the scene says otherwise.
const DEFAULT_PASSES: u32 = 8;

/// Passes at most: more would take longer than a step that is so much smaller.
const MAX_PASSES: i64 = 1000;

fn read_limit(
    value: Value,
    structural: SpringSettings,
    shear: SpringSettings,
) -> Result<LimitSettings, SceneError> {
    const HELP: &str = "write `limit = { kind = \"cut-off\", strain = 0.1 }`";
    let mut table = value.clone().table(HELP)?;
    let kind = table.take("kind");
    let is_cut_off = match table.peek("kind").optional() {
        Some(kind) => {
            kind.choice("is not a kind of limit", &[("cut-off", true), ("arctangent-projection", false)])?
        }
        None => true,
    };
    let [strain, shear_strain, passes] = if is_cut_off {
        ["strain", "shear_strain", "passes"].map(|key| Some(table.take(key)))
    } else {
        [const { None }; 3]
    };
    table.finish()?;

    kind.required("", HELP)?;
    check_springs(&value, "structural", structural)?;
    let (Some(strain), Some(shear_strain), Some(passes)) = (strain, shear_strain, passes) else {
        return Ok(LimitSettings::ArctangentProjection);
    };
    let shear_strain = shear_strain.optional();
    if let Some(strain) = &shear_strain {
        check_springs(strain, "shear", shear)?;
    }
    let passes = passes.optional().map(|passes| passes.integer(1, MAX_PASSES)).transpose()?;
    Ok(LimitSettings::CutOff {
        strain: strain.number("", NumberRule::NotNegative)?,
        shear_strain: shear_strain.map(|strain| strain.number("", NumberRule::NotNegative)).transpose()?,
        passes: passes.map_or(DEFAULT_PASSES, |passes| passes as u32),
    })
}

/// Checks that the springs that `value` limits exist.
fn check_springs(value: &Value, family: &str, springs: SpringSettings) -> Result<(), SceneError> {
    if 0.0 < springs.stiffness {
        return Ok(());
    }
    Err(value.error(SceneErrorKind::Inconsistent {
        message: format!(
            "`{}` is of {family} springs, but their stiffness is 0, so that there are none",
            value.path
        ),
        help: "leave it out, or give these springs a stiffness".to_owned(),
    }))
}
