//! Elements of a grid that feel one coordinate each: what internal friction and damping act on.

mod chunk;
#[cfg(test)]
mod tests;

use std::ops::Range;

pub(super) use chunk::{CHUNK, Chunk};

use super::StiffnessTensorsMut;
use crate::model::Grid;

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

/// Neighbouring elements of one row, whose nodes are at the same places relative to their owners.
///
/// An element is owned by its first node, in whose place it has its memory; one of a line by the particle in the middle.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Segment {
    /// Row and column of the first owner.
    pub(super) row: usize,
    pub(super) column: usize,
    /// Number of elements.
    pub(super) count: usize,
    /// Nodes of the first element; those of the others follow.
    nodes: [Node; NODES],
    node_count: usize,
    /// The share of a cell's width that each element stands for.
    pub(super) share: f64,
}

#[derive(Clone, Copy, Debug, Default)]
struct Node {
    particle: usize,
    row: usize,
}

/// Elements of neighbouring owners in one row, with nodes at the same places in columns and rows.
#[derive(Clone, Debug)]
struct Part {
    row: usize,
    columns: Range<usize>,
    nodes: [(isize, isize); NODES],
    node_count: usize,
    share: f64,
}

impl Part {
    fn new(row: usize, columns: Range<usize>, places: &[(isize, isize)], share: f64) -> Self {
        let mut nodes = [(0, 0); NODES];
        nodes[..places.len()].copy_from_slice(places);
        Self { row, columns, nodes, node_count: places.len(), share }
    }

    /// Its segments on `grid`.
    fn segments(self, grid: Grid) -> impl Iterator<Item = Segment> {
        let Self { row, columns, nodes, node_count, share } = self;
        let end = columns.end;
        columns.step_by(CHUNK).map(move |column| {
            let mut segment = Segment {
                row,
                column,
                count: CHUNK.min(end - column),
                node_count,
                share,
                ..Segment::default()
            };
            for (node, (across, along)) in segment.nodes[..node_count].iter_mut().zip(nodes) {
                let row = row.wrapping_add_signed(along);
                *node = Node { particle: grid.particle(column.wrapping_add_signed(across), row), row };
            }
            segment
        })
    }
}

impl Segment {
    fn nodes(&self) -> &[Node] {
        &self.nodes[..self.node_count]
    }

    /// Where the memory of the elements is among `layers` of whole rows whose first particle is `first`.
    pub(super) fn memory(&self, grid: &Grid, first: usize, layers: usize, layer: usize) -> Range<usize> {
        let row = layers * (grid.particle(0, self.row) - first);
        let start = row + layer * grid.columns + self.column;
        start..start + self.count
    }
}

impl GridElements {
    /// The elements that have a node in `block`, in ascending order and [`CHUNK`] at a time at most.
    ///
    /// Elements across the border of two blocks are among those of both. So every particle gets what its elements add in the
    /// same order, whatever the blocks.
    pub(super) fn touching(&self, block: &Range<usize>) -> impl Iterator<Item = Segment> + '_ {
        let rows = self.grid.block_rows(block).unwrap_or_default();
        // Nodes are from one row before their owner to two after.
        let owners = rows.start.saturating_sub(2)..(rows.end + 1).min(self.grid.rows);
        let touches = move |segment: &Segment| segment.nodes().iter().any(|node| rows.contains(&node.row));
        owners.flat_map(|row| self.in_row(row)).filter(touches)
    }

    /// The elements that particles of `block` own, in the same way: each once over all blocks.
    pub(super) fn owned(&self, block: &Range<usize>) -> impl Iterator<Item = Segment> + '_ {
        self.grid.block_rows(block).unwrap_or_default().flat_map(|row| self.in_row(row))
    }

    /// All elements.
    pub(super) fn all(&self) -> impl Iterator<Item = Segment> + '_ {
        (0..self.grid.rows).flat_map(|row| self.in_row(row))
    }

    /// The elements that the particles of `row` own.
    fn in_row(&self, row: usize) -> impl Iterator<Item = Segment> + '_ {
        self.parts(row).into_iter().flatten().flat_map(|part| part.segments(self.grid))
    }

    /// The parts of `row`, from left to right.
    fn parts(&self, row: usize) -> [Option<Part>; 3] {
        let Grid { columns, rows, .. } = self.grid;
        let inner_row = self.share(row, rows);
        let part = |columns, nodes: &[(isize, isize)], share| Some(Part::new(row, columns, nodes, share));
        match self.coordinate {
            Coordinate::Extension { columns: across, rows: along, .. } => {
                let first = across.min(0).unsigned_abs();
                let end = columns.saturating_sub(across.max(0).unsigned_abs());
                if rows <= row + along {
                    return [const { None }; 3];
                }
                let nodes = [(0, 0), (across, along as isize)];
                if along == 0 {
                    [part(first..end, &nodes, inner_row), None, None]
                } else if across == 0 && self.has_half_edges {
                    self.edges_and_inner(row, |_, _| &nodes)
                } else {
                    [part(first..end, &nodes, 1.0), None, None]
                }
            }
            Coordinate::Shear => {
                let nodes = [(0, 0), (1, 0), (1, 1), (0, 1)];
                let cells =
                    (row + 1 < rows).then(|| Part::new(row, 0..columns.saturating_sub(1), &nodes, 1.0));
                [cells, None, None]
            }
            Coordinate::Bend(Line::Weft) => {
                let [before, after] = [-isize::from(0 < row), isize::from(row + 1 < rows)];
                let nodes = [(0, 0), (-1, 0), (1, 0), (0, before), (0, after)];
                [part(1..columns.saturating_sub(1), &nodes, inner_row), None, None]
            }
            Coordinate::Bend(Line::Warp) => {
                if row == 0 || rows <= row + 1 {
                    return [const { None }; 3];
                }
                let nodes = |left: bool, right: bool| {
                    const NODES_OF: [[(isize, isize); NODES]; 4] = [
                        [(0, 0), (0, -1), (0, 1), (0, 0), (0, 0)],
                        [(0, 0), (0, -1), (0, 1), (0, 0), (1, 0)],
                        [(0, 0), (0, -1), (0, 1), (-1, 0), (0, 0)],
                        [(0, 0), (0, -1), (0, 1), (-1, 0), (1, 0)],
                    ];
                    &NODES_OF[2 * usize::from(left) + usize::from(right)][..]
                };
                self.edges_and_inner(row, nodes)
            }
        }
    }

    /// The first column, those inside and the last; `nodes` depend on whether there are columns to the left and right.
    fn edges_and_inner<'a>(
        &self,
        row: usize,
        nodes: impl Fn(bool, bool) -> &'a [(isize, isize)],
    ) -> [Option<Part>; 3] {
        let columns = self.grid.columns;
        let last = columns - 1;
        let first = Part::new(row, 0..1, nodes(false, 0 < last), self.share(0, columns));
        if last == 0 {
            return [Some(first), None, None];
        }
        let inner = Part::new(row, 1..last, nodes(true, true), 1.0);
        let last = Part::new(row, last..columns, nodes(true, false), self.share(last, columns));
        [Some(first), Some(inner), Some(last)]
    }

    /// Share of a width that line `index` of `count` stands for.
    fn share(&self, index: usize, count: usize) -> f64 {
        if self.has_half_edges && (index == 0 || index + 1 == count) { 0.5 } else { 1.0 }
    }
}
