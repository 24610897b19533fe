//! `[fabric.NAME]`: what a cloth is made of.

use std::collections::BTreeMap;

use super::table::{Entry, Table};
use super::value::{NumberRule, Value};
use crate::scene::{Fabric, ForceDirection, SceneError, SpringLawSettings, SpringSettings, SpringsFabric};

pub(super) fn read(entry: Entry) -> Result<BTreeMap<String, Fabric>, SceneError> {
    let help = "add a table `[fabric.NAME]` with `kind = \"springs\"`";
    let table = entry.required("", help)?.table("write `[fabric.NAME]`")?;
    let fabrics = table.into_named_values();
    fabrics.into_iter().map(|(name, fabric)| Ok((name.to_owned(), read_fabric(fabric)?))).collect()
}

#[derive(Clone, Copy)]
enum Kind {
    Springs,
    Measured,
}

fn read_fabric(value: Value) -> Result<Fabric, SceneError> {
    let mut table = value.table("write `[fabric.NAME]`")?;
    let kind = table.take("kind");
    if let Some(kind) = table.peek("kind").optional() {
        let kinds = [("springs", Kind::Springs), ("measured", Kind::Measured)];
        if let Kind::Measured = kind.choice("is not a kind of fabric", &kinds)? {
            return Err(kind.not_available("a measured fabric", "use `kind = \"springs\"`"));
        }
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

#[derive(Clone, Copy)]
enum Law {
    Linear,
    Later(&'static str),
}

fn read_springs(entry: Entry) -> Result<SpringSettings, SceneError> {
    const HELP: &str = "write `{ stiffness = k, law = \"linear\" }` with k in N/m; k = 0 for no springs";
    let mut table = entry.required("", HELP)?.table(HELP)?;
    let law = table.take("law");
    if let Some(law) = table.peek("law").optional() {
        let laws = [
            ("linear", Law::Linear),
            ("tangent", Law::Later("the spring law \"tangent\"")),
            ("arctangent-force", Law::Later("the spring law \"arctangent-force\"")),
            ("curve", Law::Later("the spring law \"curve\"")),
        ];
        if let Law::Later(what) = law.choice("is not the law of a spring", &laws)? {
            return Err(law.not_available(what, "use `law = \"linear\"`"));
        }
    }
    reject_limit(&table)?;
    let stiffness = table.take("stiffness");
    table.finish()?;

    law.required("", "write `law = \"linear\"`")?;
    Ok(SpringSettings {
        stiffness: stiffness.number("N/m", NumberRule::NotNegative)?,
        law: SpringLawSettings::Linear,
    })
}

fn reject_limit(table: &Table) -> Result<(), SceneError> {
    match table.peek("limit").optional() {
        None => Ok(()),
        Some(limit) => Err(limit.not_available("a strain limit", "leave it out")),
    }
}
