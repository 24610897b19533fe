//! Fabrics of kind `"measured"`: constants per width and area, as textile instruments give them.
//!
//! The settings, and the closed forms that lead from an instrument's values to them. What they become on a grid is said at
//! [`MeasuredFabric`].

mod bending;
mod shear;
mod tensile;
pub(crate) mod units;

pub use bending::{BendingRigidity, rigidity_from_bending_length};
pub use shear::{shear_modulus_from_bias_extension, shear_modulus_per_radian};
pub use tensile::{KesTensile, KesTensileError, MembraneTension};

/// A fabric of kind `"measured"`: what it is, whatever the grid.
///
/// Cells of h_x × h_y with diagonals l have shear springs k_d along both diagonals, and structural springs between
/// neighbours along the weft (x) and the warp (y), which carry what shear springs leave of the tension T per width:
///
/// ```text
/// k_d = G l² / (2 h_x h_y)
/// f_x = h_y (T_x(e) − G (h_x/h_y)² e)    f_y = h_x (T_y(e) − G (h_y/h_x)² e)
/// ```
///
/// Then a sheet has the tension T(e) per width when it is stretched along the yarns and held across them, and the shear
/// modulus G. Structural springs along an edge have half of that tension and particles there half the mass, a quarter at
/// corners: they stand for half a cell. What shear springs carry at larger strains is a little more than their share above, by
/// less than 1.5 G e² per width; and the modulus C₁₂ that couples both directions is always G, since all springs pull along
/// straight lines (Cauchy's relation).
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredFabric {
    /// Mass per area [kg/m²], positive.
    pub areal_density: f64,
    /// Linear drag k_d per area [kg/(s m²)], not negative.
    pub drag: f64,
    /// Tension along the warp, the height of a cloth.
    pub warp: MembraneTension,
    /// Tension along the weft, the width of a cloth.
    pub weft: MembraneTension,
    /// Shear modulus G [N/m], per radian of the shear angle; not negative.
    pub shear_modulus: f64,
    /// Rigidity against bending.
    pub bending: BendingRigidity,
}

impl MeasuredFabric {
    /// Tension per width and strain [N/m] that the shear springs of cells of `spacings` [m] along weft and warp carry, along
    /// the two.
    #[must_use]
    pub fn shear_springs_share(&self, [weft, warp]: [f64; 2]) -> [f64; 2] {
        let ratio = weft / warp;
        [self.shear_modulus * ratio * ratio, self.shear_modulus / (ratio * ratio)]
    }

    /// The smallest and the largest h_x / h_y [1] of cells whose structural springs have tension left, both excluded; without
    /// any such cells the first is not below the second.
    ///
    /// ```text
    /// √(G / K_warp) < h_x / h_y < √(K_weft / G)    with the least slopes K of the tensions
    /// ```
    #[must_use]
    pub fn cell_ratios(&self) -> [f64; 2] {
        let [warp, weft] = [&self.warp, &self.weft].map(MembraneTension::least_modulus);
        [(self.shear_modulus / warp).sqrt(), (weft / self.shear_modulus).sqrt()]
    }
}
