//! Units of textile instruments, exactly.

/// Standard gravity [m/s²], by definition; a gram-force is the weight of a gram under it.
pub const STANDARD_GRAVITY: f64 = 9.806_65;

/// N/m per gf/cm.
pub const GRAM_FORCE_PER_CM: f64 = 0.980_665;

/// J/m² per gf cm/cm².
pub const GRAM_FORCE_CM_PER_CM2: f64 = 0.980_665;

/// N m per gf cm²/cm, of a rigidity per width.
pub const GRAM_FORCE_CM2_PER_CM: f64 = 9.806_65e-5;

/// N per gf cm/cm, of a moment per width.
pub(crate) const GRAM_FORCE_CM_PER_CM: f64 = 9.806_65e-3;

/// kg/m² per oz/yd²: 28.349523125 g by 0.9144² m², both by definition.
pub const OUNCE_PER_SQUARE_YARD: f64 = 0.028_349_523_125 / (0.9144 * 0.9144);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_follow_from_their_parts() {
        let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 4.0 * f64::EPSILON, "{a} and {b}");
        let gram_force = 1e-3 * STANDARD_GRAVITY;
        close(GRAM_FORCE_PER_CM, gram_force / 0.01);
        close(GRAM_FORCE_CM_PER_CM2, gram_force * 0.01 / 1e-4);
        close(GRAM_FORCE_CM2_PER_CM, gram_force * 1e-4 / 0.01);
        close(GRAM_FORCE_CM_PER_CM, gram_force * 0.01 / 0.01);
        assert!((OUNCE_PER_SQUARE_YARD - 0.033_905_75).abs() < 5e-9);
    }
}
