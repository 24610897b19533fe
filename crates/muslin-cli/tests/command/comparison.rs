//! `muslin compare`: values as `muslin lab` has them, side by side, and bad input.

use serde_json::Value;

use crate::work::{Work, exists};

const SUITING: &str = "typical-suiting";
const BROADCLOTH: &str = "typical-cotton-broadcloth";

/// Bends and stretches at nothing.
const LIMP: &str = "kind = \"measured\"\nareal_density = 0.1\ndrag = 0\nwarp = { modulus = 100.0 }\nweft = { modulus = 100.0 }\n\
    shear = { modulus = 10.0 }\nbend = { warp = 0, weft = 0 }\n";

fn values(work: &Work, folder: &str) -> Value {
    serde_json::from_slice(&work.read(&format!("{folder}/compare.json"))).expect("JSON")
}

/// The quantities of an instrument, `null` being the fabrics themselves.
fn quantities<'v>(values: &'v Value, instrument: &Value) -> Vec<&'v Value> {
    let all = values["quantities"].as_array().expect("an array").iter();
    all.filter(|quantity| quantity["instrument"] == *instrument).collect()
}

/// Both columns are, bit for bit, what `muslin lab` measures, with what a fabric lacks in words.
#[test]
fn values_are_those_of_the_lab() {
    let work = Work::new();
    let outcome = work.muslin(&format!("compare {SUITING} {BROADCLOTH} --along weft --cells 4 --out both"));
    outcome.assert_success();
    let both = values(&work, "both");
    assert_eq!([&both["a"], &both["b"]], [SUITING, BROADCLOTH]);
    let mut count = 0;
    for instrument in ["tensile", "shear", "bend", "cantilever", "bias", "picture-frame"] {
        let rows = quantities(&both, &instrument.into());
        for (letter, fabric) in [("a", SUITING), ("b", BROADCLOTH)] {
            let out = format!("{instrument}-{letter}");
            work.muslin(&format!("lab {instrument} {fabric} --weft --cells 4 --out {out}")).assert_success();
            let lab: Value = serde_json::from_slice(&work.read(&format!("{out}/lab.json"))).expect("JSON");
            let readings = lab["readings"].as_array().expect("an array");
            assert_eq!(readings.len(), rows.len(), "{instrument}");
            for (row, reading) in rows.iter().zip(readings) {
                assert_eq!([&row["name"], &row["unit"]], [&reading["name"], &reading["unit"]]);
                if reading["input"] == 0.0 {
                    assert_eq!(row[letter], Value::Null);
                    assert_eq!(row["lacking"][letter], "no friction");
                } else {
                    assert_eq!(row[letter], reading["measured"], "{instrument} {fabric}: {}", row["name"]);
                    count += 1;
                }
            }
        }
        for row in &rows {
            let ratio = row["a"].as_f64().zip(row["b"].as_f64()).map(|(a, b)| b / a);
            assert_eq!(row["ratio"].as_f64(), ratio);
        }
    }
    // 16 readings each: the suiting lacks 2HG, 2HG5 and 2HB, the broadcloth 2HG and 2HG5.
    assert_eq!(count, 2 * 16 - 3 - 2);
    let line = |start: &str| outcome.stdout.lines().find(|line| line.trim_start().starts_with(start));
    let line = line("weft  2HB").expect("a line").split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(line.starts_with("weft 2HB width of the loop at 1 /cm no friction 0.12"), "{line}");
    assert!(line.ends_with(" gf cm/cm –"), "{line}");
}

/// By hand from the tables of both fabrics: mass, rigidity, (B / ρ g)^(1/3), and 2HB / 2B.
#[test]
fn fabrics_have_quantities_of_their_own() {
    let work = Work::new();
    work.muslin(&format!("compare {SUITING} {BROADCLOTH} --along warp --cells 4 --out out")).assert_success();
    let values = values(&work, "out");
    let own = quantities(&values, &Value::Null);
    let find = |name: &str| {
        let is_found = |row: &&&Value| row["name"] == name && row["along"] != "weft";
        own.iter().find(is_found).unwrap_or_else(|| panic!("{name}"))
    };
    let close = |value: &Value, exact: f64| (value.as_f64().expect("a number") / exact - 1.0).abs() < 1e-12;
    assert!(close(&find("ρ")["a"], 0.2) && close(&find("ρ")["b"], 0.1238));
    assert!(close(&find("B")["ratio"], 11.572 / 12.0));
    let length = (11.572e-6_f64 / (0.1238 * 9.80665)).cbrt();
    assert!(close(&find("c")["b"], length), "{}", find("c"));
    assert_eq!(find("κ")["lacking"]["a"], "no friction");
    assert!(close(&find("κ")["b"], 1.216e-3 / (2.0 * 11.572e-6)));
    assert!(own.iter().all(|row| row["name"] != "τ" && row["name"] != "k_d"), "what neither has is left out");
    let table = work.text("out/table.csv");
    assert!(
        table.starts_with("instrument,along,name,what,unit,A,B,B / A\n,,ρ,areal density,kg/m²,0.2,0.1238,")
    );
    assert!(table.contains("\nbend,warp,2HB,width of the loop at 1 /cm,N,no friction,"), "{table}");
    assert!(!table.contains(",NaN") && !table.contains(",inf"), "{table}");
}

/// The same fabric, by name and as a file: every ratio is 1, and curves have the same points.
#[test]
fn a_fabric_is_like_itself() {
    let work = Work::new();
    work.write("copy.toml", work.muslin(&format!("fabric show {BROADCLOTH}")).stdout);
    work.muslin(&format!("compare {BROADCLOTH} copy.toml --cells 4 --out out")).assert_success();
    let values = values(&work, "out");
    let quantities = values["quantities"].as_array().expect("an array");
    for quantity in quantities {
        assert_eq!(quantity["a"], quantity["b"]);
        if quantity["a"] != Value::Null {
            assert_eq!(quantity["ratio"], 1.0, "{quantity}");
        }
    }
    assert!(quantities.iter().filter(|quantity| quantity["ratio"] == 1.0).count() > 30);
    let tests = ["tensile-warp", "tensile-weft", "bend-weft", "cantilever-warp", "bias", "picture-frame"];
    for name in tests {
        let text = work.text(&format!("out/{name}.csv"));
        let points = |letter: &str| {
            let lines = text
                .lines()
                .filter_map(|line| line.split_once(',').filter(|(series, _)| series.starts_with(letter)));
            lines.map(|(_, point)| point.to_owned()).collect::<Vec<_>>()
        };
        assert!(9 < points("A ").len() && points("A ") == points("B "), "{name}: {text}");
    }
}

/// What a fabric lacks for an instrument is told where its values would be; the other's values stay.
#[test]
fn what_a_fabric_lacks_is_told() {
    let work = Work::new();
    work.write("limp.toml", LIMP);
    let outcome = work.muslin(&format!("compare limp.toml {SUITING} --along warp --cells 4 --out out"));
    outcome.assert_success();
    let values = values(&work, "out");
    for (instrument, lacking) in [
        ("tensile", "stretches too far"),
        ("bend", "no bending rigidity"),
        ("cantilever", "no bending rigidity"),
    ] {
        for row in quantities(&values, &instrument.into()) {
            assert_eq!(row["a"], Value::Null);
            assert_eq!(row["lacking"]["a"], lacking);
            assert_eq!(row["ratio"], Value::Null);
        }
        assert!(quantities(&values, &instrument.into())[0]["b"].is_f64(), "{instrument}");
    }
    assert!(work.text("out/index.html").contains("<td>no bending rigidity</td>"));
    let outcome = work.muslin("compare limp.toml limp.toml --along warp --cells 4 --out limp");
    outcome.assert_success();
    let line = outcome.stdout.lines().find(|line| line.contains("no result")).expect("a line");
    let words: Vec<&str> = line.split_whitespace().collect();
    assert_eq!(words.join(" "), "warp no result stretches too far stretches too far –");
    assert!(!exists(work.path("limp/bend-warp.svg")) && exists(work.path("limp/shear-warp.svg")));
}

#[test]
fn bad_input_is_told() {
    let work = Work::new();
    let outcome = work.muslin(&format!("compare {SUITING} silk"));
    assert_eq!(outcome.code, Some(2));
    assert!(
        outcome.stderr.starts_with("error: there is no fabric and no file `silk`\n  help: "),
        "{}",
        outcome.stderr
    );
    work.muslin(&format!("compare {SUITING} {BROADCLOTH} --cells 3")).assert_failure(
        2,
        "error: a specimen of 3 cells between its clamps is none: it must have 4 to 100\n  help: choose another number with `--cells N`",
    );
    assert_eq!(work.muslin(&format!("compare {SUITING}")).code, Some(2));
    let film = LIMP.replace("shear = { modulus = 10.0 }", "shear = { modulus = 200.0 }");
    work.write("film.toml", film);
    work.muslin(&format!("compare {SUITING} film.toml --along warp --cells 4")).assert_failure(
        2,
        "error: film, tensile test of KES-FB1 along the warp: no grid can have the fabric's values: its shear modulus is 200 N/m, but must be \
         below 100 N/m, the mean of its least moduli along warp and weft\n  \
         help: check the units of its shear and its tension",
    );
    assert!(!exists(work.path("out/compare-typical-suiting-film")), "nothing is left behind");
}

#[test]
fn folders_are_kept_unless_forced() {
    let work = Work::new();
    let command = format!("compare {SUITING} {BROADCLOTH} --cells 4");
    work.muslin(&format!("{command} --along warp")).assert_success();
    let folder = format!("out/compare-{SUITING}-{BROADCLOTH}");
    let before = work.contents(&folder);
    work.muslin(&command).assert_failure(
        2,
        &format!(
            "error: {folder} exists already and is not empty\n  help: replace its files with `--force`, or choose another folder with `--out DIR`"
        ),
    );
    work.muslin(&format!("{command} --force")).assert_success();
    assert!(exists(work.path(&format!("{folder}/bend-weft.svg"))));
    // What is not measured any more goes.
    work.muslin(&format!("{command} --along warp --force")).assert_success();
    assert!(work.contents(&folder) == before, "the same bits again");
}
