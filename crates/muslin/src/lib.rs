//! Cloth simulation in SI units: explicit mass-spring dynamics with the same bits on every machine.

pub mod model;
mod points;
pub mod scene;
pub mod write;

pub use points::Points;
