//! `[fabric.NAME]`: what a cloth is made of.

use std::collections::BTreeMap;

use super::table::Entry;
use super::value::{NumberRule, Value};
use super::{curve, limit};
use crate::scene::data::DataFiles;
use crate::scene::error::SceneErrorKind;
use crate::scene::{Fabric, ForceDirection, SceneError, SpringLawSettings, SpringSettings, SpringsFabric};

pub(super) fn read(entry: Entry, files: &mut DataFiles) -> Result<BTreeMap<String, Fabric>, SceneError> {
    let help = "add a table `[fabric.NAME]` with `kind = \"springs\"`";
    let table = entry.required("", help)?.table("write `[fabric.NAME]`")?;
    let fabrics = table.into_named_values();
    fabrics.into_iter().map(|(name, fabric)| Ok((name.to_owned(), read_fabric(fabric, files)?))).collect()
}

fn read_fabric(value: Value, files: &mut DataFiles) -> Result<Fabric, SceneError> {
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
    let (structural, shear) = (read_springs(structural, files)?, read_springs(shear, files)?);
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
        bend: read_springs(bend, files)?,
        limit: limit.optional().map(|limit| limit::read(limit, &structural, &shear)).transpose()?,
        structural,
        shear,
    }))
}

/// A law by its name.
#[derive(Clone, Copy, PartialEq, Eq)]
enum LawKind {
    Linear,
    Tangent,
    ArctangentForce,
    Curve,
}

fn read_springs(entry: Entry, files: &mut DataFiles) -> Result<SpringSettings, SceneError> {
    const HELP: &str = "write `{ stiffness = k, law = \"linear\" }` with k in N/m; k = 0 for no springs";
    let mut table = entry.required("", HELP)?.table(HELP)?;
    let law = table.take("law");
    let stiffness = table.take("stiffness");
    let strain_scale = table.take("strain_scale");
    let curve = table.take("curve");
    table.finish()?;

    let law = law.required("", "write `law = \"linear\"`")?;
    let kind = law.choice(
        "is not the law of a spring",
        &[
            ("linear", LawKind::Linear),
            ("tangent", LawKind::Tangent),
            ("arctangent-force", LawKind::ArctangentForce),
            ("curve", LawKind::Curve),
        ],
    )?;
    if kind != LawKind::Tangent {
        reject_constant(strain_scale.clone(), &law, "tangent")?;
    }
    if kind == LawKind::Curve {
        if let Some(stiffness) = stiffness.optional() {
            let message = format!(
                "`{}` is given, but the law \"curve\" has its stiffness from its table",
                stiffness.path
            );
            return Err(
                stiffness.error(SceneErrorKind::Inconsistent { message, help: "leave it out".to_owned() })
            );
        }
        let file = curve.required("", "write `curve = \"FILE.csv\"`")?;
        return Ok(SpringSettings {
            stiffness: 0.0,
            law: SpringLawSettings::Curve(curve::read(&file, files)?),
        });
    }
    reject_constant(curve, &law, "curve")?;
    let law = match kind {
        LawKind::Tangent => {
            SpringLawSettings::Tangent { strain_scale: strain_scale.number("", NumberRule::Positive)? }
        }
        LawKind::ArctangentForce => SpringLawSettings::ArctangentForce,
        LawKind::Linear | LawKind::Curve => SpringLawSettings::Linear,
    };
    Ok(SpringSettings { stiffness: stiffness.number("N/m", NumberRule::NotNegative)?, law })
}

/// Rejects a constant of the law `owner` under another `law`.
fn reject_constant(constant: Entry, law: &Value, owner: &str) -> Result<(), SceneError> {
    let Some(constant) = constant.optional() else { return Ok(()) };
    let message =
        format!("`{}` is of the law \"{owner}\", but the law is {}", constant.path, law.as_written());
    let help = format!("leave it out, or write `law = \"{owner}\"`");
    Err(constant.error(SceneErrorKind::Inconsistent { message, help }))
}
