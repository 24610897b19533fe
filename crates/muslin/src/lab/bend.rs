//! The bending test of KES-FB2.

use glam::DVec3;

use super::friction::bending_moments;
use super::reading::{Reading, Record, Unit};
use super::specimen::{Cut, Specimen};
use super::{Along, LabError, Resolution};
use crate::scene::{BendingFriction, MeasuredFabric};
use crate::statics::Slide;

/// Length between the clamps and width [m]. The instrument takes 20 cm; nothing varies across it, and a part stands for it.
const SIZE: [f64; 2] = [0.01, 0.0025];

/// Largest curvature [1/m], and steps up to it: 2.5 /cm by 0.25 /cm.
const LARGEST_CURVATURE: f64 = 250.0;
const STEPS: i32 = 10;

/// Steps to the curvatures of 0.5 /cm and 1.5 /cm between which B is read, and to that of 1 /cm where the loop is.
const NEAR: i32 = 2;
const FAR: i32 = 6;
const LOOP: i32 = 4;

/// What the bending test of KES-FB2 gives.
#[derive(Debug)]
pub struct BendTest {
    /// Curvature [1/m] and moment per width [N], from 0 to 2.5 /cm, −2.5 /cm and back to 0.
    pub curve: Vec<[f64; 2]>,
    /// Moment per width [N] that the fabric was given, at the curvatures of the curve.
    pub input: Vec<f64>,
    /// B: slope [N m] between 0.5 and 1.5 /cm, the mean of both ways out.
    pub rigidity: f64,
    /// 2HB: width of the loop [N] at 1 /cm, the mean of both sides.
    pub hysteresis: f64,
    /// What the instrument says beside what the fabric was given.
    pub readings: Vec<Reading>,
    /// The specimen's way.
    pub record: Record,
}

/// Bends a specimen of `fabric` with its length along the yarns `along`, as KES-FB2 does: 1 cm between clamps, to curvatures
/// of ±2.5 /cm.
///
/// The moving clamp turns by the curvature times the length, and is free to follow otherwise, so that the bending is pure:
/// the moment is the same along the specimen. Each clamp is two lines of held particles, and the specimen begins at the
/// inner one.
///
/// # Errors
/// See [`LabError`].
pub fn bend(fabric: &MeasuredFabric, along: Along, resolution: Resolution) -> Result<BendTest, LabError> {
    let rigidity = rigidity_of(fabric, along);
    if rigidity == 0.0 {
        return Err(LabError::Nothing { what: "bending rigidity along these yarns" });
    }
    let cells = resolution.cells();
    let spacing = SIZE[0] / cells as f64;
    let size = [SIZE[0] + 2.0 * spacing, SIZE[1]];
    let cut = Cut::new(fabric, along, size, cells + 2, 2)?;
    let is_held = |i: usize, _: usize| i < 2 || cells < i;
    let mut bench = Bench { specimen: Specimen::new(fabric, cut, true, 0.0, is_held), cells, spacing };
    let way = (0..=STEPS).chain((-STEPS..STEPS).rev()).chain(-STEPS + 1..=0);
    let mut curve = Vec::new();
    for step in way {
        let curvature = LARGEST_CURVATURE * f64::from(step) / f64::from(STEPS);
        let moment = bench.moment(curvature)?;
        bench.specimen.accept(curvature);
        curve.push([curvature, moment]);
    }
    let friction = friction_of(fabric, along);
    let moments = bending_moments(friction, curve.iter().map(|point| point[0]));
    let input = curve.iter().zip(moments).map(|(point, moment)| rigidity * point[0] + moment).collect();
    let (back, end) = (2 * STEPS, 4 * STEPS);
    let at = |step: i32| curve[step as usize];
    let side = |near: i32, far: i32| (at(far)[1] - at(near)[1]) / (at(far)[0] - at(near)[0]);
    let measured = 0.5 * (side(NEAR, FAR) + side(back + NEAR, back + FAR));
    let [right, left] = [at(LOOP)[1] - at(back - LOOP)[1], at(end - LOOP)[1] - at(back + LOOP)[1]];
    let hysteresis = 0.5 * (right + left);
    let reading = |name, what, unit, measured, input| Reading { name, what, unit, measured, input };
    let given = friction.map_or(0.0, |friction| 2.0 * friction.moment);
    let readings = vec![
        reading("B", "bending rigidity", Unit::RIGIDITY, measured, Some(rigidity)),
        reading("2HB", "width of the loop at 1 /cm", Unit::MOMENT, hysteresis, Some(given)),
    ];
    let record = bench.specimen.into_record();
    Ok(BendTest { curve, input, rigidity: measured, hysteresis, readings, record })
}

/// Rigidity [N m] of a fabric along given yarns.
pub(super) fn rigidity_of(fabric: &MeasuredFabric, along: Along) -> f64 {
    match along {
        Along::Warp => fabric.bending.warp,
        Along::Weft => fabric.bending.weft,
    }
}

/// Friction in bending of a fabric along given yarns, if it has any.
pub(super) fn friction_of(fabric: &MeasuredFabric, along: Along) -> Option<BendingFriction> {
    match along {
        Along::Warp => fabric.friction.warp_bend,
        Along::Weft => fabric.friction.weft_bend,
    }
}

/// The specimen in its clamps.
struct Bench {
    specimen: Specimen,
    /// Cells between the clamps.
    cells: usize,
    /// Length of a cell [m].
    spacing: f64,
}

impl Bench {
    /// Moment per width [N] at rest with the moving clamp turned by the `curvature` [1/m].
    fn moment(&mut self, curvature: f64) -> Result<f64, LabError> {
        let Self { specimen, cells, spacing } = self;
        let (cells, spacing) = (*cells, *spacing);
        if !specimen.recall(curvature) {
            let arc = arc(curvature * spacing, cells, spacing);
            specimen.move_to(|i, _, place| arc[i].with_z(place.z));
        }
        let clamp: Vec<usize> = [cells + 1, cells + 2].into_iter().flat_map(|i| specimen.line(i)).collect();
        let slides =
            [DVec3::X, DVec3::Y].map(|direction| Slide { particles: clamp.clone(), direction, load: 0.0 });
        specimen.settle(&slides, || format!("a curvature of {:.3} /cm", 0.01 * curvature))?;
        // The couple that holds the other clamp, around its edge.
        let edge = specimen.positions().get(specimen.particle(1, 0));
        let held = [0, 1].into_iter().flat_map(|i| specimen.line(i));
        let couple = held.map(|particle| {
            let arm = specimen.positions().get(particle) - edge;
            let force = specimen.holding_force(particle);
            arm.x * force.y - arm.y * force.x
        });
        Ok(-couple.sum::<f64>() / SIZE[1])
    }
}

/// Where the lines of particles are [m] if each of `cells` of length `spacing` [m] is turned by `angle` [rad] to the one
/// before, and by half of it to a clamp.
fn arc(angle: f64, cells: usize, spacing: f64) -> Vec<DVec3> {
    let mut place = DVec3::ZERO;
    let mut places = vec![place];
    for cell in 0..cells + 2 {
        let turned = (cell as f64 - 0.5).clamp(0.0, cells as f64) * angle;
        let (sine, cosine) = libm::sincos(turned);
        place += spacing * DVec3::new(cosine, sine, 0.0);
        places.push(place);
    }
    places
}
