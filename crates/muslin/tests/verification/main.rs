//! The library against closed forms, discrete exact solutions and conservation laws.
//!
//! Errors are maxima over a whole run: at its end, after whole periods, leading terms cancel.

#[path = "../common/mod.rs"]
mod common;

mod adaptive;
mod aerodynamics;
mod cantilever;
mod catenary;
mod choi_ko;
mod conservation;
mod damping;
mod energy;
mod estimator;
mod falling;
mod flutter;
mod folding;
mod friction;
mod hanging_chain;
mod instruments;
mod laws;
mod limits;
mod measured;
mod membrane;
mod moduli;
mod order;
mod oscillator;
mod pendulum;
mod picture_frame;
mod pins;
mod printed_form;
mod report;
mod stability;
mod statics;
mod wind_spectrum;
