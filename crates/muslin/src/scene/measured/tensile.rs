//! Tension per width against strain, and the KES tensile test.

use std::f64::consts::FRAC_PI_2;

use crate::scene::TensionCurve;

/// Tension per width T [N/m] against strain e along the yarns, the strain across them held at zero.
///
/// The KES tensile test measures it so but for its clamps: its specimen is four times as wide as it is long.
#[derive(Clone, Debug, PartialEq)]
pub enum MembraneTension {
    /// T = K e.
    Linear {
        /// Modulus K [N/m], positive.
        modulus: f64,
    },
    /// T = K a tan(e / a), linear in compression: stiffens without bound as the strain approaches ½π a.
    Tangent {
        /// Modulus K at rest [N/m], positive.
        modulus: f64,
        /// Strain scale a [1], positive.
        strain_scale: f64,
    },
    /// Through the points of a table of strain [1] and tension per width [N/m].
    Curve(TensionCurve),
}

impl MembraneTension {
    /// The smallest slope dT/de [N/m] of any part, which for a table is that of a straight line from point to point.
    #[must_use]
    pub fn least_modulus(&self) -> f64 {
        match self {
            Self::Linear { modulus } | Self::Tangent { modulus, .. } => *modulus,
            Self::Curve(curve) => {
                let slopes = curve.points().windows(2).map(|pair| {
                    let [[strain, tension], [next_strain, next_tension]] = [pair[0], pair[1]];
                    (next_tension - tension) / (next_strain - strain)
                });
                slopes.fold(f64::INFINITY, f64::min)
            }
        }
    }

    /// Tension per width [N/m] at the `strain` [1]; of a table, along straight lines from point to point.
    #[must_use]
    pub fn tension(&self, strain: f64) -> f64 {
        match self {
            Self::Linear { modulus } => modulus * strain,
            Self::Tangent { modulus, .. } if strain <= 0.0 => modulus * strain,
            Self::Tangent { modulus, strain_scale } => {
                modulus * strain_scale * libm::tan(strain / strain_scale)
            }
            Self::Curve(curve) => {
                let [[start, tension], _] = chord(curve, strain);
                tension + self.slope(strain) * (strain - start)
            }
        }
    }

    /// Slope dT/de [N/m] at the `strain` [1]; of a table, that of a straight line from point to point.
    #[must_use]
    pub fn slope(&self, strain: f64) -> f64 {
        match self {
            Self::Linear { modulus } => *modulus,
            Self::Tangent { modulus, .. } if strain <= 0.0 => *modulus,
            Self::Tangent { modulus, strain_scale } => {
                let tangent = libm::tan(strain / strain_scale);
                modulus * (1.0 + tangent * tangent)
            }
            Self::Curve(curve) => {
                let [[start, tension], [end, end_tension]] = chord(curve, strain);
                (end_tension - tension) / (end - start)
            }
        }
    }

    /// The same curve with `factor` times the tension at every strain.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        match self {
            Self::Linear { modulus } => Self::Linear { modulus: factor * modulus },
            Self::Tangent { modulus, strain_scale } => {
                Self::Tangent { modulus: factor * modulus, strain_scale: *strain_scale }
            }
            Self::Curve(curve) => Self::Curve(curve.reduced(0.0, factor)),
        }
    }

    /// The strain [1] that no tension reaches, if there is one.
    #[must_use]
    pub fn asymptote(&self) -> Option<f64> {
        match self {
            Self::Tangent { strain_scale, .. } => Some(FRAC_PI_2 * strain_scale),
            Self::Linear { .. } | Self::Curve(_) => None,
        }
    }
}

/// The two neighbouring points of `curve` between which `strain` lies, or the two at that end beyond which it lies.
fn chord(curve: &TensionCurve, strain: f64) -> [[f64; 2]; 2] {
    let points = curve.points();
    let next = points.partition_point(|point| point[0] <= strain).clamp(1, points.len() - 1);
    [points[next - 1], points[next]]
}

/// What the tensile test of KES gives: strain EMT at the greatest tension, and linearity LT.
///
/// With the work W = ∫ T de up to there, LT = W / (½ F EMT): 1 for a linear fabric, less for one that stiffens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KesTensile {
    /// EMT: strain at the greatest tension [1], positive.
    pub extension: f64,
    /// LT: linearity [1].
    pub linearity: f64,
    /// Greatest tension F per width [N/m], positive; 500 gf/cm in the standard test.
    pub force: f64,
}

/// Why no tangent law has the values of a tensile test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum KesTensileError {
    /// The linearity is above 1: the fabric softens.
    #[error("a linearity above 1 is that of a fabric that softens, which no tangent law does")]
    Softens,
    /// The linearity is below [`KesTensile::LEAST_LINEARITY`].
    #[error("a linearity below {} is that of a fabric that is slack at first", KesTensile::LEAST_LINEARITY)]
    Slack,
}

impl KesTensile {
    /// The least linearity that a tangent law is fitted to: published ones are above 0.3.
    pub const LEAST_LINEARITY: f64 = 0.1;

    /// The tangent law with this extension, linearity and force; of a linearity of 1 the linear law.
    ///
    /// ```text
    /// LT = −2 ln(cos u) / (u tan u)    a = EMT / u    K = F / (a tan u)
    /// ```
    ///
    /// with u = EMT / a by bisection: LT falls from 1 to 0 as u grows from 0 to ½π.
    ///
    /// # Errors
    /// If the linearity is above 1 or below [`LEAST_LINEARITY`](Self::LEAST_LINEARITY).
    pub fn tension(self) -> Result<MembraneTension, KesTensileError> {
        let Self { extension, linearity, force } = self;
        if 1.0 < linearity {
            return Err(KesTensileError::Softens);
        }
        if linearity < Self::LEAST_LINEARITY {
            return Err(KesTensileError::Slack);
        }
        let (mut low, mut high) = (0.0, FRAC_PI_2);
        for _ in 0..64 {
            let middle = 0.5 * (low + high);
            if linearity < linearity_of(middle) { low = middle } else { high = middle }
        }
        if low < LEAST_ARGUMENT {
            return Ok(MembraneTension::Linear { modulus: force / extension });
        }
        let strain_scale = extension / low;
        Ok(MembraneTension::Tangent { modulus: force / (strain_scale * libm::tan(low)), strain_scale })
    }

    /// The linearity LT [1] of a test with the work W [J/m²] up to the greatest tension `force` [N/m] at the strain
    /// `extension` [1].
    #[must_use]
    pub fn linearity_of_work(work: f64, extension: f64, force: f64) -> f64 {
        2.0 * work / (force * extension)
    }
}

/// Arguments u below which the law is linear: LT = 1 − u²/6 differs from 1 by less than can be written.
const LEAST_ARGUMENT: f64 = 1e-6;

/// LT [1] of the tangent law up to the strain u a.
fn linearity_of(u: f64) -> f64 {
    let sine = libm::sin(u);
    // −2 ln cos u without the cancellation of a cosine near one.
    -libm::log1p(-sine * sine) / (u * libm::tan(u))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Columns: EMT, LT, u, a, K₀, asymptote, secant modulus, WT; force 490.3325 N/m.
    const FITS: &str = include_str!("../../../tests/verification/reference/tan_law_kes_fit.csv");

    #[test]
    fn fits_are_those_of_the_reference() {
        let mut count = 0;
        for line in FITS.lines().filter(|line| line.starts_with("0.")) {
            let row: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
            let [extension, linearity, _, scale, stiffness, asymptote, _, work] = row[..] else {
                panic!("eight columns")
            };
            let test = KesTensile { extension, linearity, force: 490.3325 };
            let tension = test.tension().expect("a law");
            let MembraneTension::Tangent { modulus, strain_scale } = tension else { panic!("{tension:?}") };
            // The table has seven digits.
            let close = |found: f64, exact: f64| (found / exact - 1.0).abs() < 1e-6;
            assert!(close(strain_scale, scale) && close(modulus, stiffness), "{line}: {tension:?}");
            assert!(tension.asymptote().is_some_and(|found| close(found, asymptote)));
            assert!(close(KesTensile::linearity_of_work(work, extension, test.force), linearity));
            count += 1;
        }
        assert_eq!(count, 45);
    }

    /// What goes in comes out: T(EMT) = F, and the midpoint sum of T is W.
    #[test]
    fn the_law_has_the_measured_values() {
        for (extension, linearity) in [(0.047, 0.55), (0.1275, 0.55), (0.3, 0.95), (0.02, 0.1)] {
            let force = 490.3325;
            let tension = KesTensile { extension, linearity, force }.tension().expect("a law");
            let MembraneTension::Tangent { modulus, strain_scale } = tension else { panic!("{tension:?}") };
            let at = |strain: f64| modulus * strain_scale * (strain / strain_scale).tan();
            assert!((at(extension) / force - 1.0).abs() < 1e-10);
            let count = 100_000;
            let width = extension / f64::from(count);
            let work: f64 = (0..count).map(|i| at((f64::from(i) + 0.5) * width) * width).sum();
            let found = KesTensile::linearity_of_work(work, extension, force);
            assert!((found / linearity - 1.0).abs() < 1e-5, "{found} for {linearity}");
        }
    }

    #[test]
    fn a_linearity_of_one_is_linear_and_others_are_refused() {
        let fit = |linearity| KesTensile { extension: 0.05, linearity, force: 500.0 }.tension();
        assert_eq!(fit(1.0), Ok(MembraneTension::Linear { modulus: 500.0 / 0.05 }));
        assert_eq!(fit(1.01), Err(KesTensileError::Softens));
        assert_eq!(fit(0.09), Err(KesTensileError::Slack));
    }

    #[test]
    fn the_least_modulus_of_a_table_is_that_of_its_flattest_part() {
        let curve = TensionCurve::new(&[[0.01, 5.0], [0.02, 6.0], [0.03, 20.0]]).expect("a curve");
        assert!((MembraneTension::Curve(curve).least_modulus() - 100.0).abs() < 1e-12);
    }
}
