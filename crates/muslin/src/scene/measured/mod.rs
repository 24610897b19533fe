//! Fabrics of kind `"measured"`: constants per width and area, as textile instruments give them.
//!
//! The settings, and the closed forms that lead from an instrument's values to them. What they become on a grid is said at
//! [`MeasuredFabric`].

mod bending;
mod friction;
mod shear;
mod tensile;
pub mod units;

pub use bending::{BendingModel, BendingRigidity, rigidity_from_bending_length};
pub use friction::{
    BendingFriction, InternalFriction, RetardationTimes, ShearFriction, ShearFrictionError, TensionFriction,
};
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
///
/// With friction, T and G are those of the elastic part of the fabric, and friction comes on top.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredFabric {
    /// Mass per area [kg/m²], positive.
    pub areal_density: f64,
    /// Linear drag k_d per area [kg/(s m²)], not negative.
    pub drag: f64,
    /// Tension along the warp, the height of a cloth, as it is loaded.
    pub warp: MembraneTension,
    /// Tension along the weft, the width of a cloth, as it is loaded.
    pub weft: MembraneTension,
    /// Shear modulus G [N/m], per radian of the shear angle, as it is loaded; not negative.
    pub shear_modulus: f64,
    /// Rigidity against bending.
    pub bending: BendingRigidity,
    /// What that becomes on a grid.
    pub bending_model: BendingModel,
    /// Friction that does not depend on speed, and holds the shape that a cloth is bent to.
    pub friction: InternalFriction,
    /// Damping in proportion to speed.
    pub damping: RetardationTimes,
}

impl MeasuredFabric {
    /// Elastic tension along weft and warp: what is left of the loading curves without friction.
    #[must_use]
    pub fn elastic_tensions(&self) -> [MembraneTension; 2] {
        [(&self.weft, self.friction.weft), (&self.warp, self.friction.warp)].map(|(tension, friction)| {
            friction.map_or_else(|| tension.clone(), |friction| tension.scaled(1.0 / (1.0 + friction.ratio)))
        })
    }

    /// Elastic shear modulus [N/m]: what is left of the modulus without the growth of friction.
    #[must_use]
    pub fn elastic_shear_modulus(&self) -> f64 {
        self.shear_modulus - self.friction.shear.map_or(0.0, |friction| friction.growth)
    }

    /// Tension per width and strain [N/m] that the shear springs of cells of `spacings` [m] along weft and warp carry, along
    /// the two.
    #[must_use]
    pub fn shear_springs_share(&self, [weft, warp]: [f64; 2]) -> [f64; 2] {
        let ratio = weft / warp;
        let modulus = self.elastic_shear_modulus();
        [modulus * ratio * ratio, modulus / (ratio * ratio)]
    }

    /// The smallest and the largest h_x / h_y [1] of cells whose structural springs have tension left, both excluded; without
    /// any such cells the first is not below the second.
    ///
    /// ```text
    /// √(G / K_warp) < h_x / h_y < √(K_weft / G)    with the least slopes K of the elastic tensions
    /// ```
    #[must_use]
    pub fn cell_ratios(&self) -> [f64; 2] {
        let [weft, warp] = self.elastic_tensions().map(|tension| tension.least_modulus());
        let modulus = self.elastic_shear_modulus();
        [(modulus / warp).sqrt(), (weft / modulus).sqrt()]
    }
}
