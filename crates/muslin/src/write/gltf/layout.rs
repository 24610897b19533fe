//! Which frames become keys, and where each array lies in the binary chunk.

use std::ops::Range;

use crate::model::{Surface, SurfaceGrid};

/// About how large a file may become before frames are left out [byte].
const SIZE_BUDGET: u64 = 256 << 20;

/// Most keys. Viewers that keep one uniform per morph target, as three.js does, have 1024 of them on most devices.
const MOST_KEYS: usize = 960;

/// What the JSON says of one array of a target [byte], roughly.
const ACCESSOR_TEXT: u64 = 160;

/// Bytes of a vector of three `f32`, of one of two, and of a scalar or an index.
const VEC3: u64 = 12;
const VEC2: u64 = 8;
const SCALAR: u64 = 4;

/// The frames to write, ascending: evenly spread from the first to the last.
pub(super) fn key_frames(frame_count: usize, surface: &Surface) -> Vec<usize> {
    let last = frame_count.saturating_sub(1);
    let bytes_per_key = frame_length(surface) + surface.grids.len() as u64 * 2 * ACCESSOR_TEXT;
    let fits = |intervals: usize| {
        let targets = intervals as u64;
        let size = targets.saturating_mul(bytes_per_key).saturating_add(targets * targets * SCALAR);
        intervals < MOST_KEYS && size <= SIZE_BUDGET
    };
    let intervals = (1..=last).map(|stride| last.div_ceil(stride)).find(|&intervals| fits(intervals));
    // Two keys are the least; a single frame needs no interval.
    let intervals = intervals.unwrap_or(last.min(1)) as u128;
    (0..=intervals).map(|n| (n * last as u128 / intervals.max(1)) as usize).collect()
}

/// Bytes of one frame: positions, and normals of what has area.
fn frame_length(surface: &Surface) -> u64 {
    surface.grids.iter().map(|grid| vec3_length(grid) * if has_area(grid) { 2 } else { 1 }).sum()
}

fn vec3_length(grid: &SurfaceGrid) -> u64 {
    grid.vertices.len() as u64 * VEC3
}

/// Whether a grid is drawn with triangles, and so has normals and texture coordinates.
pub(super) fn has_area(grid: &SurfaceGrid) -> bool {
    !grid.triangles.is_empty()
}

/// Vertices of the primitives that a grid is drawn with.
pub(super) fn indices<'a>(surface: &'a Surface, grid: &SurfaceGrid) -> (Mode, &'a [u32]) {
    if has_area(grid) {
        (Mode::Triangles, surface.triangles[grid.triangles.clone()].as_flattened())
    } else if !grid.lines.is_empty() {
        (Mode::Lines, surface.lines[grid.lines.clone()].as_flattened())
    } else {
        (Mode::Points, &surface.points[grid.points.clone()])
    }
}

/// What a primitive's vertices make.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mode {
    Points = 0,
    Lines = 1,
    Triangles = 4,
}

/// Sections of the binary chunk [byte], one after the other; each is a buffer view unless it is empty.
pub(super) struct Layout {
    /// Per grid: positions, normals where it has area; all of the first frame.
    pub(super) base: Range<u64>,
    /// Per grid with area: texture coordinates.
    pub(super) texture: Range<u64>,
    /// Per grid: indices.
    pub(super) indices: Range<u64>,
    /// Per key after the first, per grid: as in `base`, less the first frame.
    pub(super) targets: Range<u64>,
    /// Key times, then per key a weight for each target.
    pub(super) animation: Range<u64>,
}

impl Layout {
    /// `None` if the chunk does not fit 64 bits.
    pub(super) fn new(surface: &Surface, key_count: usize) -> Option<Self> {
        let index_count: usize = surface.grids.iter().map(|grid| indices(surface, grid).1.len()).sum();
        let texture_length: u64 = surface
            .grids
            .iter()
            .filter(|grid| has_area(grid))
            .map(|grid| grid.vertices.len() as u64 * VEC2)
            .sum();
        let (keys, targets) = (key_count as u64, key_count as u64 - 1);
        let mut end = 0_u64;
        let mut section = |length: Option<u64>| {
            let start = end;
            end = end.checked_add(length?)?;
            Some(start..end)
        };
        Some(Self {
            base: section(Some(frame_length(surface)))?,
            texture: section(Some(texture_length))?,
            indices: section(Some(index_count as u64 * SCALAR))?,
            targets: section(frame_length(surface).checked_mul(targets))?,
            animation: section(if targets == 0 { Some(0) } else { keys.checked_mul(keys * SCALAR) })?,
        })
    }

    /// Size of the binary chunk [byte].
    pub(super) fn length(&self) -> u64 {
        self.animation.end
    }
}

/// Places within a frame [byte from its start], grid by grid: of positions, and of normals where there are any.
pub(super) fn frame_places(surface: &Surface) -> Vec<(u64, Option<u64>)> {
    let mut end = 0;
    let mut places = Vec::new();
    for grid in &surface.grids {
        let positions = end;
        end += vec3_length(grid);
        let normals = has_area(grid).then_some(end);
        if normals.is_some() {
            end += vec3_length(grid);
        }
        places.push((positions, normals));
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sheet(columns: usize, rows: usize) -> Surface {
        let mut surface = Surface::default();
        surface.add_grid(0, columns, rows, usize::MAX);
        surface
    }

    #[test]
    fn all_frames_are_keys_while_they_fit() {
        let surface = sheet(10, 10);
        assert_eq!(key_frames(1, &surface), [0]);
        assert_eq!(key_frames(2, &surface), [0, 1]);
        assert_eq!(key_frames(960, &surface), (0..960).collect::<Vec<_>>());
    }

    #[test]
    fn frames_are_left_out_evenly_and_never_the_ends() {
        for (frame_count, surface) in
            [(961, sheet(10, 10)), (1_000_000, sheet(3, 3)), (181, sheet(300, 300)), (50, sheet(3000, 3000))]
        {
            let keys = key_frames(frame_count, &surface);
            assert_eq!((keys.first(), keys.last()), (Some(&0), Some(&(frame_count - 1))));
            let gaps: Vec<usize> = keys.windows(2).map(|pair| pair[1] - pair[0]).collect();
            let (smallest, largest) = (gaps.iter().min().unwrap(), gaps.iter().max().unwrap());
            assert!(largest - smallest <= 1 && keys.len() < frame_count, "{frame_count}: {gaps:?}");
            assert!(keys.len() <= MOST_KEYS);
            let length = Layout::new(&surface, keys.len()).unwrap().targets;
            assert!(length.end - length.start <= SIZE_BUDGET || keys.len() == 2);
        }
    }
}
