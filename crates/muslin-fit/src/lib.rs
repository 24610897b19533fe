//! Identification of measured fabrics from the data of textile instruments.
//!
//! Text of data files comes in, constants with standard errors and the table of a scene file go out; nothing here opens a file:
//!
//! ```
//! use muslin_fit::{FabricFit, FabricText, Label, Measurement, parse_areal_density};
//!
//! // The tensile values of KES that are published of a worsted suiting.
//! let warp = b"emt [%],lt [1],force [gf/cm]\n4.7,0.55,500\n";
//! let measurements = [Measurement::read("warp.csv", warp, Label::parse("warp")?)?];
//! let fit = FabricFit::new(parse_areal_density("200 g/m2")?, &measurements)?;
//!
//! let modulus = fit.warp.as_ref().and_then(|fit| fit.outcome.parameter("K")).expect("it was measured");
//! assert!((modulus.value - 3623.0).abs() < 1.0); // N/m
//! assert!(fit.undetermined.iter().any(|quantity| quantity.what == "tension along the weft"));
//! assert!(FabricText::new(&fit, "suiting", "published").toml.contains("strain_scale = 0.0358"));
//! # Ok::<(), muslin_fit::FitError>(())
//! ```
//!
//! | from | to |
//! |---|---|
//! | [`Measurement`] | a data file, checked, in SI units; errors at the line |
//! | [`FabricFit`] | laws and constants of all tests, and what the data do not say |
//! | [`FabricText`] | the fabric's table, every value with its standard error and its file |
//!
//! The search for the least sum of squares is that of MINPACK, from the crate `levenberg-marquardt`, on five parameters at most; its
//! linear algebra takes functions from `libm` and sums in a fixed order.

mod areal_density;
mod bending;
mod columns;
mod elastica;
mod error;
mod estimate;
mod fabric;
mod fabric_text;
mod fit;
mod friction;
mod kes_values;
mod label;
mod least_squares;
mod measurement;
mod outcome;
mod path;
mod statistics;
mod table;
mod tension;

pub use areal_density::parse_areal_density;
pub use columns::Kind;
pub use elastica::load_of_chord;
pub use error::FitError;
pub use estimate::{Estimate, Parameter, Undetermined};
pub use fabric_text::FabricText;
pub use fit::FabricFit;
pub use friction::SlopeFit;
pub use label::{Direction, Label, Test};
pub use measurement::{Data, Measurement};
pub use outcome::{FittedPoint, Outcome};
pub use statistics::CONFIDENCE;
pub use tension::{LARGEST_MISFIT, TensionFit};
