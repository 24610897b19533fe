//! What does not change during a run.

mod surface;

pub use surface::{Surface, SurfaceGrid};
