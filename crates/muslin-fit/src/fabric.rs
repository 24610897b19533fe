//! The fabric that a fit has found, with the friction of its loops.

use muslin::scene::{
    BendingFriction, BendingModel, BendingRigidity, InternalFriction, MeasuredFabric, MembraneTension,
    RetardationTimes, ShearFriction, TensionFriction,
};

use crate::estimate::Estimate;
use crate::fit::FabricFit;
use crate::friction::SlopeFit;
use crate::label::Direction;
use crate::tension::TensionFit;

/// The largest strain, in parts of the asymptote of the tangent law, that a scene takes for EMT beside a strain scale.
const LARGEST_EXTENSION: f64 = 0.99;

impl TensionFit {
    /// Friction along the yarns that gives back the share RT of the work; `None` without a loop, or if there is no such friction.
    #[must_use]
    pub fn friction(&self) -> Option<TensionFriction> {
        let extension = match &self.tension {
            MembraneTension::Curve(curve) => curve.points().last()?[0],
            _ => self.outcome.parameter("EMT")?.value,
        };
        let largest = LARGEST_EXTENSION * self.tension.asymptote().unwrap_or(f64::INFINITY);
        if 1.0 <= extension || largest < extension {
            return None;
        }
        TensionFriction::from_kes(&self.tension, extension, self.loop_resilience()?.value)
    }

    /// The least slope [N/m] of the tension that friction leaves to the elastic part.
    pub(crate) fn least_elastic_modulus(&self) -> f64 {
        self.tension.least_modulus() / (1.0 + self.friction().map_or(0.0, |friction| friction.ratio))
    }

    /// RT [1] of a loop whose area is beyond scatter.
    pub(crate) fn loop_resilience(&self) -> Option<Estimate> {
        self.outcome
            .parameter("RT")
            .filter(|resilience| resilience.interval.is_some_and(|[_, high]| high < 1.0))
    }
}

impl SlopeFit {
    /// Friction in shear with the widths 2HG and 2HG5 of the loop; `None` without a loop, or if no fabric has such friction.
    #[must_use]
    pub fn shear_friction(&self) -> Option<ShearFriction> {
        let width = |symbol| self.outcome.parameter(symbol).map(|width| width.value);
        let friction = ShearFriction::from_kes(width("2HG")?, width("2HG5")).ok()?;
        (friction.growth <= self.slope.value).then_some(friction)
    }

    /// The shear modulus [N/m] that friction leaves to the elastic part.
    pub(crate) fn elastic_shear_modulus(&self) -> f64 {
        self.slope.value - self.shear_friction().map_or(0.0, |friction| friction.growth)
    }

    /// Friction in bending with the width 2HB of the loop; `None` without a loop.
    #[must_use]
    pub fn bending_friction(&self) -> Option<BendingFriction> {
        self.outcome.parameter("2HB").map(|width| BendingFriction::from_kes(width.value))
    }
}

impl FabricFit {
    /// Friction of all loops that were measured.
    #[must_use]
    pub fn friction(&self) -> InternalFriction {
        let [warp_bend, weft_bend] = [Direction::Warp, Direction::Weft]
            .map(|direction| self.bending[direction as usize].as_ref()?.bending_friction());
        InternalFriction {
            warp: self.warp.as_ref().and_then(TensionFit::friction),
            weft: self.weft.as_ref().and_then(TensionFit::friction),
            shear: self.shear.as_ref().and_then(SlopeFit::shear_friction),
            warp_bend,
            weft_bend,
        }
    }

    /// The fabric, without drag and damping; `None` if it lacks a quantity that a scene needs.
    #[must_use]
    pub fn fabric(&self) -> Option<MeasuredFabric> {
        let [warp, weft] = [Direction::Warp, Direction::Weft].map(|direction| self.rigidity(direction));
        let (warp, weft) = (warp?.value, weft?.value);
        let least = 0.25 * (warp + weft);
        // As in a scene without `bias`.
        let twist = self.bias().map_or(least, |bias| bias.value - least);
        let tension =
            |fit: &Option<TensionFit>| -> Option<MembraneTension> { Some(fit.as_ref()?.tension.clone()) };
        Some(MeasuredFabric {
            areal_density: self.areal_density,
            drag: 0.0,
            warp: tension(&self.warp)?,
            weft: tension(&self.weft)?,
            shear_modulus: self.shear.as_ref()?.slope.value,
            bending: BendingRigidity { warp, weft, twist },
            bending_model: BendingModel::default(),
            friction: self.friction(),
            damping: RetardationTimes::default(),
        })
    }

    /// Width by height of cells that a grid of the fabric may have: the middle of what [`MeasuredFabric::cell_ratios`] allows. `None`
    /// if the fabric is incomplete, or no grid of springs can have it.
    #[must_use]
    pub fn cell_ratio(&self) -> Option<f64> {
        let [narrowest, widest] = self.fabric()?.cell_ratios();
        (narrowest < widest).then(|| (narrowest * widest).sqrt())
    }
}
