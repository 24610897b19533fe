//! Cloth simulation in SI units: explicit mass-spring dynamics with the same bits on every machine.

pub mod force;
pub mod integrate;
pub mod model;
pub mod observe;
mod points;
mod run;
pub mod scene;
mod state;
pub mod write;

pub use model::Model;
pub use points::{Points, PointsMut};
pub use run::{Simulation, SimulationError, suggested_step};
pub use scene::Scene;
pub use state::State;
