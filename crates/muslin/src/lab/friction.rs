//! What internal friction adds to the curves that a fabric was given.

use crate::scene::{BendingFriction, MeasuredFabric, ShearFriction};

/// An element of friction on its way through a test: a spring that holds, and slips where its stress would exceed a limit.
#[derive(Clone, Copy, Debug)]
pub(super) struct FrictionPath {
    /// Stiffness k, by stress and coordinate; positive.
    stiffness: f64,
    /// Where the element pulls nothing.
    slip: f64,
}

impl FrictionPath {
    /// An element as new.
    pub(super) fn new(stiffness: f64) -> Self {
        Self { stiffness, slip: 0.0 }
    }

    /// The stress at a `coordinate`, where it slips at the `limit`; it has not turned around since the last.
    pub(super) fn stress(&mut self, coordinate: f64, limit: f64) -> f64 {
        let stress = (self.stiffness * (coordinate - self.slip)).clamp(-limit, limit);
        self.slip = coordinate - stress / self.stiffness;
        stress
    }
}

/// Stress in shear [N/m] by the work on the angle γ [rad], f cos γ, of the friction of a fabric; at every one of `angles`, on the
/// way from each to the next.
pub(super) fn shear_stresses(friction: Option<ShearFriction>, angles: impl Iterator<Item = f64>) -> Vec<f64> {
    let Some(ShearFriction { at_rest, growth, stiffness }) = friction else {
        return angles.map(|_| 0.0).collect();
    };
    let mut path = FrictionPath::new(stiffness);
    let stress = |angle: f64| {
        let (sine, cosine) = libm::sincos(angle);
        path.stress(sine, at_rest + growth * sine.abs()) * cosine
    };
    angles.map(stress).collect()
}

/// Moments per width [N] of the friction of a fabric, on the way from each of `curvatures` [1/m] to the next.
pub(super) fn bending_moments(
    friction: Option<BendingFriction>,
    curvatures: impl Iterator<Item = f64>,
) -> Vec<f64> {
    let Some(BendingFriction { moment, rigidity }) = friction else {
        return curvatures.map(|_| 0.0).collect();
    };
    let mut path = FrictionPath::new(rigidity);
    curvatures.map(|curvature| path.stress(curvature, moment)).collect()
}

/// Shear angle γ [rad] at which `fabric` as new has the shear `stress` τ [N/m], for small angles:
///
/// ```text
/// τ = (G_el + k) γ    as long as k γ ≤ Y₀ + c γ; then G_el γ + Y₀ + c γ
/// ```
pub(super) fn shear_angle(fabric: &MeasuredFabric, stress: f64) -> f64 {
    let elastic = fabric.elastic_shear_modulus();
    let Some(ShearFriction { at_rest, growth, stiffness }) = fabric.friction.shear else {
        return stress / elastic;
    };
    let held = stress / (elastic + stiffness);
    if stiffness * held <= at_rest + growth * held { held } else { (stress - at_rest) / (elastic + growth) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: it holds up to 0.5, slides to 2, turns around over 1, and slides back.
    #[test]
    fn a_path_holds_and_slips() {
        let mut path = FrictionPath::new(2.0);
        let way = [(0.25, 0.5), (0.5, 1.0), (2.0, 1.0), (1.75, 0.5), (1.0, -1.0), (-3.0, -1.0), (-2.5, 0.0)];
        for (coordinate, stress) in way {
            assert_eq!(path.stress(coordinate, 1.0), stress, "at {coordinate}");
        }
    }
}
