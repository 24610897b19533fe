//! Internal friction from the hysteresis that instruments measure.

use std::f64::consts::PI;

use super::MembraneTension;

/// Shear angles [°] at which KES-FB1 reads 2HG and 2HG5, and to which it shears.
const SHEAR_READINGS: [f64; 2] = [0.5, 5.0];
const SHEAR_END: f64 = 8.0;

/// Curvature [1/m] up to which friction in bending holds in a fabric as new: 0.1 /cm, a fifth of where KES-FB2 begins to read
/// the rigidity.
const BENDING_SLIP: f64 = 10.0;

/// Least stiffness of friction along yarns, in chords of the loading curve [1], and in slopes with which friction grows at the
/// greatest tension [1].
const TURNING_CHORDS: f64 = 2.0;
const TURNING_SLOPES: f64 = 2.0;

/// Internal friction of a measured fabric, each kind if it has any.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InternalFriction {
    /// Along the warp.
    pub warp: Option<TensionFriction>,
    /// Along the weft.
    pub weft: Option<TensionFriction>,
    /// In shear.
    pub shear: Option<ShearFriction>,
    /// In bending along the warp.
    pub warp_bend: Option<BendingFriction>,
    /// In bending along the weft.
    pub weft_bend: Option<BendingFriction>,
}

/// Friction in shear: a stress that grows with the shear angle γ as the yarns press on each other.
///
/// ```text
/// Y = Y₀ + c |sin γ|        hysteresis 2 Y cos γ per width
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShearFriction {
    /// Y₀ [N/m], not negative.
    pub at_rest: f64,
    /// c [N/m], less than the stiffness.
    pub growth: f64,
    /// Stiffness [N/m] of what holds, per sine of the angle; positive.
    pub stiffness: f64,
}

/// Why there is no friction in shear with given hysteresis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ShearFrictionError {
    /// 2HG5 is below 2HG.
    #[error("friction that falls with the shear angle would pull the fabric further")]
    Falls,
    /// 2HG5 is so far above 2HG that nothing would be left at rest.
    #[error("friction that grows so fast would be none in the flat fabric")]
    NoneAtRest,
}

impl ShearFriction {
    /// The friction with the hysteresis 2HG [N/m] at 0.5° and 2HG5 [N/m] at 5°, or the same everywhere without 2HG5.
    ///
    /// As the limit is the same function of the angle on both ways, a loop up to 8° is 2 Y cos γ wide wherever the friction has
    /// turned around. It holds up to the first reading, 0.5°, in a fabric as new; or less, if it would not have turned at 5° on the
    /// way back from 8°.
    ///
    /// Friction that is the same everywhere cannot have 2HG5 > 2HG: such elements come to pull the other way one after the other, so that a
    /// loop is widest in its middle.
    ///
    /// # Errors
    /// If 2HG5 is below 2HG, or ten times as large or more.
    pub fn from_kes(hysteresis: f64, hysteresis_5: Option<f64>) -> Result<Self, ShearFrictionError> {
        let [first, fifth] = SHEAR_READINGS.map(|angle| libm::sin(angle * PI / 180.0));
        let [cosine, fifth_cosine] = SHEAR_READINGS.map(|angle| libm::cos(angle * PI / 180.0));
        let limit = 0.5 * hysteresis / cosine;
        let Some(hysteresis_5) = hysteresis_5 else {
            return Ok(Self { at_rest: limit, growth: 0.0, stiffness: limit / first });
        };
        if hysteresis_5 < hysteresis {
            return Err(ShearFrictionError::Falls);
        }
        let limit_5 = 0.5 * hysteresis_5 / fifth_cosine;
        let growth = (limit_5 - limit) / (fifth - first);
        let at_rest = limit - growth * first;
        if at_rest <= 0.0 && 0.0 < growth {
            return Err(ShearFrictionError::NoneAtRest);
        }
        let end = libm::sin(SHEAR_END * PI / 180.0);
        let turning = (at_rest + growth * end + limit_5) / (end - fifth);
        Ok(Self { at_rest, growth, stiffness: turning.max(limit / first) })
    }
}

/// Friction in bending: a moment against the change of curvature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BendingFriction {
    /// Moment per width [N] at which it slips, half the hysteresis; positive.
    pub moment: f64,
    /// Rigidity [N m] of what holds, per width.
    pub rigidity: f64,
}

impl BendingFriction {
    /// The friction with the hysteresis 2HB [N] of a moment per width. It holds up to 0.1 /cm in a fabric as new.
    #[must_use]
    pub fn from_kes(hysteresis: f64) -> Self {
        let moment = 0.5 * hysteresis;
        Self { moment, rigidity: moment / BENDING_SLIP }
    }
}

/// Friction along yarns, which press on each other in proportion to their tension.
///
/// ```text
/// T = T_el + friction    |friction| ≤ μ T_el    T_el = T_load / (1 + μ)
/// ```
///
/// so that the fabric has the tension T_load as it is loaded and (1 − μ) T_el as it is unloaded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TensionFriction {
    /// μ [1], positive and below 1.
    pub ratio: f64,
    /// Tension per width and strain [N/m] of what holds.
    pub stiffness: f64,
}

impl TensionFriction {
    /// The friction of which a fabric that is loaded along `tension` up to the strain `extension` [1] gives back the share
    /// `resilience` RT [1] of the work; `None` if there is no such friction.
    ///
    /// Without the way on which friction turns around, RT = (1 − μ) / (1 + μ). It takes some strain, since what holds is only so
    /// stiff: as two chords of the loading curve, or as twice the growth of friction at the greatest tension if that is more.
    /// μ is found by bisection so that the whole loop has RT.
    #[must_use]
    pub fn from_kes(tension: &MembraneTension, extension: f64, resilience: f64) -> Option<Self> {
        let ratio_of = |ratio: f64| resilience_of(tension, extension, ratio);
        let (mut low, mut high) = (0.0, 1.0 - 1e-9);
        if !(ratio_of(high) < resilience && resilience < 1.0) {
            return None;
        }
        for _ in 0..48 {
            let middle = 0.5 * (low + high);
            if resilience < ratio_of(middle) { low = middle } else { high = middle }
        }
        Some(Self { ratio: low, stiffness: turning_stiffness(tension, extension, low) / (1.0 + low) })
    }
}

/// Stiffness of what holds, relative to that of an elastic tension as large as the loading curve.
fn turning_stiffness(tension: &MembraneTension, extension: f64, ratio: f64) -> f64 {
    let chord = tension.tension(extension) / extension;
    (TURNING_CHORDS * chord).max(TURNING_SLOPES * ratio * tension.slope(extension))
}

/// RT [1] of a loop up to the strain `extension`: the mean of many points each way.
fn resilience_of(tension: &MembraneTension, extension: f64, ratio: f64) -> f64 {
    const POINTS: u32 = 500;
    let stiffness = turning_stiffness(tension, extension, ratio);
    let greatest = ratio * tension.tension(extension);
    let (mut given, mut taken) = (0.0, 0.0);
    for i in 0..POINTS {
        let strain = (f64::from(i) + 0.5) / f64::from(POINTS) * extension;
        let elastic = tension.tension(strain);
        let friction = (greatest - stiffness * (extension - strain)).max(-ratio * elastic);
        taken += (1.0 + ratio) * elastic;
        given += elastic + friction;
    }
    given / taken
}

/// Times [s] by which a measured fabric lags behind its elastic forces: T = K (e + τ de/dt).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RetardationTimes {
    /// Along the warp, with the modulus K at rest; not negative.
    pub warp: f64,
    /// Along the weft, with the modulus K at rest; not negative.
    pub weft: f64,
    /// In shear; not negative.
    pub shear: f64,
    /// In bending along both; not negative.
    pub bend: f64,
}
