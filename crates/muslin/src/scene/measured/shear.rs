//! Shear moduli from what instruments measure.

use std::f64::consts::PI;

use super::units::GRAM_FORCE_PER_CM;

/// Tension per width [N/m] of the bias extension of FAST: 5 gf/cm.
const BIAS_TENSION: f64 = 5.0 * GRAM_FORCE_PER_CM;

/// Shear modulus G [N/m], per radian, from a slope [N/m] per degree of the shear angle, as KES has it.
#[must_use]
pub fn shear_modulus_per_radian(per_degree: f64) -> f64 {
    per_degree * (180.0 / PI)
}

/// Shear modulus G [N/m] from the strain EB5 [1] at 45° to the yarns under 5 gf/cm, as FAST-3 measures it.
///
/// ```text
/// G = T / (4 EB5)    T = 5 gf/cm
/// ```
///
/// This is FAST's own relation, G [N/m] = 123 / EB5 [%] with a rounded constant. It takes yarns as inextensible: with moduli E
/// along them, the strain is larger by T / 2E, which is counted to shear.
#[must_use]
pub fn shear_modulus_from_bias_extension(strain: f64) -> f64 {
    BIAS_TENSION / (4.0 * strain)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1 gf/(cm deg) is 56.188 N/m per radian, and FAST's constant is 122.6 in per cent.
    #[test]
    fn moduli_have_the_instruments_constants() {
        assert!((shear_modulus_per_radian(GRAM_FORCE_PER_CM) - 56.188).abs() < 5e-4);
        assert!((shear_modulus_from_bias_extension(0.01) - 122.583).abs() < 5e-4);
        // The band of men's suiting, 0.50 to 0.65 gf/(cm deg), in SI.
        for (kes, si) in [(0.5, 28.1), (0.65, 36.5)] {
            assert!((shear_modulus_per_radian(kes * GRAM_FORCE_PER_CM) - si).abs() < 0.05);
        }
    }
}
