//! A link that resists bending by what remains of its length.

use super::TensionLaw;

/// A link between two particles of a bent line, after Choi and Ko: it pushes them apart by the force of a beam that
/// buckles at once into the arc of a circle.
///
/// An arc of length L and curvature κ has the chord ℓ, and with the rigidity b [N m²] the energy of half of its length:
/// links that skip one particle cover a line twice.
///
/// ```text
/// ℓ = L sinc(κL/2)    E = ¼ b κ² L    f = dE/dℓ = ½ b κ² / (cos(κL/2) − sinc(κL/2))
/// ```
///
/// with sinc u = sin u / u. The force of a straight link would be −6 b / L² on one side and zero on the other, where it is
/// longer than its arc. So that force and energy are continuous, f is c x for small extensions x < 0, down to where that is
/// the arc's force.
///
/// With y = (κL/2)² sinc is S(y) = 1 − y/6 + y²/120 − …, whose inverse comes from Newton's method:
///
/// ```text
/// S(y) = ℓ/L    E = b y / L    f = b / (L² S')    k_t = −b S'' / (L³ S'³)
/// ```
///
/// The idea is that of Choi, Ko, "Stable but Responsive Cloth", SIGGRAPH 2002, as others quote it; the paper was not read for
/// this, and what stands here is derived from ℓ and E.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BucklingLaw {
    /// b [N m²]: rigidity per width times the width that a line stands for.
    rigidity: f64,
    /// c [N/m] of a link that is hardly bent.
    stiffness: f64,
    /// Extension [m] down to which the force is c x.
    knee: f64,
}

/// Powers of y that S has: the next term is below 1e-17 up to y = π², where the ends meet.
const TERMS: usize = 15;

/// Steps of Newton's method: the first guess is within 1.3 of a root of up to π², and then 0.12, 1e-3, 1e-7, 1e-15.
const NEWTON_STEPS: usize = 4;

/// Coefficients of S(y) and of y S + 2 cos √y − 2, the integral of y S' [1].
const SERIES: [[f64; TERMS]; 2] = series();

const fn series() -> [[f64; TERMS]; 2] {
    let mut series = [[0.0; TERMS]; 2];
    // 1 / (2k)!, with the sign of (−1)ᵏ.
    let mut inverse = 1.0;
    let mut k = 0;
    while k < TERMS {
        let twice = 2.0 * k as f64;
        series[0][k] = inverse / (twice + 1.0);
        series[1][k] = (2.0 - twice) * inverse - if k == 0 { 2.0 } else { 0.0 };
        inverse = -inverse / ((twice + 1.0) * (twice + 2.0));
        k += 1;
    }
    series
}

/// S and its first two derivatives at y.
#[inline(always)]
fn sinc(y: f64) -> [f64; 3] {
    let [mut value, mut first, mut half_second] = [0.0; 3];
    for coefficient in SERIES[0].into_iter().rev() {
        half_second = half_second * y + first;
        first = first * y + value;
        value = value * y + coefficient;
    }
    [value, first, 2.0 * half_second]
}

/// y of an arc whose chord is shorter than it by the part `r` [1], from 0 to 1.
#[inline(always)]
fn squared_half_angle(r: f64) -> f64 {
    let mut y = r * (6.0 + r * (1.8 + r * (144.0 / 175.0)));
    for _ in 0..NEWTON_STEPS {
        let [value, slope, _] = sinc(y);
        y -= (value - (1.0 - r)) / slope;
    }
    y
}

impl BucklingLaw {
    /// The law of links of `rest_length` L [m] over a line of `rigidity` b [N m²], with the `stiffness` c [N/m] of those that
    /// are hardly bent.
    #[must_use]
    pub fn new(rigidity: f64, stiffness: f64, rest_length: f64) -> Self {
        let mut law = Self { rigidity, stiffness, knee: 0.0 };
        // The arc's force grows by a sixth of b / L³ per extension there, which is far less than c.
        for _ in 0..40 {
            law.knee = (law.arc(law.knee, rest_length)[1] / stiffness).max(-rest_length);
        }
        law
    }

    /// Energy [J], force [N] and tangent [N/m] of the arc at an `extension` [m].
    #[inline(always)]
    fn arc(&self, extension: f64, rest_length: f64) -> [f64; 3] {
        let r = shortening(extension, rest_length);
        let y = squared_half_angle(r);
        let [_, first, second] = sinc(y);
        let inverse = 1.0 / rest_length;
        let force = self.rigidity * inverse * inverse / first;
        [self.rigidity * y * inverse, force, -force * inverse * second / (first * first)]
    }

    /// Integral [J m] of the arc's energy over the extension, up to a constant.
    fn arc_energy_integral(&self, extension: f64, rest_length: f64) -> f64 {
        let y = squared_half_angle(shortening(extension, rest_length));
        self.rigidity * SERIES[1].into_iter().rev().fold(0.0, |sum, coefficient| sum * y + coefficient)
    }

    /// Energy [J] that the arc has more than the link.
    fn surplus(&self, rest_length: f64) -> f64 {
        self.arc(self.knee, rest_length)[0] - 0.5 * self.stiffness * self.knee * self.knee
    }
}

/// The part [1] of its length that a link of an `extension` [m] lacks.
#[inline(always)]
fn shortening(extension: f64, rest_length: f64) -> f64 {
    let r = -extension / rest_length;
    // Comparisons in place of `clamp`: what is not a number stays so.
    let r = if r < 0.0 { 0.0 } else { r };
    if 1.0 < r { 1.0 } else { r }
}

impl TensionLaw for BucklingLaw {
    #[inline(always)]
    fn tension(&self, extension: f64, rest_length: f64) -> f64 {
        self.tension_and_tangent(extension, rest_length).0
    }

    #[inline(always)]
    fn tangent(&self, extension: f64, rest_length: f64) -> f64 {
        self.tension_and_tangent(extension, rest_length).1
    }

    #[inline(always)]
    fn tension_and_tangent(&self, extension: f64, rest_length: f64) -> (f64, f64) {
        let [_, force, tangent] = self.arc(extension, rest_length);
        let is_arc = extension < self.knee;
        let is_slack = 0.0 < extension;
        let line = if is_slack { 0.0 } else { self.stiffness };
        (if is_arc { force } else { line * extension }, if is_arc { tangent } else { line })
    }

    fn energy(&self, extension: f64, rest_length: f64) -> f64 {
        if extension < self.knee {
            return self.arc(extension, rest_length)[0] - self.surplus(rest_length);
        }
        let pushed = extension.min(0.0);
        0.5 * self.stiffness * pushed * pushed
    }

    /// By parts: M = x E − ∫ E dx.
    fn energy_moment(&self, extension: f64, rest_length: f64) -> f64 {
        let pushed = extension.min(0.0).max(self.knee);
        let mut integral = self.stiffness * pushed * pushed * pushed / 6.0;
        if extension < self.knee {
            let [at, knee] =
                [extension, self.knee].map(|extension| self.arc_energy_integral(extension, rest_length));
            integral += (at - knee) - self.surplus(rest_length) * (extension - self.knee);
        }
        extension.min(0.0) * self.energy(extension, rest_length) - integral
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Chords, energies and forces of arcs by sines and cosines, up to where the ends meet.
    #[test]
    fn the_force_is_that_of_an_arc() {
        let (rigidity, length) = (3e-8, 0.02);
        let law = BucklingLaw::new(rigidity, 400.0, length);
        assert!(law.knee < 0.0 && -1e-4 * length < law.knee, "{law:?}");
        for half_angle in [0.1_f64, 0.5, 1.0, 2.0, 3.0, 0.9999 * std::f64::consts::PI] {
            let (sine, cosine) = half_angle.sin_cos();
            let sinc = sine / half_angle;
            let curvature = 2.0 * half_angle / length;
            let extension = length * (sinc - 1.0);
            let force = 0.5 * rigidity * curvature * curvature / (cosine - sinc);
            // A length is known to 1e-16 of the whole, and 1 − sinc is u²/6 of it.
            let tolerance = 1e-14 + 1e-14 / (half_angle * half_angle);
            assert!((law.tension(extension, length) / force - 1.0).abs() < tolerance, "u = {half_angle}");
            let energy = 0.25 * rigidity * curvature * curvature * length;
            let found = law.energy(extension, length) + law.surplus(length);
            assert!((found / energy - 1.0).abs() < tolerance, "u = {half_angle}: {found:e} J");
        }
        // As steep as it is, a straight link has the load −6 b / L², half of 12 since links cover a line twice.
        let [_, force, _] = law.arc(-1e-9 * length, length);
        assert!((force * length * length / (-6.0 * rigidity) - 1.0).abs() < 1e-8);
    }

    #[test]
    fn a_link_is_slack_beyond_its_length_and_whole_where_its_ends_meet() {
        let law = BucklingLaw::new(3e-8, 400.0, 0.02);
        assert_eq!(law.tension_and_tangent(1e-3, 0.02), (0.0, 0.0));
        assert_eq!((law.energy(1e-3, 0.02), law.energy_moment(1e-3, 0.02)), (0.0, 0.0));
        let (force, _) = law.tension_and_tangent(-0.02, 0.02);
        let exact = -2.0 * std::f64::consts::PI.powi(2) * 3e-8 / (0.02 * 0.02);
        assert!((force / exact - 1.0).abs() < 1e-13, "{force:e} N");
        assert!(law.tension(f64::NAN, 0.02).is_nan());
    }
}
