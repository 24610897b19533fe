//! A small software renderer for one kind of picture: a cloth in a studio.
//!
//! [`Mesh`] holds what is drawn, [`Camera`] chooses the view, [`draw`] makes the [`Picture`]. Each sample of a pixel knows
//! its nearest triangle; each triangle that shows in a pixel is shaded once there. Key light and surroundings are
//! sampled at the vertices by depth maps from many directions. All sums have a fixed order and transcendental
//! functions come from `libm`, so that a picture has the same bytes on every machine.

mod camera;
mod fabric;
mod fill;
mod light;
mod mesh;
mod picture;
mod shape;
mod spline;
mod studio;

pub(super) use camera::Camera;
pub(super) use mesh::{Material, Mesh};
pub(super) use picture::{Picture, draw};
pub(super) use shape::{BEAD_RADIUS, LONE_BEAD_RADIUS, add_lone_particle, add_pins, add_shape};

/// From 0 at `from` and before to 1 at `to` and beyond, without a corner: 3 t² − 2 t³.
fn smooth_step(from: f64, to: f64, value: f64) -> f64 {
    let t = ((value - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
