//! Bending rigidities.

use super::units::STANDARD_GRAVITY;

/// Rigidity against bending, per width [N m].
///
/// ```text
/// energy per area = ½ (B_warp κ_y² + B_weft κ_x² + 4 D κ_xy²)
/// B at 45° to the yarns = ¼ (B_warp + B_weft) + D
/// ```
///
/// with the curvatures κ_x and κ_y along weft and warp and the twist κ_xy [1/m].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BendingRigidity {
    /// B along the warp [N m], not negative.
    pub warp: f64,
    /// B along the weft [N m], not negative.
    pub weft: f64,
    /// D against twist [N m], not negative.
    pub twist: f64,
}

impl BendingRigidity {
    /// Rigidity B [N m] of a strip cut at 45° to the yarns.
    #[must_use]
    pub fn bias(self) -> f64 {
        0.25 * (self.warp + self.weft) + self.twist
    }

    /// Bending lengths c [m] along warp and weft of a fabric of `areal_density` ρ [kg/m²]: c = (B / ρ g)^(1/3).
    #[must_use]
    pub fn bending_lengths(self, areal_density: f64) -> [f64; 2] {
        [self.warp, self.weft].map(|rigidity| libm::cbrt(rigidity / (areal_density * STANDARD_GRAVITY)))
    }
}

/// What a rigidity becomes on a grid: `bend.model`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BendingModel {
    /// `"second-differences"` of positions: a rigidity from the first curvature on, and against twist.
    #[default]
    SecondDifferences,
    /// `"choi-ko"`: links to the next particle but one that buckle at once (Choi and Ko 2002), without resistance to twist.
    ChoiKo,
}

/// Rigidity B [N m] per width from the bending length c [m] of a fabric of `areal_density` ρ [kg/m²]: B = ρ g c³.
///
/// By Peirce (1930) c is the length of a strip that bends under its own weight by 41.5°, halved; ASTM D1388 and ISO 9073-7
/// measure it so, and FAST-2. The elastica gives c / L = 0.49991 there, so that the half is right to 0.05 % in B.
#[must_use]
pub fn rigidity_from_bending_length(areal_density: f64, bending_length: f64) -> f64 {
    areal_density * STANDARD_GRAVITY * bending_length * bending_length * bending_length
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: 150 g/m² and 20 mm are 0.15 · 9.80665 · 8e-6 = 11.768 µN m; FAST has 9.8e-6 M c³ µN m in g/m² and mm.
    #[test]
    fn a_bending_length_is_a_rigidity_and_back() {
        let found = rigidity_from_bending_length(0.15, 0.02);
        assert!((found - 11.767_98e-6).abs() < 1e-11);
        assert!((found * 1e6 / (9.8e-6 * 150.0 * 8000.0) - 1.0).abs() < 1e-3);
        let rigidity = BendingRigidity { warp: found, weft: 0.0, twist: 0.0 };
        let [warp, weft] = rigidity.bending_lengths(0.15);
        assert!((warp - 0.02).abs() < 1e-15 && weft == 0.0);
    }

    #[test]
    fn a_sheet_that_twists_by_the_mean_bends_alike_on_the_bias() {
        let rigidity = BendingRigidity { warp: 3e-6, weft: 1e-6, twist: 1e-6 };
        assert_eq!(rigidity.bias(), 2e-6);
    }
}
