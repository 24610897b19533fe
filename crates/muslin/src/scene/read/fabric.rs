//! `[fabric.NAME]`: what a cloth is made of.

use std::collections::BTreeMap;

use super::table::{Entry, Table};
use super::value::{NumberRule, Value};
use crate::scene::error::SceneErrorKind;
use crate::scene::{Fabric, ForceDirection, SceneError, SpringLawSettings, SpringSettings, SpringsFabric};

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
    reject_limit(&table)?;
    let particle_mass = table.take("particle_mass");
    let drag = table.take("drag");
    let force_direction = table.take("force_direction");
    let structural = table.take("structural");
    let shear = table.take("shear");
    let bend = table.take("bend");
    table.finish()?;

    kind.required("", "write `kind = \"springs\"`")?;
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
        structural: read_springs(structural)?,
        shear: read_springs(shear)?,
        bend: read_springs(bend)?,
    }))
}

fn read_springs(entry: Entry) -> Result<SpringSettings, SceneError> {
    const HELP: &str = "write `{ stiffness = k, law = \"linear\" }` with k in N/m; k = 0 for no springs";
    let mut table = entry.required("", HELP)?.table(HELP)?;
    let law = table.take("law");
    if let Some(law) = table.peek("law").optional() {
        law.reject_later(&[("curve", "the spring law \"curve\"")], "use `law = \"linear\"`")?;
    }
    reject_limit(&table)?;
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

fn reject_limit(table: &Table) -> Result<(), SceneError> {
    match table.peek("limit").optional() {
        None => Ok(()),
        Some(limit) => Err(limit.not_available("a strain limit", "leave it out")),
    }
}
