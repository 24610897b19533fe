//! The shear test of KES-FB1.

use std::f64::consts::PI;

use glam::DVec3;

use super::friction::shear_stresses;
use super::reading::{Reading, Record, Unit};
use super::specimen::{Cut, Specimen};
use super::{Along, LabError, Resolution};
use crate::scene::MeasuredFabric;
use crate::scene::units::GRAM_FORCE_PER_CM;
use crate::statics::Slide;

/// Tension per width [N/m] that the clamp keeps: 10 gf/cm.
const TENSION: f64 = 10.0 * GRAM_FORCE_PER_CM;

/// Distance of the clamps and width [m].
const SIZE: [f64; 2] = [0.05, 0.2];

/// Angles [°] on the way out: those at which the instrument is read, and some between.
const WAY_OUT: [f64; 8] = [0.0, 0.5, 1.5, 2.5, 4.0, 5.0, 6.5, 8.0];

/// Places on the way out of the angles between which G is read, and at which the loop is: 0.5°, 2.5° and 5°.
const NEAR: usize = 1;
const FAR: usize = 3;
const AT_5: usize = 5;

/// Number of steps on the way out.
const STEPS: usize = WAY_OUT.len() - 1;

/// A degree [rad].
const DEGREE: f64 = PI / 180.0;

/// What the shear test of KES-FB1 gives.
#[derive(Debug)]
pub struct ShearTest {
    /// Shear angle [rad] and shear force per width [N/m] in the middle half of the specimen, from 0° to 8°, −8° and back to 0°.
    pub curve: Vec<[f64; 2]>,
    /// Shear force per width [N/m] of the whole specimen, as the instrument reads it, step by step.
    pub whole: Vec<f64>,
    /// Shear force per width [N/m] that the fabric was given, at the angles of the curve.
    pub input: Vec<f64>,
    /// G: slope [N/m per radian] between 0.5° and 2.5°, the mean of both ways out, in the middle half.
    pub modulus: f64,
    /// The same of the whole specimen.
    pub whole_modulus: f64,
    /// 2HG: width of the loop [N/m] at 0.5°, the mean of both sides.
    pub hysteresis: f64,
    /// 2HG5: width of the loop [N/m] at 5°.
    pub hysteresis_at_5: f64,
    /// What the instrument says beside what the fabric was given.
    pub readings: Vec<Reading>,
    /// The specimen's way.
    pub record: Record,
}

/// Shears a specimen of `fabric` with its length along the yarns `along`, as KES-FB1 does: 20 cm wide and 5 cm long between
/// clamps, of which one slides along the other under a constant tension of 10 gf/cm, to ±8°.
///
/// With the force F of the clamp along its way, and the angle φ of the yarns between the clamps, the shear force per width is
///
/// ```text
/// F_s = F / width − T tan φ        given: F_s = G φ, with friction f along sin φ: G_el φ + f cos φ
/// ```
///
/// since the clamp under the tension T comes nearer as it slides. Springs shear by G sin φ (1 + ⅝ a² sin² φ) in cells of
/// h_x × h_y with diagonals l and a = 2 h_x h_y / l²: at 8° 0.1 % less than G φ in cells that are four times as wide as long, as
/// most specimens have them, and 0.9 % more in square ones. The free edges of the specimen do not shear as its middle does,
/// over a length that grows with √(G / K): the whole specimen reads less than G, and the middle half reads G.
///
/// # Errors
/// See [`LabError`].
pub fn shear(fabric: &MeasuredFabric, along: Along, resolution: Resolution) -> Result<ShearTest, LabError> {
    if fabric.shear_modulus == 0.0 {
        return Err(LabError::Nothing { what: "resistance to shear" });
    }
    let cells = resolution.cells();
    let cut = Cut::new(fabric, along, SIZE, cells, cells)?;
    let mut bench = Bench::new(Specimen::new(fabric, cut, false, 0.0, |i, _| i == 0 || i == cells))?;
    let (mut curve, mut whole) = (Vec::new(), Vec::new());
    for degrees in way() {
        let [angle, middle_force, force] = bench.shear(degrees)?;
        bench.specimen.accept(degrees);
        curve.push([angle, middle_force]);
        whole.push(force);
    }
    let all: Vec<[f64; 2]> = curve.iter().zip(&whole).map(|(&[angle, _], &force)| [angle, force]).collect();
    let [modulus, whole_modulus] = [&curve, &all].map(|curve| slope(curve));
    let [hysteresis, hysteresis_at_5] = [NEAR, AT_5].map(|place| width(&curve, place));
    let shear_modulus = fabric.shear_modulus;
    let elastic = fabric.elastic_shear_modulus();
    let stresses = shear_stresses(fabric.friction.shear, curve.iter().map(|point| point[0]));
    let input = curve.iter().zip(stresses).map(|(point, stress)| elastic * point[0] + stress).collect();
    let unit = Unit::SHEAR;
    let reading = |name, what, unit, measured, input| Reading { name, what, unit, measured, input };
    let given = |degrees: f64| {
        Some(fabric.friction.shear.map_or(0.0, |friction| friction.hysteresis(degrees * DEGREE)))
    };
    let readings = vec![
        reading("G", "shear modulus, middle half", unit, modulus, Some(shear_modulus)),
        reading("G", "shear modulus, whole width", unit, whole_modulus, Some(shear_modulus)),
        reading("2HG", "width of the loop at 0.5°", Unit::TENSION, hysteresis, given(WAY_OUT[NEAR])),
        reading("2HG5", "width of the loop at 5°", Unit::TENSION, hysteresis_at_5, given(WAY_OUT[AT_5])),
    ];
    let record = bench.specimen.into_record();
    Ok(ShearTest {
        curve,
        whole,
        input,
        modulus,
        whole_modulus,
        hysteresis,
        hysteresis_at_5,
        readings,
        record,
    })
}

/// Angles [°] of the test: out, through zero to the other side, and back to zero.
fn way() -> impl Iterator<Item = f64> {
    let back = WAY_OUT.into_iter().rev().skip(1);
    let other = WAY_OUT.into_iter().skip(1).map(|degrees| -degrees);
    WAY_OUT.into_iter().chain(back.clone()).chain(other).chain(back.map(|degrees| -degrees))
}

/// Slope [N/m per radian] between 0.5° and 2.5°, the mean of the ways out on both sides.
fn slope(curve: &[[f64; 2]]) -> f64 {
    let side = |zero: usize| {
        let [[near, near_force], [far, far_force]] = [curve[zero + NEAR], curve[zero + FAR]];
        (far_force - near_force) / (far - near)
    };
    0.5 * (side(0) + side(2 * STEPS))
}

/// Width [N/m] of the loop at a `place` on the way out, the mean of both sides.
fn width(curve: &[[f64; 2]], place: usize) -> f64 {
    let right = curve[place][1] - curve[2 * STEPS - place][1];
    let left = curve[4 * STEPS - place][1] - curve[2 * STEPS + place][1];
    0.5 * (right + left)
}

/// The specimen in its clamps.
struct Bench {
    specimen: Specimen,
    upper_clamp: Vec<usize>,
    /// The part of it above the middle half, with the share of each particle's force that counts to it.
    middle: Vec<(usize, f64)>,
    middle_width: f64,
    /// Distance of the clamps [m] under tension alone.
    length: f64,
}

impl Bench {
    /// The specimen under tension.
    fn new(specimen: Specimen) -> Result<Self, LabError> {
        let [count, count_across] = specimen.counts();
        let upper_clamp = specimen.line(count - 1);
        let cells = count_across - 1;
        let (first, last) = (cells.div_ceil(4), 3 * cells / 4);
        // At its ends stands half a cell.
        let middle = (first..=last).map(|j| {
            let share = if j == first || j == last { 0.5 } else { 1.0 };
            (specimen.particle(count - 1, j), share)
        });
        let middle = middle.collect();
        let middle_width = SIZE[1] * (last - first) as f64 / cells as f64;
        let mut bench = Self { specimen, upper_clamp, middle, middle_width, length: 0.0 };
        bench.settle(0.0)?;
        bench.length = bench.height();
        Ok(bench)
    }

    fn height(&self) -> f64 {
        let positions = self.specimen.positions();
        positions.get(self.upper_clamp[0]).x
    }

    fn settle(&mut self, degrees: f64) -> Result<(), LabError> {
        let slide =
            Slide { particles: self.upper_clamp.clone(), direction: DVec3::X, load: TENSION * SIZE[1] };
        self.specimen.settle(&[slide], || format!("a shear angle of {degrees}°"))
    }

    /// Angle [rad], and shear force per width [N/m] of the middle half and of all, with the clamp where yarns that keep their
    /// length have turned by `degrees`.
    fn shear(&mut self, degrees: f64) -> Result<[f64; 3], LabError> {
        let way = self.length * libm::sin(degrees * DEGREE);
        let [count, count_across] = self.specimen.counts();
        let cells = count - 1;
        let rest = SIZE[1] / (count_across - 1) as f64;
        let is_guessed = self.specimen.guess(degrees);
        let before = self.specimen.positions().get(self.upper_clamp[0]).y;
        self.specimen.move_to(|i, j, place| {
            let share = i as f64 / cells as f64;
            if i == cells {
                // Its distance is the slide's.
                place.with_y(j as f64 * rest + way)
            } else if is_guessed {
                place
            } else {
                place.with_y(place.y + share * (way - before))
            }
        });
        self.settle(degrees)?;
        let angle = libm::atan2(way, self.height());
        let own = TENSION * libm::tan(angle);
        let middle: f64 =
            self.middle.iter().map(|&(p, share)| share * self.specimen.holding_force(p).y).sum();
        let all = self.specimen.clamp_force(&self.upper_clamp).y;
        Ok([angle, middle / self.middle_width - own, all / SIZE[1] - own])
    }
}
