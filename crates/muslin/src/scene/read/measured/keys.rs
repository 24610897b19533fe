//! Keys of what instruments measure, with their units.

use crate::scene::measured::units::{
    GRAM_FORCE_CM_PER_CM, GRAM_FORCE_CM_PER_CM2, GRAM_FORCE_CM2_PER_CM, GRAM_FORCE_PER_CM,
    OUNCE_PER_SQUARE_YARD,
};
use crate::scene::read::quantity::{Plausible, Spelling};

const fn spelling(key: &'static str, unit: &'static str, to_si: fn(f64) -> f64) -> Spelling {
    Spelling { key, unit, to_si, plausible: None }
}

const fn within(
    spelling: Spelling,
    holds: fn(f64) -> bool,
    rule: &'static str,
    help: &'static str,
) -> Spelling {
    Spelling { plausible: Some(Plausible { holds, rule, help }), ..spelling }
}

const fn si(key: &'static str, unit: &'static str) -> Spelling {
    spelling(key, unit, |value| value)
}

pub(super) static AREAL_DENSITY: [Spelling; 3] = [
    within(
        si("areal_density", "kg/m^2"),
        |value| value <= 10.0,
        "be at most 10 kg/m^2",
        "if it is in g/m^2, write `areal_density_g_per_m2 = ...`",
    ),
    within(
        spelling("areal_density_g_per_m2", "g/m^2", |value| value / 1000.0),
        |value| (1.0..=10_000.0).contains(&value),
        "be from 1 to 10000 g/m^2",
        "if it is in kg/m^2, write `areal_density = ...`",
    ),
    spelling("areal_density_oz_per_yd2", "oz/yd^2", |value| value * OUNCE_PER_SQUARE_YARD),
];

pub(super) static MODULUS: [Spelling; 1] = [si("modulus", "N/m")];

pub(super) static STRAIN_SCALE: [Spelling; 1] = [si("strain_scale", "")];

pub(super) static KES_EXTENSION: [Spelling; 2] = [
    within(
        si("emt", ""),
        |value| value < 1.0,
        "be below 1, where the length is doubled",
        "if it is in per cent, write `emt_percent = ...`",
    ),
    within(
        spelling("emt_percent", "%", |value| value / 100.0),
        |value| (0.1..100.0).contains(&value),
        "be from 0.1 to 100 %",
        "if it is a fraction of the length, write `emt = ...`",
    ),
];

pub(super) static KES_LINEARITY: [Spelling; 1] = [si("lt", "")];

pub(super) static KES_WORK: [Spelling; 2] =
    [si("wt", "J/m^2"), spelling("wt_gf_cm_per_cm2", "gf cm/cm^2", |value| value * GRAM_FORCE_CM_PER_CM2)];

pub(super) static KES_FORCE: [Spelling; 2] =
    [si("force", "N/m"), spelling("force_gf_per_cm", "gf/cm", |value| value * GRAM_FORCE_PER_CM)];

pub(super) static KES_RESILIENCE: [Spelling; 2] = [
    within(
        si("rt", ""),
        |value| value <= 1.0,
        "be at most 1, where all of the work is given back",
        "if it is in per cent, write `rt_percent = ...`",
    ),
    within(
        spelling("rt_percent", "%", |value| value / 100.0),
        |value| (1.0..=100.0).contains(&value),
        "be from 1 to 100 %",
        "no fabric gives back more than all of the work; if it is a fraction of it, write `rt = ...`",
    ),
];

macro_rules! fast_extension {
    ($fraction:literal, $percent:literal) => {
        [
            within(
                si($fraction, ""),
                |value| value < 1.0,
                "be below 1, where the length is doubled",
                concat!("if it is in per cent, write `", $percent, " = ...`"),
            ),
            within(
                spelling($percent, "%", |value| value / 100.0),
                |value| value < 100.0,
                "be below 100 %, where the length is doubled",
                "",
            ),
        ]
    };
}

pub(super) static EXTENSION_5: [Spelling; 2] = fast_extension!("e5", "e5_percent");

pub(super) static EXTENSION_20: [Spelling; 2] = fast_extension!("e20", "e20_percent");

pub(super) static EXTENSION_100: [Spelling; 2] = fast_extension!("e100", "e100_percent");

pub(super) static BIAS_EXTENSION: [Spelling; 2] = fast_extension!("eb5", "eb5_percent");

pub(super) static SHEAR_MODULUS: [Spelling; 1] = [si("modulus", "N/m")];

pub(super) static KES_SHEAR: [Spelling; 1] =
    [spelling("g_gf_per_cm_deg", "gf/(cm deg)", |value| value * GRAM_FORCE_PER_CM)];

pub(super) static KES_RIGIDITY: [Spelling; 1] =
    [spelling("b_gf_cm2_per_cm", "gf cm^2/cm", |value| value * GRAM_FORCE_CM2_PER_CM)];

pub(super) static KES_SHEAR_HYSTERESIS: [Spelling; 2] =
    [si("2hg", "N/m"), spelling("2hg_gf_per_cm", "gf/cm", |value| value * GRAM_FORCE_PER_CM)];

pub(super) static KES_SHEAR_HYSTERESIS_5: [Spelling; 2] =
    [si("2hg5", "N/m"), spelling("2hg5_gf_per_cm", "gf/cm", |value| value * GRAM_FORCE_PER_CM)];

pub(super) static RIGIDITY: [Spelling; 1] = [si("rigidity", "N m")];

pub(super) static KES_BENDING_HYSTERESIS: [Spelling; 2] = [
    within(
        si("2hb", "N"),
        |value| value <= 1.0,
        "be at most 1 N, a moment per width",
        "if it is in gf cm/cm, write `2hb_gf_cm_per_cm = ...`",
    ),
    spelling("2hb_gf_cm_per_cm", "gf cm/cm", |value| value * GRAM_FORCE_CM_PER_CM),
];

pub(super) static DAMPING_TIME: [Spelling; 1] = [si("damping_time", "s")];

pub(super) static BENDING_LENGTH: [Spelling; 2] = [
    within(
        si("bending_length", "m"),
        |value| value < 1.0,
        "be below 1 m",
        "if it is in millimetres, write `bending_length_mm = ...`",
    ),
    within(
        spelling("bending_length_mm", "mm", |value| value / 1000.0),
        |value| value == 0.0 || (0.5..1000.0).contains(&value),
        "be from 0.5 to 1000 mm",
        "if it is in metres, write `bending_length = ...`",
    ),
];
