//! `[fabric.NAME]`: what a cloth is made of.

use std::collections::BTreeMap;

use toml::de::DeTable;

use super::table::{Entry, Table};
use super::value::{NumberRule, Value};
use super::{curve, limit, measured};
use crate::scene::data::DataFiles;
use crate::scene::error::SceneErrorKind;
use crate::scene::{
    Fabric, ForceDirection, LibraryFabric, MeasuredFabric, SceneError, SpringLawSettings, SpringSettings,
    SpringsFabric,
};

pub(super) fn read(entry: Entry, files: &mut DataFiles) -> Result<BTreeMap<String, Fabric>, SceneError> {
    let help = "add a table `[fabric.NAME]` with `kind = \"springs\"`";
    let table = entry.required("", help)?.table("write `[fabric.NAME]`")?;
    let fabrics = table.into_named_values();
    fabrics.into_iter().map(|(name, fabric)| Ok((name.to_owned(), read_fabric(fabric, files)?))).collect()
}

/// The only fabric of `text`, whose `entries` are its keys, or a table `[fabric.NAME]` with them.
pub(super) fn read_alone(
    text: &str,
    entries: &DeTable<'_>,
    files: &mut DataFiles,
) -> Result<Fabric, SceneError> {
    let mut table = Table::new(text, String::new(), None, entries);
    if !table.peek("fabric").is_given() {
        return read_table(Table::new(text, "fabric".to_owned(), None, entries), files);
    }
    let fabrics = table.take("fabric");
    table.finish()?;
    let table = fabrics.required("", "write `[fabric.NAME]`")?;
    let mut values = table.clone().table("write `[fabric.NAME]`")?.into_named_values().into_iter();
    match (values.next(), values.next()) {
        (Some((_, only)), None) => read_fabric(only, files),
        (_, second) => Err(table.error(SceneErrorKind::Inconsistent {
            message: match second {
                Some(_) => "there is more than one fabric, but only one is read from a file".to_owned(),
                None => "`fabric` is empty, but must be a table `[fabric.NAME]`".to_owned(),
            },
            help: "give each fabric a file of its own".to_owned(),
        })),
    }
}

fn read_fabric(value: Value, files: &mut DataFiles) -> Result<Fabric, SceneError> {
    read_table(value.table("write `[fabric.NAME]`")?, files)
}

fn read_table(mut table: Table, files: &mut DataFiles) -> Result<Fabric, SceneError> {
    let kind = table.take("kind");
    let kind_name = match table.peek("kind").optional() {
        Some(kind) => kind.choice(
            "is not a kind of fabric",
            &[("springs", Kind::Springs), ("measured", Kind::Measured), ("library", Kind::Library)],
        )?,
        // Its keys tell what it is meant to be, so that only the kind is found missing.
        None if ["warp", "weft"].into_iter().any(|key| table.peek(key).is_given()) => Kind::Measured,
        None if table.peek("name").is_given() => Kind::Library,
        None => Kind::Springs,
    };
    Ok(match kind_name {
        Kind::Springs => Fabric::Springs(read_springs_fabric(table, &kind, files)?),
        Kind::Measured => Fabric::Measured(measured::read(table, &kind, files)?),
        Kind::Library => {
            let name = table.take("name");
            table.finish()?;
            require_kind(&kind)?;
            let name = name.required("", "write `name = \"...\"`; `muslin fabric list` has the names")?;
            let Some(fabric) = LibraryFabric::find(name.string()?) else {
                let names = LibraryFabric::ALL.map(LibraryFabric::name);
                return Err(name.unknown_name("no fabric of the library has that name", names));
            };
            Fabric::Measured(read_library(fabric.text())?)
        }
    })
}

/// A kind of fabric by its name.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Springs,
    Measured,
    Library,
}

/// The fabric of the library whose keys are in `text`.
pub(in crate::scene) fn read_library(text: &str) -> Result<MeasuredFabric, SceneError> {
    let entries =
        DeTable::parse(text).map_err(|error| super::not_toml(error.message(), error.span(), text))?;
    let mut table = Table::new(text, "fabric".to_owned(), None, entries.get_ref());
    let kind = table.take("kind");
    measured::read(table, &kind, &mut DataFiles::new(None))
}

/// Checks that a fabric has its `kind`.
pub(super) fn require_kind(kind: &Entry) -> Result<(), SceneError> {
    if kind.is_given() {
        return Ok(());
    }
    Err(kind.missing("", "write `kind = \"springs\"`, `kind = \"measured\"` or `kind = \"library\"`"))
}

/// What `table` holds, whose `kind` is that of springs or missing.
fn read_springs_fabric(
    mut table: Table,
    kind: &Entry,
    files: &mut DataFiles,
) -> Result<SpringsFabric, SceneError> {
    let particle_mass = table.take("particle_mass");
    let drag = table.take("drag");
    let force_direction = table.take("force_direction");
    let structural = table.take("structural");
    let shear = table.take("shear");
    let bend = table.take("bend");
    let limit = table.take("limit");
    table.finish()?;

    require_kind(kind)?;
    let (structural, shear) = (read_springs(structural, files)?, read_springs(shear, files)?);
    Ok(SpringsFabric {
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
    })
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
    let damping = table.take("damping");
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
    let damping = match damping.optional() {
        None => 0.0,
        Some(damping) => damping.number("kg/s", NumberRule::NotNegative)?,
    };
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
            damping,
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
    Ok(SpringSettings { stiffness: stiffness.number("N/m", NumberRule::NotNegative)?, law, damping })
}

/// Rejects a constant of the law `owner` under another `law`.
fn reject_constant(constant: Entry, law: &Value, owner: &str) -> Result<(), SceneError> {
    let Some(constant) = constant.optional() else { return Ok(()) };
    let message =
        format!("`{}` is of the law \"{owner}\", but the law is {}", constant.path, law.as_written());
    let help = format!("leave it out, or write `law = \"{owner}\"`");
    Err(constant.error(SceneErrorKind::Inconsistent { message, help }))
}
