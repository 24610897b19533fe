//! `[fabric.NAME]` with `kind = "measured"`.

mod keys;
mod tension;

use self::keys::{
    AREAL_DENSITY, BENDING_LENGTH, BIAS_EXTENSION, DAMPING_TIME, KES_BENDING_HYSTERESIS, KES_RIGIDITY,
    KES_SHEAR, KES_SHEAR_HYSTERESIS, KES_SHEAR_HYSTERESIS_5, RIGIDITY, SHEAR_MODULUS,
};
use super::fabric::require_kind;
use super::quantity::{Quantity, twice};
use super::table::{Entry, Table, joined};
use super::value::{NumberRule, Value, rounded, with_decimals};
use crate::scene::data::DataFiles;
use crate::scene::error::SceneErrorKind;
use crate::scene::{
    BendingFriction, BendingModel, BendingRigidity, Fabric, GridSettings, InternalFriction, MeasuredFabric,
    MembraneTension, RetardationTimes, SceneError, ShearFriction, ShearFrictionError,
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
    let drag = drag.number("kg/(s m^2)", NumberRule::NotNegative)?;
    let warp = tension::read(warp, files)?;
    let weft = tension::read(weft, files)?;
    let shear = read_shear(shear)?;
    let bend = read_bending(bend, areal_density)?;
    Ok(MeasuredFabric {
        areal_density,
        drag,
        friction: InternalFriction {
            warp: warp.friction,
            weft: weft.friction,
            shear: shear.friction,
            warp_bend: bend.friction[0],
            weft_bend: bend.friction[1],
        },
        damping: RetardationTimes {
            warp: warp.damping_time,
            weft: weft.damping_time,
            shear: shear.damping_time,
            bend: bend.damping_time,
        },
        warp: warp.tension,
        weft: weft.tension,
        shear_modulus: shear.modulus,
        bending: bend.rigidity,
        bending_model: bend.model,
    })
}

/// What a table of shear holds.
struct Shear {
    /// Per radian [N/m].
    modulus: f64,
    friction: Option<ShearFriction>,
    /// Retardation time [s].
    damping_time: f64,
}

fn read_shear(entry: Entry) -> Result<Shear, SceneError> {
    const HELP: &str =
        "write `shear = { modulus = ... }` [N/m], or with `g_gf_per_cm_deg` of KES or `eb5` of FAST";
    let mut table = entry.required("", HELP)?.table(HELP)?;
    let modulus = Quantity::take(&mut table, "the shear modulus", NumberRule::NotNegative, &SHEAR_MODULUS);
    let kes = Quantity::take(&mut table, "G of KES", NumberRule::NotNegative, &KES_SHEAR);
    let bias = Quantity::take(&mut table, "EB5 of FAST", NumberRule::Positive, &BIAS_EXTENSION);
    let mut take = |name, spellings| Quantity::take(&mut table, name, NumberRule::NotNegative, spellings);
    let hysteresis = take("2HG of KES", &KES_SHEAR_HYSTERESIS[..]);
    let hysteresis_5 = take("2HG5 of KES", &KES_SHEAR_HYSTERESIS_5);
    let damping_time = take("the damping time", &DAMPING_TIME);
    table.finish()?;

    let ways = [modulus.value(), kes.value(), bias.value()];
    check_ways(&ways, "the resistance to shear")?;
    let modulus = match (bias.optional()?, kes.optional()?) {
        (Some(bias), _) => shear_modulus_from_bias_extension(bias.si),
        (None, Some(slope)) => shear_modulus_per_radian(slope.si),
        (None, None) => modulus.required_with(HELP)?.si,
    };
    let friction = read_shear_friction(hysteresis, hysteresis_5, modulus)?;
    let damping_time = damping_time.optional()?.map_or(0.0, |time| time.si);
    Ok(Shear { modulus, friction, damping_time })
}

/// Friction in shear of a fabric of this `modulus` [N/m], which is that of its loading curve.
fn read_shear_friction(
    hysteresis: Quantity,
    hysteresis_5: Quantity,
    modulus: f64,
) -> Result<Option<ShearFriction>, SceneError> {
    const HELP: &str = "write `2hg = ...` [N/m], the hysteresis at 0.5 degrees, beside that at 5 degrees";
    let Some(of_5) = hysteresis_5.optional()? else {
        let friction = hysteresis.optional()?.filter(|hysteresis| 0.0 < hysteresis.si);
        // Without a second value there is nothing to contradict.
        return Ok(friction.and_then(|hysteresis| ShearFriction::from_kes(hysteresis.si, None).ok()));
    };
    let hysteresis = hysteresis.required_with(HELP)?;
    if hysteresis.si == 0.0 && of_5.si == 0.0 {
        return Ok(None);
    }
    let inconsistent = |message: String, help: &str| {
        Err(of_5.value.error(SceneErrorKind::Inconsistent { message, help: help.to_owned() }))
    };
    let both = format!(
        "`{}` is {} N/m and `{}` {} N/m",
        of_5.value.path,
        shown(of_5.si),
        hysteresis.value.path,
        shown(hysteresis.si)
    );
    match ShearFriction::from_kes(hysteresis.si, Some(of_5.si)) {
        Err(ShearFrictionError::Falls) => inconsistent(
            format!("{both}, but the hysteresis at 5 degrees must be at least that at 0.5 degrees"),
            "yarns press harder on each other as the fabric is sheared: see that the two are not exchanged; for the same \
             hysteresis everywhere leave `2hg5` out",
        ),
        Err(_) => inconsistent(
            format!(
                "{both}, but the hysteresis at 5 degrees must be less than ten times that at 0.5 degrees"
            ),
            "a straight line through more would have none in the flat fabric",
        ),
        Ok(friction) if modulus < friction.growth => inconsistent(
            format!(
                "{both}: such friction grows by {} N/m per radian, but the shear modulus, which is that of the loading curve, \
                 is only {} N/m",
                shown(friction.growth),
                shown(modulus)
            ),
            "without friction the fabric would shear by itself: see that 2HG, 2HG5 and G are of one test and in the units of \
             their keys",
        ),
        Ok(friction) => Ok(Some(friction)),
    }
}

/// What a table of bending holds.
struct Bending {
    rigidity: BendingRigidity,
    model: BendingModel,
    /// Along warp and weft.
    friction: [Option<BendingFriction>; 2],
    /// Retardation time [s].
    damping_time: f64,
}

fn read_bending(entry: Entry, areal_density: f64) -> Result<Bending, SceneError> {
    const HELP: &str = "write `bend = { warp = ..., weft = ... }` with rigidities in N m";
    let mut table = entry.required("", HELP)?.table(HELP)?;
    let warp = table.take("warp");
    let weft = table.take("weft");
    let bias = table.take("bias");
    let damping_time = Quantity::take(&mut table, "the damping time", NumberRule::NotNegative, &DAMPING_TIME);
    let model = table.take("model");
    table.finish()?;
    let model = match model.optional() {
        None => BendingModel::default(),
        Some(name) => name.choice(
            "is not a model of bending",
            &[("second-differences", BendingModel::SecondDifferences), ("choi-ko", BendingModel::ChoiKo)],
        )?,
    };

    let (warp, warp_friction) = read_line(warp.required("N m", RIGIDITY_HELP)?, areal_density)?;
    let (weft, weft_friction) = read_line(weft.required("N m", RIGIDITY_HELP)?, areal_density)?;
    let twist = read_twist(bias, model, 0.25 * (warp + weft), areal_density)?;
    Ok(Bending {
        rigidity: BendingRigidity { warp, weft, twist },
        model,
        friction: [warp_friction, weft_friction],
        damping_time: damping_time.optional()?.map_or(0.0, |time| time.si),
    })
}

/// The rigidity [N m] against twist, where a strip at 45° without it would have the rigidity `least` [N m].
fn read_twist(bias: Entry, model: BendingModel, least: f64, areal_density: f64) -> Result<f64, SceneError> {
    let Some(value) = bias.optional() else {
        // Such a strip bends as the mean of warp and weft, unless nothing resists twist.
        return Ok(if model == BendingModel::ChoiKo { 0.0 } else { least });
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
    Ok(bias - least)
}

const RIGIDITY_HELP: &str = "write a rigidity [N m], or a table with a `rigidity` [N m], `b_gf_cm2_per_cm` of KES or a `bending_length` [m]";

/// A rigidity [N m] along yarns, and the friction beside it.
fn read_line(value: Value, areal_density: f64) -> Result<(f64, Option<BendingFriction>), SceneError> {
    if !value.value.is_table() {
        return Ok((value.number("N m", NumberRule::NotNegative)?, None));
    }
    let mut table = value.table("")?;
    let ways = RigidityEntries::take(&mut table);
    let hysteresis =
        Quantity::take(&mut table, "2HB of KES", NumberRule::NotNegative, &KES_BENDING_HYSTERESIS);
    table.finish()?;
    let rigidity = ways.read(areal_density)?;
    let hysteresis = hysteresis.optional()?.filter(|hysteresis| 0.0 < hysteresis.si);
    Ok((rigidity, hysteresis.map(|hysteresis| BendingFriction::from_kes(hysteresis.si))))
}

/// A rigidity [N m]: a number, or a table with one way to it.
fn read_rigidity(value: Value, areal_density: f64) -> Result<f64, SceneError> {
    if !value.value.is_table() {
        return value.number("N m", NumberRule::NotNegative);
    }
    let mut table = value.table("")?;
    let ways = RigidityEntries::take(&mut table);
    table.finish()?;
    ways.read(areal_density)
}

/// Ways to a rigidity.
struct RigidityEntries<'t> {
    rigidity: Quantity<'t>,
    kes: Quantity<'t>,
    bending_length: Quantity<'t>,
}

impl<'t> RigidityEntries<'t> {
    fn take(table: &mut Table<'t>) -> Self {
        let mut take = |name, spellings| Quantity::take(table, name, NumberRule::NotNegative, spellings);
        Self {
            rigidity: take("the rigidity", &RIGIDITY[..]),
            kes: take("B of KES", &KES_RIGIDITY),
            bending_length: take("the bending length", &BENDING_LENGTH),
        }
    }

    /// The rigidity [N m] of a fabric of `areal_density` [kg/m²], in one of the ways.
    fn read(self, areal_density: f64) -> Result<f64, SceneError> {
        let Self { rigidity, kes, bending_length } = self;
        check_ways(&[rigidity.value(), kes.value(), bending_length.value()], "the rigidity")?;
        match (bending_length.optional()?, kes.optional()?) {
            (Some(length), _) => Ok(rigidity_from_bending_length(areal_density, length.si)),
            (None, Some(kes)) => Ok(kes.si),
            (None, None) => Ok(rigidity.required_with(RIGIDITY_HELP)?.si),
        }
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
    let moduli = fabric.elastic_tensions().map(|tension| tension.least_modulus());
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
