//! From scene text to a checked [`Scene`].

mod settings;

pub use settings::*;
