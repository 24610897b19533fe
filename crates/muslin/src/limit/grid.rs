//! The limits of a grid's springs.

use glam::DVec3;

use super::{Limit, LimitRule};
use crate::Points;
use crate::model::{Grid, Particles};
use crate::scene::{LimitSettings, SpringsFabric};

/// Springs that are corrected together at most: both diagonals of a cell, and of its mirror images across both middles.
const LARGEST_GROUP: usize = 8;

/// Limits of the springs of one grid: structural ones, and shear springs if they have a limit of their own.
///
/// A pass takes the springs along columns, those along rows, then the diagonals, each spring once, and begins from where
/// the one before has left the particles. Of each of these, every other spring, counted from the nearer edge, comes first.
/// A spring and its mirror images across the middles of the grid are corrected from the same positions, so that a mirrored
/// grid has the mirrored motion. A grid with columns and rows exchanged has not: the order is exchanged, too.
#[derive(Clone, Debug, PartialEq)]
pub struct GridLimit {
    grid: Grid,
    passes: u32,
    structural: LimitRule,
    shear: Option<LimitRule>,
}

impl GridLimit {
    /// The limits that `fabric` gives `grid`, if it has any.
    #[must_use]
    pub fn new(grid: Grid, fabric: &SpringsFabric) -> Option<Self> {
        let limit = match fabric.limit.as_ref()? {
            LimitSettings::CutOff { strain, shear_strain, passes } => Self {
                grid,
                passes: *passes,
                structural: LimitRule::CutOff { strain: *strain },
                shear: shear_strain.map(|strain| LimitRule::CutOff { strain }),
            },
            LimitSettings::ArctangentProjection => {
                Self { grid, passes: 1, structural: LimitRule::ArctangentProjection, shear: None }
            }
        };
        Some(limit)
    }

    /// Corrects each spring once; whether any was too long.
    fn pass(&self, points: &mut Correction<'_>) -> bool {
        let Grid { columns, rows, column_spacing, row_spacing, .. } = self.grid;
        let mut any = false;
        for parity in 0..2 {
            for row in 0..rows {
                for column in half(columns - 1, parity) {
                    let springs = mirrored(columns - 1, column)
                        .map(|column| [self.grid.particle(column, row), self.grid.particle(column + 1, row)]);
                    any |= points.shorten(self.structural, column_spacing, springs);
                }
            }
        }
        for parity in 0..2 {
            for row in half(rows - 1, parity) {
                for column in 0..columns {
                    let springs = mirrored(rows - 1, row)
                        .map(|row| [self.grid.particle(column, row), self.grid.particle(column, row + 1)]);
                    any |= points.shorten(self.structural, row_spacing, springs);
                }
            }
        }
        if let Some(rule) = self.shear {
            let diagonal = (column_spacing * column_spacing + row_spacing * row_spacing).sqrt();
            for (row_parity, column_parity) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                for row in half(rows - 1, row_parity) {
                    for column in half(columns - 1, column_parity) {
                        any |= points.shorten(rule, diagonal, self.diagonals(column, row));
                    }
                }
            }
        }
        any
    }

    /// The diagonals of a cell and of its mirror images.
    fn diagonals(&self, column: usize, row: usize) -> impl Iterator<Item = [usize; 2]> {
        let grid = self.grid;
        mirrored(grid.rows - 1, row).flat_map(move |row| {
            mirrored(grid.columns - 1, column).flat_map(move |column| {
                let [left, right] = [column, column + 1];
                [
                    [grid.particle(left, row), grid.particle(right, row + 1)],
                    [grid.particle(right, row), grid.particle(left, row + 1)],
                ]
            })
        })
    }
}

impl Limit for GridLimit {
    fn correct(&self, particles: &Particles, positions: &mut Points, impulses: &mut Points) {
        let mut points = Correction { particles, positions, impulses };
        for _ in 0..self.passes {
            if !self.pass(&mut points) {
                return;
            }
        }
    }
}

/// Every other number of the first half of `count`, the middle included, from `parity` on.
fn half(count: usize, parity: usize) -> impl Iterator<Item = usize> {
    (parity..count.div_ceil(2)).step_by(2)
}

/// `index` of `count`, and its mirror image if that is another.
fn mirrored(count: usize, index: usize) -> impl Iterator<Item = usize> {
    let image = count - 1 - index;
    std::iter::once(index).chain((image != index).then_some(image))
}

/// Particles that are being corrected.
struct Correction<'a> {
    particles: &'a Particles,
    positions: &'a mut Points,
    impulses: &'a mut Points,
}

impl Correction<'_> {
    /// Shortens those of the `springs` of `rest_length` [m], given by their ends, that are too long; whether any is. None
    /// sees what is done to the others.
    fn shorten(
        &mut self,
        rule: LimitRule,
        rest_length: f64,
        springs: impl Iterator<Item = [usize; 2]>,
    ) -> bool {
        let mut found = [([0; 2], DVec3::ZERO); LARGEST_GROUP];
        let mut count = 0;
        let (masses, pinned) = (self.particles.masses(), self.particles.pinned());
        for ends in springs {
            let [own, other] = ends;
            let vector = self.positions.get(other) - self.positions.get(own);
            let length = vector.length();
            let Some(shortened) = rule.shortened(length, rest_length) else { continue };
            let mass = match (pinned[own], pinned[other]) {
                (true, true) => continue,
                (true, false) => masses[other],
                (false, true) => masses[own],
                (false, false) => masses[own] * (masses[other] / (masses[own] + masses[other])),
            };
            found[count] = (ends, vector * (mass * (1.0 - shortened / length)));
            count += 1;
        }
        for (ends, impulse) in &found[..count] {
            for (&end, impulse) in ends.iter().zip([*impulse, -*impulse]) {
                self.impulses.set(end, self.impulses.get(end) + impulse);
                if !pinned[end] {
                    self.positions.set(end, self.positions.get(end) + impulse / masses[end]);
                }
            }
        }
        0 < count
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every spring is corrected once, and no particle twice but by mirror images.
    #[test]
    fn a_pass_meets_every_spring_once() {
        for count in 0..12 {
            let mut met = vec![0; count];
            for parity in 0..2 {
                let mut touched = vec![None; count + 1];
                for index in half(count, parity) {
                    for spring in mirrored(count, index) {
                        met[spring] += 1;
                        for end in [spring, spring + 1] {
                            let before = touched[end].replace(index);
                            assert!(before.is_none_or(|before| before == index), "{count} springs");
                        }
                    }
                }
            }
            assert!(met.iter().all(|times| *times == 1), "{met:?}");
        }
    }
}
