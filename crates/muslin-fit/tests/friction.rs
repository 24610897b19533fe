//! Loops become the friction of a fabric, in the keys of a scene.

use muslin::scene::{Fabric, MeasuredFabric};
use muslin_fit::{FabricFit, FabricText, Label, Measurement};

/// The fit of files with these labels and texts.
fn fit(files: &[(&str, String)]) -> FabricFit {
    let read = |(label, text): &(&str, String)| {
        Measurement::read(&format!("{label}.csv"), text.as_bytes(), Label::parse(label).expect("a label"))
            .unwrap_or_else(|error| panic!("{}", error.render()))
    };
    let measurements: Vec<Measurement> = files.iter().map(read).collect();
    FabricFit::new(0.2, &measurements).unwrap_or_else(|error| panic!("{}", error.render()))
}

/// The fabric that a scene reads from the text of `fit`.
fn parsed(fit: &FabricFit) -> MeasuredFabric {
    let text = FabricText::new(fit, "suiting", "given");
    let mut load = |name: &str| {
        let table = text.tables.iter().find(|(known, _)| known == name);
        table.map(|(_, content)| content.clone().into_bytes()).ok_or_else(|| format!("there is no {name}"))
    };
    match Fabric::parse_with(&text.toml, &mut load) {
        Ok(Fabric::Measured(fabric)) => fabric,
        other => panic!("{other:?}\n{}", text.toml),
    }
}

/// 0 → end → −end → 0 in `quarter` points each, with friction of half the width `half_width` at a place, which slides over a path.
fn loop_of(header: &str, end: f64, slope: f64, path: f64, half_width: impl Fn(f64) -> f64) -> String {
    let quarter = 40;
    let places = (0..quarter).chain((-quarter..=quarter).rev()).chain(-quarter + 1..=0);
    let (mut z, mut before) = (0.0, 0.0);
    let mut text = format!("{header}\n");
    for place in places {
        let x = end * f64::from(place) / f64::from(quarter);
        let way = if before <= x { 1.0 } else { -1.0 };
        z = way + (z - way) * f64::exp(-f64::abs(x - before) / path);
        before = x;
        text += &format!("{x},{}\n", slope * x + z * half_width(x.abs()));
    }
    text
}

/// A shear test in degrees and gf/cm, whose loop is `widths` wide at 0.5° and 5°.
fn shear(end: f64, slope: f64, widths: [f64; 2]) -> String {
    let growth = (widths[1] - widths[0]) / 4.5;
    let half_width = |angle: f64| 0.5 * (widths[0] + growth * (angle - 0.5));
    loop_of("angle [deg],force [gf/cm]", end, slope, 0.3, half_width)
}

/// A bending test in 1/cm and gf cm/cm.
fn bend(slope: f64, width: f64) -> String {
    loop_of("curvature [1/cm],moment [gf cm/cm]", 2.5, slope, 0.1, |_| 0.5 * width)
}

/// A tensile test up to `end` per cent, whose tension on the way back is the share `returned` of that on the way out.
fn tensile(end: f64, returned: f64, tension: impl Fn(f64) -> f64) -> String {
    let way = |part: &dyn Fn(i32) -> f64, places: &mut dyn Iterator<Item = i32>| -> String {
        let strain = |i: i32| end * f64::from(i) / 60.0;
        places.map(|i| format!("{},{}\n", strain(i), part(i) * tension(strain(i)))).collect()
    };
    let (up, down) = (way(&|_| 1.0, &mut (0..=60)), way(&|_| returned, &mut (0..60).rev()));
    format!("strain [%],tension [gf/cm]\n{up}{down}")
}

fn suiting(percent: f64) -> f64 {
    3694.0 * 0.0358 * (0.01 * percent / 0.0358).tan()
}

/// What a suiting gives in loops, with a softening weft that becomes a table.
fn loops() -> [(&'static str, String); 5] {
    [
        ("warp", tensile(4.7, 0.6, suiting)),
        ("weft", tensile(10.0, 0.7, |percent| 158.0 * percent.sqrt())),
        ("shear", shear(8.0, 0.5, [0.9, 1.8])),
        ("bend-warp", bend(0.12, 0.05)),
        ("bend-weft", bend(0.08, 0.03)),
    ]
}

/// The text is the fabric of the fit, to the six digits that it has.
#[test]
fn friction_is_written_as_keys_that_a_scene_reads() {
    let fit = fit(&loops());
    let [found, fabric] = [parsed(&fit), fit.fabric().expect("a whole fabric")];
    let pairs = [
        (found.shear_modulus, fabric.shear_modulus),
        (found.bending.warp, fabric.bending.warp),
        (found.warp.tension(0.03), fabric.warp.tension(0.03)),
        (found.weft.tension(0.03), fabric.weft.tension(0.03)),
    ];
    let [found, friction] = [found.friction, fabric.friction];
    let warp = [found.warp, friction.warp].map(|friction| friction.expect("along the warp"));
    let weft = [found.weft, friction.weft].map(|friction| friction.expect("along the weft"));
    let shear = [found.shear, friction.shear].map(|friction| friction.expect("in shear"));
    let bend = [found.warp_bend, friction.warp_bend].map(|friction| friction.expect("in bending"));
    let friction = [
        (warp[0].ratio, warp[1].ratio),
        (weft[0].ratio, weft[1].ratio),
        (shear[0].at_rest, shear[1].at_rest),
        (shear[0].growth, shear[1].growth),
        (bend[0].moment, bend[1].moment),
    ];
    // Where the law is steep an error in the strain is five times as large in the tension, which is as much in its friction.
    for (read, known) in pairs.into_iter().chain(friction) {
        assert!((read / known - 1.0).abs() < 5e-5, "{read} of {known}");
    }
}

/// Widths as they went in, with 1 gf/cm of 0.980665 N/m; G is the slope of the way out, 0.5 gf/(cm deg) and half of the growth.
#[test]
fn widths_and_slopes_are_those_of_the_loops() {
    let fit = fit(&loops());
    let shear = fit.shear.as_ref().expect("a fit");
    let width = |symbol| shear.outcome.parameter(symbol).expect(symbol).value;
    assert!((width("2HG") / (0.9 * 0.980665) - 1.0).abs() < 1e-4, "{}", width("2HG"));
    assert!((width("2HG5") / (1.8 * 0.980665) - 1.0).abs() < 1e-4, "{}", width("2HG5"));
    let modulus = 56.188 * (0.5 + 0.5 * 0.9 / 4.5);
    assert!((shear.slope.value / modulus - 1.0).abs() < 1e-4, "{:?} {modulus}", shear.slope);
    let friction = fit.friction().warp_bend.expect("friction");
    assert!((friction.moment / (0.5 * 0.05 * 9.80665e-3) - 1.0).abs() < 1e-4, "{friction:?}");
    // At the turn the trapeze of the way back begins at the full tension.
    let resilience = fit.warp.as_ref().and_then(|fit| fit.outcome.parameter("RT")).expect("a loop");
    assert!(0.6 < resilience.value && resilience.value < 0.62, "{resilience:?}");
}

/// A loop to 4° says nothing of 5°: the hysteresis is then the same everywhere, and the text says why.
#[test]
fn a_loop_that_ends_early_has_one_width() {
    let mut files = loops();
    files[2].1 = shear(4.0, 0.5, [0.9, 1.8]);
    let fit = fit(&files);
    let text = FabricText::new(&fit, "suiting", "given").toml;
    assert!(text.contains("\n# 2hg5 = ...  # not determined: see below\n"), "{text}");
    assert!(text.contains("#   2HG5: the loop ends before"), "{text}");
    assert_eq!(parsed(&fit).friction.shear.expect("friction").growth, 0.0);
}

/// What has no loop has no friction, and it is said what is missing.
#[test]
fn a_way_out_alone_has_no_friction() {
    let mut files = loops();
    files[0].1 = files[0].1.lines().take(62).map(|line| format!("{line}\n")).collect();
    let fit = fit(&files);
    assert_eq!(parsed(&fit).friction.warp, None);
    let what = "friction in tension along the warp";
    let missing = fit.undetermined.iter().find(|quantity| quantity.what == what).expect(what);
    assert_eq!(missing.why, "the data have no way back");
}

/// Loops that no fabric has are left out with a warning, and the rest is a fabric.
#[test]
fn impossible_loops_are_left_out() {
    let mut files = loops();
    files[0].1 = tensile(4.7, 0.1, suiting);
    // Almost ten times as wide at 5° as at 0.5°: along sines and cosines nothing is left at rest.
    files[2].1 = shear(8.0, 0.7, [0.6, 5.99]);
    let fit = fit(&files);
    let begins = |with: &str| fit.warnings.iter().any(|warning| warning.starts_with(with));
    assert!(begins("warp.csv: no friction in proportion to the tension gives back 1"), "{:?}", fit.warnings);
    assert!(begins("shear.csv: the loop widens from 0.588 N/m"), "{:?}", fit.warnings);
    let friction = parsed(&fit).friction;
    assert!(friction.warp.is_none() && friction.shear.is_none() && friction.warp_bend.is_some());
}
