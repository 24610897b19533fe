//! The tensile test of KES-FB1.

use super::friction::FrictionPath;
use super::reading::Unit;
use super::specimen::{Cut, Specimen};
use super::{Along, LabError, Reading, Record, Resolution};
use crate::force::{SpringLaw, TensionLaw};
use crate::scene::units::GRAM_FORCE_PER_CM;
use crate::scene::{MeasuredFabric, MembraneTension, TensionFriction};

/// Tension per width [N/m] at which the instrument turns back: 500 gf/cm.
const TENSILE_FORCE: f64 = 500.0 * GRAM_FORCE_PER_CM;

/// Distance of the clamps and width [m].
const SIZE: [f64; 2] = [0.05, 0.2];

/// Readings on the way up, and as many on the way back.
const READINGS: usize = 16;

/// Secants to the greatest tension at most, and how well it is met.
const MOST_SECANTS: usize = 20;
const TURNING_TOLERANCE: f64 = 1e-9;

/// Strain [1] beyond which no test goes.
const LARGEST_STRAIN: f64 = 2.0;

/// What the tensile test of KES-FB1 gives.
#[derive(Debug)]
pub struct TensileTest {
    /// Strain [1] and tension per width [N/m], up to 500 gf/cm and back to no tension or no strain.
    pub curve: Vec<[f64; 2]>,
    /// Tension per width [N/m] that the fabric was given, at the strains of the curve.
    pub input: Vec<f64>,
    /// Place in the curve of the greatest tension.
    pub turn: usize,
    /// EMT: strain [1] at the greatest tension.
    pub extension: f64,
    /// LT: linearity [1].
    pub linearity: f64,
    /// WT: work per area [J/m²] up to the greatest tension.
    pub work: f64,
    /// RT: share [1] of the work that comes back.
    pub resilience: f64,
    /// What the instrument says beside what the fabric was given.
    pub readings: Vec<Reading>,
    /// The specimen's way.
    pub record: Record,
}

/// Stretches a specimen of `fabric` along the yarns `along` as KES-FB1 does: 20 cm wide and 5 cm long between clamps that hold
/// its width, up to a tension of 500 gf/cm and back.
///
/// # Errors
/// See [`LabError`].
pub fn tensile(
    fabric: &MeasuredFabric,
    along: Along,
    resolution: Resolution,
) -> Result<TensileTest, LabError> {
    let cells = resolution.cells();
    let mut bench = Bench::new(Specimen::new(
        fabric,
        Cut::new(fabric, along, SIZE, cells, cells)?,
        false,
        0.0,
        |i, _| i == 0 || i == cells,
    ));
    let law = law(tension_of(fabric, along));
    // Where it turns, if the specimen is like its fabric.
    let last = strain_of(&law)?;
    let mut curve = Vec::new();
    for reading in 0..READINGS {
        let strain = last * reading as f64 / READINGS as f64;
        let tension = bench.tension(strain)?;
        if TENSILE_FORCE <= tension {
            break;
        }
        bench.specimen.accept(strain);
        curve.push([strain, tension]);
    }
    let extension = bench.turning_strain(last, law.tangent(last, 1.0))?;
    curve.push([extension, bench.tension(extension)?]);
    bench.specimen.accept(extension);
    let turn = curve.len() - 1;
    for reading in (0..READINGS).rev() {
        let strain = extension * reading as f64 / READINGS as f64;
        let tension = bench.tension(strain)?;
        bench.specimen.accept(strain);
        curve.push([strain, tension]);
        if tension < 0.0 {
            break;
        }
    }
    let work = area(&curve[..=turn]);
    let linearity = 2.0 * work / (TENSILE_FORCE * extension);
    let resilience = -area(&curve[turn..]) / work;
    let friction = match along {
        Along::Warp => fabric.friction.warp,
        Along::Weft => fabric.friction.weft,
    };
    let given = friction.map_or(1.0, |friction| friction.resilience(tension_of(fabric, along), last));
    let readings = readings(&law, last, given, [extension, linearity, work, resilience]);
    let record = bench.specimen.into_record();
    let input = tensions(&law, friction, curve.iter().map(|point| point[0]));
    Ok(TensileTest { curve, input, turn, extension, linearity, work, resilience, readings, record })
}

/// Tension of a fabric along given yarns.
pub(super) fn tension_of(fabric: &MeasuredFabric, along: Along) -> &MembraneTension {
    match along {
        Along::Warp => &fabric.warp,
        Along::Weft => &fabric.weft,
    }
}

/// The specimen in its clamps.
struct Bench {
    specimen: Specimen,
    upper_clamp: Vec<usize>,
}

impl Bench {
    fn new(specimen: Specimen) -> Self {
        let [count, _] = specimen.counts();
        let upper_clamp = specimen.line(count - 1);
        Self { specimen, upper_clamp }
    }

    /// Tension per width [N/m] at rest with the clamps apart by the `strain` [1].
    fn tension(&mut self, strain: f64) -> Result<f64, LabError> {
        let [count, _] = self.specimen.counts();
        let cells = count - 1;
        let spacing = SIZE[0] / cells as f64 * (1.0 + strain);
        let is_guessed = self.specimen.guess(strain);
        self.specimen.move_to(|i, _, place| {
            if is_guessed && 0 < i && i < cells { place } else { place.with_x(i as f64 * spacing) }
        });
        self.specimen.settle(&[], || format!("a strain of {:.4} %", 100.0 * strain))?;
        Ok(self.specimen.clamp_force(&self.upper_clamp).x / SIZE[1])
    }

    /// The strain [1] at which the instrument turns back, near `strain`, where the tension rises by about `slope` [N/m]; by the
    /// method of secants.
    fn turning_strain(&mut self, mut strain: f64, mut slope: f64) -> Result<f64, LabError> {
        let mut rest = self.tension(strain)? - TENSILE_FORCE;
        for _ in 0..MOST_SECANTS {
            if rest.abs() <= TURNING_TOLERANCE * TENSILE_FORCE {
                break;
            }
            let next = strain - rest / slope;
            let next_rest = self.tension(next)? - TENSILE_FORCE;
            slope = (next_rest - rest) / (next - strain);
            (strain, rest) = (next, next_rest);
        }
        Ok(strain)
    }
}

/// Tension per width [N/m] of a fabric that is loaded along `law`, on the way from each of `strains` [1] to the next.
fn tensions(
    law: &SpringLaw,
    friction: Option<TensionFriction>,
    strains: impl Iterator<Item = f64>,
) -> Vec<f64> {
    let Some(TensionFriction { ratio, stiffness }) = friction else {
        return strains.map(|strain| law.tension(strain, 1.0)).collect();
    };
    let mut path = FrictionPath::new(stiffness);
    let tension = |strain: f64| {
        let elastic = law.tension(strain, 1.0) / (1.0 + ratio);
        elastic + path.stress(strain, ratio * elastic.max(0.0))
    };
    strains.map(tension).collect()
}

/// ∫ T de [J/m²] along a curve, by Simpson's rule for unequal steps; over a last odd step by the trapezium.
fn area(curve: &[[f64; 2]]) -> f64 {
    let mut area = 0.0;
    let mut rest = curve;
    while let [a, b, c, ..] = rest {
        let (first, second) = (b[0] - a[0], c[0] - b[0]);
        let both = first + second;
        area += both / 6.0
            * ((2.0 - second / first) * a[1]
                + both * both / (first * second) * b[1]
                + (2.0 - first / second) * c[1]);
        rest = &rest[2..];
    }
    if let [a, b] = rest {
        area += 0.5 * (a[1] + b[1]) * (b[0] - a[0]);
    }
    area
}

/// The instrument's values beside those of the `law` that went in, which has its greatest tension at the strain
/// `extension`, and to that of its `resilience`.
fn readings(law: &SpringLaw, extension: f64, resilience: f64, measured: [f64; 4]) -> Vec<Reading> {
    // Of a spring of unit length, the energy is the work per area.
    let work = law.energy(extension, 1.0);
    let linearity = 2.0 * work / (TENSILE_FORCE * extension);
    let reading = |name, what, unit, measured, input| Reading { name, what, unit, measured, input };
    vec![
        reading("EMT", "strain at 500 gf/cm", Unit::PERCENT, measured[0], Some(extension)),
        reading("LT", "linearity", Unit::ONE, measured[1], Some(linearity)),
        reading("WT", "work up to 500 gf/cm", Unit::WORK, measured[2], Some(work)),
        reading("RT", "share of the work that comes back", Unit::PERCENT, measured[3], Some(resilience)),
    ]
}

/// The law of a spring of unit length with this tension per width.
pub(super) fn law(tension: &MembraneTension) -> SpringLaw {
    use crate::force::{LinearLaw, TangentLaw};
    match tension {
        MembraneTension::Linear { modulus } => SpringLaw::Linear(LinearLaw { stiffness: *modulus }),
        MembraneTension::Tangent { modulus, strain_scale } => {
            SpringLaw::Tangent(TangentLaw::with_initial_stiffness(*modulus, *strain_scale))
        }
        MembraneTension::Curve(curve) => SpringLaw::curve(curve),
    }
}

/// The strain [1] at which `law` has the greatest tension of the test, by bisection.
fn strain_of(law: &SpringLaw) -> Result<f64, LabError> {
    let (mut low, mut high) = (0.0, LARGEST_STRAIN);
    let tension = law.tension(high, 1.0);
    if tension < TENSILE_FORCE {
        return Err(LabError::OutOfReach { tension, strain: high, force: TENSILE_FORCE });
    }
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if law.tension(middle, 1.0) < TENSILE_FORCE { low = middle } else { high = middle }
    }
    Ok(0.5 * (low + high))
}
