//! `warp` and `weft` of a measured fabric: tension per width against strain.

use super::keys::{
    DAMPING_TIME, EXTENSION_5, EXTENSION_20, EXTENSION_100, KES_EXTENSION, KES_FORCE, KES_LINEARITY,
    KES_RESILIENCE, KES_WORK, MODULUS, STRAIN_SCALE,
};
use super::{check_ways, rounded, shown};
use crate::scene::data::DataFiles;
use crate::scene::error::SceneErrorKind;
use crate::scene::measured::units::GRAM_FORCE_PER_CM;
use crate::scene::read::curve;
use crate::scene::read::quantity::{Given, Quantity};
use crate::scene::read::table::Entry;
use crate::scene::read::value::{NumberRule, Value};
use crate::scene::{KesTensile, KesTensileError, MembraneTension, SceneError, TensionCurve, TensionFriction};

/// Ways to the tension, for who gives none.
const HELP: &str = "write `{ modulus = ... }` [N/m], if it stiffens with a `strain_scale`; or `emt`, `lt` and `force` of KES; \
                    or `e5`, `e20` and `e100` of FAST; or `curve = \"FILE.csv\"`";

/// What a table of tension along some yarns holds.
pub(super) struct Yarns {
    /// As the fabric is loaded.
    pub(super) tension: MembraneTension,
    pub(super) friction: Option<TensionFriction>,
    /// Retardation time [s].
    pub(super) damping_time: f64,
}

pub(super) fn read(entry: Entry, files: &mut DataFiles) -> Result<Yarns, SceneError> {
    let mut table = entry.required("", HELP)?.table(HELP)?;
    let mut take = |name, spellings| Quantity::take(&mut table, name, NumberRule::NotNegative, spellings);
    // FAST shows no strain below its resolution; what to do then is said below.
    let fast = [take("E5", &EXTENSION_5[..]), take("E20", &EXTENSION_20), take("E100", &EXTENSION_100)];
    let mut take = |name, spellings| Quantity::take(&mut table, name, NumberRule::Positive, spellings);
    let modulus = take("the modulus", &MODULUS);
    let strain_scale = take("the strain scale", &STRAIN_SCALE);
    let kes = KesEntries {
        extension: take("EMT", &KES_EXTENSION),
        linearity: take("LT", &KES_LINEARITY),
        work: take("WT", &KES_WORK),
        force: take("the greatest tension", &KES_FORCE),
    };
    let resilience = take("RT", &KES_RESILIENCE);
    let curve = table.take("curve");
    let damping_time = Quantity::take(&mut table, "the damping time", NumberRule::NotNegative, &DAMPING_TIME);
    table.finish()?;

    let (tension, greatest) = read_tension(modulus, strain_scale, fast, kes, curve.optional(), files)?;
    let friction = match resilience.optional()? {
        Some(resilience) if resilience.si < 1.0 => Some(read_friction(&resilience, &tension, greatest)?),
        _ => None,
    };
    let damping_time = damping_time.optional()?.map_or(0.0, |time| time.si);
    Ok(Yarns { tension, friction, damping_time })
}

/// The friction of a fabric that gives back the share `resilience` of the work up to the strain `greatest`.
fn read_friction(
    resilience: &Given,
    tension: &MembraneTension,
    greatest: Option<f64>,
) -> Result<TensionFriction, SceneError> {
    let value = &resilience.value;
    // A loop along a straight line has the same shape up to any strain.
    let greatest = greatest.or(matches!(tension, MembraneTension::Linear { .. }).then_some(0.01));
    let Some(greatest) = greatest else {
        let message = format!("`{}` is given, but not up to which tension", value.path);
        let help = "a fabric that stiffens gives back a share that depends on it: write `emt = ...` and `force = ...` in place \
                    of `modulus`";
        return Err(value.error(SceneErrorKind::Inconsistent { message, help: help.to_owned() }));
    };
    TensionFriction::from_kes(tension, greatest, resilience.si).ok_or_else(|| {
        value.error(SceneErrorKind::Inconsistent {
            message: format!(
                "`{}` is {}, but friction in proportion to the tension gives back more",
                value.path,
                value.as_written()
            ),
            help: "see that it is the share that is given back, and not the share that is lost".to_owned(),
        })
    })
}

/// The tension, and the strain [1] up to which it was measured, if that is known.
fn read_tension(
    modulus: Quantity,
    strain_scale: Quantity,
    fast: [Quantity; 3],
    kes: KesEntries,
    file: Option<Value>,
    files: &mut DataFiles,
) -> Result<(MembraneTension, Option<f64>), SceneError> {
    let of_table = |tension: MembraneTension| {
        let last = match &tension {
            MembraneTension::Curve(curve) => curve.points().last().map(|point| point[0]),
            _ => None,
        };
        (tension, last)
    };
    let of_fast = fast.iter().find_map(Quantity::value);
    check_ways(&[modulus.value(), kes.value(), of_fast, file.as_ref()], "the tension")?;
    if let Some(file) = file {
        reject_strain_scale(strain_scale, "a table of tension")?;
        return Ok(of_table(MembraneTension::Curve(curve::read_per_width(&file, files)?)));
    }
    if of_fast.is_some() {
        reject_strain_scale(strain_scale, "a curve through the strains of FAST")?;
        return Ok(of_table(read_fast(fast)?));
    }
    if kes.value().is_some() {
        return kes.read(strain_scale).map(|(tension, extension)| (tension, Some(extension)));
    }
    let modulus = modulus.required_with(HELP)?.si;
    let tension = match strain_scale.optional()? {
        None => MembraneTension::Linear { modulus },
        Some(strain_scale) => MembraneTension::Tangent { modulus, strain_scale: strain_scale.si },
    };
    Ok((tension, None))
}

/// Rejects a strain scale beside `owner`, which has none.
fn reject_strain_scale(strain_scale: Quantity, owner: &str) -> Result<(), SceneError> {
    let Some(value) = strain_scale.value() else { return Ok(()) };
    let message = format!("`{}` is given, but {owner} has no strain scale", value.path);
    Err(value.error(SceneErrorKind::Inconsistent { message, help: "leave it out".to_owned() }))
}

/// Values of the tensile test of KES.
struct KesEntries<'t> {
    extension: Quantity<'t>,
    linearity: Quantity<'t>,
    work: Quantity<'t>,
    force: Quantity<'t>,
}

impl KesEntries<'_> {
    fn value(&self) -> Option<&Value<'_>> {
        [&self.extension, &self.linearity, &self.work, &self.force].into_iter().find_map(Quantity::value)
    }

    /// The tangent law with these values: with the linearity or the work of the test, or with a strain scale; and the strain
    /// EMT [1].
    fn read(self, strain_scale: Quantity) -> Result<(MembraneTension, f64), SceneError> {
        let Self { extension, linearity, work, force } = self;
        check_ways(&[linearity.value(), work.value(), strain_scale.value()], "how the fabric stiffens")?;
        let extension = extension.required()?;
        let force = force.required()?.si;
        if let Some(strain_scale) = strain_scale.optional()? {
            return Ok((through_point(&extension, force, strain_scale.si)?, extension.si));
        }
        let (linearity, given) = match work.optional()? {
            Some(work) => (KesTensile::linearity_of_work(work.si, extension.si, force), work),
            None => {
                const HELP: &str =
                    "write how the fabric stiffens: `lt = ...`, or `wt = ...` [J/m^2], or a `strain_scale`";
                let linearity = linearity.required_with(HELP)?;
                (linearity.si, linearity)
            }
        };
        let test = KesTensile { extension: extension.si, linearity, force };
        let tension =
            test.tension().map_err(|error| given.value.error(unfitted(&given, linearity, error)))?;
        Ok((tension, extension.si))
    }
}

/// The tangent law of `strain_scale` [1] with the tension `force` [N/m] at the strain `extension`.
fn through_point(extension: &Given, force: f64, strain_scale: f64) -> Result<MembraneTension, SceneError> {
    let law = MembraneTension::Tangent { modulus: 1.0, strain_scale };
    let asymptote = law.asymptote().unwrap_or(f64::INFINITY);
    // Where the tangent is 10⁴ times that at rest the law goes on linearly; its formula ends there.
    if 0.99 * asymptote < extension.si {
        return Err(extension.value.error(SceneErrorKind::Inconsistent {
            message: format!(
                "`{}` is a strain of {}, but with a strain scale of {} no tension stretches the fabric by {}",
                extension.value.path,
                rounded(extension.si),
                rounded(strain_scale),
                rounded(asymptote)
            ),
            help: format!(
                "take a strain scale above {}, or leave it out and write `lt = ...`",
                rounded(extension.si / (0.99 * std::f64::consts::FRAC_PI_2))
            ),
        }));
    }
    let modulus = force / (strain_scale * libm::tan(extension.si / strain_scale));
    Ok(MembraneTension::Tangent { modulus, strain_scale })
}

/// What is wrong with a `linearity` that no tangent law has, or with the work that it is from.
fn unfitted(given: &Given, linearity: f64, error: KesTensileError) -> SceneErrorKind {
    let value = &given.value;
    let found = if value.path.ends_with("lt") {
        format!("`{}` is {}", value.path, value.as_written())
    } else {
        format!(
            "`{}` is {} {}, a linearity LT of {}",
            value.path,
            value.as_written(),
            given.unit,
            shown(linearity)
        )
    };
    let rule = match error {
        KesTensileError::Softens => "but LT must be at most 1: a fabric of more softens".to_owned(),
        _ => format!(
            "but LT must be at least {}: a fabric of less is slack at first",
            KesTensile::LEAST_LINEARITY
        ),
    };
    let help = "see that EMT, LT, WT and the force stand under their own keys; or write `curve = \"FILE.csv\"` with the \
                measured curve";
    SceneErrorKind::Inconsistent { message: format!("{found}, {rule}"), help: help.to_owned() }
}

/// The curve through the strains of FAST-3 at 5, 20 and 100 gf/cm, of which the first may be left out.
fn read_fast([e5, e20, e100]: [Quantity; 3]) -> Result<MembraneTension, SceneError> {
    let mut strains = Vec::new();
    strains.extend(e5.optional()?.map(|strain| (strain, 5.0)));
    strains.push((e20.required()?, 20.0));
    strains.push((e100.required()?, 100.0));
    if let Some((zero, _)) = strains.iter().find(|(strain, _)| strain.si <= 0.0) {
        let help = "an instrument that shows no strain has not resolved it; leave `e5` out if it is that";
        return Err(zero.value.out_of_range(zero.unit, "be positive", help));
    }
    for pair in strains.windows(2) {
        let [(before, _), (strain, _)] = [&pair[0], &pair[1]];
        if strain.si - before.si < 1e-9 {
            let value = &strain.value;
            return Err(value.error(SceneErrorKind::Inconsistent {
                message: format!(
                    "`{}` is {}, but must be above `{}`, which is {}",
                    value.path,
                    rounded(strain.si),
                    before.value.path,
                    rounded(before.si),
                ),
                help: "a fabric stretches further under more tension: see that no two are exchanged; where the instrument \
                       shows the same strain twice, leave `e5` out"
                    .to_owned(),
            }));
        }
    }
    let points: Vec<[f64; 2]> =
        strains.iter().map(|(strain, tension)| [strain.si, tension * GRAM_FORCE_PER_CM]).collect();
    let last = &strains[strains.len() - 1].0.value;
    let curve = TensionCurve::per_width(&points).map_err(|error| {
        last.error(SceneErrorKind::Inconsistent { message: error.to_string(), help: error.help.to_owned() })
    })?;
    Ok(MembraneTension::Curve(curve))
}
