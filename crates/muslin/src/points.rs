//! Arrays of points in space, one array per coordinate.

use std::ops::Range;

use glam::DVec3;

use crate::AlignedArray;

/// Points or vectors in space as a structure of arrays; the unit is the owner's.
///
/// The three arrays have the same length, so that loops over them vectorise. Single points are [`DVec3`].
#[derive(Debug, Default, PartialEq)]
pub struct Points {
    /// First coordinates, one per point.
    pub x: AlignedArray,
    /// Second coordinates (up), one per point.
    pub y: AlignedArray,
    /// Third coordinates, one per point.
    pub z: AlignedArray,
}

impl Points {
    /// `count` points at the origin.
    #[must_use]
    pub fn zeros(count: usize) -> Self {
        let [x, y, z] = [(); 3].map(|()| AlignedArray::zeros(count));
        Self { x, y, z }
    }

    /// Number of points.
    #[must_use]
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// Whether there are no points.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// Point `index`.
    ///
    /// # Panics
    /// If `index` is not below [`len`](Self::len).
    #[must_use]
    pub fn get(&self, index: usize) -> DVec3 {
        DVec3::new(self.x[index], self.y[index], self.z[index])
    }

    /// Replaces point `index`.
    ///
    /// # Panics
    /// If `index` is not below [`len`](Self::len).
    pub fn set(&mut self, index: usize, point: DVec3) {
        self.x[index] = point.x;
        self.y[index] = point.y;
        self.z[index] = point.z;
    }

    /// All x, y and z, and some zeros behind them, none if there are no points: loops that run past the end need no copy.
    #[inline(always)]
    pub(crate) fn with_zeros_behind(&self) -> [&[f64]; 3] {
        [self.x.with_zeros_behind(), self.y.with_zeros_behind(), self.z.with_zeros_behind()]
    }

    /// Makes every coordinate `value`.
    pub fn fill(&mut self, value: f64) {
        self.as_mut().fill(value);
    }

    /// Exclusive access to all points.
    pub fn as_mut(&mut self) -> PointsMut<'_> {
        PointsMut { x: &mut self.x, y: &mut self.y, z: &mut self.z }
    }

    /// The x, y and z of the points of `range`.
    ///
    /// # Panics
    /// If it reaches beyond the last.
    #[must_use]
    #[inline]
    pub fn slice(&self, range: &Range<usize>) -> [&[f64]; 3] {
        [&self.x[range.clone()], &self.y[range.clone()], &self.z[range.clone()]]
    }

    /// Exclusive access to the points of `range`.
    ///
    /// # Panics
    /// If it reaches beyond the last.
    #[inline]
    pub fn slice_mut(&mut self, range: &Range<usize>) -> PointsMut<'_> {
        PointsMut {
            x: &mut self.x[range.clone()],
            y: &mut self.y[range.clone()],
            z: &mut self.z[range.clone()],
        }
    }

    /// Whether every coordinate is finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        [&self.x, &self.y, &self.z].into_iter().flatten().all(|value| value.is_finite())
    }

    /// The points in order.
    pub fn iter(&self) -> impl Iterator<Item = DVec3> + '_ {
        (0..self.len()).map(|index| self.get(index))
    }
}

impl Clone for Points {
    fn clone(&self) -> Self {
        Self { x: self.x.clone(), y: self.y.clone(), z: self.z.clone() }
    }

    /// Keeps the memory of `self`, which a derived `clone_from` would not.
    fn clone_from(&mut self, source: &Self) {
        self.x.clone_from(&source.x);
        self.y.clone_from(&source.y);
        self.z.clone_from(&source.z);
    }
}

impl FromIterator<DVec3> for Points {
    fn from_iter<I: IntoIterator<Item = DVec3>>(points: I) -> Self {
        let points: Vec<DVec3> = points.into_iter().collect();
        let axis = |coordinate: fn(&DVec3) -> f64| points.iter().map(coordinate).collect();
        Self { x: axis(|point| point.x), y: axis(|point| point.y), z: axis(|point| point.z) }
    }
}

/// Exclusive access to a run of consecutive [`Points`].
#[derive(Debug, Default)]
pub struct PointsMut<'a> {
    /// First coordinates.
    pub x: &'a mut [f64],
    /// Second coordinates (up).
    pub y: &'a mut [f64],
    /// Third coordinates.
    pub z: &'a mut [f64],
}

impl<'a> PointsMut<'a> {
    /// Number of points.
    #[must_use]
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// Whether there are no points.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// The first `count` points and the rest.
    ///
    /// # Panics
    /// If there are fewer than `count`.
    #[must_use]
    pub fn split_at(self, count: usize) -> (PointsMut<'a>, PointsMut<'a>) {
        let (x, x_rest) = self.x.split_at_mut(count);
        let (y, y_rest) = self.y.split_at_mut(count);
        let (z, z_rest) = self.z.split_at_mut(count);
        (PointsMut { x, y, z }, PointsMut { x: x_rest, y: y_rest, z: z_rest })
    }

    /// Makes every coordinate `value`.
    pub fn fill(&mut self, value: f64) {
        self.x.fill(value);
        self.y.fill(value);
        self.z.fill(value);
    }

    /// Replaces point `index`.
    ///
    /// # Panics
    /// If `index` is not below [`len`](Self::len).
    pub fn set(&mut self, index: usize, point: DVec3) {
        self.x[index] = point.x;
        self.y[index] = point.y;
        self.z[index] = point.z;
    }

    /// Adds `vector` to point `index`.
    ///
    /// # Panics
    /// If `index` is not below [`len`](Self::len).
    pub fn add(&mut self, index: usize, vector: DVec3) {
        self.x[index] += vector.x;
        self.y[index] += vector.y;
        self.z[index] += vector.z;
    }
}

/// Overwrites all `values` with `number`: what `fill` does, which in a loop in vectors would not be compiled for the same instructions.
#[inline(always)]
pub(crate) fn set_all(values: &mut [f64], number: f64) {
    for value in values {
        *value = number;
    }
}

/// Sum of `term(index, value)` over `values`, in eight partial sums so that it can use vector registers; the order is
/// the same on every machine.
#[inline(always)]
pub(crate) fn sum_in_lanes(values: &[f64], term: impl Fn(usize, f64) -> f64) -> f64 {
    let mut lanes = [0.0; 8];
    let chunks = values.chunks_exact(8);
    let rest = chunks.remainder();
    for (chunk_index, chunk) in chunks.enumerate() {
        for lane in 0..8 {
            lanes[lane] += term(8 * chunk_index + lane, chunk[lane]);
        }
    }
    let done = values.len() - rest.len();
    for (lane, (offset, &value)) in lanes.iter_mut().zip(rest.iter().enumerate()) {
        *lane += term(done + offset, value);
    }
    lanes.iter().sum()
}

/// Sum of x · u, y · v and z · w, whose lengths are the same, each in the order of [`sum_in_lanes`].
///
/// The three together take little more time than one: none waits for the addition before.
#[inline(always)]
pub(crate) fn dots_in_lanes([x, y, z]: [&[f64]; 3], [u, v, w]: [&[f64]; 3]) -> f64 {
    let [(xs, x_rest), (ys, y_rest), (zs, z_rest)] = [x, y, z].map(<[f64]>::as_chunks::<8>);
    let [(us, u_rest), (vs, v_rest), (ws, w_rest)] = [u, v, w].map(<[f64]>::as_chunks::<8>);
    let [mut along_x, mut along_y, mut along_z] = [[0.0; 8]; 3];
    let count = xs.len();
    let (ys, zs, us, vs, ws) = (&ys[..count], &zs[..count], &us[..count], &vs[..count], &ws[..count]);
    for i in 0..count {
        add_products(&mut along_x, &xs[i], &us[i]);
        add_products(&mut along_y, &ys[i], &vs[i]);
        add_products(&mut along_z, &zs[i], &ws[i]);
    }
    add_products(&mut along_x, x_rest, u_rest);
    add_products(&mut along_y, y_rest, v_rest);
    add_products(&mut along_z, z_rest, w_rest);
    sum(along_x) + sum(along_y) + sum(along_z)
}

/// Called once at the end of a loop, and not inlined: seeing how lanes end, the compiler would shuffle them in every turn for the sake
/// of these few additions.
#[inline(never)]
fn sum(lanes: [f64; 8]) -> f64 {
    lanes.iter().sum()
}

#[inline(always)]
fn add_products(lanes: &mut [f64; 8], a: &[f64], b: &[f64]) {
    for lane in 0..a.len().min(8) {
        lanes[lane] += a[lane] * b[lane];
    }
}

/// Sum of the products of `a` and `b`, which are as long, in the order of [`sum_in_lanes`].
#[inline(always)]
pub(crate) fn dot_in_lanes(a: &[f64], b: &[f64]) -> f64 {
    let mut lanes = [0.0; 8];
    let ((chunks_a, rest_a), (chunks_b, rest_b)) = (a.as_chunks::<8>(), b.as_chunks::<8>());
    for (a, b) in chunks_a.iter().zip(chunks_b) {
        add_products(&mut lanes, a, b);
    }
    add_products(&mut lanes, rest_a, rest_b);
    lanes.iter().sum()
}
