//! `[fabric.NAME]` with `kind = "measured"`.

mod keys;
mod tension;

use self::keys::{AREAL_DENSITY, BENDING_LENGTH, BIAS_EXTENSION, KES_RIGIDITY, KES_SHEAR, SHEAR_MODULUS};
use super::fabric::require_kind;
use super::quantity::{Quantity, twice};
use super::table::{Entry, Table, joined};
use super::value::{NumberRule, Value, rounded, with_decimals};
use crate::scene::data::DataFiles;
use crate::scene::error::SceneErrorKind;
use crate::scene::{
    BendingModel, BendingRigidity, Fabric, GridSettings, MeasuredFabric, MembraneTension, SceneError,
    rigidity_from_bending_length, shear_modulus_from_bias_extension, shear_modulus_per_radian,
};

/// What `table` holds, whose `kind` is that of measured fabrics or missing.
pub(super) fn read(
    mut table: Table,
    kind: &Entry,
    files: &mut DataFiles,
) -> Result<MeasuredFabric, SceneError> {
    let areal_density = Quantity::take(&mut table, "the mass per area", NumberRule::Positive, &AREAL_DENSITY);
    let drag = table.take("drag");
    let warp = table.take("warp");
    let weft = table.take("weft");
    let shear = table.take("shear");
    let bend = table.take("bend");
    table.finish()?;

    require_kind(kind)?;
    let areal_density = areal_density.required()?.si;
    let (bending, bending_model) = read_bending(bend, areal_density)?;
    Ok(MeasuredFabric {
        areal_density,
        drag: drag.number("kg/(s m^2)", NumberRule::NotNegative)?,
        warp: tension::read(warp, files)?,
        weft: tension::read(weft, files)?,
        shear_modulus: read_shear(shear)?,
        bending,
        bending_model,
    })
}

/// Shear modulus [N/m] per radian.
fn read_shear(entry: Entry) -> Result<f64, SceneError> {
    const HELP: &str =
        "write `shear = { modulus = ... }` [N/m], or with `g_gf_per_cm_deg` of KES or `eb5` of FAST";
    let mut table = entry.required("", HELP)?.table(HELP)?;
    let modulus = Quantity::take(&mut table, "the shear modulus", NumberRule::NotNegative, &SHEAR_MODULUS);
    let kes = Quantity::take(&mut table, "G of KES", NumberRule::NotNegative, &KES_SHEAR);
    let bias = Quantity::take(&mut table, "EB5 of FAST", NumberRule::Positive, &BIAS_EXTENSION);
    table.finish()?;

    let ways = [modulus.value(), kes.value(), bias.value()];
    check_ways(&ways, "the resistance to shear")?;
    if let Some(bias) = bias.optional()? {
        return Ok(shear_modulus_from_bias_extension(bias.si));
    }
    match kes.optional()? {
        Some(slope) => Ok(shear_modulus_per_radian(slope.si)),
        None => Ok(modulus.required_with(HELP)?.si),
    }
}

fn read_bending(entry: Entry, areal_density: f64) -> Result<(BendingRigidity, BendingModel), SceneError> {
    const HELP: &str = "write `bend = { warp = ..., weft = ... }` with rigidities in N m";
    let mut table = entry.required("", HELP)?.table(HELP)?;
    let warp = table.take("warp");
    let weft = table.take("weft");
    let bias = table.take("bias");
    let model = table.take("model");
    table.finish()?;

    let model = match model.optional() {
        None => BendingModel::default(),
        Some(name) => name.choice(
            "is not a model of bending",
            &[("second-differences", BendingModel::SecondDifferences), ("choi-ko", BendingModel::ChoiKo)],
        )?,
    };
    let warp = read_rigidity(warp.required("N m", RIGIDITY_HELP)?, areal_density)?;
    let weft = read_rigidity(weft.required("N m", RIGIDITY_HELP)?, areal_density)?;
    let least = 0.25 * (warp + weft);
    let Some(value) = bias.optional() else {
        // A strip at 45° bends as the mean of warp and weft, unless nothing resists twist.
        let twist = if model == BendingModel::ChoiKo { 0.0 } else { least };
        return Ok((BendingRigidity { warp, weft, twist }, model));
    };
    if model == BendingModel::ChoiKo {
        return Err(value.error(SceneErrorKind::Inconsistent {
            message: format!("`{}` is given, but links of the model \"choi-ko\" resist no twist", value.path),
            help: "leave it out, or leave out the model for second differences".to_owned(),
        }));
    }
    let bias = read_rigidity(value.clone(), areal_density)?;
    if bias < least {
        return Err(value.error(SceneErrorKind::Inconsistent {
            message: format!(
                "`{}` is {} N m, but must be at least a quarter of warp and weft together, {} N m",
                value.path,
                rounded(bias),
                rounded(least)
            ),
            help: "a strip at 45 degrees bends both yarns, and any resistance to twist comes on top"
                .to_owned(),
        }));
    }
    Ok((BendingRigidity { warp, weft, twist: bias - least }, model))
}

const RIGIDITY_HELP: &str =
    "write a rigidity [N m], or a table with `b_gf_cm2_per_cm` of KES or a `bending_length` [m]";

/// A rigidity [N m]: a number, or a table with one way to it.
fn read_rigidity(value: Value, areal_density: f64) -> Result<f64, SceneError> {
    if !value.value.is_table() {
        return value.number("N m", NumberRule::NotNegative);
    }
    let mut table = value.table("")?;
    let kes = Quantity::take(&mut table, "B of KES", NumberRule::NotNegative, &KES_RIGIDITY);
    let length = Quantity::take(&mut table, "the bending length", NumberRule::NotNegative, &BENDING_LENGTH);
    table.finish()?;

    check_ways(&[kes.value(), length.value()], "the rigidity")?;
    match length.optional()? {
        Some(length) => Ok(rigidity_from_bending_length(areal_density, length.si)),
        None => Ok(kes.required_with(RIGIDITY_HELP)?.si),
    }
}

/// `number` to 4 digits, for a message.
fn shown(number: f64) -> String {
    format!("{:?}", with_decimals(number, 3))
}

/// Checks that at most one of `ways` gives `what`.
fn check_ways(ways: &[Option<&Value>], what: &str) -> Result<(), SceneError> {
    let mut given = ways.iter().copied().flatten();
    match (given.next(), given.next()) {
        (Some(first), Some(second)) => Err(twice(first, second, what)),
        _ => Ok(()),
    }
}

/// Checks that a cloth of the fabric called `name` can have the grid that `value` gives.
pub(super) fn check_grid(
    name: &str,
    fabric: &Fabric,
    grid: GridSettings,
    value: &Value,
) -> Result<(), SceneError> {
    let Fabric::Measured(fabric) = fabric else { return Ok(()) };
    let (columns, rows) = (grid.columns, grid.rows);
    if columns < 2 || rows < 2 {
        return Err(value.error(SceneErrorKind::Inconsistent {
            message: format!(
                "`{}` has {columns} x {rows} particles, but a measured fabric needs at least 2 x 2",
                value.path
            ),
            help: "its constants are per width and area: give a strip of it two columns or rows".to_owned(),
        }));
    }
    check_springs(name, fabric, [grid.width / (columns - 1) as f64, grid.height / (rows - 1) as f64], value)
}

/// Checks that structural springs of cells of `spacings` [m] along weft and warp have something left to carry.
fn check_springs(
    name: &str,
    fabric: &MeasuredFabric,
    spacings: [f64; 2],
    grid: &Value,
) -> Result<(), SceneError> {
    let moduli = [fabric.weft.least_modulus(), fabric.warp.least_modulus()];
    let shares = fabric.shear_springs_share(spacings);
    let Some(conflict) = (0..2).find(|&yarns| moduli[yarns] <= shares[yarns]) else { return Ok(()) };
    let fabric_path = joined("fabric", name);
    let message = format!(
        "`{}` has cells of {} m x {} m, in which the shear springs of `{fabric_path}.shear` resist stretch along the {} \
         by {} N/m, but `{fabric_path}.{}` {} {} N/m",
        grid.path,
        shown(spacings[0]),
        shown(spacings[1]),
        ["weft", "warp"][conflict],
        shown(shares[conflict]),
        ["weft", "warp"][conflict],
        match [&fabric.weft, &fabric.warp][conflict] {
            MembraneTension::Curve(_) => "rises in its flattest part by only",
            _ => "has a modulus of only",
        },
        shown(moduli[conflict]),
    );
    let [narrowest, widest] = fabric.cell_ratios();
    let help = if narrowest < widest {
        format!(
            "take cells that are more than {} and less than {} times as wide as they are high",
            shown(narrowest),
            shown(widest)
        )
    } else {
        format!(
            "no cells can: springs cannot resist shear more than stretch; the shear modulus must be below {} N/m, and a \
             table must rise at least by that per strain",
            shown((moduli[0] * moduli[1]).sqrt())
        )
    };
    Err(grid.error(SceneErrorKind::Inconsistent { message, help }))
}
