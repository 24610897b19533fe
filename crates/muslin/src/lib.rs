//! Cloth simulation in SI units: explicit mass-spring dynamics with the same bits on every machine.
//!
//! # A tour
//! A [`Scene`] is read from text and checked: after [`Scene::parse`] nothing in it is missing or out of range. A
//! [`Simulation`] builds a [`Model`], which stays as it is, and a [`State`], which an [`Integrator`] moves. What should be
//! known of a run is measured by an [`Observer`], which can look but not touch:
//!
//! ```
//! use muslin::integrate::Workers;
//! use muslin::observe::{Recorder, relative_residual};
//! use muslin::{Scene, Simulation};
//!
//! let text = r#"
//!     title = "A bead on a thread"
//!     run = { duration = 0.5, step = { constant = 8.333333333333e-4 } }
//!     environment = { gravity = [0.0, -9.81, 0.0] }
//!
//!     [fabric.thread]
//!     kind = "springs"
//!     particle_mass = 0.01
//!     drag = 0.0
//!     structural = { stiffness = 500.0, law = "linear" }
//!     shear = { stiffness = 0.0, law = "linear" }
//!     bend = { stiffness = 0.0, law = "linear" }
//!
//!     [[cloth]]
//!     name = "thread"
//!     fabric = "thread"
//!     grid = { columns = 1, rows = 2, height = 1.0 }
//!     place = { origin = [0, 0, 0], width_axis = [0, 0, 1], height_axis = [1, 0, 0] }
//!     pins = [{ row = 0 }]
//! "#;
//! let scene = Scene::parse(text)?;
//! let mut simulation = Simulation::new(&scene, Simulation::integrator(&scene, Workers::single()))?;
//! let mut recorder = Recorder::default();
//! simulation.observe(&mut [&mut recorder]); // the first frame, which no step leads to
//! while !simulation.is_finished() {
//!     simulation.advance(&mut [&mut recorder])?; // to the next frame
//! }
//! let last = simulation.frame();
//! assert_eq!(last.state.time, 0.5);
//! assert!(last.state.positions.get(1).y < -0.9, "the bead is nearly below the pin");
//! assert!(relative_residual(recorder.frames().iter().map(|frame| &frame.energies)) < 1e-4);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | module | what is there |
//! |---|---|
//! | [`scene`] | from text to a checked [`Scene`]; errors at line and column |
//! | [`model`] | what is constant: particles, grids, forces, and the surface to draw |
//! | [`force`](mod@force) | the trait [`Force`](force::Force), springs and their laws, gravity, wind |
//! | [`limit`] | corrections of springs that are too long |
//! | [`integrate`] | the trait [`Integrator`], central differences, the largest stable step, threads |
//! | [`observe`] | the trait [`Observer`], energies, strains, hashes, expectations |
//! | [`lab`] | virtual instruments: what a measured fabric gives on them |
//! | [`write`](mod@write) | formats, each to an `impl Write` |
//!
//! Stepping without [`Simulation`], as in a game loop, is shown by the example `step_by_hand`.
//!
//! # What holds everywhere
//! Units are SI, lengths in metres, y up. Arrays have an entry per particle; within a cloth of `columns` x `rows`, column
//! `i` of row `j` is particle `j * columns + i`. The library opens no files, reads no clock and prints nothing. The same
//! scene gives the same bits for every number of threads, on every machine: sums have a fixed order, and no result of a
//! step comes from a platform's own mathematics library.
//!
//! [`Integrator`]: integrate::Integrator
//! [`Observer`]: observe::Observer

mod aligned;
pub mod force;
mod instructions;
pub mod integrate;
pub mod lab;
pub mod limit;
pub mod model;
pub mod observe;
mod points;
mod run;
pub mod scene;
mod state;
mod statics;
pub mod write;

pub use aligned::AlignedArray;
pub use glam;
pub use instructions::InstructionSet;
pub use model::Model;
pub use points::{Points, PointsMut};
pub use run::{Simulation, SimulationError, initial_step, suggested_step};
pub use scene::Scene;
pub use state::{LimitWork, Motion, State, StepMemory, StepSummary};

/// The program in the README compiles.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
