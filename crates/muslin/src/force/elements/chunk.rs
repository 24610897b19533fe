//! Some elements, number by number, so that loops over them vectorise.

use std::ops::Range;

use glam::DVec3;

use super::{Coordinate, GridElements, NODES, Segment, StiffnessTensorsMut};
use crate::force::SpringLength;
use crate::model::{Grid, Particles};
use crate::{Points, PointsMut};

/// Elements that are worked on at a time, in a core's first-level cache.
pub(in crate::force) const CHUNK: usize = 64;

/// The coordinates and gradients of the elements of a segment.
pub(in crate::force) struct Chunk {
    segment: Segment,
    /// Coordinates q, of [`Segment::count`] elements.
    pub(in crate::force) coordinates: [f64; CHUNK],
    /// What constants per curvature or strain have to be multiplied by: the segment's share, twice that at a clamp.
    pub(in crate::force) shares: [f64; CHUNK],
    /// Gradients g, node by node and coordinate by coordinate of space.
    gradients: [[[f64; CHUNK]; 3]; NODES],
}

impl Chunk {
    /// Room for elements.
    #[inline(always)]
    pub(in crate::force) fn empty() -> Self {
        Self {
            segment: Segment::default(),
            coordinates: [0.0; CHUNK],
            shares: [0.0; CHUNK],
            gradients: [[[0.0; CHUNK]; 3]; NODES],
        }
    }

    /// Becomes the `elements` of `segment` where they are; what is behind them stays as it was.
    #[inline(always)]
    pub(in crate::force) fn eval(
        &mut self,
        elements: &GridElements,
        segment: &Segment,
        positions: &Points,
        particles: &Particles,
    ) {
        self.segment = *segment;
        self.shares.fill(segment.share);
        match elements.coordinate {
            Coordinate::Extension { rest_length, .. } => self.eval_extensions(positions, rest_length),
            Coordinate::Shear => self.eval_shear(positions, &elements.grid),
            Coordinate::Bend(_) => {
                self.eval_bends(positions, &elements.grid);
                self.double_clamps(particles.pinned());
            }
        }
    }

    /// Number of elements.
    #[inline(always)]
    pub(in crate::force) fn len(&self) -> usize {
        // Never more, which the compiler cannot know.
        self.segment.count.min(CHUNK)
    }

    /// The values of `points` at the nodes with this number.
    #[inline(always)]
    fn node<'a>(&self, node: usize, points: &'a Points) -> [&'a [f64]; 3] {
        let range = self.particles(node);
        [&points.x, &points.y, &points.z].map(|axis| &axis[range.clone()])
    }

    /// The particles at the nodes with this number.
    #[inline(always)]
    fn particles(&self, node: usize) -> Range<usize> {
        let first = self.segment.nodes[node].particle;
        first..first + self.len()
    }

    #[inline(always)]
    fn set_gradient(&mut self, node: usize, i: usize, gradient: DVec3) {
        let [x, y, z] = &mut self.gradients[node];
        (x[i], y[i], z[i]) = (gradient.x, gradient.y, gradient.z);
    }

    #[inline(always)]
    fn eval_extensions(&mut self, positions: &Points, rest_length: f64) {
        let [a, b] = [0, 1].map(|node| self.node(node, positions));
        for i in 0..self.len() {
            let vector = point(b, i) - point(a, i);
            let length = SpringLength::of(vector);
            self.coordinates[i] = length.length - rest_length;
            let normal = vector * length.inverse;
            self.set_gradient(0, i, -normal);
            self.set_gradient(1, i, normal);
        }
    }

    #[inline(always)]
    fn eval_shear(&mut self, positions: &Points, grid: &Grid) {
        let [a, b, c, d] = [0, 1, 2, 3].map(|node| self.node(node, positions));
        let factor = 0.5 / (grid.column_spacing * grid.row_spacing);
        for i in 0..self.len() {
            let first = point(c, i) - point(a, i);
            let second = point(d, i) - point(b, i);
            // ℓ₁² − ℓ₂² without the cancellation of squares.
            self.coordinates[i] = 0.5 * factor * (first - second).dot(first + second);
            let (first, second) = (first * factor, second * factor);
            self.set_gradient(0, i, -first);
            self.set_gradient(1, i, second);
            self.set_gradient(2, i, first);
            self.set_gradient(3, i, -second);
        }
    }

    /// With S = a × b, n = S / N(|S|) and w = (Δ − q S / max(|S|, A)) / N, for Δ = x₋ − 2x + x₊:
    ///
    /// ```text
    /// dq = n · dΔ + w · (da × b + a × db) = n · dΔ + (b × w) · da + (w × a) · db
    /// ```
    #[inline(always)]
    fn eval_bends(&mut self, positions: &Points, grid: &Grid) {
        let cell = grid.column_spacing * grid.row_spacing;
        let [own, before, after, left, right] = [0, 1, 2, 3, 4].map(|node| self.node(node, positions));
        for i in 0..self.len() {
            let at = point(own, i);
            let (before, after) = (point(before, i) - at, point(after, i) - at);
            let difference = before + after;
            let along = after - before;
            let across = point(right, i) - point(left, i);
            let area = along.cross(across);
            let squared = area.length_squared();
            let is_open = cell * cell <= squared;
            let open = SpringLength::from_squared(squared).inverse;
            let folded = 2.0 * cell / (cell * cell + squared);
            let inverse = if is_open { open } else { folded };
            let normal = area * inverse;
            let coordinate = normal.dot(difference);
            self.coordinates[i] = coordinate;
            let direction = area * if is_open { open } else { 1.0 / cell };
            let rest = (difference - direction * coordinate) * inverse;
            let of_along = across.cross(rest);
            let of_across = rest.cross(along);
            self.set_gradient(0, i, normal * -2.0);
            self.set_gradient(1, i, normal - of_along);
            self.set_gradient(2, i, normal + of_along);
            self.set_gradient(3, i, -of_across);
            self.set_gradient(4, i, of_across);
        }
    }

    /// Where two particles in a line are pinned and the next is free, the curvature around the second pin is that of half a
    /// cell: twice as large, over half the length.
    #[inline(always)]
    fn double_clamps(&mut self, pinned: &[bool]) {
        let [own, before, after] = [0, 1, 2].map(|node| &pinned[self.particles(node)]);
        for i in 0..self.len() {
            if own[i] & (before[i] != after[i]) {
                self.shares[i] *= 2.0;
            }
        }
    }

    /// Overwrites the first `rates` with dq/dt at `velocities` [m/s].
    #[inline(always)]
    pub(in crate::force) fn eval_rates(&self, velocities: &Points, rates: &mut [f64; CHUNK]) {
        let count = self.len();
        rates.fill(0.0);
        for (node, gradients) in self.gradients[..self.segment.node_count].iter().enumerate() {
            let [x, y, z] = self.node(node, velocities);
            for i in 0..count {
                rates[i] += gradients[0][i] * x[i] + gradients[1][i] * y[i] + gradients[2][i] * z[i];
            }
        }
    }

    /// Adds `factors` times the gradients to `sums` of the particles of a block that begins with particle `first` and has
    /// these `rows`.
    #[inline(always)]
    pub(in crate::force) fn add_gradients(
        &self,
        factors: &[f64; CHUNK],
        rows: &Range<usize>,
        first: usize,
        sums: &mut PointsMut<'_>,
    ) {
        for (node, gradients) in self.segment.nodes().iter().zip(&self.gradients) {
            if !rows.contains(&node.row) {
                continue;
            }
            let target = node.particle - first..node.particle - first + self.len();
            let axes = [&mut *sums.x, &mut *sums.y, &mut *sums.z];
            for (sums, gradients) in axes.into_iter().zip(gradients) {
                for ((sum, gradient), factor) in sums[target.clone()].iter_mut().zip(gradients).zip(factors) {
                    *sum += factor * gradient;
                }
            }
        }
    }

    /// Adds bounds on the norms of the particles' rows of Σ c g gᵀ over the elements, with coefficients c that are not
    /// negative.
    ///
    /// ```text
    /// c |g_k| Σ_j |g_j|        over the node itself and those that are not pinned
    /// ```
    #[inline(always)]
    pub(in crate::force) fn add_bounds(
        &self,
        coefficients: &[f64; CHUNK],
        pinned: &[bool],
        rows: &Range<usize>,
        first: usize,
        bounds: &mut [f64],
    ) {
        let (sizes, free) = self.sizes(pinned);
        for (index, node) in self.segment.nodes().iter().enumerate() {
            if !rows.contains(&node.row) {
                continue;
            }
            let pinned = &pinned[self.particles(index)];
            let target = &mut bounds[node.particle - first..][..self.len()];
            for i in 0..self.len() {
                let size = sizes[index][i];
                let sum = free[i] + if pinned[i] { size } else { 0.0 };
                target[i] += coefficients[i] * size * sum;
            }
        }
    }

    /// Adds tensors that bound the same matrix, by the particles' own displacements: with the sum S of the above,
    ///
    /// ```text
    /// c (Σ g_j · u_j)² ≤ c Σ (S / |g_j|) (g_j · u_j)²
    /// ```
    ///
    /// (the inequality of Cauchy and Schwarz), whose terms have the norm c S |g_j|.
    #[inline(always)]
    pub(in crate::force) fn add_tensors(
        &self,
        coefficients: &[f64; CHUNK],
        pinned: &[bool],
        rows: &Range<usize>,
        first: usize,
        tensors: &mut StiffnessTensorsMut<'_>,
    ) {
        let (sizes, free) = self.sizes(pinned);
        for (index, node) in self.segment.nodes().iter().enumerate() {
            if !rows.contains(&node.row) {
                continue;
            }
            let pinned = &pinned[self.particles(index)];
            let target = node.particle - first;
            let [x, y, z] = &self.gradients[index];
            for i in 0..self.len() {
                let size = sizes[index][i];
                if size == 0.0 {
                    continue;
                }
                let sum = free[i] + if pinned[i] { size } else { 0.0 };
                let factor = coefficients[i] * sum / size;
                let gradient = DVec3::new(x[i], y[i], z[i]);
                let scaled = gradient * factor;
                tensors.diagonal.add(target + i, scaled * gradient);
                let turned = DVec3::new(gradient.z, gradient.x, gradient.y);
                let off = DVec3::new(scaled.y, scaled.z, scaled.x) * turned;
                tensors.off_diagonal.add(target + i, off);
            }
        }
    }

    /// |g| of all nodes, and the sums over those of each element that are not pinned.
    #[inline(always)]
    fn sizes(&self, pinned: &[bool]) -> ([[f64; CHUNK]; NODES], [f64; CHUNK]) {
        let (mut sizes, mut free) = ([[0.0; CHUNK]; NODES], [0.0; CHUNK]);
        for node in 0..self.segment.node_count {
            let [x, y, z] = &self.gradients[node];
            let pinned = &pinned[self.particles(node)];
            for i in 0..self.len() {
                let size = (x[i] * x[i] + y[i] * y[i] + z[i] * z[i]).sqrt();
                sizes[node][i] = size;
                free[i] += if pinned[i] { 0.0 } else { size };
            }
        }
        (sizes, free)
    }
}

#[inline(always)]
fn point(axes: [&[f64]; 3], i: usize) -> DVec3 {
    DVec3::new(axes[0][i], axes[1][i], axes[2][i])
}
