//! The bias extension of FAST-3.

use std::f64::consts::FRAC_1_SQRT_2;

use glam::DVec3;

use super::friction::shear_angle;
use super::reading::{Reading, Record, Unit};
use super::specimen::{Cut, Specimen};
use super::tensile::law;
use super::{Along, LabError, Resolution};
use crate::force::TensionLaw;
use crate::scene::units::GRAM_FORCE_PER_CM;
use crate::scene::{MeasuredFabric, shear_modulus_from_bias_extension};
use crate::statics::Slide;

/// Greatest tension per width [N/m]: 5 gf/cm.
const TENSION: f64 = 5.0 * GRAM_FORCE_PER_CM;

/// Sides [m] of the square whose diagonal is the width of the strip, 50 mm.
const SIDE: f64 = 0.05 * FRAC_1_SQRT_2;

/// Steps up to the greatest tension, and share of it in the first, before which the modulus is read.
const STEPS: i32 = 10;
const FIRST: f64 = 0.01;

/// What the bias extension of FAST-3 gives.
#[derive(Debug)]
pub struct BiasTest {
    /// Strain [1] at 45° to the yarns and tension per width [N/m], from 0 to 5 gf/cm and back.
    pub curve: Vec<[f64; 2]>,
    /// EB5: strain [1] at 5 gf/cm.
    pub extension: f64,
    /// E₄₅: slope [N/m] at the first hundredth of the tension.
    pub modulus: f64,
    /// G [N/m per radian] from EB5, as FAST has it: 123 / EB5.
    pub shear_modulus: f64,
    /// What the instrument says beside what the fabric was given.
    pub readings: Vec<Reading>,
    /// The specimen's way.
    pub record: Record,
}

/// Pulls `fabric` at 45° to its yarns by up to 5 gf/cm, as FAST-3 does.
///
/// Grids lie along the yarns, so the specimen is a square of the middle of a strip, with its sides along the yarns. The rest
/// of the strip pulls at each side as it does in a strip under uniform tension T along d, by T (n · d) d per length of a side
/// with the normal n. For small strains
///
/// ```text
/// 1/E₄₅ = ¼ (1/E₁ + 1/E₂ − 2 ν₁₂/E₁) + 1/(4 G)        EB5 ≈ T / 4 G
/// ```
///
/// where the second is what FAST takes. With friction in shear, what holds counts to the G of the first, and the second is
/// EB5 ≈ ½ γ, with the shear angle γ at which the fabric as new has the shear stress ½ T. At 4 % strain the yarns have
/// turned towards the pull, and EB5 is about 5 % less than by E₄₅.
///
/// # Errors
/// See [`LabError`].
pub fn bias(fabric: &MeasuredFabric, resolution: Resolution) -> Result<BiasTest, LabError> {
    if fabric.shear_modulus == 0.0 {
        return Err(LabError::Nothing { what: "resistance to shear" });
    }
    let cells = resolution.cells();
    let cut = Cut::new(fabric, Along::Warp, [SIDE; 2], cells, cells)?;
    let across = cut.cells[1];
    let is_held = |i: usize, j: usize| (i == 0 && j == 0) || (i == cells && j == across);
    let mut bench = Bench { specimen: Specimen::new(fabric, cut, false, 0.0, is_held), cells: cut.cells };
    let way = (1..=STEPS).chain((0..STEPS).rev()).map(|step| f64::from(step) / f64::from(STEPS));
    let mut curve = Vec::new();
    for share in [0.0, FIRST].into_iter().chain(way) {
        let strain = bench.pull(share * TENSION)?;
        bench.specimen.accept(share);
        curve.push([strain, share * TENSION]);
    }
    let modulus = curve[1][1] / curve[1][0];
    let extension = curve[1 + STEPS as usize][0];
    let shear_modulus = shear_modulus_from_bias_extension(extension);
    let reading =
        |name, what, unit, measured, input| Reading { name, what, unit, measured, input: Some(input) };
    // In a square whose diagonal is pulled the shear stress is half of the tension, and the strain half of the angle.
    let linear = 0.5 * shear_angle(fabric, 0.5 * TENSION);
    let readings = vec![
        reading("E45", "modulus at small strain", Unit::plain("N/m"), modulus, bias_modulus(fabric)),
        reading("EB5", "strain at 5 gf/cm", Unit::PERCENT, extension, linear),
        reading(
            "G",
            "shear modulus, 123 / EB5",
            Unit::plain("N/m per rad"),
            shear_modulus,
            shear_modulus_from_bias_extension(linear),
        ),
    ];
    let record = bench.specimen.into_record();
    Ok(BiasTest { curve, extension, modulus, shear_modulus, readings, record })
}

/// E₄₅ [N/m] of `fabric` at rest, whose coupling C₁₂ is G; friction in shear holds there.
fn bias_modulus(fabric: &MeasuredFabric) -> f64 {
    let [warp, weft] = [&fabric.warp, &fabric.weft].map(|tension| law(tension).tangent(0.0, 1.0));
    let coupling = fabric.elastic_shear_modulus();
    let shear = coupling + fabric.friction.shear.map_or(0.0, |friction| friction.stiffness);
    let determinant = warp * weft - coupling * coupling;
    // 1/E₁ = C₂₂ / det, 1/E₂ = C₁₁ / det, ν₁₂/E₁ = C₁₂ / det.
    4.0 / ((weft + warp - 2.0 * coupling) / determinant + 1.0 / shear)
}

/// The square, held at one corner, the opposite one kept on the diagonal.
struct Bench {
    specimen: Specimen,
    cells: [usize; 2],
}

impl Bench {
    /// Strain [1] along the diagonal at rest under the `tension` per width [N/m].
    fn pull(&mut self, tension: f64) -> Result<f64, LabError> {
        let direction = DVec3::new(FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0);
        let [cells, across] = self.cells;
        let pull = |i: usize, j: usize| {
            // Per side, T (n · d) times the length that a particle stands for.
            let side = |place: usize, count: usize, other: usize, others: usize| {
                let length = SIDE / others as f64 * if other == 0 || other == others { 0.5 } else { 1.0 };
                let normal = if place == 0 {
                    -1.0
                } else if place == count {
                    1.0
                } else {
                    0.0
                };
                tension * FRAC_1_SQRT_2 * normal * length
            };
            side(i, cells, j, across) + side(j, across, i, cells)
        };
        for i in 0..=cells {
            for j in 0..=across {
                let particle = self.specimen.particle(i, j);
                self.specimen.set_load(particle, direction * pull(i, j));
            }
        }
        let corner = self.specimen.particle(cells, across);
        // Its load is that of its particle.
        let slide = Slide { particles: vec![corner], direction, load: 0.0 };
        self.specimen.guess(tension / TENSION);
        self.specimen.settle(&[slide], || format!("a tension of {tension:.4} N/m"))?;
        let diagonal = self.specimen.positions().get(corner) - self.specimen.positions().get(0);
        Ok(diagonal.length() / (SIDE / FRAC_1_SQRT_2) - 1.0)
    }
}
