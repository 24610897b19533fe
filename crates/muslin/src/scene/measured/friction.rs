//! Internal friction from the hysteresis that instruments measure.

use std::f64::consts::PI;

use super::MembraneTension;

/// Shear angles [°] at which KES-FB1 reads 2HG and 2HG5, and to which it shears.
const SHEAR_READINGS: [f64; 2] = [0.5, 5.0];
const SHEAR_END: f64 = 8.0;

/// Curvature [1/m] up to which friction in bending holds in a fabric as new: 0.1 /cm, a fifth of where KES-FB2 begins to read
/// the rigidity.
const BENDING_SLIP: f64 = 10.0;

/// Least stiffness of what holds along yarns, in chords of the friction on loading [1], so that it turns around in a fifth of the
/// extension, and in slopes of that friction at the greatest tension [1], so that it can follow the curve.
const TURNING_CHORDS: f64 = 10.0;
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

    /// The hysteresis [N/m] at a shear `angle` [rad] in a loop whose both ways have turned there.
    #[must_use]
    pub fn hysteresis(&self, angle: f64) -> f64 {
        let (sine, cosine) = libm::sincos(angle.abs());
        2.0 * (self.at_rest + self.growth * sine) * cosine
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
    /// Relative to an elastic tension t(e), friction is μ t on the way up. On the way back it falls with a stiffness of μ s until it
    /// is −μ t, with s ten times the chord t/e up to the greatest tension, or twice the slope of t there if that is more:
    ///
    /// ```text
    /// J = ∫ max(t(E) − s (E − e), −t(e)) de / ∫ t de        RT = (1 + μ J) / (1 + μ)        μ = (1 − RT) / (RT − J)
    /// ```
    ///
    /// If it turned around at once, J would be −1, and RT = (1 − μ) / (1 + μ).
    #[must_use]
    pub fn from_kes(tension: &MembraneTension, extension: f64, resilience: f64) -> Option<Self> {
        let stiffness = turning_stiffness(tension, extension);
        let ratio = (1.0 - resilience) / (resilience - returned_share(tension, extension, stiffness));
        // Written so that what is not a number is no friction.
        (0.0 < ratio && ratio < 1.0).then(|| Self { ratio, stiffness: ratio * stiffness / (1.0 + ratio) })
    }

    /// The share RT [1] of the work that a fabric with this friction gives back, which is loaded along `tension` up to the strain
    /// `extension` [1].
    #[must_use]
    pub fn resilience(&self, tension: &MembraneTension, extension: f64) -> f64 {
        let stiffness = self.stiffness * (1.0 + self.ratio) / self.ratio;
        (1.0 + self.ratio * returned_share(tension, extension, stiffness)) / (1.0 + self.ratio)
    }
}

/// s [N/m]: stiffness of what holds, by μ and relative to an elastic tension as large as the loading curve.
fn turning_stiffness(tension: &MembraneTension, extension: f64) -> f64 {
    let chord = tension.tension(extension) / extension;
    (TURNING_CHORDS * chord).max(TURNING_SLOPES * tension.slope(extension))
}

/// J [1]: what friction gives back on the way from the strain `extension` to zero, by μ and the elastic work.
fn returned_share(tension: &MembraneTension, extension: f64, stiffness: f64) -> f64 {
    const POINTS: u32 = 10_000;
    let greatest = tension.tension(extension);
    let (mut returned, mut work) = (0.0, 0.0);
    for i in 0..POINTS {
        let strain = (f64::from(i) + 0.5) / f64::from(POINTS) * extension;
        let elastic = tension.tension(strain);
        returned += (greatest - stiffness * (extension - strain)).max(-elastic);
        work += elastic;
    }
    returned / work
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

#[cfg(test)]
mod tests {
    use super::*;

    const DEGREE: f64 = PI / 180.0;

    /// A straight line in the sine through both limits; what holds slips at 0.5°, or has turned around from 8° to 5°.
    #[test]
    fn friction_in_shear_goes_through_both_readings() {
        let both = ShearFriction::from_kes(0.5, Some(0.9)).expect("a friction");
        assert!((both.hysteresis(0.5 * PI / 180.0) - 0.5).abs() < 1e-14);
        assert!((both.hysteresis(-5.0 * PI / 180.0) - 0.9).abs() < 1e-14);
        for (hysteresis, hysteresis_5) in [(1.0, 1.0), (1.0, 2.0), (0.4, 3.9)] {
            let friction = ShearFriction::from_kes(hysteresis, Some(hysteresis_5)).expect("friction");
            let limit = |degrees: f64| friction.at_rest + friction.growth * (degrees * DEGREE).sin();
            assert!((2.0 * limit(0.5) * (0.5 * DEGREE).cos() - hysteresis).abs() < 1e-14);
            assert!((2.0 * limit(5.0) * (5.0 * DEGREE).cos() - hysteresis_5).abs() < 1e-14);
            let way = friction.stiffness * ((8.0 * DEGREE).sin() - (5.0 * DEGREE).sin());
            assert!(limit(8.0) + limit(5.0) <= way * (1.0 + 1e-14), "{friction:?}");
            assert!(limit(0.5) <= friction.stiffness * (0.5 * DEGREE).sin() * (1.0 + 1e-14));
            assert!(friction.growth < friction.stiffness);
        }
        assert_eq!(ShearFriction::from_kes(1.0, Some(0.9)), Err(ShearFrictionError::Falls));
        assert_eq!(ShearFriction::from_kes(1.0, Some(10.1)), Err(ShearFrictionError::NoneAtRest));
        let same = ShearFriction::from_kes(1.0, None).expect("friction");
        assert_eq!(same.growth, 0.0);
    }

    /// μ is above (1 − RT) / (1 + RT), where friction would turn around at once, by half or so.
    #[test]
    fn friction_along_yarns_gives_back_what_it_should() {
        let tension = MembraneTension::Tangent { modulus: 3000.0, strain_scale: 0.05 };
        let friction = TensionFriction::from_kes(&tension, 0.04, 0.7).expect("a friction");
        assert!((friction.resilience(&tension, 0.04) - 0.7).abs() < 1e-12);
        let linear = MembraneTension::Linear { modulus: 900.0 };
        let stiffening = MembraneTension::Tangent { modulus: 3600.0, strain_scale: 0.036 };
        for (tension, extension, nearness) in [(&linear, 0.03, 1.6), (&stiffening, 0.047, 1.7)] {
            for resilience in [0.35, 0.7, 0.9] {
                let friction = TensionFriction::from_kes(tension, extension, resilience).expect("friction");
                let at_once = (1.0 - resilience) / (1.0 + resilience);
                assert!(at_once < friction.ratio && friction.ratio < nearness * at_once, "{friction:?}");
                let growth = friction.ratio / (1.0 + friction.ratio) * tension.slope(extension);
                assert!(growth < friction.stiffness, "friction follows the curve");
            }
            assert_eq!(TensionFriction::from_kes(tension, extension, 1.0), None);
            assert_eq!(TensionFriction::from_kes(tension, extension, 0.01), None);
        }
    }

    /// By hand, for a linear fabric: friction falls tenfold as fast as it grew, and is turned at 9/11 of the way; J = −7/11.
    #[test]
    fn the_loop_of_a_linear_fabric_is_known() {
        let tension = MembraneTension::Linear { modulus: 3.0 };
        let found = returned_share(&tension, 0.5, turning_stiffness(&tension, 0.5));
        // A sum of 10⁴ midpoints across one kink.
        assert!((found + 7.0 / 11.0).abs() < 1e-7, "{found}");
        let friction = TensionFriction::from_kes(&tension, 0.5, 0.7).expect("friction");
        assert!((friction.ratio - 0.3 / (0.7 + 7.0 / 11.0)).abs() < 1e-7, "{friction:?}");
    }
}
