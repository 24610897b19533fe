//! Laws of tension against extension.

mod arctangent;
mod buckling;
mod curve;
mod linear;
mod reduced;
mod tangent;

pub use arctangent::ArctangentLaw;
pub use buckling::BucklingLaw;
pub use curve::{Cubic, CurveLaw};
pub use linear::LinearLaw;
pub use reduced::ReducedLaw;
pub use tangent::TangentLaw;

use super::spring::SpringLength;
use crate::scene::{SpringLawSettings, SpringSettings, TensionCurve};

/// Tension of a spring against its extension.
///
/// With extension `x = ℓ − L` [m] and rest length `L` [m]:
///
/// ```text
/// f(x) [N]    k_t = df/dx [N/m]    E = ∫₀ˣ f(s) ds [J]    M = ∫₀ˣ f(s) s ds [J m]
/// ```
pub trait TensionLaw: Send + Sync {
    /// Tension f [N], positive when it pulls the ends together.
    fn tension(&self, extension: f64, rest_length: f64) -> f64;

    /// Tangent k_t [N/m].
    fn tangent(&self, extension: f64, rest_length: f64) -> f64;

    /// Tension [N] and tangent [N/m] together, for laws that share work between them.
    #[inline(always)]
    fn tension_and_tangent(&self, extension: f64, rest_length: f64) -> (f64, f64) {
        (self.tension(extension, rest_length), self.tangent(extension, rest_length))
    }

    /// The `tension` f [N] at a length ℓ, divided by it: f / ℓ [N/m]. A law may know a shorter way than by its tension, but
    /// where the ends coincide it does not matter what it is.
    #[inline(always)]
    fn tension_by_length(&self, tension: f64, at: SpringLength, rest_length: f64) -> f64 {
        let _ = rest_length;
        tension * at.inverse
    }

    /// Whether the tangent is positive and nowhere smaller at a larger extension: then it is nowhere smaller than f / ℓ [N/m]
    /// either, since f ≤ k_t x and x < ℓ.
    #[inline(always)]
    fn only_stiffens(&self) -> bool {
        false
    }

    /// Whether the law consists of [`cubics`](Self::cubics).
    const HAS_CUBICS: bool = false;

    /// The cubics that the law consists of from the first to the second of two `extensions` [m], ascending: loops in vectors can take
    /// all of them for some springs, but could not look for that of each.
    fn cubics(&self, extensions: [f64; 2], rest_length: f64) -> &[Cubic] {
        let _ = (extensions, rest_length);
        &[]
    }

    /// Energy E [J].
    fn energy(&self, extension: f64, rest_length: f64) -> f64;

    /// First moment M [J m] of the tension, which the as-printed force direction needs for its energy.
    fn energy_moment(&self, extension: f64, rest_length: f64) -> f64;
}

/// A borrowed law is that law: a spring need not own the table of its law.
impl<L: TensionLaw> TensionLaw for &L {
    #[inline(always)]
    fn tension(&self, extension: f64, rest_length: f64) -> f64 {
        L::tension(self, extension, rest_length)
    }

    #[inline(always)]
    fn tangent(&self, extension: f64, rest_length: f64) -> f64 {
        L::tangent(self, extension, rest_length)
    }

    #[inline(always)]
    fn tension_and_tangent(&self, extension: f64, rest_length: f64) -> (f64, f64) {
        L::tension_and_tangent(self, extension, rest_length)
    }

    #[inline(always)]
    fn tension_by_length(&self, tension: f64, at: SpringLength, rest_length: f64) -> f64 {
        L::tension_by_length(self, tension, at, rest_length)
    }

    #[inline(always)]
    fn only_stiffens(&self) -> bool {
        L::only_stiffens(self)
    }

    const HAS_CUBICS: bool = L::HAS_CUBICS;

    fn cubics(&self, extensions: [f64; 2], rest_length: f64) -> &[Cubic] {
        L::cubics(self, extensions, rest_length)
    }

    fn energy(&self, extension: f64, rest_length: f64) -> f64 {
        L::energy(self, extension, rest_length)
    }

    fn energy_moment(&self, extension: f64, rest_length: f64) -> f64 {
        L::energy_moment(self, extension, rest_length)
    }
}

/// Any law that a scene can ask for.
///
/// It is a law itself; loops over many springs match it once and use the law inside.
#[derive(Clone, Debug, PartialEq)]
pub enum SpringLaw {
    /// `"linear"`
    Linear(LinearLaw),
    /// `"tangent"`
    Tangent(TangentLaw),
    /// `"arctangent-force"`
    Arctangent(ArctangentLaw),
    /// `"curve"`
    Curve(CurveLaw),
    /// Of a measured fabric that stiffens, beside shear springs.
    ReducedTangent(ReducedLaw<TangentLaw>),
    /// Of a measured fabric whose bending is that of links.
    Buckling(BucklingLaw),
}

impl SpringLaw {
    /// The law of `settings`.
    #[must_use]
    pub fn new(settings: &SpringSettings) -> Self {
        let stiffness = settings.stiffness;
        match settings.law {
            SpringLawSettings::Linear => Self::Linear(LinearLaw { stiffness }),
            SpringLawSettings::Tangent { strain_scale } => {
                Self::Tangent(TangentLaw::new(stiffness, strain_scale))
            }
            SpringLawSettings::ArctangentForce => Self::Arctangent(ArctangentLaw { stiffness }),
            SpringLawSettings::Curve(ref curve) => Self::curve(curve),
        }
    }

    /// The law through the points of `curve`.
    #[must_use]
    pub fn curve(curve: &TensionCurve) -> Self {
        Self::Curve(CurveLaw::new(curve))
    }

    /// Gives the law that it is to `visitor`, once for a loop over many springs.
    #[inline(always)]
    pub fn visit<V: LawVisitor>(&self, visitor: V) {
        // Small laws go by value, so that a loop need not read them again for each spring.
        match self {
            Self::Linear(law) => visitor.visit(*law),
            Self::Tangent(law) => visitor.visit(*law),
            Self::Arctangent(law) => visitor.visit(*law),
            Self::Curve(law) => visitor.visit(law),
            Self::ReducedTangent(law) => visitor.visit(*law),
            Self::Buckling(law) => visitor.visit(*law),
        }
    }

    /// Whether the tangent is the same at every extension.
    #[must_use]
    pub fn is_linear(&self) -> bool {
        matches!(self, Self::Linear(_))
    }
}

/// What is compiled apart for each law.
pub trait LawVisitor {
    /// Does it with `law`.
    fn visit<L: TensionLaw>(self, law: L);
}

impl TensionLaw for SpringLaw {
    fn tension(&self, extension: f64, rest_length: f64) -> f64 {
        match self {
            Self::Linear(law) => law.tension(extension, rest_length),
            Self::Tangent(law) => law.tension(extension, rest_length),
            Self::Arctangent(law) => law.tension(extension, rest_length),
            Self::Curve(law) => law.tension(extension, rest_length),
            Self::ReducedTangent(law) => law.tension(extension, rest_length),
            Self::Buckling(law) => law.tension(extension, rest_length),
        }
    }

    fn tangent(&self, extension: f64, rest_length: f64) -> f64 {
        match self {
            Self::Linear(law) => law.tangent(extension, rest_length),
            Self::Tangent(law) => law.tangent(extension, rest_length),
            Self::Arctangent(law) => law.tangent(extension, rest_length),
            Self::Curve(law) => law.tangent(extension, rest_length),
            Self::ReducedTangent(law) => law.tangent(extension, rest_length),
            Self::Buckling(law) => law.tangent(extension, rest_length),
        }
    }

    fn tension_and_tangent(&self, extension: f64, rest_length: f64) -> (f64, f64) {
        match self {
            Self::Linear(law) => law.tension_and_tangent(extension, rest_length),
            Self::Tangent(law) => law.tension_and_tangent(extension, rest_length),
            Self::Arctangent(law) => law.tension_and_tangent(extension, rest_length),
            Self::Curve(law) => law.tension_and_tangent(extension, rest_length),
            Self::ReducedTangent(law) => law.tension_and_tangent(extension, rest_length),
            Self::Buckling(law) => law.tension_and_tangent(extension, rest_length),
        }
    }

    fn tension_by_length(&self, tension: f64, at: SpringLength, rest_length: f64) -> f64 {
        match self {
            Self::Linear(law) => law.tension_by_length(tension, at, rest_length),
            Self::Tangent(law) => law.tension_by_length(tension, at, rest_length),
            Self::Arctangent(law) => law.tension_by_length(tension, at, rest_length),
            Self::Curve(law) => law.tension_by_length(tension, at, rest_length),
            Self::ReducedTangent(law) => law.tension_by_length(tension, at, rest_length),
            Self::Buckling(law) => law.tension_by_length(tension, at, rest_length),
        }
    }

    fn energy(&self, extension: f64, rest_length: f64) -> f64 {
        match self {
            Self::Linear(law) => law.energy(extension, rest_length),
            Self::Tangent(law) => law.energy(extension, rest_length),
            Self::Arctangent(law) => law.energy(extension, rest_length),
            Self::Curve(law) => law.energy(extension, rest_length),
            Self::ReducedTangent(law) => law.energy(extension, rest_length),
            Self::Buckling(law) => law.energy(extension, rest_length),
        }
    }

    fn energy_moment(&self, extension: f64, rest_length: f64) -> f64 {
        match self {
            Self::Linear(law) => law.energy_moment(extension, rest_length),
            Self::Tangent(law) => law.energy_moment(extension, rest_length),
            Self::Arctangent(law) => law.energy_moment(extension, rest_length),
            Self::Curve(law) => law.energy_moment(extension, rest_length),
            Self::ReducedTangent(law) => law.energy_moment(extension, rest_length),
            Self::Buckling(law) => law.energy_moment(extension, rest_length),
        }
    }
}
