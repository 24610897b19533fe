//! A mass per area with its unit, as a person writes it.

use muslin::scene::units::OUNCE_PER_SQUARE_YARD;

use crate::FitError;

/// Units of mass per area, each with kg/m² in one of it; ² may be written `^2` or `2`.
const UNITS: [(&str, f64); 3] = [("g/m2", 1e-3), ("kg/m2", 1.0), ("oz/yd2", OUNCE_PER_SQUARE_YARD)];

/// Masses per area [kg/m²] of anything that is cloth.
const DENSITIES: std::ops::RangeInclusive<f64> = 1e-3..=10.0;

/// Mass per area [kg/m²] from a number and a unit, as in `162.9 g/m2`.
///
/// # Errors
/// If there is no number or no unit, or cloth is not so heavy.
pub fn parse_areal_density(text: &str) -> Result<f64, FitError> {
    let text = text.trim();
    let end = text.find(|c: char| !(c.is_ascii_digit() || ".+-".contains(c))).unwrap_or(text.len());
    let (number, unit) = text.split_at(end);
    let unit = unit.trim().replace('²', "2").replace('^', "");
    let help = "write a number and a unit, as `162.9 g/m2`; units are g/m2, kg/m2 and oz/yd2";
    let parsed = number.parse::<f64>().ok().filter(|number| number.is_finite());
    let Some(number) = parsed else {
        return Err(FitError::inconsistent(
            format!("the mass per area is `{text}`, but must begin with a number"),
            help,
        ));
    };
    let Some((_, factor)) = UNITS.into_iter().find(|(known, _)| *known == unit) else {
        let message = if unit.is_empty() {
            format!("the mass per area is `{text}`, but must have a unit")
        } else if unit.starts_with(',') {
            format!("the mass per area is `{text}`, but must have a decimal point")
        } else {
            format!("the mass per area is `{text}`, in the unknown unit `{unit}`")
        };
        return Err(FitError::inconsistent(message, help));
    };
    let density = number * factor;
    if DENSITIES.contains(&density) {
        return Ok(density);
    }
    Err(FitError::inconsistent(
        format!("the mass per area is {text}, but must be from 1 g/m2 to 10 kg/m2"),
        "see that the unit is that of the number",
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_units() {
        for text in ["162.9 g/m2", "162.9g/m^2", " 0.1629 kg/m² "] {
            assert!(
                parse_areal_density(text).is_ok_and(|density| (density - 0.1629).abs() < 1e-15),
                "{text}"
            );
        }
        let ounces = parse_areal_density("11 oz/yd2").expect("a density");
        assert!((ounces - 0.372_963).abs() < 1e-6, "{ounces}");
    }
}
