//! The checked contents of a scene: every value in SI units and within its range.

use std::collections::BTreeMap;

use glam::DVec3;

use super::read::{joined, rounded};
use super::{DataFile, Keyframes, MeasuredFabric, TensionCurve};

/// Tolerance relative to the distance of neighbours above which it is loose: errors of a tenth in every frame are strains
/// of a tenth.
const LOOSE_TOLERANCE: f64 = 0.1;

/// A checked scene: what a run needs to know, in SI units.
///
/// Invariants (kept by being readable only): every fabric that a cloth names exists; there is at least one cloth; all
/// numbers are finite and within the ranges that their fields state.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    pub(crate) title: String,
    pub(crate) run: RunSettings,
    pub(crate) environment: Environment,
    pub(crate) fabrics: BTreeMap<String, Fabric>,
    pub(crate) cloths: Vec<ClothSettings>,
    pub(crate) expectations: Vec<Expectation>,
    pub(crate) data_files: Vec<DataFile>,
}

impl Scene {
    /// Number of particles of all cloths.
    #[must_use]
    pub fn particle_count(&self) -> usize {
        self.cloths.iter().map(|cloth| cloth.grid.columns * cloth.grid.rows).sum()
    }

    /// Title, for pages and pictures.
    #[must_use]
    pub fn title(&self) -> &str {
        &self.title
    }

    /// How long and by which method.
    #[must_use]
    pub fn run(&self) -> &RunSettings {
        &self.run
    }

    /// What acts on every cloth.
    #[must_use]
    pub fn environment(&self) -> &Environment {
        &self.environment
    }

    /// Fabrics by name.
    #[must_use]
    pub fn fabrics(&self) -> &BTreeMap<String, Fabric> {
        &self.fabrics
    }

    /// Cloths in the order of their particles.
    #[must_use]
    pub fn cloths(&self) -> &[ClothSettings] {
        &self.cloths
    }

    /// The files that the scene names, by name; each once.
    #[must_use]
    pub fn data_files(&self) -> &[DataFile] {
        &self.data_files
    }

    /// What a reader of the results must know, one sentence each, in lower case and without full stop.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let winds = &self.environment.winds;
        let white = |wind: &WindSettings| {
            matches!(
                wind,
                WindSettings::ParticleForce(GustSettings {
                    noise: Some(NoiseSettings { time: 0.0, .. }),
                    ..
                })
            )
        };
        let noisy = winds.iter().enumerate().filter(|(_, wind)| white(wind)).map(|(index, _)| {
            format!(
                "`environment.wind.{index}` has a new random value at each step (`noise_time = 0`), so the motion \
                 depends on the step"
            )
        });
        let has_air = winds.iter().any(|wind| matches!(wind, WindSettings::Aerodynamic(_)));
        let faceless =
            self.cloths.iter().filter(|cloth| has_air && cloth.grid.columns.min(cloth.grid.rows) == 1);
        let unmoved = faceless.map(|cloth| {
            format!(
                "the cloth `{}` has one row or column and so no faces, on which alone an aerodynamic wind acts",
                cloth.name
            )
        });
        let is_used = |name: &str| self.cloths.iter().any(|cloth| cloth.fabric == name);
        let of_limits = self.fabrics.iter().filter(|(name, _)| is_used(name)).filter_map(|(name, fabric)| {
            let effect = match fabric.limit()? {
                LimitSettings::CutOff { .. } => {
                    "shortens springs that are too long after each step, so where it acts the motion depends on the step"
                }
                LimitSettings::ArctangentProjection => {
                    "shortens every stretched spring after each step, so the motion depends strongly on the step: the \
                     smaller it is, the stiffer the cloth"
                }
            };
            Some(format!("`{}.limit` {effect}", joined("fabric", name)))
        });
        let spacing =
            self.cloths.iter().map(|cloth| cloth.grid.smallest_spacing()).fold(f64::INFINITY, f64::min);
        let loose = match self.run.step {
            StepRule::Adaptive { tolerance: Some(tolerance) } if LOOSE_TOLERANCE * spacing < tolerance => {
                Some(format!(
                    "`run.step.tolerance` is {tolerance:?} m, more than a tenth of the {} m between neighbours, so it \
                 hardly asks for anything",
                    rounded(spacing)
                ))
            }
            _ => None,
        };
        noisy.chain(unmoved).chain(of_limits).chain(loose).collect()
    }

    /// What the run must give.
    #[must_use]
    pub fn expectations(&self) -> &[Expectation] {
        &self.expectations
    }
}

/// `[run]`: how long and by which method.
#[derive(Clone, Debug, PartialEq)]
pub struct RunSettings {
    /// Simulated time [s], positive: [`frame_intervals`](Self::frame_intervals) / [`frame_rate`](Self::frame_rate).
    pub duration: f64,
    /// Frames written per simulated second [1/s], positive.
    pub frame_rate: f64,
    /// Number of frames after the first, at least 1.
    pub frame_intervals: u64,
    /// Integration method.
    pub method: Method,
    /// How the time step is chosen.
    pub step: StepRule,
    /// How the first step starts.
    pub start: Start,
    /// Seed of every random process.
    pub seed: u64,
    /// Whether a step larger than the largest stable one is accepted.
    pub allow_unstable: bool,
}

/// `run.method`
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Explicit central differences, the paper's equation (5): `"central-difference"`.
    CentralDifference,
}

/// `run.step`
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StepRule {
    /// `{ constant = h }` [s]: the same step throughout, a whole number of times per frame.
    Constant {
        /// Steps from one frame to the next, at least 1.
        steps_per_frame: u64,
    },
    /// `"adaptive"` or `{ tolerance = e }` [m]: as long as stability and accuracy allow.
    Adaptive {
        /// Largest error [m] of any position that the steps of a frame may add up to, positive, if there is a limit.
        tolerance: Option<f64>,
    },
}

/// `run.start`: how the method finds the step before the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// `"consistent"`: second order, from the initial velocities and forces.
    Consistent,
    /// `"as-printed"`: S(-h) = S(0), the paper's equation (6). First order.
    AsPrinted,
}

/// `[environment]`: what acts on every cloth.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    /// Gravitational acceleration [m/s²].
    pub gravity: DVec3,
    /// Winds; their forces add up.
    pub winds: Vec<WindSettings>,
}

/// `[[environment.wind]]`
#[derive(Clone, Debug, PartialEq)]
pub enum WindSettings {
    /// `law = "particle-force"`: the force F = [A sin(ω t + φ) + ε] d [N] on every particle, as the paper writes it.
    ParticleForce(GustSettings),
    /// `law = "aerodynamic"`: air that pushes faces by its velocity relative to them.
    Aerodynamic(AirSettings),
}

/// What swings and varies at random: [A sin(ω t + φ) + ε] d, in N or m/s as the wind's law has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GustSettings {
    /// Amplitude A, not negative.
    pub amplitude: f64,
    /// Angular frequency ω [rad/s], not negative.
    pub angular_frequency: f64,
    /// Phase φ [rad].
    pub phase: f64,
    /// Direction d [1], of unit length.
    pub direction: DVec3,
    /// Random part ε, if there is one.
    pub noise: Option<NoiseSettings>,
}

/// A wind of law `"aerodynamic"`. Of several the velocities add up; density and coefficients are the same in all of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AirSettings {
    /// Mean velocity [m/s].
    pub velocity: DVec3,
    /// What comes on top of it [m/s], if anything does; its noise has a correlation time.
    pub gust: Option<GustSettings>,
    /// Density of the air ρ [kg/m³], positive.
    pub air_density: f64,
    /// Coefficient C_N [1] of the pressure along a face's normal, not negative.
    pub normal_coefficient: f64,
    /// Coefficient C_T [1] of the friction along a face, not negative.
    pub tangential_coefficient: f64,
}

/// `noise` and `noise_time` of a wind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseSettings {
    /// Standard deviation, positive; in the unit of the wind's amplitude.
    pub deviation: f64,
    /// Correlation time [s]; zero for a new value at each step, or else at least 1e-5 of the duration.
    pub time: f64,
}

/// `[fabric.NAME]`
#[derive(Clone, Debug, PartialEq)]
pub enum Fabric {
    /// `kind = "springs"`: one constant per spring and particle, as the paper writes them.
    Springs(SpringsFabric),
    /// `kind = "measured"`: constants per width and area, independent of the grid.
    Measured(MeasuredFabric),
}

impl Fabric {
    /// Whether a cloth of more than one particle has structural springs.
    #[must_use]
    pub fn has_structural_springs(&self) -> bool {
        match self {
            Self::Springs(fabric) => fabric.structural.has_springs(),
            Self::Measured(_) => true,
        }
    }

    /// What corrects springs that are too long, if anything does.
    #[must_use]
    pub fn limit(&self) -> Option<LimitSettings> {
        match self {
            Self::Springs(fabric) => fabric.limit,
            Self::Measured(_) => None,
        }
    }
}

/// A fabric of kind `"springs"`.
#[derive(Clone, Debug, PartialEq)]
pub struct SpringsFabric {
    /// Mass of every particle [kg], positive.
    pub particle_mass: f64,
    /// Linear drag k_d on every particle [kg/s], not negative.
    pub drag: f64,
    /// What a spring's force divides its vector by.
    pub force_direction: ForceDirection,
    /// Springs to the next particle along the grid.
    pub structural: SpringSettings,
    /// Springs to the next particle along the diagonals.
    pub shear: SpringSettings,
    /// Springs to the next particle but one along the grid.
    pub bend: SpringSettings,
    /// What keeps springs from becoming too long, if anything does.
    pub limit: Option<LimitSettings>,
}

/// `fabric.NAME.limit`: what corrects springs that are too long after each step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LimitSettings {
    /// `kind = "cut-off"`: at most a certain strain.
    CutOff {
        /// Largest strain of structural springs [1], not negative.
        strain: f64,
        /// Largest strain of shear springs [1], not negative; `None` for any.
        shear_strain: Option<f64>,
        /// Passes over all springs after each step at most, from 1 to 1000.
        passes: u32,
    },
    /// `kind = "arctangent-projection"`: every stretched structural spring shortened along the paper's curve.
    ArctangentProjection,
}

/// `fabric.NAME.force_direction`: what a spring's vector is divided by to give its force a direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ForceDirection {
    /// `"current-length"`: a unit vector, Hooke's law.
    CurrentLength,
    /// `"rest-length"`: as the paper prints it; the force is larger by the stretch ratio.
    RestLength,
}

/// Constants of one spring family.
#[derive(Clone, Debug, PartialEq)]
pub struct SpringSettings {
    /// Stiffness k [N/m], not negative; zero under the law `"curve"`, which has none.
    pub stiffness: f64,
    /// Tension against strain.
    pub law: SpringLawSettings,
    /// Damping c along each spring [kg/s], not negative: tension per rate of its length.
    pub damping: f64,
}

impl SpringSettings {
    /// Whether there are springs of this family: without stiffness there are none.
    #[must_use]
    pub fn has_springs(&self) -> bool {
        matches!(self.law, SpringLawSettings::Curve(_)) || 0.0 < self.stiffness
    }
}

/// `law` of a spring family.
#[derive(Clone, Debug, PartialEq)]
pub enum SpringLawSettings {
    /// `"linear"`: f = k (ℓ - L).
    Linear,
    /// `"tangent"`: stiffens without bound as the strain approaches ½π times the scale.
    Tangent {
        /// Strain scale a [1], positive.
        strain_scale: f64,
    },
    /// `"arctangent-force"`: the paper's limit curve taken literally as a force; softens.
    ArctangentForce,
    /// `"curve"`: tension against strain from a table.
    Curve(TensionCurve),
}

/// `[[cloth]]`
#[derive(Clone, Debug, PartialEq)]
pub struct ClothSettings {
    /// Name, unique in the scene.
    pub name: String,
    /// Name of its fabric.
    pub fabric: String,
    /// Particles.
    pub grid: GridSettings,
    /// Where the cloth is at time zero, at rest and flat.
    pub place: Placement,
    /// Particles that are held, or moved along a path. No particle has two different motions.
    pub pins: Vec<PinSettings>,
}

/// `cloth.grid`
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridSettings {
    /// Particles along the width, at least 1.
    pub columns: usize,
    /// Particles along the height, at least 1.
    pub rows: usize,
    /// Distance from the first to the last column [m]; zero if there is one column, else positive.
    pub width: f64,
    /// Distance from the first to the last row [m]; zero if there is one row, else positive.
    pub height: f64,
}

impl GridSettings {
    /// Smallest distance [m] of neighbours along columns and rows; infinite if there are none.
    pub(super) fn smallest_spacing(self) -> f64 {
        let spacing =
            |extent: f64, count: usize| if count == 1 { f64::INFINITY } else { extent / (count - 1) as f64 };
        spacing(self.width, self.columns).min(spacing(self.height, self.rows))
    }
}

/// `cloth.place`
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Position of column 0, row 0 [m].
    pub origin: DVec3,
    /// Direction of ascending columns [1], of unit length.
    pub width_axis: DVec3,
    /// Direction of ascending rows [1], of unit length and perpendicular to the width axis.
    pub height_axis: DVec3,
}

/// One entry of `cloth.pins`.
#[derive(Clone, Debug, PartialEq)]
pub struct PinSettings {
    /// What is pinned.
    pub place: PinPlace,
    /// How it moves; `None` if it keeps its place.
    pub motion: Option<PinMotionSettings>,
}

/// What a pin holds: a particle, a row or a column. Indices count from zero and are within the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PinPlace {
    /// `{ column = i, row = j }`
    Particle {
        /// Column i.
        column: usize,
        /// Row j.
        row: usize,
    },
    /// `{ row = j }`: every particle of the row.
    Row(usize),
    /// `{ column = i }`: every particle of the column.
    Column(usize),
}

/// `motion` of a pin: its displacement from where its cloth is placed, over time.
#[derive(Clone, Debug, PartialEq)]
pub enum PinMotionSettings {
    /// `kind = "sine"`: A sin(2π f t + φ) along an axis.
    Sine {
        /// Axis [1], of unit length.
        axis: DVec3,
        /// Amplitude A [m], not negative.
        amplitude: f64,
        /// Frequency f [1/s], not negative.
        frequency: f64,
        /// Phase φ [rad].
        phase: f64,
    },
    /// `kind = "keyframes"`: through given displacements at given times.
    Keyframes(Keyframes),
}

/// One line of `[expect]`: a quantity of the finished run and the range it must lie in.
#[derive(Clone, Debug, PartialEq)]
pub struct Expectation {
    /// Which quantity.
    pub quantity: ExpectedQuantity,
    /// Its range, in the quantity's unit.
    pub range: ExpectedRange,
}

/// Key of a line of `[expect]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExpectedQuantity {
    /// `max_strain` [1]: largest strain of any structural spring over all steps.
    MaxStrain,
    /// `lowest_point` [m]: height of the lowest particle in the last frame.
    LowestPoint,
    /// `energy_residual` [1]: largest residual of the energy ledger relative to the largest change of any term.
    EnergyResidual,
}

impl ExpectedQuantity {
    /// Key in the scene file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::MaxStrain => "max_strain",
            Self::LowestPoint => "lowest_point",
            Self::EnergyResidual => "energy_residual",
        }
    }
}

/// `{ below = a }`, `{ above = a }` or `{ between = [a, b] }`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ExpectedRange {
    /// Smaller than the value.
    Below(f64),
    /// Larger than the value.
    Above(f64),
    /// From the first to the second value, both included.
    Between(f64, f64),
}
