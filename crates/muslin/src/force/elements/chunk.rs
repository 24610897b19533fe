//! Some elements, number by number, so that loops over them vectorise.

use std::ops::Range;

use glam::DVec3;

use super::{Coordinate, GridElements, Layout, STRIDE, Segment, StiffnessTensorsMut};
use crate::force::SpringLength;
use crate::model::{Grid, Particles};
use crate::{Points, PointsMut};

/// Elements that are worked on at a time, in a core's first-level cache.
pub(in crate::force) const CHUNK: usize = 128;

/// Vectors that the gradients of an element are made of, at most.
const VECTORS: usize = 4;

/// The coordinates and gradients of the elements of a segment.
#[repr(align(64))]
pub(in crate::force) struct Chunk {
    layout: Layout,
    /// Coordinates q, of [`Segment::count`] elements.
    pub(in crate::force) coordinates: [f64; CHUNK],
    /// The share of a cell's width that each stands for; zero beyond the last.
    pub(in crate::force) widths: [f64; CHUNK],
    /// One at clamps, where elements are twice as stiff, zero elsewhere.
    pub(in crate::force) clamps: [f64; CHUNK],
    /// Whether any of these is one.
    has_clamps: bool,
    /// Coordinate by coordinate of space: first what leads from one particle to another, then what gradients are made of.
    vectors: [[[f64; CHUNK]; 3]; VECTORS],
}

impl Chunk {
    /// Room for elements.
    pub(in crate::force) const EMPTY: Self = Self {
        layout: Layout::EMPTY,
        coordinates: [0.0; CHUNK],
        widths: [0.0; CHUNK],
        clamps: [0.0; CHUNK],
        has_clamps: false,
        vectors: [[[0.0; CHUNK]; 3]; VECTORS],
    };

    /// Becomes the `elements` of `segment` where they are.
    #[inline(always)]
    pub(in crate::force) fn eval(
        &mut self,
        elements: &GridElements,
        segment: &Segment,
        positions: &Points,
        particles: &Particles,
    ) {
        self.eval_parts::<true>(elements, segment, positions, particles);
    }

    /// Becomes the same but for gradients, which are not known then; the coordinates have the same bits.
    #[inline(always)]
    pub(in crate::force) fn eval_coordinates(
        &mut self,
        elements: &GridElements,
        segment: &Segment,
        positions: &Points,
        particles: &Particles,
    ) {
        self.eval_parts::<false>(elements, segment, positions, particles);
    }

    #[inline(always)]
    fn eval_parts<const GRADIENTS: bool>(
        &mut self,
        elements: &GridElements,
        segment: &Segment,
        positions: &Points,
        particles: &Particles,
    ) {
        let widths = self.layout.widths;
        self.layout = elements.layout(segment);
        if self.layout.widths != widths {
            self.eval_widths();
        }
        match elements.coordinate {
            Coordinate::Extension { rest_length, .. } => {
                self.eval_vectors(positions, [0, 1], 0);
                self.eval_extensions::<GRADIENTS>(rest_length);
            }
            Coordinate::Shear => {
                self.eval_vectors(positions, [0, 2], 0);
                self.eval_vectors(positions, [1, 3], 1);
                self.eval_shear::<GRADIENTS>(&elements.grid);
            }
            Coordinate::Bend(_) => {
                self.eval_clamps(particles.pinned());
                self.eval_differences(positions);
                self.eval_bends::<GRADIENTS>(&elements.grid);
            }
        }
    }

    /// Number of elements.
    #[inline(always)]
    pub(in crate::force) fn len(&self) -> usize {
        // Never more, which the compiler cannot know.
        self.layout.widths.count.min(CHUNK)
    }

    /// Length of the loops over elements, a multiple of [`STRIDE`] and at most [`CHUNK`].
    #[inline(always)]
    pub(in crate::force) fn padded_len(&self) -> usize {
        // In words that the compiler sees this by.
        ((self.len() + STRIDE - 1) & !(STRIDE - 1)).min(CHUNK)
    }

    /// What a `constant` per width comes to in each element: as much of it as its share of a cell's width, and twice at clamps.
    #[inline(always)]
    pub(in crate::force) fn shares_of(&self, constant: f64) -> [f64; CHUNK] {
        let mut shares = self.widths;
        for (share, clamp) in shares.iter_mut().zip(&self.clamps) {
            *share = (*share + *share * clamp) * constant;
        }
        shares
    }

    #[inline(always)]
    fn eval_widths(&mut self) {
        let count = self.len();
        self.widths[..count].fill(self.layout.widths.inner);
        self.widths[count..].fill(0.0);
        let last = count.max(1) - 1;
        [self.widths[0], self.widths[last]] = self.layout.widths.ends;
    }

    /// Where two particles in a line are pinned and the next is free, the curvature around the second pin is that of half a
    /// cell: twice as large, over half the length.
    #[inline(always)]
    fn eval_clamps(&mut self, pinned: &[bool]) {
        let count = self.len();
        let [own, before, after, ..] = self.layout.starts;
        let own = &pinned[own..own + count];
        let before = &pinned[before..before + count];
        let after = &pinned[after..after + count];
        let mut has_clamps = false;
        for i in 0..count {
            has_clamps |= own[i] & (before[i] != after[i]);
        }
        if has_clamps | self.has_clamps {
            // A segment that was longer may have left some.
            self.clamps[count..].fill(0.0);
            for i in 0..count {
                self.clamps[i] = if own[i] & (before[i] != after[i]) { 1.0 } else { 0.0 };
            }
        }
        self.has_clamps = has_clamps;
    }

    /// Overwrites the vectors number `target` with what leads from one node to another.
    #[inline(always)]
    fn eval_vectors(&mut self, positions: &Points, [from, to]: [usize; 2], target: usize) {
        let count = self.padded_len();
        let [from, to] = [self.layout.starts[from], self.layout.starts[to]];
        let axes = positions.with_zeros_behind();
        for (values, vectors) in axes.into_iter().zip(&mut self.vectors[target]) {
            let (from, to) = (&values[from..from + count], &values[to..to + count]);
            let vectors = &mut vectors[..count];
            for i in 0..count {
                vectors[i] = to[i] - from[i];
            }
        }
    }

    /// Overwrites the first three vectors with Δ, a and b of bends.
    #[inline(always)]
    fn eval_differences(&mut self, positions: &Points) {
        let (count, last) = (self.padded_len(), self.len().max(1) - 1);
        let Layout { starts, ends_row: [is_first, is_last], .. } = self.layout;
        let axes = positions.with_zeros_behind();
        let [differences, lines, across, _] = &mut self.vectors;
        for (axis, values) in axes.into_iter().enumerate() {
            let own = &values[starts[0]..starts[0] + count];
            let before = &values[starts[1]..starts[1] + count];
            let after = &values[starts[2]..starts[2] + count];
            let left = &values[starts[3]..starts[3] + count];
            let right = &values[starts[4]..starts[4] + count];
            let differences = &mut differences[axis][..count];
            let lines = &mut lines[axis][..count];
            let across = &mut across[axis][..count];
            for i in 0..count {
                let (before, after) = (before[i] - own[i], after[i] - own[i]);
                differences[i] = before + after;
                lines[i] = after - before;
                across[i] = right[i] - left[i];
            }
            if is_first {
                across[0] = right[0] - own[0];
            }
            if is_last {
                across[last] = if is_first & (last == 0) { 0.0 } else { own[last] - left[last] };
            }
        }
    }

    #[inline(always)]
    fn eval_extensions<const GRADIENTS: bool>(&mut self, rest_length: f64) {
        let count = self.padded_len();
        let [[x, y, z], ..] = &mut self.vectors;
        for i in 0..count {
            let vector = DVec3::new(x[i], y[i], z[i]);
            let length = SpringLength::of(vector);
            self.coordinates[i] = length.length - rest_length;
            if GRADIENTS {
                let normal = vector * length.inverse;
                (x[i], y[i], z[i]) = (normal.x, normal.y, normal.z);
            }
        }
    }

    #[inline(always)]
    fn eval_shear<const GRADIENTS: bool>(&mut self, grid: &Grid) {
        let count = self.padded_len();
        let factor = 0.5 / (grid.column_spacing * grid.row_spacing);
        let [[a_x, a_y, a_z], [b_x, b_y, b_z], ..] = &mut self.vectors;
        for i in 0..count {
            let (first, second) = (DVec3::new(a_x[i], a_y[i], a_z[i]), DVec3::new(b_x[i], b_y[i], b_z[i]));
            // ℓ₁² − ℓ₂² without the cancellation of squares.
            self.coordinates[i] = 0.5 * factor * (first - second).dot(first + second);
            if GRADIENTS {
                let (first, second) = (first * factor, second * factor);
                (a_x[i], a_y[i], a_z[i]) = (first.x, first.y, first.z);
                (b_x[i], b_y[i], b_z[i]) = (second.x, second.y, second.z);
            }
        }
    }

    /// With S = a × b, n = S / N(|S|) and w = (Δ − q S / max(|S|, A)) / N, for Δ = x₋ − 2x + x₊:
    ///
    /// ```text
    /// dq = n · dΔ + w · (da × b + a × db) = n · dΔ + (b × w) · da + (w × a) · db
    /// ```
    ///
    /// Vectors become n, n − b × w, n + b × w and w × a.
    #[inline(always)]
    fn eval_bends<const GRADIENTS: bool>(&mut self, grid: &Grid) {
        let count = self.padded_len();
        let cell = grid.column_spacing * grid.row_spacing;
        let (squared_cell, inverse_cell) = (cell * cell, 1.0 / cell);
        let [[a_x, a_y, a_z], [b_x, b_y, b_z], [c_x, c_y, c_z], [d_x, d_y, d_z]] = &mut self.vectors;
        // Apart from what follows, or too few of these elements would be under way at a time.
        for i in 0..count {
            let along = DVec3::new(b_x[i], b_y[i], b_z[i]);
            let across = DVec3::new(c_x[i], c_y[i], c_z[i]);
            let area = along.cross(across);
            let squared = area.length_squared();
            let is_open = squared_cell <= squared;
            // One by |S|, or by the root of A² + |S|².
            let root = SpringLength::from_squared(if is_open { squared } else { squared_cell + squared });
            let folded = 2.0 * cell * (root.inverse * root.inverse);
            (d_x[i], d_y[i], d_z[i]) = (area.x, area.y, area.z);
            self.coordinates[i] = if is_open { root.inverse } else { folded };
        }
        for i in 0..count {
            let difference = DVec3::new(a_x[i], a_y[i], a_z[i]);
            let area = DVec3::new(d_x[i], d_y[i], d_z[i]);
            let inverse = self.coordinates[i];
            let normal = area * inverse;
            let coordinate = normal.dot(difference);
            self.coordinates[i] = coordinate;
            if GRADIENTS {
                let along = DVec3::new(b_x[i], b_y[i], b_z[i]);
                let across = DVec3::new(c_x[i], c_y[i], c_z[i]);
                // 1 / N is 1 / A at most where |S| is A at most.
                let is_open = inverse <= inverse_cell;
                let direction = area * if is_open { inverse } else { inverse_cell };
                let rest = (difference - direction * coordinate) * inverse;
                let of_along = across.cross(rest);
                let of_across = rest.cross(along);
                let (before, after) = (normal - of_along, normal + of_along);
                (a_x[i], a_y[i], a_z[i]) = (normal.x, normal.y, normal.z);
                (b_x[i], b_y[i], b_z[i]) = (before.x, before.y, before.z);
                (c_x[i], c_y[i], c_z[i]) = (after.x, after.y, after.z);
                (d_x[i], d_y[i], d_z[i]) = (of_across.x, of_across.y, of_across.z);
            }
        }
    }

    /// Overwrites the first `rates` with dq/dt at `velocities` [m/s].
    #[inline(always)]
    pub(in crate::force) fn eval_rates(&self, velocities: &Points, rates: &mut [f64; CHUNK]) {
        rates.fill(0.0);
        for node in self.layout.nodes() {
            let (elements, particles) = (node.elements(), node.particles());
            let rates = &mut rates[elements.clone()];
            let axes = [&velocities.x, &velocities.y, &velocities.z];
            let [vx, vy, vz] = axes.map(|axis| &axis[particles.clone()][..rates.len()]);
            let [x, y, z] = self.vectors[node.vector].each_ref().map(|axis| &axis[elements.clone()]);
            for i in 0..rates.len() {
                rates[i] += node.weight * (x[i] * vx[i] + y[i] * vy[i] + z[i] * vz[i]);
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
        for node in self.layout.nodes() {
            if !rows.contains(&node.row) {
                continue;
            }
            let target = node.particles_from(first);
            let (count, weight) = (target.len(), node.weight);
            let factors = &factors[node.elements()][..count];
            let [x, y, z] = &self.vectors[node.vector];
            let x = &x[node.elements()][..count];
            let y = &y[node.elements()][..count];
            let z = &z[node.elements()][..count];
            let x_sums = &mut sums.x[target.clone()][..count];
            let y_sums = &mut sums.y[target.clone()][..count];
            let z_sums = &mut sums.z[target][..count];
            for i in 0..count {
                let factor = weight * factors[i];
                x_sums[i] += factor * x[i];
                y_sums[i] += factor * y[i];
                z_sums[i] += factor * z[i];
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
        for node in self.layout.nodes() {
            if !rows.contains(&node.row) {
                continue;
            }
            let (elements, weight) = (node.elements(), node.weight.abs());
            let target = &mut bounds[node.particles_from(first)];
            let count = target.len();
            let pinned = &pinned[node.particles()][..count];
            let sizes = &sizes[node.vector][elements.clone()][..count];
            let free = &free[elements.clone()][..count];
            let coefficients = &coefficients[elements][..count];
            for i in 0..count {
                let size = weight * sizes[i];
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
        for node in self.layout.nodes() {
            if !rows.contains(&node.row) {
                continue;
            }
            let (particle, target) = (node.particle, node.particles_from(first).start);
            let [x, y, z] = &self.vectors[node.vector];
            for (own, i) in node.elements().enumerate() {
                let size = node.weight.abs() * sizes[node.vector][i];
                if size == 0.0 {
                    continue;
                }
                let sum = free[i] + if pinned[particle + own] { size } else { 0.0 };
                let factor = coefficients[i] * sum / size;
                let gradient = DVec3::new(x[i], y[i], z[i]) * node.weight;
                let scaled = gradient * factor;
                tensors.diagonal.add(target + own, scaled * gradient);
                let turned = DVec3::new(gradient.z, gradient.x, gradient.y);
                let off = DVec3::new(scaled.y, scaled.z, scaled.x) * turned;
                tensors.off_diagonal.add(target + own, off);
            }
        }
    }

    /// The lengths of all vectors, and the sums of |g| over those nodes of each element that are not pinned.
    #[inline(always)]
    fn sizes(&self, pinned: &[bool]) -> ([[f64; CHUNK]; VECTORS], [f64; CHUNK]) {
        let (mut sizes, mut free) = ([[0.0; CHUNK]; VECTORS], [0.0; CHUNK]);
        let vectors = self.layout.gradients.iter().fold(0, |count, (_, vector)| count.max(vector + 1));
        for (sizes, [x, y, z]) in sizes.iter_mut().zip(&self.vectors[..vectors]) {
            for i in 0..self.padded_len() {
                sizes[i] = SpringLength::from_squared(x[i] * x[i] + y[i] * y[i] + z[i] * z[i]).length;
            }
        }
        for node in self.layout.nodes() {
            let free = &mut free[node.elements()];
            let count = free.len();
            let sizes = &sizes[node.vector][node.elements()][..count];
            let pinned = &pinned[node.particles()][..count];
            for i in 0..count {
                free[i] += if pinned[i] { 0.0 } else { node.weight.abs() * sizes[i] };
            }
        }
        (sizes, free)
    }
}
