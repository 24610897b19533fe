//! Arrays of points in space, one array per coordinate.

use glam::DVec3;

/// Points or vectors in space as a structure of arrays; the unit is the owner's.
///
/// The three arrays have the same length, so that loops over them vectorise. Single points are [`DVec3`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Points {
    /// First coordinates, one per point.
    pub x: Vec<f64>,
    /// Second coordinates (up), one per point.
    pub y: Vec<f64>,
    /// Third coordinates, one per point.
    pub z: Vec<f64>,
}

impl Points {
    /// `count` points at the origin.
    #[must_use]
    pub fn zeros(count: usize) -> Self {
        Self { x: vec![0.0; count], y: vec![0.0; count], z: vec![0.0; count] }
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

    /// Makes every coordinate `value`.
    pub fn fill(&mut self, value: f64) {
        self.x.fill(value);
        self.y.fill(value);
        self.z.fill(value);
    }

    /// The points in order.
    pub fn iter(&self) -> impl Iterator<Item = DVec3> + '_ {
        (0..self.len()).map(|index| self.get(index))
    }
}

impl FromIterator<DVec3> for Points {
    fn from_iter<I: IntoIterator<Item = DVec3>>(points: I) -> Self {
        let mut array = Self::default();
        for point in points {
            array.x.push(point.x);
            array.y.push(point.y);
            array.z.push(point.z);
        }
        array
    }
}
