//! Rectangular grids of particles, whose neighbours are known without an index.

use std::ops::Range;

use glam::DVec3;

use crate::Points;
use crate::scene::{GridSettings, Placement};

/// A rectangular grid of consecutive particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Particle at column 0, row 0.
    pub first_particle: usize,
    /// Particles along the width (weft), at least 1.
    pub columns: usize,
    /// Particles along the height (warp), at least 1.
    pub rows: usize,
    /// Rest distance of neighbouring columns [m]; zero if there is one column.
    pub column_spacing: f64,
    /// Rest distance of neighbouring rows [m]; zero if there is one row.
    pub row_spacing: f64,
}

impl Grid {
    /// The grid of `settings` that starts at `first_particle`.
    #[must_use]
    pub fn new(first_particle: usize, settings: GridSettings) -> Self {
        let spacing = |extent: f64, count: usize| if count == 1 { 0.0 } else { extent / (count - 1) as f64 };
        Self {
            first_particle,
            columns: settings.columns,
            rows: settings.rows,
            column_spacing: spacing(settings.width, settings.columns),
            row_spacing: spacing(settings.height, settings.rows),
        }
    }

    /// Number of particles.
    #[must_use]
    pub fn particle_count(&self) -> usize {
        self.columns * self.rows
    }

    /// Width and height together [m]; zero for a single particle.
    #[must_use]
    pub fn extent(&self) -> f64 {
        (self.columns - 1) as f64 * self.column_spacing + (self.rows - 1) as f64 * self.row_spacing
    }

    /// The particle at `column`, `row`.
    #[must_use]
    pub fn particle(&self, column: usize, row: usize) -> usize {
        self.first_particle + row * self.columns + column
    }

    /// Column and row of `particle`, or `None` if it is not of this grid.
    #[must_use]
    pub fn cell(&self, particle: usize) -> Option<(usize, usize)> {
        let index = particle.checked_sub(self.first_particle)?;
        (index < self.particle_count()).then(|| (index % self.columns, index / self.columns))
    }

    /// The rows that the particles of `block` make up, or `None` if it is not of this grid.
    pub(crate) fn block_rows(&self, block: &Range<usize>) -> Option<Range<usize>> {
        let (_, first_row) = self.cell(block.start)?;
        Some(first_row..first_row + block.len() / self.columns)
    }

    /// Ranges of whole rows of about `size` particles.
    pub(crate) fn blocks(&self, size: usize) -> impl Iterator<Item = Range<usize>> + use<> {
        let Self { first_particle, columns, rows, .. } = *self;
        // Springs reach two rows down, and no farther than into the next block.
        let rows_per_block = (size / columns).max(2);
        (0..rows).step_by(rows_per_block).map(move |row| {
            let end = (row + rows_per_block).min(rows);
            first_particle + row * columns..first_particle + end * columns
        })
    }

    /// Sets the grid's particles among `positions` [m] flat and unstretched at `place`.
    pub(crate) fn place(&self, place: &Placement, positions: &mut Points) {
        for row in 0..self.rows {
            for column in 0..self.columns {
                positions.set(self.particle(column, row), self.place_of(column, row, place));
            }
        }
    }

    /// Where the particle at `column`, `row` is [m] if the grid is flat and unstretched at `place`.
    pub(crate) fn place_of(&self, column: usize, row: usize, place: &Placement) -> DVec3 {
        let across = place.width_axis * (column as f64 * self.column_spacing);
        let along = place.height_axis * (row as f64 * self.row_spacing);
        place.origin + across + along
    }
}
