//! `muslin check`, `new`, `schema` and `view`, and how progress is shown.

use serde_json::Value;

use crate::work::{Work, exists};

const NAMES: [&str; 8] =
    ["hanging", "hanging-tangent", "hanging-100", "flag", "flag-flutter", "free-fall", "wool", "pendulum"];

#[test]
fn check_tells_what_a_run_would_be() {
    let work = Work::with_scene(&[]);
    let outcome = work.muslin("check scene.toml");
    outcome.assert_success();
    let lines: Vec<&str> = outcome.stdout.lines().collect();
    let (constant, measured) = lines.split_at(lines.len() - 2);
    assert_eq!(
        constant.join("\n"),
        "\
Small cloth
  cloth `sheet`: 5 x 4 particles, 0.400 kg together
  particles            20, 2 of them pinned
  structural springs   31
  shear springs        24
  bend springs         22
  step                 5.00 ms (5.000000000000e-3 s), 100 of them
  largest stable step  30.1 ms in the initial shape
  stable for certain   19.7 ms (Gershgorin)
  suggested            step = { constant = 2.500000000000e-2 }, or \"adaptive\""
    );
    assert!(measured[0].starts_with("  estimated cost       "), "{}", measured[0]);
    // 11 frames of 20 particles with positions and velocities of 24 bytes each.
    assert_eq!(measured[1], "  estimated size       0.0106 MB for trajectory.npz");
    assert_eq!(work.names("."), ["scene.toml"]);
}

#[test]
fn check_tells_the_rule_of_the_step_and_warns() {
    let limit = "drag = 0.01\nlimit = { kind = \"cut-off\", strain = 0.1 }";
    let work = Work::with_scene(&[("{ constant = 5e-3 }", "{ tolerance = 1e-4 }"), ("drag = 0.01", limit)]);
    let outcome = work.muslin("check scene.toml");
    outcome.assert_success();
    let line = |start: &str| outcome.stdout.lines().find(|line| line.starts_with(start)).expect(start);
    let step = line("  step  ");
    assert!(step.ends_with(" in the initial shape, or less for a tolerance of 0.0001 m"), "{step}");
    let cost = line("  estimated cost  ");
    assert!(cost.ends_with(", more if springs stiffen or the tolerance asks for it"), "{cost}");
    assert!(
        line("warning: ").starts_with("warning: `fabric.plain.limit` shortens springs"),
        "{}",
        outcome.stdout
    );
    assert!(!outcome.stdout.contains("suggested"), "{}", outcome.stdout);
}

#[test]
fn every_new_scene_runs() {
    let work = Work::new();
    let list = work.muslin("new");
    list.assert_success();
    for name in NAMES {
        assert!(list.stdout.lines().any(|line| line.split_whitespace().next() == Some(name)), "{name}");
        let outcome = work.muslin(&format!("new {name}"));
        outcome.assert_success();
        assert_eq!(outcome.stdout, work.muslin(&format!("new {name}.toml")).stdout);
        work.write("scene.toml", &outcome.stdout);
        work.muslin("check scene.toml").assert_success();
        // Two frames show that it runs; what it expects holds at its own end only.
        let text = outcome.stdout.split("[expect]").next().unwrap_or_default();
        work.write("scene.toml", text);
        let frame_rate: f64 = {
            let line = text.lines().find(|line| line.starts_with("frame_rate")).expect("a frame rate");
            line.split(['=', '#']).nth(1).and_then(|value| value.trim().parse().ok()).expect("a number")
        };
        let arguments = format!("run scene.toml --out {name} --set run.duration={:?}", 2.0 / frame_rate);
        work.muslin(&arguments).assert_success();
    }
    work.muslin("new curtain").assert_failure(
        2,
        "error: there is no scene `curtain` to start from\n  help: scenes: hanging, hanging-tangent, hanging-100, flag, flag-flutter, free-fall, \
         wool, pendulum",
    );
}

#[test]
fn the_schema_is_json() {
    let outcome = Work::new().muslin("schema");
    outcome.assert_success();
    let schema: Value = serde_json::from_str(&outcome.stdout).expect("JSON");
    assert_eq!(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
}

#[test]
fn view_needs_a_page() {
    let work = Work::new();
    work.muslin("view nowhere")
        .assert_failure(2, "error: nowhere has no view.html\n  help: name a folder that `muslin run` wrote");
    assert!(!exists(work.path("nowhere")));
}

/// The first line of progress that a run draws on a terminal of so many `columns`.
///
/// `script` of util-linux gives the command a terminal; where there is none, the unit tests of progress must do.
#[cfg(target_os = "linux")]
fn drawn_bar(columns: usize) -> Option<String> {
    use std::process::Command;
    for duration in ["100.0", "1000.0", "10000.0"] {
        let work = Work::with_scene(&[("duration = 0.5", &format!("duration = {duration}"))]);
        let run = format!("stty rows 24 cols {columns}; '{}' run scene.toml", env!("CARGO_BIN_EXE_muslin"));
        let mut script = Command::new("script");
        script.args(["-qec", &run, "/dev/null"]).current_dir(work.path("."));
        let output = script.env("TERM", "xterm").output().ok()?;
        let text = String::from_utf8(output.stdout).expect("UTF-8");
        assert_eq!(output.status.code(), Some(0), "{text}");
        // A run that ends within a tenth of a second shows none.
        if let Some(line) = text.split('\r').find(|line| line.contains(&format!("/{duration}0 s"))) {
            return Some(line.replace("\u{1b}[2K", ""));
        }
    }
    panic!("no run was long enough");
}

#[cfg(target_os = "linux")]
#[test]
fn a_terminal_shows_a_bar() {
    let Some(line) = drawn_bar(120) else { return };
    for part in [" s  step 5.00 ms  ", "x real time  ", " left"] {
        assert!(line.contains(part), "{line}");
    }
    assert!(line.contains('█') || line.contains('░'), "{line}");
}

/// What is longer would be wrapped, and a wrapped line cannot be drawn anew.
#[cfg(target_os = "linux")]
#[test]
fn a_narrow_terminal_cuts_the_bar_off() {
    let Some(line) = drawn_bar(30) else { return };
    let width = line.trim_end_matches('\n').chars().filter(|letter| !letter.is_control()).count();
    assert!(width <= 30, "{width} characters: {line:?}");
}

/// What is shown is a table that a scene can have in place of the name.
#[test]
fn fabrics_are_listed_and_shown() {
    let work = Work::new();
    let list = work.muslin("fabric list");
    list.assert_success();
    let names: Vec<&str> = list.stdout.lines().map_while(|line| line.split_whitespace().next()).collect();
    assert!(5 <= names.len(), "{}", list.stdout);
    for name in names {
        let shown = work.muslin(&format!("fabric show {name}"));
        shown.assert_success();
        assert!(shown.stdout.contains("# Source") && shown.stdout.contains("largest stable step"), "{name}");
        let scene = |fabric: &str| {
            format!(
                "title = \"sheet\"\nrun = {{ duration = 0.1 }}\nenvironment = {{ gravity = [0, -9.81, 0] }}\n{fabric}\n\
                 [[cloth]]\nname = \"sheet\"\nfabric = \"{name}\"\n\
                 grid = {{ columns = 5, rows = 5, width = 0.2, height = 0.2 }}\n\
                 place = {{ origin = [0, 1, 0], width_axis = [1, 0, 0], height_axis = [0, 0, 1] }}\n"
            )
        };
        work.write("copied.toml", scene(&shown.stdout));
        work.write("named.toml", scene(&format!("[fabric.{name}]\nkind = \"library\"\nname = \"{name}\"")));
        let [copied, named] = ["copied", "named"].map(|scene| {
            let outcome = work.muslin(&format!("check {scene}.toml"));
            outcome.assert_success();
            let lines = outcome.stdout.lines().filter(|line| !line.contains("estimated cost"));
            lines.map(str::to_owned).collect::<Vec<_>>()
        });
        assert_eq!(copied, named);
    }
    let outcome = work.muslin("fabric show cotton");
    outcome.assert_failure(
        2,
        "error: there is no fabric `cotton`\n  help: fabrics: nylon-heat-bondable, \
         typical-cotton-broadcloth, typical-cotton-shirting, typical-denim, \
         typical-polyester-cotton-twill, typical-polyester-faille, typical-polyester-plain, \
         typical-polyester-tropical, typical-silk, typical-stretch-twill, typical-suiting, \
         typical-wool-lycra, typical-wool-plain, typical-wool-tropical",
    );
}

/// Of invented numbers: what is printed is a table that a scene can have.
#[test]
fn a_material_file_becomes_a_fabric() {
    let work = Work::new();
    let row = "[100, 5, 300, 40]";
    let material = format!(
        "{{\"density\": 0.2, \"stretching\": [{}], \"bending\": [{}]}}",
        [row; 6].join(", "),
        ["[8e-5, 8e-5, 8e-5, 8e-5, 8e-5]"; 3].join(", ")
    );
    work.write("cloth.json", &material);
    let outcome = work.muslin("fabric import cloth.json --name cotton");
    outcome.assert_success();
    for line in [
        "[fabric.cotton]",
        "warp = { modulus = 600.0 }",
        "weft = { modulus = 200.0 }",
        "#   bending rigidity       20.0 µN m along warp, 20.0 along weft, 20.0 at 45°",
    ] {
        assert!(outcome.stdout.lines().any(|found| found.starts_with(line)), "{line}: {}", outcome.stdout);
    }
    let scene = format!(
        "title = \"sheet\"\nrun = {{ duration = 0.1 }}\nenvironment = {{ gravity = [0, -9.81, 0] }}\n{}\n\
         [[cloth]]\nname = \"sheet\"\nfabric = \"cotton\"\n\
         grid = {{ columns = 5, rows = 5, width = 0.2, height = 0.2 }}\n\
         place = {{ origin = [0, 1, 0], width_axis = [1, 0, 0], height_axis = [0, 0, 1] }}\n",
        outcome.stdout
    );
    work.write("scene.toml", scene);
    let check = work.muslin("check scene.toml");
    check.assert_success();
    for line in ["  fabric `cotton`", "    bending rigidity   20.0 µN m", "    bending length     21.7 mm"] {
        assert!(check.stdout.lines().any(|found| found.starts_with(line)), "{line}: {}", check.stdout);
    }
    work.write("cloth.json", material.replace("\"density\": 0.2, ", ""));
    work.muslin("fabric import cloth.json").assert_failure(
        2,
        "error: cloth.json: `density` is missing\n  help: see `muslin fabric import --help` for what it must have",
    );
}
