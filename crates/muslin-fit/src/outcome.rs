//! What was identified from one file.

use crate::columns::Kind;
use crate::estimate::{Estimate, Parameter, Undetermined};
use crate::label::Direction;

/// The fit of one test.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Name of the file.
    pub file: String,
    /// What the file holds.
    pub kind: Kind,
    /// What the specimen was stretched or bent along.
    pub direction: Option<Direction>,
    /// The constants of the law.
    pub parameters: Vec<Parameter>,
    /// Correlations of the constants, in their order; empty where nothing tells them.
    pub correlations: Vec<Vec<f64>>,
    /// How ill the constants are told apart: ratio of the largest to the least singular value of the derivatives, each scaled to
    /// one. 1 at best; above 10⁴ two constants do the same.
    pub condition: f64,
    /// What else follows from the data, such as widths of a loop.
    pub results: Vec<Parameter>,
    /// What the law gives, what was measured, and at what, in SI units; empty of values one a specimen.
    pub points: Vec<FittedPoint>,
    /// Standard deviation of what was measured from the law, in the unit of what was measured; none of fewer than two values.
    pub scatter: Option<f64>,
    /// Whether the scatter keeps its sign for longer than chance does, so that it is the law's fault.
    pub is_systematic: bool,
    /// How the law was chosen, and what else a reader should know; sentences without full stop.
    pub notes: Vec<String>,
    /// What the data do not say.
    pub undetermined: Vec<Undetermined>,
}

/// A measured point beside its law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FittedPoint {
    /// Strain [1], angle [rad], curvature [1/m] or angle of the chord [rad].
    pub at: f64,
    /// Tension or force per width [N/m], moment per width [N], or overhang [m].
    pub measured: f64,
    /// The same by the law.
    pub fitted: f64,
}

/// The least condition of two constants that the data do not tell apart.
pub(crate) const WORST_CONDITION: f64 = 1e4;

impl Outcome {
    /// The constant with this letter.
    #[must_use]
    pub fn parameter(&self, symbol: &str) -> Option<Estimate> {
        let all = self.parameters.iter().chain(&self.results);
        all.clone().find(|parameter| parameter.symbol == symbol).map(|parameter| parameter.estimate)
    }

    /// What it is about, as in `tension along the warp`.
    #[must_use]
    pub fn subject(&self) -> String {
        let quantity = match self.kind.test() {
            crate::Test::Tensile => "tension",
            crate::Test::Shear => "shear",
            crate::Test::Bend | crate::Test::Cantilever => "bending",
        };
        subject(quantity, self.direction)
    }
}

/// `quantity` with the direction that it is along.
pub(crate) fn subject(quantity: &str, direction: Option<Direction>) -> String {
    match direction {
        None => quantity.to_owned(),
        Some(Direction::Bias) => format!("{quantity} at 45 degrees"),
        Some(direction) => format!("{quantity} along the {direction}"),
    }
}
