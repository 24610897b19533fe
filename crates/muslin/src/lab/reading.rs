//! What an instrument says, and how the specimen went.

use crate::scene::units::{
    GRAM_FORCE_CM_PER_CM2, GRAM_FORCE_CM2_PER_CM, GRAM_FORCE_PER_CM, STANDARD_GRAVITY,
};
use crate::{Model, Points};

/// A unit of an instrument: its symbol, and what it is in SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// Symbol of the unit in SI.
    pub si: &'static str,
    /// Symbol of the instrument's unit, the same if it has none of its own.
    pub symbol: &'static str,
    /// The instrument's unit in SI.
    pub size: f64,
}

impl Unit {
    /// A number without a unit.
    pub const ONE: Self = Self::plain("1");
    /// A share or strain, in per cent.
    pub const PERCENT: Self = Self { si: "1", symbol: "%", size: 0.01 };
    /// A length, in millimetres.
    pub const LENGTH: Self = Self { si: "m", symbol: "mm", size: 1e-3 };
    /// An angle, in degrees.
    pub const ANGLE: Self = Self { si: "rad", symbol: "°", size: std::f64::consts::PI / 180.0 };
    /// Tension or shear force per width.
    pub const TENSION: Self = Self { si: "N/m", symbol: "gf/cm", size: GRAM_FORCE_PER_CM };
    /// Shear modulus, per angle.
    pub const SHEAR: Self = Self {
        si: "N/m per rad",
        symbol: "gf/(cm deg)",
        size: GRAM_FORCE_PER_CM * 180.0 / std::f64::consts::PI,
    };
    /// Curvature.
    pub const CURVATURE: Self = Self { si: "1/m", symbol: "1/cm", size: 100.0 };
    /// Moment per width.
    pub const MOMENT: Self = Self { si: "N", symbol: "gf cm/cm", size: 1e-3 * STANDARD_GRAVITY };
    /// Bending rigidity per width.
    pub const RIGIDITY: Self = Self { si: "N m", symbol: "gf cm²/cm", size: GRAM_FORCE_CM2_PER_CM };
    /// Work per area.
    pub const WORK: Self = Self { si: "J/m²", symbol: "gf cm/cm²", size: GRAM_FORCE_CM_PER_CM2 };

    /// A unit of SI that is also the instrument's.
    #[must_use]
    pub const fn plain(symbol: &'static str) -> Self {
        Self { si: symbol, symbol, size: 1.0 }
    }
}

/// One quantity at every step of a test.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// What it is: "strain".
    pub name: &'static str,
    /// Its units.
    pub unit: Unit,
    /// Its values, in SI.
    pub values: Vec<f64>,
}

/// A value that an instrument gives, in SI, beside the one that the fabric was given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Its name on the instrument: "EMT".
    pub name: &'static str,
    /// What it is, in words.
    pub what: &'static str,
    /// Its units.
    pub unit: Unit,
    /// What the instrument measured.
    pub measured: f64,
    /// What the fabric was given, or by the law that it was given what the instrument would read of it as new; `None` where that
    /// is no property of the fabric.
    pub input: Option<f64>,
}

impl Reading {
    /// The measured value's difference from the input, relative to it; `None` without an input other than zero.
    #[must_use]
    pub fn relative_difference(&self) -> Option<f64> {
        self.input.filter(|input| *input != 0.0).map(|input| self.measured / input - 1.0)
    }
}

/// The specimen's way through a test: where its particles were whenever it was at rest.
#[derive(Debug)]
pub struct Record {
    /// The specimen, as it was last.
    pub model: Model,
    /// Positions [m] of all particles, once per reading.
    pub frames: Vec<Points>,
    /// The largest force [N] left on a free particle in any of them.
    pub residual: f64,
    /// The same relative to the largest force on a clamp or of a load then.
    pub relative_residual: f64,
}
