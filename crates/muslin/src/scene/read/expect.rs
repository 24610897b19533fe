//! `[expect]`: what the finished run must give.

use super::table::Entry;
use super::value::{NumberRule, Value};
use crate::scene::error::SceneErrorKind;
use crate::scene::{Expectation, ExpectedQuantity, ExpectedRange, SceneError};

/// Every quantity with its key and unit.
const QUANTITIES: [(ExpectedQuantity, &str, &str); 3] = [
    (ExpectedQuantity::MaxStrain, "max_strain", ""),
    (ExpectedQuantity::LowestPoint, "lowest_point", "m"),
    (ExpectedQuantity::EnergyResidual, "energy_residual", ""),
];

/// Reads the expectations of a scene that `has_structural_springs` or not.
pub(super) fn read(entry: Entry, has_structural_springs: bool) -> Result<Vec<Expectation>, SceneError> {
    let Some(value) = entry.optional() else {
        return Ok(Vec::new());
    };
    let mut table = value.table("write `[expect]`")?;
    let lines = QUANTITIES.map(|(quantity, key, unit)| (quantity, unit, table.take(key)));
    table.finish()?;

    let mut expectations = Vec::new();
    for (quantity, unit, line) in lines {
        if let Some(line) = line.optional() {
            if quantity == ExpectedQuantity::MaxStrain && !has_structural_springs {
                let message = format!("`{}` is of structural springs, but no cloth has any", line.path);
                let help = "leave it out".to_owned();
                return Err(line.error(SceneErrorKind::Inconsistent { message, help }));
            }
            let range = read_range(line.clone(), unit)?;
            expectations.push((line.span.start, Expectation { quantity, range }));
        }
    }
    // In the order of the text.
    expectations.sort_by_key(|(start, _)| *start);
    Ok(expectations.into_iter().map(|(_, expectation)| expectation).collect())
}

fn read_range(value: Value, unit: &'static str) -> Result<ExpectedRange, SceneError> {
    const HELP: &str = "write `{ below = b }`, `{ above = a }` or `{ between = [a, b] }`";
    let mut table = value.table(HELP)?;
    let below = table.take("below");
    let above = table.take("above");
    let between = table.take("between");
    table.finish()?;

    match (below.optional(), above.optional(), between.optional()) {
        (Some(below), None, None) => Ok(ExpectedRange::Below(below.number(unit, NumberRule::Finite)?)),
        (None, Some(above), None) => Ok(ExpectedRange::Above(above.number(unit, NumberRule::Finite)?)),
        (None, None, Some(between)) => read_between(&between, unit),
        _ => Err(table.error(SceneErrorKind::Inconsistent {
            message: format!("`{}` must have just one of below, above and between", table.path()),
            help: HELP.to_owned(),
        })),
    }
}

fn read_between(value: &Value, unit: &'static str) -> Result<ExpectedRange, SceneError> {
    let elements = value.elements("an array of 2 numbers", unit)?;
    let [least, most] = elements.as_slice() else {
        return Err(value.wrong_length(elements.len(), 2));
    };
    let (least, most) = (least.number(unit, NumberRule::Finite)?, most.number(unit, NumberRule::Finite)?);
    if most < least {
        return Err(value.out_of_range(unit, "be in ascending order", "write the smaller number first"));
    }
    Ok(ExpectedRange::Between(least, most))
}
