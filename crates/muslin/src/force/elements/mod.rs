//! Elements of a grid that feel one coordinate each: what internal friction and damping act on.

mod chunk;
#[cfg(test)]
mod tests;

use std::ops::Range;

pub(super) use chunk::{CHUNK, Chunk};

use super::StiffnessTensorsMut;
use crate::model::Grid;

/// Loops over elements are as long as a multiple of this, so that no vector is half empty. What they compute beyond the elements, of
/// other particles or of zeros behind the last, is used by nobody, or counts nothing: [widths](Chunk::widths) are zero there.
const STRIDE: usize = 8;

/// Nodes of an element at most.
pub(super) const NODES: usize = 5;

/// Equal elements all over a grid, each of which has one coordinate q of the positions of a few particles.
///
/// A force f along the coordinate acts on the particles by its gradients g, and its rate is that of the velocities v:
///
/// ```text
/// F_k = −f g_k    g_k = ∂q/∂x_k    dq/dt = Σ g_k · v_k
/// ```
///
/// No coordinate changes when the cloth is moved or turned as a whole. So whatever f is, the forces of an element have neither a sum
/// nor a moment, and no work is done on a rigid motion.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct GridElements {
    pub(super) grid: Grid,
    pub(super) coordinate: Coordinate,
    /// Whether elements along an edge of the grid stand for half a cell's width.
    pub(super) has_half_edges: bool,
}

/// What an element feels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Coordinate {
    /// The extension q = ℓ − L [m] between a particle and the one that is so many columns and rows further.
    ///
    /// Coincident ends feel nothing.
    Extension {
        columns: isize,
        /// Not negative.
        rows: usize,
        rest_length: f64,
    },
    /// The sine of the shear angle of a cell [1], by its diagonals ℓ₁ and ℓ₂:
    ///
    /// ```text
    /// q = (ℓ₁² − ℓ₂²) / (4 h_x h_y) = sin γ
    /// ```
    ///
    /// Stretch along the yarns alone does not change it.
    Shear,
    /// The second difference q [m] of three particles in a line, x₋, x and x₊, along the cloth's normal n at x:
    ///
    /// ```text
    /// q = n · (x₋ − 2x + x₊)    n = S / N    S = a × b    a = x₊ − x₋    b = y₊ − y₋
    ///
    /// N = |S|  if |S| ≥ A    (A² + |S|²) / 2A  else        A = h_x h_y
    /// ```
    ///
    /// with the neighbours y across the line; at an edge x itself stands for the one that is missing. Its size is
    /// 2 h sin ½θ where the line turns by θ, h² times the curvature if the angle is small. The sign is that of the side to which the
    /// cloth bends.
    ///
    /// A flat cloth has |S| = 4A, and 2A at an edge. As S vanishes, when a and b become parallel or one of them has no length, a unit
    /// normal turns over at once, and its gradients grow as 1 / |S|. So n fades where a fold leaves less than A: q goes
    /// through zero there, and no gradient exceeds 1 + 2 |b| |x₋ − 2x + x₊| / A or the same with a, 9 for squares of the flat cloth's lengths.
    Bend(Line),
}

/// Direction of a line of particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Line {
    /// Along the columns' numbers, the weft.
    Weft,
    /// Along the rows' numbers, the warp.
    Warp,
}

/// Neighbouring elements of one row, [`CHUNK`] at most.
///
/// An element is owned by its first node, in whose place it has its memory; one of a line by the particle in the middle.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Segment {
    /// Row and column of the first owner.
    pub(super) row: usize,
    pub(super) column: usize,
    /// Number of elements.
    pub(super) count: usize,
}

/// Where the nodes of a segment are: at the same places relative to the elements' owners, but at the ends of the row.
#[derive(Clone, Copy, Debug)]
struct Layout {
    /// Nodes of the first element, or where a row would have them; those of the others follow.
    starts: [usize; NODES],
    rows: [usize; NODES],
    /// The gradient on each node: so many times the element's vector of this number.
    gradients: &'static [(f64, usize)],
    /// Whether the first and the last element lack the node number [`LEFT`] or [`RIGHT`], and are themselves in its place.
    ends_row: [bool; 2],
    widths: Widths,
}

/// Numbers of the nodes beside the line of a bend.
const LEFT: usize = 3;
const RIGHT: usize = 4;

/// The shares of a cell's width that the elements of a segment stand for.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Widths {
    count: usize,
    /// Of all but the first and the last.
    inner: f64,
    ends: [f64; 2],
}

/// Nodes of the same number in neighbouring elements of a segment.
#[derive(Clone, Copy, Debug)]
struct Nodes {
    /// Those of the first of these elements.
    particle: usize,
    row: usize,
    /// Number of the first of these elements in the segment, and how many there are.
    first: usize,
    count: usize,
    /// Gradients are so many times the elements' vector of this number.
    weight: f64,
    vector: usize,
}

impl Nodes {
    /// Numbers of the elements in the segment.
    #[inline(always)]
    fn elements(&self) -> Range<usize> {
        self.first..self.first + self.count
    }

    #[inline(always)]
    fn particles(&self) -> Range<usize> {
        self.particle..self.particle + self.count
    }

    /// The particles, counted from number `first`.
    #[inline(always)]
    fn particles_from(&self, first: usize) -> Range<usize> {
        self.particle - first..self.particle - first + self.count
    }
}

impl Layout {
    /// Of no elements.
    const EMPTY: Self = Self {
        starts: [0; NODES],
        rows: [0; NODES],
        gradients: &[],
        ends_row: [false; 2],
        widths: Widths { count: 0, inner: 0.0, ends: [0.0; 2] },
    };

    /// All nodes, in the order of their numbers.
    #[inline(always)]
    fn nodes(&self) -> AllNodes<'_> {
        AllNodes { layout: self, number: 0, is_end: false }
    }

    /// The nodes of this number of most elements, or that of the one at an end of the row, if there is one.
    #[inline(always)]
    fn nodes_of(&self, number: usize, is_end: bool) -> Nodes {
        let (weight, vector) = self.gradients[number];
        let count = self.widths.count;
        let first = usize::from(self.ends_row[0] & (number == LEFT));
        let last = usize::from(self.ends_row[1] & (number == RIGHT));
        let row = self.rows[number];
        if is_end {
            let end = last * (count - 1);
            Nodes { particle: self.starts[0] + end, row, first: end, count: first + last, weight, vector }
        } else {
            let particle = self.starts[number] + first;
            Nodes { particle, row, first, count: count - first - last, weight, vector }
        }
    }
}

/// Nodes of a segment, each as many as there are.
struct AllNodes<'a> {
    layout: &'a Layout,
    number: usize,
    is_end: bool,
}

impl Iterator for AllNodes<'_> {
    type Item = Nodes;

    #[inline(always)]
    fn next(&mut self) -> Option<Nodes> {
        while self.number < self.layout.gradients.len() {
            let nodes = self.layout.nodes_of(self.number, self.is_end);
            self.number += usize::from(self.is_end);
            self.is_end = !self.is_end;
            if 0 < nodes.count {
                return Some(nodes);
            }
        }
        None
    }
}

impl Segment {
    /// Where the memory of the elements is among `layers` of whole rows whose first particle is `first`.
    pub(super) fn memory(&self, grid: &Grid, first: usize, layers: usize, layer: usize) -> Range<usize> {
        let row = layers * (grid.particle(0, self.row) - first);
        let start = row + layer * grid.columns + self.column;
        start..start + self.count
    }
}

/// Segments of some rows, in ascending order.
#[derive(Clone, Debug)]
pub(super) struct Segments {
    rows: Range<usize>,
    columns: Range<usize>,
    /// Where the next one begins in the first row.
    column: usize,
    /// Elements of each but the last of a row.
    length: usize,
}

impl Iterator for Segments {
    type Item = Segment;

    #[inline(always)]
    fn next(&mut self) -> Option<Segment> {
        if self.columns.end <= self.column {
            self.column = self.columns.start;
            self.rows.start += 1;
        }
        if self.rows.is_empty() || self.columns.is_empty() {
            return None;
        }
        let (row, column) = (self.rows.start, self.column);
        self.column += self.length;
        Some(Segment { row, column, count: self.length.min(self.columns.end - column) })
    }
}

impl GridElements {
    /// The elements that have a node in `block`, in ascending order.
    ///
    /// Elements across the border of two blocks are among those of both. So every particle gets what its elements add in the
    /// same order, whatever the blocks.
    #[inline(always)]
    pub(super) fn touching(&self, block: &Range<usize>) -> Segments {
        let Some(rows) = self.grid.block_rows(block) else { return self.in_rows(0..0) };
        let [up, down] = match self.coordinate {
            Coordinate::Extension { rows, .. } => [0, rows],
            Coordinate::Shear => [0, 1],
            Coordinate::Bend(_) => [1, 1],
        };
        self.in_rows(rows.start.saturating_sub(down)..rows.end + up)
    }

    /// The elements that particles of `block` own, in the same way: each once over all blocks.
    #[inline(always)]
    pub(super) fn owned(&self, block: &Range<usize>) -> Segments {
        self.in_rows(self.grid.block_rows(block).unwrap_or_default())
    }

    /// All elements.
    pub(super) fn all(&self) -> Segments {
        self.in_rows(0..self.grid.rows)
    }

    /// The elements that the particles of `rows` own.
    #[inline(always)]
    fn in_rows(&self, rows: Range<usize>) -> Segments {
        let [columns, owners] = self.owners();
        let rows = rows.start.max(owners.start)..rows.end.min(owners.end);
        // About as many in each segment of a row.
        let length = columns.len().div_ceil(columns.len().div_ceil(CHUNK).max(1));
        Segments { column: columns.start, columns, rows, length: length.next_multiple_of(STRIDE) }
    }

    /// The columns and the rows of owners.
    fn owners(&self) -> [Range<usize>; 2] {
        let Grid { columns, rows, .. } = self.grid;
        match self.coordinate {
            Coordinate::Extension { columns: across, rows: along, .. } => {
                let end = columns.saturating_sub(across.max(0).unsigned_abs());
                [across.min(0).unsigned_abs()..end, 0..rows.saturating_sub(along)]
            }
            Coordinate::Shear => [0..columns.saturating_sub(1), 0..rows.saturating_sub(1)],
            Coordinate::Bend(Line::Weft) => [1..columns.saturating_sub(1), 0..rows],
            Coordinate::Bend(Line::Warp) => [0..columns, 1..rows.saturating_sub(1)],
        }
    }

    /// Where the nodes of `segment` are.
    #[inline(always)]
    fn layout(&self, segment: &Segment) -> Layout {
        let &Segment { row, column, count } = segment;
        let Grid { columns, rows, .. } = self.grid;
        let own = self.grid.particle(column, row);
        let mut layout = Layout {
            starts: [own; NODES],
            rows: [row; NODES],
            widths: Widths { count, inner: 1.0, ends: [1.0; 2] },
            ..Layout::EMPTY
        };
        let at_ends = [column == 0, column + count == columns];
        let share = |is_half: bool| if self.has_half_edges && is_half { 0.5 } else { 1.0 };
        let row_share = share(row == 0 || row + 1 == rows);
        match self.coordinate {
            Coordinate::Extension { columns: across, rows: along, .. } => {
                if along == 0 {
                    layout.widths = Widths { count, inner: row_share, ends: [row_share; 2] };
                } else if across == 0 {
                    layout.widths.ends = at_ends.map(share);
                }
                layout.gradients = &[(-1.0, 0), (1.0, 0)];
                layout.starts[1] = (own + along * columns).wrapping_add_signed(across);
                layout.rows[1] = row + along;
            }
            Coordinate::Shear => {
                layout.gradients = &[(-1.0, 0), (1.0, 1), (1.0, 0), (-1.0, 1)];
                layout.starts = [own, own + 1, own + columns + 1, own + columns, own];
                layout.rows = [row, row, row + 1, row + 1, row];
            }
            Coordinate::Bend(line) => {
                layout.gradients = &[(-2.0, 0), (1.0, 1), (1.0, 2), (-1.0, 3), (1.0, 3)];
                let (up, down) = (usize::from(0 < row), usize::from(row + 1 < rows));
                // The first column of a grid has none to its left.
                let (left, right) = (own.saturating_sub(1), own + 1);
                let [above, below] = [own - up * columns, own + down * columns];
                if line == Line::Weft {
                    layout.widths = Widths { count, inner: row_share, ends: [row_share; 2] };
                    layout.starts = [own, left, right, above, below];
                    layout.rows = [row, row, row, row - up, row + down];
                } else {
                    layout.widths.ends = at_ends.map(share);
                    layout.ends_row = at_ends;
                    layout.starts = [own, above, below, left, right];
                    layout.rows = [row, row - up, row + down, row, row];
                }
            }
        }
        layout
    }
}
