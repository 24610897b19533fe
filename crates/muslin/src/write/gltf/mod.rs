//! `cloth.glb`: an animated binary glTF 2.0 that any viewer and modeller opens.

mod document;
mod layout;
#[cfg(test)]
mod tests;

use std::io::{self, Write};

use super::FrameSource;
use crate::Points;
use crate::model::Surface;
use document::{Bounds, document};
use layout::{Layout, has_area, indices, key_frames};

/// What a `.glb` says beside the shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GlbInfo<'a> {
    /// Name of the scene and of its animation.
    pub title: &'a str,
    /// Name of the object that each grid of the surface becomes, in order.
    pub cloth_names: &'a [&'a str],
    /// Frames per second of the animation [1/s]: those of the run, for it to play in real time.
    pub frame_rate: f64,
}

/// Writes the moving surface as a binary glTF 2.0, an object per grid.
///
/// Every frame after the first is a morph target: differences of positions [m], and of normals where a grid has area;
/// between frames both are interpolated linearly. Grids with area have texture coordinates too, u along the columns
/// and v along the rows, both from 0 to 1; the others are drawn as lines or as a point. A single frame gives a still.
///
/// A file larger than about 256 MiB or with more than 960 frames has frames left out evenly, never the first and the
/// last; the animation takes as long as with them. To draw a large cloth, thin the surface
/// ([`Surface::add_grid`]). Frames are read one at a time, each twice. The same input gives the same bytes.
///
/// # Errors
/// If `out` or `frames` fails; if there is no frame, no vertex, a name too few or too many, or the frame rate does not
/// give ascending times; if a coordinate does not fit `f32`, a frame lacks a particle of the surface, or the file
/// would be larger than its format allows (4 GiB).
///
/// # Panics
/// If the surface's grids do not hold all that it draws, as [`Surface::add_grid`] leaves it.
pub fn write_glb(
    mut out: impl Write,
    info: &GlbInfo,
    surface: &Surface,
    frames: &mut (impl FrameSource + ?Sized),
) -> io::Result<()> {
    check(info, surface, frames.frame_count())?;
    let keys = key_frames(frames.frame_count(), surface);
    let times = key_times(&keys, info.frame_rate)?;
    let too_large = || {
        let message = format!("a surface of {} vertices is too large for a .glb", surface.vertices.len());
        io::Error::new(io::ErrorKind::InvalidInput, message)
    };
    let layout = Layout::new(surface, keys.len()).ok_or_else(too_large)?;

    let mut shape = Shape::new(surface);
    let mut bounds = Vec::with_capacity(keys.len());
    for &frame in &keys {
        shape.read(frames, frame)?;
        bounds.push(shape.bounds());
    }

    let mut text = serde_json::to_vec(&document(info, surface, &layout, &keys, &times, &bounds))?;
    drop(bounds);
    // Chunks end at multiples of four bytes: text with spaces; the arrays do anyway.
    text.resize(text.len().next_multiple_of(4), b' ');
    let total = (12 + 8 + 8 + text.len() as u64).checked_add(layout.length());
    let total = total.and_then(|total| u32::try_from(total).ok()).ok_or_else(too_large)?;
    out.write_all(b"glTF")?;
    out.write_all(&2_u32.to_le_bytes())?;
    out.write_all(&total.to_le_bytes())?;
    // Both are smaller than the total, which fits.
    out.write_all(&(text.len() as u32).to_le_bytes())?;
    out.write_all(b"JSON")?;
    out.write_all(&text)?;
    drop(text);
    out.write_all(&(layout.length() as u32).to_le_bytes())?;
    out.write_all(b"BIN\0")?;

    let mut bytes = Vec::new();
    let mut shape = Shape::new(surface);
    shape.read(frames, keys[0])?;
    shape.append_to(&mut bytes);
    append_texture_coordinates(surface, &mut bytes);
    for grid in &surface.grids {
        bytes.extend(indices(surface, grid).1.iter().flat_map(|&vertex| {
            // Vertices of the surface become vertices of the grid's own mesh.
            (vertex - grid.vertices.start as u32).to_le_bytes()
        }));
    }
    out.write_all(&bytes)?;
    for &frame in &keys[1..] {
        bytes.clear();
        shape.read(frames, frame)?;
        shape.append_to(&mut bytes);
        out.write_all(&bytes)?;
    }
    write_animation(&mut out, &times)?;
    out.flush()
}

fn check(info: &GlbInfo, surface: &Surface, frame_count: usize) -> io::Result<()> {
    let grids = &surface.grids;
    let held = [
        grids.iter().map(|grid| grid.vertices.len()).sum::<usize>(),
        grids.iter().map(|grid| grid.triangles.len()).sum(),
        grids.iter().map(|grid| grid.lines.len()).sum(),
        grids.iter().map(|grid| grid.points.len()).sum(),
    ];
    let all = [surface.vertices.len(), surface.triangles.len(), surface.lines.len(), surface.points.len()];
    assert_eq!(held, all, "vertices, triangles, lines and points of the surface belong to its grids");
    let message = if frame_count == 0 {
        "there is no frame to write".to_owned()
    } else if surface.vertices.is_empty() {
        "there is nothing to draw".to_owned()
    } else if info.cloth_names.len() != grids.len() {
        format!("{} names for {} cloths", info.cloth_names.len(), grids.len())
    } else {
        return Ok(());
    };
    Err(io::Error::new(io::ErrorKind::InvalidInput, message))
}

/// Times of the keys [s].
fn key_times(keys: &[usize], frame_rate: f64) -> io::Result<Vec<f32>> {
    let times: Vec<f32> = keys.iter().map(|&frame| (frame as f64 / frame_rate) as f32).collect();
    let is_ascending = times.windows(2).all(|pair| pair[0] < pair[1]);
    if times[0] == 0.0 && is_ascending && times.iter().all(|time| time.is_finite()) {
        return Ok(times);
    }
    let message = format!("{frame_rate} frames per second give no ascending times");
    Err(io::Error::new(io::ErrorKind::InvalidInput, message))
}

/// Times, then for each key its row of weights.
fn write_animation(out: &mut impl Write, times: &[f32]) -> io::Result<()> {
    if times.len() < 2 {
        return Ok(());
    }
    let times_bytes: Vec<u8> = times.iter().flat_map(|time| time.to_le_bytes()).collect();
    out.write_all(&times_bytes)?;
    let mut weights = vec![0; (times.len() - 1) * 4];
    for key in 0..times.len() {
        weights.fill(0);
        if let Some(target) = key.checked_sub(1) {
            weights[target * 4..][..4].copy_from_slice(&1_f32.to_le_bytes());
        }
        out.write_all(&weights)?;
    }
    Ok(())
}

fn append_texture_coordinates(surface: &Surface, bytes: &mut Vec<u8>) {
    for grid in surface.grids.iter().filter(|grid| has_area(grid)) {
        for row in 0..grid.rows {
            for column in 0..grid.columns {
                let u = column as f32 / (grid.columns - 1) as f32;
                let v = row as f32 / (grid.rows - 1) as f32;
                bytes.extend([u, v].into_iter().flat_map(f32::to_le_bytes));
            }
        }
    }
}

/// The surface in the frame that was read last, less the frame that was read first.
struct Shape<'a> {
    surface: &'a Surface,
    particles: Points,
    normals: Vec<[f32; 3]>,
    /// Per vertex, as read: positions [m] and normals of the first frame, differences from it afterwards.
    current: Vec<[[f32; 3]; 2]>,
    first: Option<Vec<[[f32; 3]; 2]>>,
}

impl<'a> Shape<'a> {
    fn new(surface: &'a Surface) -> Self {
        let (particles, normals, current) = (Points::default(), Vec::new(), Vec::new());
        Self { surface, particles, normals, current, first: None }
    }

    fn read(&mut self, frames: &mut (impl FrameSource + ?Sized), frame: usize) -> io::Result<()> {
        if self.first.is_none() && !self.current.is_empty() {
            self.first = Some(std::mem::take(&mut self.current));
        }
        frames.read_positions(frame, &mut self.particles)?;
        let invalid = |message: String| Err(io::Error::new(io::ErrorKind::InvalidData, message));
        let count = self.particles.len();
        if let Some(particle) = self.surface.vertices.iter().find(|&&particle| count <= particle as usize) {
            return invalid(format!(
                "frame {frame} has {count} particles, but the surface needs particle {particle}"
            ));
        }
        self.surface.eval_normals(&self.particles, &mut self.normals);
        self.current.clear();
        for (vertex, &particle) in self.surface.vertices.iter().enumerate() {
            let position = self.particles.get(particle as usize);
            let [origin, first_normal] = self.first.as_ref().map_or([[0.0; 3]; 2], |first| first[vertex]);
            // From the rounded origin, so that its rounding error is not added to that of the difference.
            let difference = (position - glam::Vec3::from_array(origin).as_dvec3()).as_vec3();
            if !difference.is_finite() {
                return invalid(format!(
                    "particle {particle} of frame {frame} is at {position} m, which 32 bits do not hold"
                ));
            }
            let normal = glam::Vec3::from_array(self.normals[vertex]) - glam::Vec3::from_array(first_normal);
            self.current.push([difference.to_array(), normal.to_array()]);
        }
        Ok(())
    }

    /// Bounds of the current positions or differences, per grid.
    fn bounds(&self) -> Vec<Bounds> {
        let of_grid = |vertices: std::ops::Range<usize>| {
            let mut bounds = Bounds::EMPTY;
            self.current[vertices].iter().for_each(|[position, _]| bounds.include(*position));
            bounds
        };
        self.surface.grids.iter().map(|grid| of_grid(grid.vertices.clone())).collect()
    }

    /// Grid by grid: positions or differences, and normals or differences where the grid has area.
    fn append_to(&self, bytes: &mut Vec<u8>) {
        for grid in &self.surface.grids {
            let vertices = &self.current[grid.vertices.clone()];
            for array in 0..if has_area(grid) { 2 } else { 1 } {
                bytes.extend(vertices.iter().flat_map(|vertex| vertex[array]).flat_map(f32::to_le_bytes));
            }
        }
    }
}
