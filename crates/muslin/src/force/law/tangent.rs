//! The stiffening law that the paper's limit curve stands for.

use std::f64::consts::{LN_2, PI};

use super::TensionLaw;

/// Tangent of the law at which it goes on linearly, relative to the one at rest [1].
const CAP_RATIO: f64 = 1e4;

/// tan u at the cap [1]: √(ratio − 1).
const CAP_TANGENT: f64 = 99.994_999_874_993_75;

/// Argument u at the cap [1]: arctan √(ratio − 1).
const CAP_ARGUMENT: f64 = 1.560_796_160_120_729_4;

/// Ratio of the paper's stiffness k to the tangent K₀ at rest [1]: the slope 0.06 · 5π of its curve.
const SLOPE: f64 = 0.3 * PI;

/// A stiffening law: an extension that approaches `½π a L` however large the force.
///
/// The paper's curve y = 0.06 L arctan(5π x / L) gives the extension y of a spring that would be x under Hooke's law.
/// Solved for the force and with any strain scale a in place of 0.06, with u = x / (a L) and K₀ = k / 0.3π:
///
/// ```text
/// f = K₀ a L tan u    k_t = K₀ (1 + tan² u)    E = −K₀ a² L² ln cos u
/// M = K₀ a³ L³ ∫₀ᵘ s tan s ds
/// ```
///
/// for 0 < u up to where k_t reaches 10⁴ K₀, at 99.4 % of the asymptote. Beyond, the law goes on along its
/// tangent there, so that nothing overflows and no extension meets the next branch of the tangent. In compression it is
/// linear with K₀: cloth buckles, and an odd law would forbid that. With a = 0.06 the asymptote is 9.42 %.
///
/// Source: Luo, Miyaki, Yamasaki, Aizawa, "Dynamic 3D Simulation of Fabric Based on Improved Mass-Spring Model",
/// section 4, whose text calls y an elongation, not a force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TangentLaw {
    initial_stiffness: f64,
    strain_scale: f64,
}

impl TangentLaw {
    /// The law of `stiffness` k [N/m] and `strain_scale` a [1], both positive.
    #[must_use]
    pub fn new(stiffness: f64, strain_scale: f64) -> Self {
        Self::with_initial_stiffness(stiffness / SLOPE, strain_scale)
    }

    /// The law with the tangent `initial_stiffness` K₀ [N/m] at rest and `strain_scale` a [1], both positive.
    #[must_use]
    pub fn with_initial_stiffness(initial_stiffness: f64, strain_scale: f64) -> Self {
        Self { initial_stiffness, strain_scale }
    }

    /// Tangent K₀ at rest [N/m].
    #[must_use]
    pub fn initial_stiffness(self) -> f64 {
        self.initial_stiffness
    }

    /// Strain [1] that no force below the cap reaches: ½π a.
    #[must_use]
    pub fn asymptote(self) -> f64 {
        0.5 * PI * self.strain_scale
    }

    /// Extension [m] at which a spring of `rest_length` [m] has `tension` [N]; the inverse of
    /// [`tension`](TensionLaw::tension).
    #[must_use]
    pub fn extension(self, tension: f64, rest_length: f64) -> f64 {
        if tension <= 0.0 {
            return tension / self.initial_stiffness;
        }
        let scale = self.strain_scale * rest_length;
        let tangent = tension / (self.initial_stiffness * scale);
        if tangent <= CAP_TANGENT {
            scale * libm::atan(tangent)
        } else {
            scale * (CAP_ARGUMENT + (tangent - CAP_TANGENT) / CAP_RATIO)
        }
    }
}

impl TensionLaw for TangentLaw {
    #[inline(always)]
    fn tension(&self, extension: f64, rest_length: f64) -> f64 {
        self.tension_and_tangent(extension, rest_length).0
    }

    fn tangent(&self, extension: f64, rest_length: f64) -> f64 {
        self.tension_and_tangent(extension, rest_length).1
    }

    #[inline(always)]
    fn tension_and_tangent(&self, extension: f64, rest_length: f64) -> (f64, f64) {
        // All branches at once, so that springs of a row can be evaluated side by side; and by comparisons that let
        // through what is not a number.
        let compression = if extension > 0.0 { 0.0 } else { extension };
        let scale = self.strain_scale * rest_length;
        let u = (extension - compression) * (1.0 / scale);
        let beyond = if u < CAP_ARGUMENT { 0.0 } else { u - CAP_ARGUMENT };
        let tangent = tangent(u - beyond);
        let tension = self.initial_stiffness * (scale * (tangent + CAP_RATIO * beyond) + compression);
        (tension, self.initial_stiffness * (1.0 + tangent * tangent))
    }

    #[inline(always)]
    fn only_stiffens(&self) -> bool {
        true
    }

    fn energy(&self, extension: f64, rest_length: f64) -> f64 {
        if extension <= 0.0 {
            return 0.5 * self.initial_stiffness * extension * extension;
        }
        let scale = self.strain_scale * rest_length;
        let u = extension / scale;
        let beyond = (u - CAP_ARGUMENT).max(0.0);
        let sine = libm::sin(u.min(CAP_ARGUMENT));
        // −ln cos u without the cancellation of a cosine near one.
        let curved = -0.5 * libm::log1p(-sine * sine);
        let straight = (CAP_TANGENT + 0.5 * CAP_RATIO * beyond) * beyond;
        self.initial_stiffness * scale * scale * (curved + straight)
    }

    fn energy_moment(&self, extension: f64, rest_length: f64) -> f64 {
        if extension <= 0.0 {
            return self.initial_stiffness * extension * extension * extension / 3.0;
        }
        let scale = self.strain_scale * rest_length;
        let u = extension / scale;
        let beyond = (u - CAP_ARGUMENT).max(0.0);
        let (t, r, c) = (CAP_TANGENT, CAP_RATIO, CAP_ARGUMENT);
        let straight = beyond * (t * c + beyond * (0.5 * (t + r * c) + beyond * r / 3.0));
        self.initial_stiffness * scale * scale * scale * (tangent_moment(u.min(c)) + straight)
    }
}

/// tan u for 0 ≤ u up to the cap, by 2t / (1 − t²) with t = tan ½u from Lambert's continued fraction of eight terms
///
/// ```text
/// tan w = w / (1 − w² / (3 − w² / (5 − …)))
/// ```
///
/// whose error at w = ¼π is 5e-16. It has one division, no branch and no table, so that a row of springs takes it at the
/// full width of vectors.
#[inline(always)]
fn tangent(u: f64) -> f64 {
    let w = 0.5 * u;
    let z = w * w;
    let numerator = w * (2_027_025.0 - z * (270_270.0 - z * (6930.0 - z * 36.0)));
    let denominator = 2_027_025.0 - z * (945_945.0 - z * (51_975.0 - z * (630.0 - z)));
    2.0 * numerator * denominator / ((denominator - numerator) * (denominator + numerator))
}

/// `∫₀ᵘ s tan s ds` for 0 ≤ u < ½π: by parts −u ln cos u + ∫₀ᵘ ln cos s ds.
fn tangent_moment(u: f64) -> f64 {
    let sine = libm::sin(u);
    -0.5 * u * libm::log1p(-sine * sine) + log_cosine_integral(u)
}

/// |B₂ₖ| / (2k (2k + 1)!) for k = 1, 2, ...: coefficients of the series of Clausen's function.
const CLAUSEN: [f64; 16] = [
    0.013888888888888888,
    6.944444444444444e-05,
    7.873519778281683e-07,
    1.1482216343327455e-08,
    1.8978869988971e-10,
    3.387301370953521e-12,
    6.372636443183181e-14,
    1.2462059912950672e-15,
    2.5105444608999545e-17,
    5.178258806090623e-19,
    1.0887357368300849e-20,
    2.325744114302087e-22,
    5.03519521314739e-24,
    1.1026499294381215e-25,
    2.4386585509007344e-27,
    5.440142678856253e-29,
];

/// `∫₀ᵘ ln cos s ds = −u ln 2 + ½ Cl₂(π − 2u)` for 0 ≤ u < ½π, with Clausen's function Cl₂ by its series around 0 or π,
/// whichever is nearer; both fall by at least 9 from term to term.
fn log_cosine_integral(u: f64) -> f64 {
    let near_pi = 2.0 * u;
    if near_pi < PI / 3.0 {
        // Cl₂(π − y) = y ln 2 − Σ cₖ (4ᵏ − 1) y²ᵏ⁺¹, whose first term cancels −u ln 2.
        let mut power = near_pi;
        let mut four = 1.0;
        let mut sum = 0.0;
        for coefficient in CLAUSEN {
            power *= near_pi * near_pi;
            four *= 4.0;
            sum += coefficient * (four - 1.0) * power;
        }
        return -0.5 * sum;
    }
    // Cl₂(y) = y (1 − ln y) + Σ cₖ y²ᵏ⁺¹
    let y = PI - near_pi;
    let mut power = y;
    let mut sum = y * (1.0 - libm::log(y));
    for coefficient in CLAUSEN {
        power *= y * y;
        sum += coefficient * power;
    }
    0.5 * sum - u * LN_2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cap_is_where_the_tangent_reaches_its_ratio() {
        assert!((libm::tan(CAP_ARGUMENT) - CAP_TANGENT).abs() < 1e-11 * CAP_TANGENT);
        assert!((CAP_TANGENT * CAP_TANGENT + 1.0 - CAP_RATIO).abs() < 1e-11 * CAP_RATIO);
        assert!((2.0 * CAP_ARGUMENT / PI - 0.994).abs() < 5e-4);
    }

    /// An error of one rounding of u changes the tangent by u (1 + tan² u) ε; four of them are allowed, and two of the tangent.
    #[test]
    fn the_continued_fraction_is_the_tangent() {
        for i in 0..=100_000 {
            let u = CAP_ARGUMENT * f64::from(i) / 100_000.0;
            let exact = libm::tan(u);
            let allowed = f64::EPSILON * (4.0 * u * (1.0 + exact * exact) + 2.0 * exact);
            assert!((tangent(u) - exact).abs() <= allowed, "{u}: {} for {exact}", tangent(u));
        }
    }

    #[test]
    fn what_is_not_a_number_stays_so() {
        let (tension, tangent) = TangentLaw::new(60.0, 0.06).tension_and_tangent(f64::NAN, 0.1);
        assert!(tension.is_nan() && tangent.is_nan());
    }

    /// The paper's curve backwards: under the force k x its arctangent is the extension.
    #[test]
    fn extension_is_the_papers_curve() {
        let (stiffness, rest_length) = (60.0, 0.11);
        let law = TangentLaw::new(stiffness, 0.06);
        for x in [1e-9, 0.001, 0.01, 0.1] {
            let y = 0.06 * rest_length * libm::atan(5.0 * PI * x / rest_length);
            let found = law.extension(stiffness * x, rest_length);
            assert!((found - y).abs() < 1e-15 * 4.0 * y.max(1e-3), "{found} for {y}");
        }
    }

    #[test]
    fn extension_inverts_tension() {
        let law = TangentLaw::new(250.0, 0.097);
        for strain in [-0.9, -1e-6, 0.0, 1e-6, 0.05, 0.15, 0.1514, 0.2, 3.0] {
            let extension = 0.8 * strain;
            let found = law.extension(law.tension(extension, 0.8), 0.8);
            assert!((found - extension).abs() < 1e-12, "{found} for {extension}");
        }
    }

    /// Midpoint sums of s tan s; their error is h² / 24 of the derivative's change, below 1e-9 here.
    #[test]
    fn the_moment_is_the_integral_of_s_tan_s() {
        for u in [0.01_f64, 0.3, 0.52, 0.53, 1.0, 1.5] {
            let count = 400_000;
            let h = u / f64::from(count);
            let sum: f64 = (0..count).map(|i| (f64::from(i) + 0.5) * h).map(|s| s * s.tan()).sum::<f64>() * h;
            let error = (tangent_moment(u) / sum - 1.0).abs();
            assert!(error < 1e-8, "u = {u}: {error:e}");
        }
    }
}
