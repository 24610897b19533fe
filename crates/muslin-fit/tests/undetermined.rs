//! What the data cannot say is said.

use muslin_fit::{FabricFit, FabricText, Label, Measurement};

/// The fit of files with these labels and texts.
fn fit(files: &[(&str, &str)]) -> FabricFit {
    let read = |(index, (label, text)): (usize, &(&str, &str))| {
        let label = Label::parse(label).expect("a label");
        Measurement::read(&format!("{index}.csv"), text.as_bytes(), label)
            .unwrap_or_else(|error| panic!("{}", error.render()))
    };
    let measurements: Vec<Measurement> = files.iter().enumerate().map(read).collect();
    FabricFit::new(0.2, &measurements).unwrap_or_else(|error| panic!("{}", error.render()))
}

/// The names of what is undetermined, in order.
fn names(fit: &FabricFit) -> Vec<&str> {
    fit.undetermined.iter().map(|quantity| quantity.what.as_str()).collect()
}

/// A table of `count` rows from a header and what stands in row i.
fn table(header: &str, count: i32, row: impl Fn(f64) -> [f64; 2]) -> String {
    let rows = (0..count).map(|i| row(f64::from(i)));
    let rows = rows.map(|[x, y]| format!("{x},{y}\n"));
    format!("{header}\n{}", rows.collect::<String>())
}

/// Values with an alternating error of 1 % of the last: noise without a stream.
fn wobble(i: f64, count: f64) -> f64 {
    [1.0, -1.0, -1.0, 1.0][i as usize % 4] * 0.01 * count
}

const WARP: &str = "emt [%],lt [1],force [gf/cm]\n4.7,0.55,500\n4.6,0.56,500\n4.8,0.54,500\n";
const WEFT: &str = "emt [%],lt [1],force [gf/cm]\n12.7,0.55,500\n12.8,0.56,500\n12.9,0.54,500\n";
const SHEAR: &str = "g [gf/(cm deg)]\n0.57\n0.58\n";
const LENGTHS: &str = "bending_length [mm]\n18\n18.5\n";

#[test]
fn a_fabric_of_all_tests_lacks_nothing() {
    let stiff = "bending_length [mm]\n20\n20.5\n";
    let fit = fit(&[
        ("warp", WARP),
        ("weft", WEFT),
        ("shear", SHEAR),
        ("cantilever-warp", LENGTHS),
        ("cantilever-weft", LENGTHS),
        ("bias", stiff),
    ]);
    assert_eq!(names(&fit), Vec::<&str>::new());
    assert!(fit.is_complete() && fit.bias().is_some() && fit.warnings.is_empty());
}

#[test]
fn what_no_file_is_about_is_missing() {
    let fit = fit(&[("warp", WARP)]);
    assert_eq!(
        names(&fit),
        ["tension along the weft", "shear", "bending along the warp", "bending along the weft", "twist"]
    );
    assert_eq!(fit.undetermined[0].why, "data along the warp alone say nothing of it");
    assert!(!fit.is_complete());
    let text = FabricText::new(&fit, "wool", "given").toml;
    for line in ["# modulus = ...  # not determined: see below", "# bias = ...  # not determined: see below"]
    {
        assert!(text.contains(line), "{text}");
    }
}

/// A curve in its linear range: any strain scale above some value will do.
#[test]
fn the_strain_scale_of_a_straight_curve_is_undetermined() {
    let text = table("strain [%],tension [N/m]", 30, |i| [0.1 * i, 5.0 * (i + wobble(i, 29.0))]);
    let fit = fit(&[("warp", &text)]);
    let scale = fit.undetermined.iter().find(|quantity| quantity.what.starts_with("strain scale"));
    let scale = scale.expect("the strain scale");
    assert_eq!(scale.what, "strain scale of the tension along the warp");
    assert!(
        scale.why.starts_with("the data stay where the law is linear: every strain scale above 0.1"),
        "{scale:?}"
    );
    assert_eq!(scale.remedy, "measure to a larger strain, where the curve bends");
}

#[test]
fn friction_of_data_on_one_way_is_undetermined() {
    let bend =
        table("curvature [1/cm],moment [gf cm/cm]", 20, |i| [0.1 * i, 0.01 + 0.01 * (i + wobble(i, 19.0))]);
    let shear = table("angle [deg],force [gf/cm]", 20, |i| [0.4 * i, 0.2 * (i + wobble(i, 19.0))]);
    let fit = fit(&[("warp", &bend), ("shear", &shear)]);
    for what in ["friction in shear", "friction in bending along the warp"] {
        assert!(names(&fit).contains(&what), "{:?}", names(&fit));
    }
}

/// Five points a quarter: friction has turned before the first point after a turn, which says no more of its path.
#[test]
fn the_sliding_path_of_a_coarse_loop_is_undetermined() {
    let places = (0..5).chain((-5..=5).rev()).chain(-4..=0);
    let mut before = 0;
    let rows = places.map(|i: i32| {
        let way = if before <= i { 1.0 } else { -1.0 };
        before = i;
        let i = f64::from(i);
        format!("{},{}\n", 0.5 * i, 0.03 * i + 0.01 * way + 0.1 * wobble(i.abs(), 0.1))
    });
    let text = format!("curvature [1/cm],moment [gf cm/cm]\n{}", rows.collect::<String>());
    let fit = fit(&[("warp", &text)]);
    assert!(names(&fit).iter().any(|name| name.starts_with("sliding path")), "{:?}", names(&fit));
}

#[test]
fn a_single_specimen_has_no_standard_error() {
    let one = |text: &'static str| text.lines().take(2).map(|line| format!("{line}\n")).collect::<String>();
    let fit = fit(&[("warp", &one(WARP)), ("shear", &one(SHEAR)), ("weft", &one(LENGTHS))]);
    for what in [
        "standard error of the tension along the warp",
        "standard error of the shear",
        "standard error of the bending along the weft",
    ] {
        assert!(names(&fit).contains(&what), "{:?}", names(&fit));
    }
}

/// 2HG5 is at 5 degrees, where a loop of 4 has no width.
#[test]
fn a_narrow_loop_has_no_width_beyond_its_end() {
    let places = (0..20).chain((-20..=20).rev()).chain(-19..=0);
    let mut before = 0;
    let rows = places.map(|i: i32| {
        let way = if before <= i { 1.0 } else { -1.0 };
        before = i;
        format!(
            "{},{}\n",
            0.2 * f64::from(i),
            0.1 * f64::from(i) + 0.5 * way + 0.01 * wobble(f64::from(i.abs()), 1.0)
        )
    });
    let fit = fit(&[("shear", &format!("angle [deg],force [gf/cm]\n{}", rows.collect::<String>()))]);
    assert!(names(&fit).contains(&"2HG5"), "{:?}", names(&fit));
    assert!(fit.shear.expect("a fit").outcome.parameter("2HG").is_some());
}

/// A sheet's rigidity at 45° is a quarter of both others and what resists twist.
#[test]
fn a_strip_at_45_degrees_that_is_too_soft_is_left_out_with_a_warning() {
    let soft = "bending_length [mm]\n10\n10.5\n";
    let fit = fit(&[("warp", LENGTHS), ("weft", LENGTHS), ("bias", soft)]);
    assert_eq!(fit.warnings.len(), 1);
    assert!(fit.warnings[0].starts_with("the rigidity at 45 degrees"), "{:?}", fit.warnings);
    assert!(fit.bias().is_none());
}

/// A bending test goes before a cantilever test of the same strip, which checks it.
#[test]
fn two_tests_of_one_rigidity_are_compared() {
    let bend = "b [gf cm^2/cm]\n0.12\n0.121\n";
    let fit = fit(&[("cantilever-warp", LENGTHS), ("bend-warp", bend)]);
    let rigidity = fit.rigidity(muslin_fit::Direction::Warp).expect("a rigidity");
    assert!((rigidity.value / 11.8e-6 - 1.0).abs() < 0.01, "{rigidity:?}");
    let [first, ..] = fit.bending.clone().map(|fit| fit.map(|fit| fit.outcome));
    let notes = first.expect("a fit").notes;
    assert!(notes.iter().any(|note| note.starts_with("0.csv gives ")), "{notes:?}");
    assert_eq!(fit.checks.len(), 1);
}

/// A sheet that locks: the straight line through it leaves a rest that keeps its sign, and that is said.
#[test]
fn a_straight_line_through_a_bent_curve_has_a_warning() {
    let bent = |i: f64| 0.25 * i + 0.0001 * i * i * i;
    let text = table("angle [deg],force [gf/cm]", 61, |i| [0.5 * i, bent(i) + 0.1 * wobble(i, 1.0)]);
    let fit = fit(&[("shear", &text)]);
    assert_eq!(fit.warnings.len(), 1, "{:?}", fit.warnings);
    assert!(fit.warnings[0].starts_with("0.csv: the law leaves a systematic 7."), "{:?}", fit.warnings);
}
