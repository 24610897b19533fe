//! Points and values as raw bytes: little-endian IEEE 754 doubles, `x y z` of each point.

use std::io::{self, Read, Write};

use glam::DVec3;

use crate::Points;

/// How many points are converted at a time.
pub(super) const CHUNK: usize = 2048;

/// Bytes of one point.
pub const POINT_BYTES: usize = 24;

/// Writes all `points`, `x y z` of each, as little-endian doubles.
///
/// # Errors
/// If `out` fails.
pub fn write_points(out: &mut (impl Write + ?Sized), points: &Points) -> io::Result<()> {
    let mut bytes = Vec::with_capacity(CHUNK.min(points.len()) * POINT_BYTES);
    for first in (0..points.len()).step_by(CHUNK) {
        bytes.clear();
        for index in first..points.len().min(first + CHUNK) {
            bytes.extend(points.get(index).to_array().into_iter().flat_map(f64::to_le_bytes));
        }
        out.write_all(&bytes)?;
    }
    Ok(())
}

/// Writes all `values` as little-endian doubles.
///
/// # Errors
/// If `out` fails.
pub fn write_values(out: &mut (impl Write + ?Sized), values: &[f64]) -> io::Result<()> {
    for chunk in values.chunks(CHUNK) {
        let bytes: Vec<u8> = chunk.iter().flat_map(|value| value.to_le_bytes()).collect();
        out.write_all(&bytes)?;
    }
    Ok(())
}

/// Overwrites `values` with the next of `input`.
///
/// # Errors
/// If `input` fails or ends early; `values` then hold what could be read.
pub fn read_values(input: &mut (impl Read + ?Sized), values: &mut [f64]) -> io::Result<()> {
    let mut bytes = vec![0; CHUNK.min(values.len()) * 8];
    for chunk in values.chunks_mut(CHUNK) {
        let bytes = &mut bytes[..chunk.len() * 8];
        input.read_exact(bytes)?;
        let (numbers, _) = bytes.as_chunks::<8>();
        for (value, number) in chunk.iter_mut().zip(numbers) {
            *value = f64::from_le_bytes(*number);
        }
    }
    Ok(())
}

/// Overwrites `points` with the next `count` points of `input`.
///
/// # Errors
/// If `input` fails or ends early; `points` then holds what could be read.
pub fn read_points(input: &mut (impl Read + ?Sized), count: usize, points: &mut Points) -> io::Result<()> {
    if points.len() != count {
        *points = Points::zeros(count);
    }
    let mut bytes = vec![0; CHUNK.min(count) * POINT_BYTES];
    for first in (0..count).step_by(CHUNK) {
        let bytes = &mut bytes[..CHUNK.min(count - first) * POINT_BYTES];
        input.read_exact(bytes)?;
        let (coordinates, _) = bytes.as_chunks::<8>();
        for (index, point) in (first..).zip(coordinates.chunks_exact(3)) {
            points.set(index, DVec3::from_array([0, 1, 2].map(|axis| f64::from_le_bytes(point[axis]))));
        }
    }
    Ok(())
}
