//! Formats, each written to an `impl Write`. Nothing here opens a file.

mod gltf;
pub mod npz;
mod poster;
mod raster;
mod raw;
mod series;
mod trajectory;
mod view;

use std::io;

pub use view::{VIEW_VERTEX_FRAMES, ViewInfo, ViewSeries, write_view};

use crate::Points;

pub use gltf::{GlbInfo, write_glb};
pub use poster::write_poster;
pub use raw::{POINT_BYTES, read_points, read_values, write_points, write_values};
pub use series::{SeriesWriter, write_series};
pub use trajectory::{MotionSource, TrajectoryReader, write_trajectory};

/// The frames of a run, read again one at a time and in any order.
///
/// Writers take frames from here rather than from memory, so that a long run of a large cloth needs no more memory than
/// a short one.
pub trait FrameSource {
    /// Number of frames, the first at time zero.
    fn frame_count(&self) -> usize;

    /// Overwrites `positions` with the positions [m] of all particles in frame `frame`.
    ///
    /// # Errors
    /// If the frame cannot be read.
    fn read_positions(&mut self, frame: usize, positions: &mut Points) -> io::Result<()>;
}

/// Frames in memory: positions [m] of all particles, frame by frame.
impl FrameSource for [Points] {
    fn frame_count(&self) -> usize {
        self.len()
    }

    fn read_positions(&mut self, frame: usize, positions: &mut Points) -> io::Result<()> {
        positions.clone_from(&self[frame]);
        Ok(())
    }
}
