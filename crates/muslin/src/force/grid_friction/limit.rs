//! The force at which an element of friction slips.

use crate::force::law::{LawVisitor, SpringLaw, TensionLaw};

/// The force Y along the coordinate q at which an element slips.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum FrictionLimit {
    /// Y = Y₀ + c |q|
    Affine { at_rest: f64, growth: f64 },
    /// Y = μ f(q) in tension, none in compression, with the elastic tension f [N] along the yarns.
    Tension { law: SpringLaw, ratio: f64, rest_length: f64 },
}

/// A limit as loops over elements have it.
pub(super) trait SlipLimit {
    /// Whether Y is not the same at every coordinate.
    const GROWS: bool;

    /// Y and dY/dq at the `coordinate` q.
    fn limit_and_growth(&self, coordinate: f64) -> [f64; 2];
}

/// What is compiled apart for each kind of limit.
pub(super) trait LimitVisitor {
    /// Does it with `limit`.
    fn visit<L: SlipLimit>(self, limit: L);
}

impl FrictionLimit {
    /// Gives the limit that it is to `visitor`, once for a loop over many elements.
    #[inline(always)]
    pub(super) fn visit(&self, visitor: impl LimitVisitor) {
        match *self {
            Self::Affine { at_rest, growth: 0.0 } => visitor.visit(ConstantLimit { at_rest }),
            Self::Affine { at_rest, growth } => visitor.visit(AffineLimit { at_rest, growth }),
            Self::Tension { ref law, ratio, rest_length } => {
                law.visit(WithTension { visitor, ratio, rest_length });
            }
        }
    }
}

/// Y = Y₀
struct ConstantLimit {
    at_rest: f64,
}

impl SlipLimit for ConstantLimit {
    const GROWS: bool = false;

    #[inline(always)]
    fn limit_and_growth(&self, _coordinate: f64) -> [f64; 2] {
        [self.at_rest, 0.0]
    }
}

/// Y = Y₀ + c |q|
struct AffineLimit {
    at_rest: f64,
    growth: f64,
}

impl SlipLimit for AffineLimit {
    const GROWS: bool = true;

    #[inline(always)]
    fn limit_and_growth(&self, coordinate: f64) -> [f64; 2] {
        let limit = self.at_rest + self.growth * coordinate.abs();
        [limit, if coordinate < 0.0 { -self.growth } else { self.growth }]
    }
}

/// Y = μ f(q)
struct TensionLimit<L> {
    law: L,
    ratio: f64,
    rest_length: f64,
}

impl<L: TensionLaw> SlipLimit for TensionLimit<L> {
    const GROWS: bool = true;

    #[inline(always)]
    fn limit_and_growth(&self, coordinate: f64) -> [f64; 2] {
        let (tension, tangent) = self.law.tension_and_tangent(coordinate, self.rest_length);
        let share = if 0.0 < coordinate { self.ratio } else { 0.0 };
        [share * tension, share * tangent]
    }
}

/// Makes a limit of a law of tension, for `visitor`.
struct WithTension<V> {
    visitor: V,
    ratio: f64,
    rest_length: f64,
}

impl<V: LimitVisitor> LawVisitor for WithTension<V> {
    #[inline(always)]
    fn visit<L: TensionLaw>(self, law: L) {
        let Self { visitor, ratio, rest_length } = self;
        visitor.visit(TensionLimit { law, ratio, rest_length });
    }
}
