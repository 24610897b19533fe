//! From scene text to a checked [`Scene`].

mod curve;
mod data;
mod edit;
mod error;
mod excerpt;
mod keyframes;
mod library;
mod measured;
mod read;
mod settings;

pub use curve::{TensionCurve, TensionCurveError};
pub use data::{DataFile, MAX_DATA_BYTES};
pub use edit::set_value;
pub use error::{Position, SceneError, SceneErrorKind};
pub use keyframes::{Keyframe, Keyframes, KeyframesError};
pub use library::LibraryFabric;
pub(crate) use measured::units;
pub use measured::{
    BendingRigidity, KesTensile, KesTensileError, MeasuredFabric, MembraneTension,
    rigidity_from_bending_length, shear_modulus_from_bias_extension, shear_modulus_per_radian,
};
pub use settings::*;

/// The longest scene text [B] that [`Scene::parse`] reads.
pub const MAX_SCENE_BYTES: usize = 1 << 20;

/// The most particles that all cloths of a scene may have together.
pub const MAX_PARTICLES: u64 = 1 << 31;

/// The most frames after the first that a run may have.
pub const MAX_FRAME_INTERVALS: u64 = 10_000_000;

/// The most steps from one frame to the next.
pub const MAX_STEPS_PER_FRAME: u64 = u32::MAX as u64;

/// JSON Schema (draft 2020-12) of the scene file, with descriptions and units, for editors.
///
/// It cannot say all that [`Scene::parse`] checks: whether a duration is a whole number of frames, for instance.
pub const JSON_SCHEMA: &str = include_str!("schema.json");
