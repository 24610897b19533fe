//! A measured fabric from all of its measurements.

use muslin::scene::MembraneTension;

use crate::FitError;
use crate::bending::{fit_bending_lengths, fit_cantilever, fit_rigidities};
use crate::estimate::{Estimate, Undetermined};
use crate::friction::{SlopeFit, fit_bend, fit_shear, fit_shear_moduli};
use crate::label::{Direction, Test};
use crate::measurement::{Data, Measurement};
use crate::outcome::{Outcome, subject};
use crate::tension::{LARGEST_MISFIT, TensionFit, fit_curve, fit_kes};

/// The largest ratio of the ends of an interval for which a constant counts as determined.
const WIDEST_INTERVAL: f64 = 4.0;

/// What was identified of a fabric.
#[derive(Clone, Debug, PartialEq)]
pub struct FabricFit {
    /// Mass per area [kg/m²], as it was given.
    pub areal_density: f64,
    /// Tension along the warp.
    pub warp: Option<TensionFit>,
    /// Tension along the weft.
    pub weft: Option<TensionFit>,
    /// Resistance to shear.
    pub shear: Option<SlopeFit>,
    /// Rigidity along warp, weft and at 45°, in the order of [`Direction::ALL`].
    pub bending: [Option<SlopeFit>; 3],
    /// Second tests of a rigidity, which a test with a measured moment goes before.
    pub checks: Vec<SlopeFit>,
    /// What contradicts itself or the model; sentences without full stop.
    pub warnings: Vec<String>,
    /// What the data do not say, of the whole fabric and of every test.
    pub undetermined: Vec<Undetermined>,
}

impl FabricFit {
    /// Identifies a fabric of `areal_density` [kg/m²] from `measurements`.
    ///
    /// # Errors
    /// If two files hold the same test, or one has no law that cloth may have.
    pub fn new(areal_density: f64, measurements: &[Measurement]) -> Result<Self, FitError> {
        let mut fit = Self {
            areal_density,
            warp: None,
            weft: None,
            shear: None,
            bending: [None, None, None],
            checks: Vec::new(),
            warnings: Vec::new(),
            undetermined: Vec::new(),
        };
        for (index, measurement) in measurements.iter().enumerate() {
            check_twice(&measurements[..index], measurement)?;
            fit.add(measurement)?;
        }
        fit.compare_rigidities();
        fit.check_model();
        fit.check_misfits();
        let found = fit.outcomes().flat_map(|outcome| {
            let wide = outcome.parameters.iter().filter_map(|parameter| too_wide(outcome, parameter));
            outcome.undetermined.iter().cloned().chain(wide).collect::<Vec<_>>()
        });
        let found: Vec<Undetermined> = found.collect();
        fit.undetermined = fit.missing();
        fit.undetermined.extend(found);
        Ok(fit)
    }

    /// Every test, in the order of the fabric's keys, second tests last.
    pub fn outcomes(&self) -> impl Iterator<Item = &Outcome> {
        let tension = [&self.warp, &self.weft].into_iter().flatten().map(|fit| &fit.outcome);
        let slopes = [&self.shear].into_iter().chain(&self.bending).flatten().chain(&self.checks);
        tension.chain(slopes.map(|fit| &fit.outcome))
    }

    /// Whether the fabric has every quantity that a scene needs.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        let [warp, weft, _] = &self.bending;
        self.warp.is_some() && self.weft.is_some() && self.shear.is_some() && warp.is_some() && weft.is_some()
    }

    fn add(&mut self, measurement: &Measurement) -> Result<(), FitError> {
        let file = measurement.file.as_str();
        let Some(direction) = measurement.direction else {
            self.shear = Some(match &measurement.data {
                Data::Shear(rows) => fit_shear(file, rows)?,
                Data::ShearModulus(values) => fit_shear_moduli(file, values),
                _ => {
                    return Err(FitError::whole(
                        file,
                        "has no direction",
                        "label it `warp`, `weft` or `bias`",
                    ));
                }
            });
            return Ok(());
        };
        let slope = match &measurement.data {
            Data::Tensile(rows) => {
                *self.tension_mut(direction) = Some(fit_curve(file, direction, rows)?);
                return Ok(());
            }
            Data::KesTensile(tests) => {
                *self.tension_mut(direction) = Some(fit_kes(file, direction, tests)?);
                return Ok(());
            }
            Data::Bend(rows) => fit_bend(file, direction, rows)?,
            Data::Rigidity(values) => fit_rigidities(file, direction, values)?,
            Data::Cantilever(rows) => fit_cantilever(file, direction, rows, self.areal_density)?,
            Data::BendingLength(lengths) => {
                fit_bending_lengths(file, direction, lengths, self.areal_density)?
            }
            Data::Shear(_) | Data::ShearModulus(_) => {
                return Err(FitError::whole(file, "is a shear test with a direction", "label it `shear`"));
            }
        };
        let place = &mut self.bending[direction as usize];
        match place.take() {
            // The test with a measured moment needs no mass, and sees friction.
            Some(first) if first.outcome.kind.test() == Test::Bend => {
                *place = Some(first);
                self.checks.push(slope);
            }
            Some(first) => {
                *place = Some(slope);
                self.checks.push(first);
            }
            None => *place = Some(slope),
        }
        Ok(())
    }

    fn tension_mut(&mut self, direction: Direction) -> &mut Option<TensionFit> {
        if direction == Direction::Warp { &mut self.warp } else { &mut self.weft }
    }

    /// The rigidity of a direction [N m].
    #[must_use]
    pub fn rigidity(&self, direction: Direction) -> Option<Estimate> {
        self.bending[direction as usize].as_ref().map(|fit| fit.slope)
    }

    /// A note at the first of two tests of one rigidity, whether they agree.
    fn compare_rigidities(&mut self) {
        for check in &self.checks {
            let direction = check.outcome.direction.map_or(0, |direction| direction as usize);
            let Some(first) = &mut self.bending[direction] else { continue };
            let ratio = check.slope.value / first.slope.value;
            let errors = [first.slope.relative_error(), check.slope.relative_error()];
            let verdict = match errors {
                [Some(a), Some(b)] if libm::log(ratio).abs() < 2.0 * libm::hypot(a, b) => {
                    ", within the errors of both"
                }
                [Some(_), Some(_)] => ", more than twice the errors of both apart",
                _ => "",
            };
            first
                .outcome
                .notes
                .push(format!("{} gives {ratio:.3} times as much{verdict}", check.outcome.file));
        }
    }

    /// What no fabric of springs can have.
    fn check_model(&mut self) {
        if let [Some(warp), Some(weft), Some(bias)] = Direction::ALL.map(|direction| self.rigidity(direction))
            && bias.value < 0.25 * (warp.value + weft.value)
        {
            self.warnings.push(format!(
                "the rigidity at 45 degrees, {:.3e} N m, is below a quarter of warp and weft together, {:.3e} N m, which no \
                 sheet has: `bias` is left out",
                bias.value,
                0.25 * (warp.value + weft.value)
            ));
        }
        if let (Some(warp), Some(weft), Some(shear)) = (&self.warp, &self.weft, &self.shear) {
            let [warp, weft] = [warp, weft].map(TensionFit::least_elastic_modulus);
            let shear = shear.elastic_shear_modulus();
            if (warp * weft).sqrt() <= shear {
                self.warnings.push(format!(
                    "the fabric resists shear by {shear:.1} N/m, more than stretch at rest by {:.1} N/m: no grid of springs can",
                    (warp * weft).sqrt()
                ));
            }
        }
        self.check_friction();
    }

    /// Loops of which no friction of a fabric can be.
    fn check_friction(&mut self) {
        for fit in [&self.warp, &self.weft].into_iter().flatten() {
            if let (Some(resilience), None) = (fit.loop_resilience(), fit.friction()) {
                self.warnings.push(format!(
                    "{}: no friction in proportion to the tension gives back {:.1} % of the work: `rt` is left out",
                    fit.outcome.file,
                    100.0 * resilience.value
                ));
            }
        }
        if let Some(fit) = &self.shear
            && let (Some(width), None) = (fit.outcome.parameter("2HG"), fit.shear_friction())
        {
            self.warnings.push(format!(
"{}: the loop widens from {:.3} N/m at 0.5 degrees so fast that no fabric has such friction: `2hg` and `2hg5` are left out",
                fit.outcome.file, width.value
            ));
        }
    }

    /// Straight lines through what is not straight: tension has a table for it, shear and bending have not.
    fn check_misfits(&mut self) {
        let slopes = self.shear.iter().chain(self.bending.iter().flatten()).chain(&self.checks);
        let misfits = slopes.filter_map(|SlopeFit { outcome, .. }| {
            let largest = outcome.points.iter().fold(0.0_f64, |largest, point| largest.max(point.measured.abs()));
            let misfit = outcome.scatter? / largest;
            (outcome.is_systematic && LARGEST_MISFIT < misfit).then(|| {
                format!(
                    "{}: the law leaves a systematic {:.1} % of the largest value, so that its constants are those of the mean over \
                     the range; leave out the part that is not meant",
                    outcome.file,
                    100.0 * misfit
                )
            })
        });
        let misfits: Vec<String> = misfits.collect();
        self.warnings.extend(misfits);
    }

    /// Whether the strip at 45° says something that a sheet can have.
    #[must_use]
    pub fn bias(&self) -> Option<Estimate> {
        let [warp, weft, bias] = Direction::ALL.map(|direction| self.rigidity(direction));
        let bias = bias?;
        let least = 0.25 * (warp?.value + weft?.value);
        (least <= bias.value).then_some(bias)
    }

    /// Quantities without any data.
    fn missing(&self) -> Vec<Undetermined> {
        let mut missing = Vec::new();
        let mut lacks =
            |what: String, why: String, remedy: String| missing.push(Undetermined { what, why, remedy });
        for (direction, found, other) in
            [(Direction::Warp, &self.warp, &self.weft), (Direction::Weft, &self.weft, &self.warp)]
        {
            if found.is_some() {
                continue;
            }
            let why = match other.as_ref().and_then(|fit| fit.outcome.direction) {
                Some(other) => format!("data along the {other} alone say nothing of it"),
                None => "there are no tensile data".to_owned(),
            };
            lacks(
                subject("tension", Some(direction)),
                why,
                format!("give a tensile test, `{direction}=FILE`"),
            );
        }
        if self.shear.is_none() {
            lacks(
                "shear".to_owned(),
                "there are no shear data".to_owned(),
                "give a shear test, `shear=FILE`".to_owned(),
            );
        }
        for direction in [Direction::Warp, Direction::Weft] {
            if self.rigidity(direction).is_none() {
                let what = subject("bending", Some(direction));
                let remedy = format!("give a bending or cantilever test, `{direction}=FILE`");
                lacks(what, "there are no such data".to_owned(), remedy);
            }
        }
        if self.rigidity(Direction::Bias).is_none() {
            lacks(
                "twist".to_owned(),
                "strips along the yarns do not twist; at 45 degrees muslin takes the mean of both".to_owned(),
                "give a bending or cantilever test of a strip cut at 45 degrees, `bias=FILE`".to_owned(),
            );
        }
        missing
    }
}

/// Refuses two files of the same test in the same direction.
fn check_twice(before: &[Measurement], measurement: &Measurement) -> Result<(), FitError> {
    let same = |other: &&Measurement| {
        other.direction == measurement.direction && other.kind().test() == measurement.kind().test()
    };
    let Some(first) = before.iter().find(same) else { return Ok(()) };
    let [title, first] = [measurement.kind().title(), first.file.as_str()];
    let direction =
        measurement.direction.map_or(String::new(), |direction| format!(" along the {direction}"));
    Err(FitError::inconsistent(
        format!("`{first}` and `{}` both hold {title}{direction}", measurement.file),
        "fit each specimen by itself, or give one file of the mean curve",
    ))
}

/// What to say of a constant of `outcome` whose interval is so wide that it is hardly known.
fn too_wide(outcome: &Outcome, parameter: &crate::Parameter) -> Option<Undetermined> {
    let [low, high] = parameter.estimate.interval?;
    let is_wide = 0.0 < low && WIDEST_INTERVAL * low < high;
    is_wide.then(|| Undetermined {
        what: format!("{} of {}", parameter.name, outcome.subject()),
        why: format!("anything from {low:.3e} to {high:.3e} {} fits", parameter.unit).replace("  ", " "),
        remedy: "measure more points, or over a larger range".to_owned(),
    })
}

/// The law in a word.
pub(crate) fn law_name(tension: &MembraneTension) -> &'static str {
    match tension {
        MembraneTension::Linear { .. } => "linear",
        MembraneTension::Tangent { .. } => "tangent",
        MembraneTension::Curve(_) => "table",
    }
}
