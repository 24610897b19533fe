//! What resists the turn of a line of particles.

/// |d|² / 6h² where a line is folded onto itself, |d| = 2h; only where it is stretched, too, is it larger.
const LARGEST_GROWTH: f64 = 2.0 / 3.0;

/// How lines of three particles resist bending in one direction of a grid with cells of length h.
///
/// The second difference d = x₋ − 2 x + x₊ of particles h apart has |d| = 2h sin(θ/2) where the line turns by θ, so that
///
/// ```text
/// E = ½ c |d|² (1 + |d|² / 12h²) = ½ c h² θ² (1 − θ⁴/90 + θ⁶/1008 − …)        F = c (1 + |d|² / 6h²) d
/// ```
///
/// Without the second term E would be that of the angle times (1 − θ²/12 + …). Beyond |d| = 2h, E goes on as a square with the
/// force that it has there, F = 5/3 c d: forces are continuous, and the stiffness along d drops from 3 c to 5/3 c.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in super::super) struct LineRigidity {
    /// c [N/m].
    pub(in super::super) coefficient: f64,
    /// 1 / 6h² [1/m²].
    growth: f64,
}

impl LineRigidity {
    /// c = B w / h³ for the `rigidity` B [N m] of a `width` w [m] with cells of `length` h [m].
    pub(super) fn new(rigidity: f64, width: f64, length: f64) -> Self {
        Self {
            coefficient: rigidity * width / (length * length * length),
            growth: 1.0 / (6.0 * length * length),
        }
    }

    /// The same with another c [N/m].
    #[inline(always)]
    pub(in super::super) fn with_coefficient(self, coefficient: f64) -> Self {
        Self { coefficient, ..self }
    }

    /// |F| / |d| [N/m] where |d|² is `square` [m²].
    #[inline(always)]
    pub(in super::super) fn force_coefficient(self, square: f64) -> f64 {
        let growth = self.growth * square;
        let growth = if growth < LARGEST_GROWTH { growth } else { LARGEST_GROWTH };
        self.coefficient + self.coefficient * growth
    }

    /// E [J] where |d|² is `square` [m²].
    pub(super) fn energy(self, square: f64) -> f64 {
        let growth = self.growth * square;
        let sum = if growth < LARGEST_GROWTH {
            square * (1.0 + 0.5 * growth)
        } else {
            square * (1.0 + LARGEST_GROWTH) - 0.5 * LARGEST_GROWTH * LARGEST_GROWTH / self.growth
        };
        0.5 * self.coefficient * sum
    }

    /// ∂F/∂d [N/m] where |d|² is `square` [m²], as the pair a, b of a 1 + b d dᵀ with b in N/m³.
    pub(super) fn tangent(self, square: f64) -> [f64; 2] {
        let turns = self.growth * square < LARGEST_GROWTH;
        let along = if turns { 2.0 * self.coefficient * self.growth } else { 0.0 };
        [self.force_coefficient(square), along]
    }

    /// The largest stiffness ‖∂F/∂d‖ [N/m] of all: c (1 + |d|² / 2h²) where the line is folded.
    pub(super) fn largest_stiffness(self) -> f64 {
        (1.0 + 3.0 * LARGEST_GROWTH) * self.coefficient
    }
}
