//! Why a test gives no result.

use super::{Resolution, Rest};

/// Why an instrument gives no result.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LabError {
    /// Too few or too many cells.
    #[error(
        "a specimen of {cells} cells between its clamps is none: it must have {} to {}",
        Resolution::RANGE[0],
        Resolution::RANGE[1]
    )]
    Resolution {
        /// The cells asked for.
        cells: usize,
    },
    /// The fabric resists shear more than stretch, so that no grid has its values.
    #[error(
        "no grid can have the fabric's values: its shear modulus is {shear_modulus} N/m, but must be below {limit} N/m, \
         the mean of its least moduli along warp and weft"
    )]
    ShearAboveStretch {
        /// Shear modulus G [N/m].
        shear_modulus: f64,
        /// √(K_warp K_weft) [N/m].
        limit: f64,
    },
    /// The instrument measures what the fabric does not have.
    #[error("the fabric has no {what}, so there is nothing for this instrument to measure")]
    Nothing {
        /// What it lacks.
        what: &'static str,
    },
    /// The tensile test does not reach its greatest tension.
    #[error("the tension is only {tension} N/m at a strain of {strain}, but the test goes up to {force} N/m")]
    OutOfReach {
        /// Tension per width [N/m] reached.
        tension: f64,
        /// Strain [1] there.
        strain: f64,
        /// Tension per width [N/m] that the test goes up to.
        force: f64,
    },
    /// The specimen does not come to rest.
    #[error(
        "the specimen does not come to rest at {place}: after {} steps a force of {:e} N is left, but must be below {:e} N",
        .rest.steps,
        .rest.residual,
        .rest.allowed()
    )]
    NotAtRest {
        /// Where in the test: "an angle of 3.5°".
        place: String,
        /// What is left of the forces.
        rest: Rest,
    },
}
