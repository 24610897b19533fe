//! `muslin lab`: files, values and bad input.

use crate::work::{Work, exists};

const LIBRARY: &str = "nylon-heat-bondable, typical-cotton-broadcloth, typical-cotton-shirting, typical-denim, typical-polyester-cotton-twill, typical-polyester-faille, typical-polyester-plain, typical-polyester-tropical, typical-silk, typical-stretch-twill, typical-suiting, typical-wool-lycra, typical-wool-plain, typical-wool-tropical";

/// Every instrument, its files, and its first value beside what went in.
#[test]
fn every_instrument_writes_its_folder() {
    let work = Work::new();
    for (instrument, first) in [
        ("tensile", "EMT"),
        ("shear", "G"),
        ("bend", "B"),
        ("cantilever", "c"),
        ("bias", "E45"),
        ("picture-frame", "G"),
    ] {
        let outcome =
            work.muslin(&format!("lab {instrument} typical-suiting --weft --cells 6 --out {instrument}"));
        outcome.assert_success();
        assert!(outcome.stdout.contains(&format!("\n  {first} ")), "{}", outcome.stdout);
        assert_eq!(work.names(instrument), ["cloth.glb", "curve.csv", "lab.json", "plot.svg", "view.html"]);
        let values: serde_json::Value =
            serde_json::from_slice(&work.read(&format!("{instrument}/lab.json"))).expect("JSON");
        let reading = &values["readings"][0];
        assert_eq!(reading["name"], first);
        // Six cells: bending is right to 2 %.
        let difference = reading["relative_difference"].as_f64().expect("an input");
        assert!(difference.abs() < 0.02, "{instrument}: {difference}");
        assert!(values["equilibrium"]["relative_residual"].as_f64().expect("a number") <= 1e-8);
        let curve = work.text(&format!("{instrument}/curve.csv"));
        let states = values["states"].as_u64().expect("a number") as usize;
        assert_eq!(curve.lines().count(), 1 + states);
        assert!(curve.lines().next().expect("a header").contains(" ["), "{curve}");
    }
}

/// A film that hardly stretches and is hard to bend: Newton's method takes more than 60 steps to some overhangs.
#[test]
fn a_stiff_film_comes_to_rest() {
    let work = Work::new();
    work.muslin("lab cantilever nylon-heat-bondable --along weft").assert_success();
}

/// A file with the keys alone, and one as `muslin fabric show` prints it, are the fabric.
#[test]
fn a_file_is_a_fabric_too() {
    let work = Work::new();
    let shown = work.muslin("fabric show typical-suiting").stdout;
    let (_, keys) = shown.split_once('\n').expect("lines");
    work.write("table.toml", &shown);
    work.write("keys.toml", keys);
    for name in ["table", "keys", "typical-suiting"] {
        let file = if name == "typical-suiting" { name.to_owned() } else { format!("{name}.toml") };
        work.muslin(&format!("lab picture-frame {file} --cells 4 --out {name}")).assert_success();
        assert_eq!(work.text(&format!("{name}/curve.csv")), work.text("table/curve.csv"));
    }
}

/// A fabric with friction is compared to what it should read with it: the force of the frame on its way up and back, but for rounding.
#[test]
fn friction_is_in_what_readings_are_compared_to() {
    let work = Work::new();
    let suiting = work.muslin("fabric show typical-suiting").stdout;
    let plain = "{ g_gf_per_cm_deg = 0.575 }";
    assert!(suiting.contains(plain), "{suiting}");
    let friction = "{ g_gf_per_cm_deg = 0.575, 2hg_gf_per_cm = 0.9, 2hg5_gf_per_cm = 1.8 }";
    work.write("friction.toml", suiting.replace(plain, friction));
    work.muslin("lab picture-frame friction.toml --cells 4 --out out").assert_success();
    let values: serde_json::Value = serde_json::from_slice(&work.read("out/lab.json")).expect("JSON");
    let reading = &values["readings"][0];
    let [measured, input] = ["measured", "input"].map(|key| reading[key].as_f64().expect("a number"));
    assert!((measured / input - 1.0).abs() < 1e-9, "{reading}");
    // 0.575 gf/(cm deg) in N/m; half of 2HG holds up to 0.5° and slips from there to 2°.
    assert!(1.2 * 32.31 < input && input < 1.5 * 32.31, "{reading}");
    let curve = work.text("out/curve.csv");
    let rows: Vec<Vec<f64>> = curve
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|cell| cell.parse().expect("a number")).collect())
        .collect();
    let largest = rows.iter().map(|row| row[2].abs()).fold(0.0, f64::max);
    assert!(rows.iter().all(|row| (row[1] - row[2]).abs() < 1e-9 * largest), "{curve}");
    assert!(rows.last().is_some_and(|last| last[1] < -0.01 * largest), "friction pulls back at 0°: {curve}");
}

#[test]
fn bad_input_is_told() {
    let work = Work::with_scene(&[]);
    let outcome = work.muslin("lab tensil typical-suiting");
    assert_eq!(outcome.code, Some(2));
    assert!(outcome.stderr.contains("possible values: tensile, shear, bend"), "{}", outcome.stderr);
    work.muslin("lab tensile silk").assert_failure(
        2,
        &format!(
            "error: there is no fabric and no file `silk`\n  help: name a TOML file with a measured fabric, or one of the library: {LIBRARY}"
        ),
    );
    work.muslin("lab tensile typical-suiting --cells 3").assert_failure(
        2,
        "error: a specimen of 3 cells between its clamps is none: it must have 4 to 100\n  help: choose another number with `--cells N`",
    );
    let springs = "kind = \"springs\"\nparticle_mass = 0.02\ndrag = 0.01\nstructural = { stiffness = 20.0, law = \"linear\" }\n\
                   shear = { stiffness = 5.0, law = \"linear\" }\nbend = { stiffness = 1.0, law = \"linear\" }\n";
    work.write("springs.toml", springs);
    work.muslin("lab tensile springs.toml").assert_failure(
        2,
        "error: springs.toml has a fabric of kind \"springs\", but instruments measure per width and area\n  \
         help: give its values as kind \"measured\"; `muslin fabric show NAME` prints an example",
    );
    work.write("two.toml", format!("[fabric.a]\n{springs}[fabric.b]\n{springs}"));
    let outcome = work.muslin("lab tensile two.toml");
    assert_eq!(outcome.code, Some(2));
    assert!(outcome.stderr.contains("more than one fabric"), "{}", outcome.stderr);
    work.write("text.toml", "no TOML at all");
    let outcome = work.muslin("lab tensile text.toml");
    assert_eq!(outcome.code, Some(2));
    assert!(outcome.stderr.starts_with("error: the text is not TOML"), "{}", outcome.stderr);
    let outcome = work.muslin("lab tensile scene.toml");
    assert_eq!(outcome.code, Some(2), "a scene is no fabric: {}", outcome.stderr);
    assert_eq!(
        work.names("."),
        ["scene.toml", "springs.toml", "text.toml", "two.toml"],
        "nothing was written"
    );
}

/// A fabric that does not bend, or does not reach the tension of the test, gives no result and no folder.
#[test]
fn what_cannot_be_measured_is_told() {
    let work = Work::new();
    work.write(
        "limp.toml",
        "kind = \"measured\"\nareal_density = 0.1\ndrag = 0\nwarp = { modulus = 100.0 }\nweft = { modulus = 100.0 }\n\
         shear = { modulus = 10.0 }\nbend = { warp = 0, weft = 0 }\n",
    );
    work.muslin("lab bend limp.toml --out a").assert_failure(
        2,
        "error: the fabric has no bending rigidity along these yarns, so there is nothing for this instrument to measure\n  \
         help: choose another instrument, or give the fabric a value",
    );
    work.muslin("lab tensile limp.toml --out b").assert_failure(
        2,
        "error: the tension is only 200 N/m at a strain of 2, but the test goes up to 490.3325 N/m\n  \
         help: a fabric that stretches so far needs another test; check the units of its tension",
    );
    assert!(!exists(work.path("a")) && !exists(work.path("b")));
}

#[test]
fn folders_are_kept_unless_forced() {
    let work = Work::new();
    let command = "lab picture-frame typical-suiting --cells 4 --out out";
    work.muslin(command).assert_success();
    let before = work.contents("out");
    work.muslin(command).assert_failure(
        2,
        "error: out exists already and is not empty\n  help: replace its files with `--force`, or choose another folder with `--out DIR`",
    );
    work.muslin(&format!("{command} --force")).assert_success();
    assert!(work.contents("out") == before, "the same bits again");
    work.write("out/mine.txt", "");
    std::fs::remove_file(work.path("out/lab.json")).expect("a file");
    work.muslin(&format!("{command} --force")).assert_failure(
        2,
        "error: out holds other files than those of a test, which `--force` does not replace\n  \
         help: choose another folder with `--out DIR`",
    );
}
