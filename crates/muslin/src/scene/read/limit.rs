//! `fabric.NAME.limit`: what keeps springs from becoming too long.

use super::value::{NumberRule, Value};
use crate::scene::error::SceneErrorKind;
use crate::scene::{LimitSettings, SceneError, SpringSettings};

/// Passes of a cut-off after each step, unless the scene says otherwise.
const DEFAULT_PASSES: u32 = 8;

/// Passes at most: more would take longer than a step that is so much smaller.
const MAX_PASSES: i64 = 1000;

pub(super) fn read(
    value: Value,
    structural: &SpringSettings,
    shear: &SpringSettings,
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
fn check_springs(value: &Value, family: &str, springs: &SpringSettings) -> Result<(), SceneError> {
    if springs.has_springs() {
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
