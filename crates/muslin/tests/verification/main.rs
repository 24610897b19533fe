//! The library against closed forms, discrete exact solutions and conservation laws.
//!
//! Errors are maxima over a whole run: at its end, after whole periods, leading terms cancel.

#[path = "../common/mod.rs"]
mod common;

mod aerodynamics;
mod conservation;
mod energy;
mod falling;
mod flutter;
mod laws;
mod order;
mod oscillator;
mod printed_form;
mod stability;
mod statics;
mod wind_spectrum;
