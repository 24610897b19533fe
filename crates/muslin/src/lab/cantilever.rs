//! Peirce's cantilever, the bending length of ASTM D1388.

use glam::DVec3;

use super::bend::{friction_of, rigidity_of};
use super::elastica::HeavyStrip;
use super::reading::{Reading, Record, Unit};
use super::specimen::{Cut, Specimen};
use super::{Along, LabError, Resolution};
use crate::scene::units::STANDARD_GRAVITY;
use crate::scene::{MeasuredFabric, rigidity_from_bending_length};

/// Width of the strip [m].
const WIDTH: f64 = 0.025;

/// Angle [rad] below the horizontal at which the tip is sighted: 41.5°.
const ANGLE: f64 = 41.5 * std::f64::consts::PI / 180.0;

/// First overhang, in bending lengths: it hangs by 3°.
const FIRST: f64 = 0.75;

/// Ratio of an overhang to the one before at most.
const RATIO: f64 = 1.1;

/// How well the angle is met [rad].
const ANGLE_TOLERANCE: f64 = 1e-5;

/// Secants to it at most.
const MOST_SECANTS: usize = 20;

/// What Peirce's cantilever gives.
#[derive(Debug)]
pub struct CantileverTest {
    /// Overhang [m] and angle [rad] of the tip below the horizontal, seen from the edge; the last at 41.5°.
    pub curve: Vec<[f64; 2]>,
    /// c: half of the overhang [m] at 41.5°.
    pub bending_length: f64,
    /// B = ρ g c³ [N m].
    pub rigidity: f64,
    /// What the instrument says beside what the fabric was given.
    pub readings: Vec<Reading>,
    /// The specimen's way.
    pub record: Record,
}

/// Pushes a strip of `fabric` along the yarns `along` over an edge until its tip is 41.5° below, as ASTM D1388 and ISO 9073-7
/// do. Half of the overhang is the bending length.
///
/// Of a fabric without friction, c = (B / ρ g)^(1/3) goes in. Friction holds the strip as well; then half of the overhang goes in
/// that a strip as new has by its law, and the rigidity from it:
///
/// ```text
/// M = B κ + min(B_f κ, M_f)    dM/ds = −ρ g (L − s) cos θ    dθ/ds = κ
/// ```
///
/// # Errors
/// See [`LabError`].
pub fn cantilever(
    fabric: &MeasuredFabric,
    along: Along,
    resolution: Resolution,
) -> Result<CantileverTest, LabError> {
    let mut strip = Strip::new(fabric, along, resolution)?;
    let mut last = strip.point();
    let mut curve = vec![last];
    while last[1] < ANGLE {
        strip.accept();
        strip.push_to(RATIO * last[0])?;
        let before = std::mem::replace(&mut last, strip.point());
        if ANGLE <= last[1] {
            last = strip.find(ANGLE, before, last)?;
        }
        curve.push(last);
    }
    strip.accept();
    let bending_length = 0.5 * last[0];
    let rigidity = rigidity_from_bending_length(fabric.areal_density, bending_length);
    let reading =
        |name, what, unit, measured, input| Reading { name, what, unit, measured, input: Some(input) };
    let [given_length, given_rigidity] = strip.given();
    let readings = vec![
        reading("c", "bending length", Unit::LENGTH, bending_length, given_length),
        reading("B", "bending rigidity from it", Unit::RIGIDITY, rigidity, given_rigidity),
    ];
    Ok(CantileverTest { curve, bending_length, rigidity, readings, record: strip.specimen.into_record() })
}

/// Where the tip of a strip hangs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tip {
    /// Distance W [m] from the edge, level.
    pub reach: f64,
    /// Drop H [m] below the edge.
    pub drop: f64,
}

impl Tip {
    /// Angle [rad] of the tip below the horizontal, seen from the edge.
    #[must_use]
    pub fn angle(self) -> f64 {
        libm::atan2(self.drop, self.reach)
    }
}

/// Where the tip of a strip of `fabric` along the yarns `along` hangs that is pushed over an edge by `overhang` [m].
///
/// # Errors
/// See [`LabError`].
pub fn hang(
    fabric: &MeasuredFabric,
    along: Along,
    resolution: Resolution,
    overhang: f64,
) -> Result<Tip, LabError> {
    let mut strip = Strip::new(fabric, along, resolution)?;
    while RATIO * strip.overhang < overhang {
        strip.accept();
        strip.push_to(RATIO * strip.overhang)?;
    }
    strip.push_to(overhang)?;
    Ok(strip.tip())
}

/// A strip over an edge, whose cells are those of its overhang; on the table it is flat.
struct Strip<'f> {
    fabric: &'f MeasuredFabric,
    along: Along,
    cells: usize,
    /// (B / ρ g)^(1/3) [m] of the fabric.
    bending_length: f64,
    /// Length [m] beyond the edge.
    overhang: f64,
    specimen: Specimen,
}

impl<'f> Strip<'f> {
    /// The strip at its first overhang.
    fn new(fabric: &'f MeasuredFabric, along: Along, resolution: Resolution) -> Result<Self, LabError> {
        let rigidity = rigidity_of(fabric, along);
        if rigidity == 0.0 {
            return Err(LabError::Nothing { what: "bending rigidity along these yarns" });
        }
        let bending_length = libm::cbrt(rigidity / (fabric.areal_density * STANDARD_GRAVITY));
        let (cells, overhang) = (resolution.cells(), FIRST * bending_length);
        let specimen = specimen(fabric, along, cells, overhang)?;
        let mut strip = Self { fabric, along, cells, bending_length, overhang, specimen };
        strip.settle()?;
        Ok(strip)
    }

    /// Bending length [m] and rigidity from it [N m] by the law of the fabric.
    fn given(&self) -> [f64; 2] {
        let (rigidity, areal_density) = (rigidity_of(self.fabric, self.along), self.fabric.areal_density);
        let Some(friction) = friction_of(self.fabric, self.along) else {
            return [self.bending_length, rigidity];
        };
        let strip = HeavyStrip { weight: areal_density * STANDARD_GRAVITY, rigidity, friction };
        let bending_length = 0.5 * strip.overhang(ANGLE);
        [bending_length, rigidity_from_bending_length(areal_density, bending_length)]
    }

    /// Lets the strip come to rest with another `overhang` [m]: from its shape before, made larger.
    fn push_to(&mut self, overhang: f64) -> Result<(), LabError> {
        let ratio = overhang / self.overhang;
        let mut next = specimen(self.fabric, self.along, self.cells, overhang)?;
        let edges = [&self.specimen, &next].map(edge);
        let before = &self.specimen;
        let shape = (0..self.cells + 2)
            .map(|i| edges[1] + (before.positions().get(before.particle(i, 0)) - edges[0]) * ratio);
        let shape: Vec<DVec3> = shape.collect();
        next.move_to(|i, _, place| shape[i].with_z(place.z));
        let earlier = std::mem::replace(&mut self.specimen, next);
        self.specimen.follow(earlier);
        self.overhang = overhang;
        self.settle()
    }

    fn settle(&mut self) -> Result<(), LabError> {
        let overhang = self.overhang;
        self.specimen.settle(&[], || format!("an overhang of {:.3} mm", 1e3 * overhang))
    }

    fn tip(&self) -> Tip {
        let tip = self.specimen.positions().get(self.specimen.particle(self.cells + 1, 0));
        let from_edge = tip - edge(&self.specimen);
        Tip { reach: from_edge.x, drop: -from_edge.y }
    }

    /// Overhang [m] and angle [rad].
    fn point(&self) -> [f64; 2] {
        [self.overhang, self.tip().angle()]
    }

    /// Pushes the strip to where its tip is at `angle` [rad], from the points `before` and `after`, by the method of secants.
    fn find(&mut self, angle: f64, before: [f64; 2], after: [f64; 2]) -> Result<[f64; 2], LabError> {
        let (mut last, mut next) = (before, after);
        for _ in 0..MOST_SECANTS {
            if (next[1] - angle).abs() <= ANGLE_TOLERANCE {
                break;
            }
            let slope = (next[1] - last[1]) / (next[0] - last[0]);
            self.push_to(next[0] + (angle - next[1]) / slope)?;
            (last, next) = (next, self.point());
        }
        Ok(next)
    }

    /// Takes the shape for the next of the test.
    fn accept(&mut self) {
        self.specimen.accept(self.overhang);
    }
}

/// The strip of `cells` beyond the edge and one on the table, flat.
fn specimen(
    fabric: &MeasuredFabric,
    along: Along,
    cells: usize,
    overhang: f64,
) -> Result<Specimen, LabError> {
    let spacing = overhang / cells as f64;
    let cut = Cut::new(fabric, along, [overhang + spacing, WIDTH], cells + 1, 2)?;
    Ok(Specimen::new(fabric, cut, true, STANDARD_GRAVITY, |i, _| i < 2))
}

/// Where the table ends [m].
fn edge(specimen: &Specimen) -> DVec3 {
    specimen.positions().get(specimen.particle(1, 0))
}
