//! The frames of a page: quantised, predicted, deflated, in base64.
//!
//! Before compression the payload is, in little-endian order:
//!
//! ```text
//! triangles  3 × u32 each, vertex indices     lines  2 × u32 each     points  u32 each     pins  u32 each
//! per frame: origin  3 × i32 [quanta]
//!            per axis: low bytes of every vertex, high bytes of every vertex
//!            strain byte of every vertex
//! ```
//!
//! A coordinate is a whole number of quanta from the run's lowest corner, `g = round((x − low) / quantum)`. It is
//! predicted from the two frames before and from the vertex before, and sixteen bits of the difference are kept:
//!
//! ```text
//! t(f, v) = 2 g(f−1, v) − g(f−2, v)                          (g(0, v) in frame 1, 0 in frame 0)
//! d(f, v) = g(f, v) − t(f, v) − (g(f, v−1) − t(f, v−1))       (the last bracket is the origin for v = 0 of frame 0)
//! ```
//!
//! stored as `zigzag(d mod 2¹⁶)`. The reader finds `g mod 2¹⁶`, and `g` itself because every coordinate of a frame lies
//! within 2¹⁶ quanta above the frame's origin.
//!
//! A strain is kept as `s = round(127 sign(e) √(|e| / largest))`, minus the same of the frame before, modulo 2⁸.

use std::io::{self, Write};

use base64::engine::general_purpose::STANDARD;
use base64::write::EncoderWriter;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use glam::DVec3;

use crate::Points;
use crate::model::Surface;
use crate::write::FrameSource;

/// Steps of a strain on either side of zero.
const STRAIN_STEPS: f64 = 127.0;

/// Where the vertices of a run lie, and how finely the payload resolves it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PayloadBounds {
    low: DVec3,
    high: DVec3,
    largest_frame_extent: f64,
    largest_strain: f64,
}

impl PayloadBounds {
    /// Reads the frames `shown` for their bounds and their largest strain.
    pub(super) fn measure(
        surface: &Surface,
        shown: &[usize],
        strains: &mut dyn FnMut(&Points, &mut Vec<f32>),
        frames: &mut (impl FrameSource + ?Sized),
    ) -> io::Result<Self> {
        let (mut positions, mut frame_strains) = (Points::default(), Vec::new());
        let mut bounds = Self {
            low: DVec3::INFINITY,
            high: DVec3::NEG_INFINITY,
            largest_frame_extent: 0.0,
            largest_strain: 0.0,
        };
        for &frame in shown {
            frames.read_positions(frame, &mut positions)?;
            strains(&positions, &mut frame_strains);
            let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            for &particle in &surface.vertices {
                let point = positions.get(particle as usize);
                if !point.is_finite() {
                    return Err(invalid(frame, particle, "position", "finite"));
                }
                (low, high) = (low.min(point), high.max(point));
                let strain = f64::from(frame_strains[particle as usize]).abs();
                if strain.is_nan() {
                    return Err(invalid(frame, particle, "strain", "a number"));
                }
                if strain.is_finite() {
                    bounds.largest_strain = bounds.largest_strain.max(strain);
                }
            }
            (bounds.low, bounds.high) = (bounds.low.min(low), bounds.high.max(high));
            bounds.largest_frame_extent = bounds.largest_frame_extent.max((high - low).max_element());
        }
        if !(bounds.high - bounds.low).is_finite() {
            let message = "the extent of the run is too large for a number";
            return Err(io::Error::new(io::ErrorKind::InvalidData, message));
        }
        Ok(bounds)
    }

    /// Lowest coordinates [m] of any vertex in any frame.
    pub(super) fn low(&self) -> DVec3 {
        self.low
    }

    /// Largest magnitude [1] of a finite strain.
    pub(super) fn largest_strain(&self) -> f64 {
        self.largest_strain
    }

    /// Size of a quantum [m]: a frame spans at most 65534 of them, so that its ends still differ by at most 65535
    /// when both are rounded, and the run at most 2³⁰. Positive even where the run has no extent.
    pub(super) fn quantum(&self) -> f64 {
        let run_extent = (self.high - self.low).max_element();
        let quantum = (self.largest_frame_extent / 65534.0).max(run_extent / f64::from(1u32 << 30));
        quantum.max(f64::MIN_POSITIVE)
    }

    /// Extent of the run [quanta].
    pub(super) fn extent_quanta(&self) -> [i32; 3] {
        self.quantise(self.high)
    }

    /// `point` [m] in whole quanta from the lowest corner.
    fn quantise(&self, point: DVec3) -> [i32; 3] {
        ((point - self.low) / self.quantum()).round().as_ivec3().to_array()
    }

    /// `strain` [1] in steps.
    fn quantise_strain(&self, strain: f32) -> i8 {
        let limited = f64::from(strain).clamp(-self.largest_strain, self.largest_strain);
        if limited == 0.0 {
            return 0;
        }
        ((limited.abs() / self.largest_strain).sqrt().copysign(limited) * STRAIN_STEPS).round() as i8
    }
}

fn invalid(frame: usize, particle: u32, quantity: &str, rule: &str) -> io::Error {
    let message = format!("frame {frame}: the {quantity} of particle {particle} is not {rule}");
    io::Error::new(io::ErrorKind::InvalidData, message)
}

/// Writes shape and frames as the text of the page's payload element.
pub(super) fn write_payload(
    out: impl Write,
    surface: &Surface,
    pinned: &[u32],
    bounds: &PayloadBounds,
    shown: &[usize],
    strains: &mut dyn FnMut(&Points, &mut Vec<f32>),
    frames: &mut (impl FrameSource + ?Sized),
) -> io::Result<()> {
    let mut deflate = ZlibEncoder::new(EncoderWriter::new(out, &STANDARD), Compression::default());
    let triangles = surface.triangles.as_flattened();
    let indices = [triangles, surface.lines.as_flattened(), &surface.points, pinned];
    for index in indices.into_iter().flatten() {
        deflate.write_all(&index.to_le_bytes())?;
    }
    let mut encoder = FrameEncoder::new(surface.vertices.len());
    let (mut positions, mut frame_strains) = (Points::default(), Vec::new());
    for &frame in shown {
        frames.read_positions(frame, &mut positions)?;
        strains(&positions, &mut frame_strains);
        deflate.write_all(encoder.encode(surface, bounds, &positions, &frame_strains))?;
    }
    deflate.finish()?.finish()?;
    Ok(())
}

/// What prediction needs of the frames before, and room for the next.
struct FrameEncoder {
    frames_encoded: usize,
    /// Coordinates [quanta] of the frame now, one before and two before.
    now: Vec<[i32; 3]>,
    before: Vec<[i32; 3]>,
    two_before: Vec<[i32; 3]>,
    /// Strains [steps] of the frame before.
    strains_before: Vec<i8>,
    bytes: Vec<u8>,
}

impl FrameEncoder {
    fn new(vertex_count: usize) -> Self {
        let zeros = vec![[0; 3]; vertex_count];
        Self {
            frames_encoded: 0,
            now: zeros.clone(),
            before: zeros.clone(),
            two_before: zeros,
            strains_before: vec![0; vertex_count],
            bytes: Vec::new(),
        }
    }

    /// The next frame's part of the payload.
    fn encode(
        &mut self,
        surface: &Surface,
        bounds: &PayloadBounds,
        positions: &Points,
        strains: &[f32],
    ) -> &[u8] {
        let vertex_count = surface.vertices.len();
        for (coordinates, &particle) in self.now.iter_mut().zip(&surface.vertices) {
            *coordinates = bounds.quantise(positions.get(particle as usize));
        }
        let origin = [0, 1, 2].map(|axis| self.now.iter().map(|c| c[axis]).min().unwrap_or(0));
        self.bytes.clear();
        self.bytes.extend(origin.iter().flat_map(|coordinate| coordinate.to_le_bytes()));
        for (axis, &axis_origin) in origin.iter().enumerate() {
            let low_bytes = self.bytes.len();
            self.bytes.resize(low_bytes + 2 * vertex_count, 0);
            let mut drift_before = if self.frames_encoded == 0 { axis_origin } else { 0 };
            for vertex in 0..vertex_count {
                let predicted = match self.frames_encoded {
                    0 => 0,
                    1 => self.before[vertex][axis],
                    _ => {
                        self.before[vertex][axis].wrapping_mul(2).wrapping_sub(self.two_before[vertex][axis])
                    }
                };
                let drift = self.now[vertex][axis].wrapping_sub(predicted);
                let [low, high] = zigzag(drift.wrapping_sub(drift_before)).to_le_bytes();
                self.bytes[low_bytes + vertex] = low;
                self.bytes[low_bytes + vertex_count + vertex] = high;
                drift_before = drift;
            }
        }
        for (before, &particle) in self.strains_before.iter_mut().zip(&surface.vertices) {
            let strain = bounds.quantise_strain(strains[particle as usize]);
            self.bytes.push(strain.wrapping_sub(*before).cast_unsigned());
            *before = strain;
        }
        std::mem::swap(&mut self.before, &mut self.two_before);
        std::mem::swap(&mut self.now, &mut self.before);
        self.frames_encoded += 1;
        &self.bytes
    }
}

/// The low sixteen bits of `value`, folded so that small magnitudes of either sign become small numbers.
fn zigzag(value: i32) -> u16 {
    let low = value as i16;
    ((low << 1) ^ (low >> 15)).cast_unsigned()
}
