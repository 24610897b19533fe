//! `muslin fit`: from data files to a fabric that `muslin` reads back.

use serde_json::Value;

use crate::work::{Outcome, SMALL, Work, exists};

const WARP: &str = "emt [%],lt [1],force [gf/cm]\n4.7,0.55,500\n";
const WEFT: &str = "emt [%],lt [1],force [gf/cm]\n12.75,0.55,500\n";
const SHEAR: &str = "g [gf/(cm deg)]\n0.575\n";
const BEND: &str = "# direction: warp\nb [gf cm^2/cm]\n0.12\n0.125\n0.121\n";
const OVERHANG: &str = "overhang [mm],angle [deg]\n31.9,41.5\n32.2,41.5\n32.0,41.5\n";

/// The published tensile and shear values of a worsted suiting, and typical bending.
fn suiting() -> Work {
    let work = Work::new();
    let files = [
        ("warp.csv", WARP),
        ("weft.csv", WEFT),
        ("shear.csv", SHEAR),
        ("bend.csv", BEND),
        ("overhang.csv", OVERHANG),
    ];
    for (name, text) in files {
        work.write(name, text);
    }
    work
}

const FILES: [&str; 6] =
    ["fit", "warp=warp.csv", "weft=weft.csv", "shear=shear.csv", "bend.csv", "cantilever-weft=overhang.csv"];

fn fit(work: &Work, more: &[&str]) -> Outcome {
    let arguments = [&FILES[..], &["--areal-density", "200 g/m2", "--fabric", "suiting"], more].concat();
    Outcome::of(&mut work.command(arguments))
}

/// A scene of a sheet of the fabric that `text` holds.
fn scene(text: &str) -> String {
    let (head, rest) = SMALL.split_once("[fabric.plain]").expect("a fabric");
    let (_, cloth) = rest.split_once("[[cloth]]").expect("a cloth");
    let cloth = cloth.replace("\"plain\"", "\"suiting\"");
    format!("{}{text}\n[[cloth]]{cloth}", head.replace("step = { constant = 5e-3 }\n", ""))
}

/// The whole fabric of a published suiting: constants as the book has them, every value with its error and its file; and it runs.
#[test]
fn a_published_suiting_becomes_a_fabric() {
    let work = suiting();
    let outcome = fit(&work, &[]);
    outcome.assert_success();
    assert_eq!(outcome.stdout, include_str!("suiting.toml"));
    work.write("scene.toml", scene(&outcome.stdout));
    work.muslin("run scene.toml --out run").assert_success();
}

#[test]
fn a_folder_holds_fabric_page_plots_and_numbers() {
    let work = suiting();
    let outcome = fit(&work, &["--out", "out"]);
    outcome.assert_success();
    assert!(outcome.stdout.ends_with("\n# written to out: suiting.toml, index.html with plots, fit.json\n"));
    assert_eq!(
        work.names("out"),
        ["cantilever-weft-residuals.svg", "cantilever-weft.svg", "fit.json", "index.html", "suiting.toml"]
    );
    assert!(outcome.stdout.starts_with(&work.text("out/suiting.toml")));
    let numbers: Value = serde_json::from_slice(&work.read("out/fit.json")).expect("JSON");
    assert_eq!(numbers["tests"].as_array().map(Vec::len), Some(5));
    assert_eq!(numbers["tests"][4]["constants"][0]["symbol"], "B");
    let page = work.text("out/index.html");
    assert!(!page.contains("http") && page.contains("[fabric.suiting.warp]"));

    let message = "error: out exists already and is not empty\n  help: replace its files with `--force`, or choose another \
                   folder with `--out DIR`";
    fit(&work, &["--out", "out"]).assert_failure(2, message);
    // Plots that the new fit has none of go, what is not the fit's stays.
    work.write("out/notes.txt", "mine");
    let less = [
        "fit",
        "warp=warp.csv",
        "--areal-density",
        "200 g/m2",
        "--fabric",
        "other",
        "--out",
        "out",
        "--force",
    ];
    Outcome::of(&mut work.command(less)).assert_success();
    assert_eq!(work.names("out"), ["fit.json", "index.html", "notes.txt", "other.toml"]);
}

/// A curve that softens fits no law: the fabric names a table, which stands beside it and is read back.
#[test]
fn what_fits_no_law_becomes_a_table() {
    let work = suiting();
    let rows = (0..=60).map(|i| f64::from(i) / 60.0).map(|e| format!("{},{}\n", 10.0 * e, 400.0 * e.sqrt()));
    work.write("warp.csv", format!("strain [%],tension [gf/cm]\n{}", rows.collect::<String>()));
    fit(&work, &[]).assert_failure(
        2,
        "error: no law fits the tension, so that the fabric needs its table in a file, suiting-warp.csv\n  \
         help: give a folder for both with `--out DIR`",
    );
    assert!(!exists(work.path("out")));
    let outcome = fit(&work, &["--out", "out"]);
    outcome.assert_success();
    let text = work.text("out/suiting.toml");
    assert!(text.contains("curve = \"suiting-warp.csv\"  # 41 points; from warp.csv\n"), "{text}");
    work.write("out/scene.toml", scene(&text));
    work.muslin("run out/scene.toml --out run").assert_success();
}

#[test]
fn bad_arguments_have_their_messages() {
    let work = suiting();
    let with = |arguments: &[&str]| Outcome::of(&mut work.command(["fit"].iter().chain(arguments).copied()));
    let density = ["--areal-density", "200 g/m2"];
    for (arguments, message) in [
        (
            ["warp=warp.csv", "--fabric", "a b"],
            "error: the fabric's name is \"a b\", but must have letters, digits, `-` and `_` alone\n  \
             help: take a name such as `wool-tropical`",
        ),
        (
            ["warp=none.csv", "--fabric", "a"],
            "error: none.csv could not be read: no such file or directory\n  \
             help: name the CSV file of a test, as `warp=tensile-warp.csv`",
        ),
        (
            ["wrap=warp.csv", "--fabric", "a"],
            "error: there is no label `wrap`\n  \
             help: write `warp=FILE`, `weft=FILE`, `shear=FILE`, or the test with its direction, as `bend-warp=FILE`: tests are \
             tensile, shear, bend and cantilever, directions warp, weft and bias",
        ),
        (
            ["warp.csv", "--fabric", "a"],
            "error: `warp.csv` is a tensile test of an unknown direction\n --> warp.csv\n  = help: write `warp=warp.csv` or \
             `weft=warp.csv`, or add the line `# direction: warp` to the file",
        ),
    ] {
        with(&[&arguments[..], &density].concat()).assert_failure(2, message);
    }
    for (mass, message) in [
        ("200", "but must have a unit"),
        ("g/m2", "but must begin with a number"),
        ("162,9 g/m2", "but must have a decimal point"),
        ("200 lb", "in the unknown unit `lb`"),
    ] {
        let outcome = with(&["warp=warp.csv", "--fabric", "a", "--areal-density", mass]);
        let help = "write a number and a unit, as `162.9 g/m2`; units are g/m2, kg/m2 and oz/yd2";
        outcome
            .assert_failure(2, &format!("error: the mass per area is `{mass}`, {message}\n  help: {help}"));
    }
    with(&["warp=warp.csv", "--fabric", "a", "--areal-density", "200 kg/m2"]).assert_failure(
        2,
        "error: the mass per area is 200 kg/m2, but must be from 1 g/m2 to 10 kg/m2\n  help: see that the unit is that of the number",
    );
}

/// 0 → end → −end → 0 in 40 points each, with friction that slides over a path and is half of `width` at a place.
fn loop_of(header: &str, end: f64, slope: f64, path: f64, width: impl Fn(f64) -> f64) -> String {
    let places = (0..40).chain((-40..=40).rev()).chain(-39..=0);
    let (mut z, mut before) = (0.0, 0.0);
    let mut text = format!("{header}\n");
    for place in places {
        let x = end * f64::from(place) / 40.0;
        let way = if before <= x { 1.0 } else { -1.0 };
        z = way + (z - way) * f64::exp(-f64::abs(x - before) / path);
        before = x;
        text += &format!("{x},{}\n", slope * x + 0.5 * z * width(x.abs()));
    }
    text
}

/// Loops of a suiting, in the instruments' units: tension whose way back is 65 % of the way out, 2HG 0.9 and 2HG5 1.8 gf/cm, 2HB 0.06
/// and 0.04 gf cm/cm.
fn loops() -> Work {
    let work = Work::new();
    for (name, end, modulus, scale) in [("warp", 4.7, 3694.0, 0.0358), ("weft", 12.75, 1362.0, 0.0972)] {
        let row = |i: i32, share: f64| {
            let strain = end * f64::from(i) / 100.0;
            format!("{strain},{}\n", share * modulus * scale * (0.01 * strain / scale).tan())
        };
        let out: String = (0..=100).map(|i| row(i, 1.0)).collect();
        let back: String = (0..100).rev().map(|i| row(i, 0.65)).collect();
        work.write(&format!("{name}.csv"), format!("strain [%],tension [gf/cm]\n{out}{back}"));
    }
    let widening = |angle: f64| 0.9 + 0.2 * (angle - 0.5);
    work.write("shear.csv", loop_of("angle [deg],force [gf/cm]", 8.0, 0.5, 0.3, widening));
    for (name, rigidity, width) in [("bend-warp", 0.12, 0.06), ("bend-weft", 0.08, 0.04)] {
        let text = loop_of("curvature [1/cm],moment [gf cm/cm]", 2.5, rigidity, 0.1, |_| width);
        work.write(&format!("{name}.csv"), text);
    }
    work
}

/// What goes in comes out: loops in files become a fabric whose loops on the virtual instruments are as wide, and which is loaded
/// along the same curves.
#[test]
fn loops_become_friction_that_instruments_measure() {
    let work = loops();
    let density = ["--areal-density", "200 g/m2", "--fabric", "suiting", "--out", "out"];
    let files = [
        "fit",
        "warp=warp.csv",
        "weft=weft.csv",
        "shear.csv",
        "bend-warp=bend-warp.csv",
        "weft=bend-weft.csv",
    ];
    Outcome::of(&mut work.command([&files[..], &density].concat())).assert_success();
    // By hand: G is 0.5 gf/(cm deg) and half of the 0.2 by which the loop widens; RT counts the trapeze at the turn.
    for (test, along, known) in [
        ("tensile", "warp", vec![("EMT", 4.7), ("RT", 65.0)]),
        ("tensile", "weft", vec![("EMT", 12.75), ("RT", 65.0)]),
        ("shear", "warp", vec![("G", 0.6), ("2HG", 0.9), ("2HG5", 1.8)]),
        ("bend", "warp", vec![("B", 0.12), ("2HB", 0.06)]),
        ("bend", "weft", vec![("B", 0.08), ("2HB", 0.04)]),
    ] {
        let folder = format!("{test}-{along}");
        work.muslin(&format!("lab {test} out/suiting.toml --along {along} --cells 10 --out {folder}"))
            .assert_success();
        let values: Value = serde_json::from_slice(&work.read(&format!("{folder}/lab.json"))).expect("JSON");
        let readings = values["readings"].as_array().expect("readings");
        for (name, known) in known {
            let reading = readings.iter().find(|reading| reading["name"] == name).expect(name);
            let measured = reading["instrument"]["measured"].as_f64().expect("a number");
            assert!(
                (measured / known - 1.0).abs() < 0.03,
                "{folder}: {name} is {measured}, but {known} went in"
            );
        }
    }
}
