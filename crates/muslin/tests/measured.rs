//! Measured fabrics as they are read: in any unit, from tables, and with the whole message that a person gets of bad ones.

use muslin::Scene;
use muslin::scene::{Fabric, MeasuredFabric, MembraneTension, SceneError};

const BASE: &str = include_str!("scenes/measured.toml");

/// Blocks as in `errors.txt`: headings after `#`, removed parts after `-`, added ones after `+`, and below them the message.
#[test]
fn every_bad_measurement_has_its_message() {
    Scene::parse(BASE).unwrap_or_else(|error| panic!("{}", error.render("measured.toml", BASE)));
    let blocks: Vec<&str> = include_str!("scenes/measured_errors.txt").split("\n\n").collect();
    assert!(30 <= blocks.len(), "only {} cases were read", blocks.len());
    let mut failures = Vec::new();
    for block in blocks {
        let lines_after = |mark: char| {
            let lines = block.lines().filter_map(|line| line.strip_prefix(mark));
            lines.map(|line| line.strip_prefix(' ').unwrap_or(line)).collect::<Vec<_>>().join("\n")
        };
        let (old, new) = (lines_after('-'), lines_after('+'));
        let expected: Vec<&str> = block.lines().filter(|line| !line.starts_with(['#', '-', '+'])).collect();
        assert!(BASE.contains(&old), "the base scene has no\n{old}");
        let text = BASE.replacen(&old, &new, 1);
        let actual = match Scene::parse_with(&text, &mut |_| Err("it is not there".to_owned())) {
            Ok(_) => panic!("accepted:\n{text}"),
            Err(error) => error.render("scene.toml", &text),
        };
        if actual != expected.join("\n") {
            failures
                .push(format!("- {old}\n+ {new}\nexpected:\n{}\nactual:\n{actual}\n", expected.join("\n")));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// The base scene with `old` replaced by `new`, and `table` for the file that it names.
fn read(old: &str, new: &str, table: &str) -> Result<MeasuredFabric, (String, SceneError)> {
    assert!(BASE.contains(old), "the base scene has no\n{old}");
    let text = BASE.replacen(old, new, 1);
    match Scene::parse_with(&text, &mut |_| Ok(table.as_bytes().to_vec())) {
        Ok(scene) => match &scene.fabrics()["cotton"] {
            Fabric::Measured(fabric) => Ok(fabric.clone()),
            Fabric::Springs(_) => panic!("a measured fabric"),
        },
        Err(error) => Err((text, error)),
    }
}

fn fabric(old: &str, new: &str) -> MeasuredFabric {
    read(old, new, "").unwrap_or_else(|(text, error)| panic!("{}", error.render("measured.toml", &text)))
}

/// Each value in the instrument's unit, and in SI by the unit's definition. Two roundings at most part them.
#[test]
fn units_of_instruments_are_converted_exactly() {
    let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 4.0 * f64::EPSILON, "{a} and {b}");
    let density = |new: &str| fabric("areal_density = 0.15", new).areal_density;
    close(density("areal_density_g_per_m2 = 150"), 0.15);
    // 28.349523125 g / (0.9144 m)².
    close(density("areal_density_oz_per_yd2 = 4.4"), 4.4 * 0.028349523125 / 0.83612736);
    let shear = |new: &str| fabric("modulus = 40.0", new).shear_modulus;
    close(shear("g_gf_per_cm_deg = 0.7"), 0.7 * 0.980665 * 180.0 / std::f64::consts::PI);
    close(shear("eb5_percent = 3.0"), 4.903325 / (4.0 * 0.03));
    close(shear("eb5 = 0.03"), 4.903325 / (4.0 * 0.03));
    let bending = |new: &str| fabric("warp = 9e-6", new).bending.warp;
    close(bending("warp = { b_gf_cm2_per_cm = 0.09 }"), 0.09 * 98.0665e-6);
    close(bending("warp = { bending_length_mm = 18 }"), 0.15 * 9.80665 * 0.018_f64.powi(3));
    close(bending("warp = { bending_length = 0.018 }"), 0.15 * 9.80665 * 0.018_f64.powi(3));
}

/// The test of the base scene in every way to write it: with WT = LT F EMT / 2, and with the strain scale that follows.
#[test]
fn a_tensile_test_is_the_same_however_it_is_written() {
    let constants = |fabric: &MeasuredFabric| match fabric.warp {
        MembraneTension::Tangent { modulus, strain_scale } => (modulus, strain_scale),
        _ => panic!("{fabric:?}"),
    };
    let base = constants(&fabric("", ""));
    // As by hand: a = 0.047 / 1.312007, K₀ = 490.3325 / (a tan 1.312007).
    assert!((base.0 / 3623.47 - 1.0).abs() < 1e-5 && (base.1 / 0.0358230 - 1.0).abs() < 1e-5, "{base:?}");
    let whole = "emt = 0.047, lt = 0.55, force = 490.3325";
    for new in [
        "emt_percent = 4.7, lt = 0.55, force_gf_per_cm = 500",
        &format!("emt = 0.047, wt = {:?}, force = 490.3325", 0.55 * 490.3325 * 0.047 / 2.0),
        &format!("emt = 0.047, wt_gf_cm_per_cm2 = {:?}, force_gf_per_cm = 500", 0.55 * 500.0 * 0.047 / 2.0),
        &format!("emt = 0.047, strain_scale = {:?}, force = 490.3325", base.1),
        &format!("modulus = {:?}, strain_scale = {:?}", base.0, base.1),
    ] {
        let found = constants(&fabric(whole, new));
        // The modulus is steep in LT there: roundings grow some tens of times.
        let error = (found.0 / base.0 - 1.0).abs().max((found.1 / base.1 - 1.0).abs());
        assert!(error < 1e-13, "{new}: {error:e}");
    }
}

const LAW: &str = "modulus = 1300.0, strain_scale = 0.1";

#[test]
fn tables_are_per_width_in_the_unit_of_their_header() {
    let points = |new: &str, table: &str| match read(LAW, new, table) {
        Ok(MeasuredFabric { weft: MembraneTension::Curve(curve), .. }) => curve.points().to_vec(),
        other => panic!("{other:?}"),
    };
    let expected = [[0.0, 0.0], [0.02, 4.903325], [0.05, 19.6133], [0.08, 98.0665]];
    let file = "curve = \"weft.csv\"";
    for found in [
        points(file, "strain [1],tension [N/m]\n0.02,4.903325\n0.05,19.6133\n0.08,98.0665\n"),
        points(file, "strain [%],tension [gf/cm]\n2,5\n5,20\n8,100\n"),
        points(file, "tension [N/cm],strain [%]\n0.04903325,2\n0.196133,5\n0.980665,8\n"),
        points("e5 = 0.02, e20 = 0.05, e100_percent = 8", ""),
    ] {
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.iter().zip(expected) {
            assert_eq!(found[0], expected[0]);
            assert!((found[1] - expected[1]).abs() <= 4.0 * f64::EPSILON * expected[1]);
        }
    }
}

#[test]
fn a_bad_table_per_width_has_its_message() {
    let message = |table: &str| match read(LAW, "curve = \"weft.csv\"", table) {
        Ok(_) => panic!("accepted"),
        Err((_, error)) => (error.to_string(), error.help().unwrap_or_default()),
    };
    let (text, help) = message("strain [1],tension [N]\n0.02,4.9\n0.05,19.6\n");
    assert_eq!(
        text,
        "`weft.csv` line 1: has the unit \"N\" at the column \"tension\", but must have `tension [N/m]` or \
         `tension [N/cm]` or `tension [gf/cm]`"
    );
    assert_eq!(help, "tension is the force by the width of the specimen");
    let (text, help) = message("strain [1],tension [N/m]\n4.9,0.02\n19.6,0.05\n");
    assert_eq!(text, "`weft.csv` line 3: strain is 19.6, but must be at most 10");
    assert!(help.ends_with("see that the columns stand below their names"), "{help}");
    let (text, _) = message("strain [1],tension [N/m]\n0.02,19.6\n0.05,4.9\n");
    assert_eq!(text, "`weft.csv` line 3: tension is 4.9 N/m, but must not be below the 19.6 N/m before it");
    let (text, _) = message("strain [%];tension [gf/cm]\n2,5;5,0\n");
    assert_eq!(text, "`weft.csv` line 1: has semicolons between its cells, but must have commas");
}

/// A part of the table that rises by less than shear springs resist: no spring can carry what is left.
#[test]
fn a_table_that_is_too_flat_for_the_shear_modulus_is_refused() {
    let table = "strain [1],tension [N/m]\n0.1,100\n0.2,103\n0.3,400\n";
    let Err((_, error)) = read(LAW, "curve = \"weft.csv\"", table) else { panic!("accepted") };
    assert_eq!(
        error.to_string(),
        "`cloth.0.grid` has cells of 0.1 m x 0.1 m, in which the shear springs of `fabric.cotton.shear` resist stretch \
         along the weft by 40.0 N/m, but `fabric.cotton.weft` rises in its flattest part by only 30.0 N/m"
    );
}
