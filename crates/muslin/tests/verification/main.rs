//! The library against closed forms, discrete exact solutions and conservation laws.
//!
//! Errors are maxima over a whole run: at its end, after whole periods, leading terms cancel.

#[path = "../common/mod.rs"]
mod common;

mod conservation;
mod energy;
mod falling;
mod laws;
mod limits;
mod order;
mod oscillator;
mod pins;
mod printed_form;
mod stability;
mod statics;
