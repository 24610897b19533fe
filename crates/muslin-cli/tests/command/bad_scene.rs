//! Scenes and arguments that cannot be used: exit code 2, the whole message, nothing written.

use std::fs::File;

use crate::work::{Outcome, Work, scene};

const SCENE_HELP: &str =
    "  help: name a scene file such as scenes/hanging.toml, or print one with `muslin new hanging`";

#[test]
fn a_missing_scene_file() {
    Work::new().muslin("run nowhere/scene.toml").assert_failure(
        2,
        &format!("error: nowhere/scene.toml could not be read: no such file or directory\n{SCENE_HELP}"),
    );
}

#[test]
fn a_folder_instead_of_a_scene_file() {
    Work::new()
        .muslin("run .")
        .assert_failure(2, &format!("error: . is a folder, not a scene file\n{SCENE_HELP}"));
}

#[test]
fn a_file_that_is_not_utf8() {
    let work = Work::new();
    work.write("scene.toml", b"# a comment\ntitle = \"\xe9t\xe9\"\n");
    work.muslin("run scene.toml").assert_failure(
        2,
        "error: scene.toml:2 is not UTF-8 text (byte 21 of the file)\n  help: save the file as UTF-8",
    );
}

/// With less memory than the file would take.
#[cfg(target_os = "linux")]
#[test]
fn a_file_of_100_megabytes() {
    let work = Work::new();
    let file = File::create(work.path("scene.toml")).expect("a file");
    file.set_len(100_000_000).expect("a sparse file");
    let outcome = Outcome::of(&mut work.shell("ulimit -v 65536; exec \"$@\"", ["run", "scene.toml"]));
    outcome.assert_failure(
        2,
        &format!("error: scene.toml is larger than 1 MiB, so it is no scene file\n{SCENE_HELP}"),
    );
}

/// What is wrong in a scene: replaced and new piece, and the message.
const BAD_SCENES: [(&str, &str, &str); 10] = [
    (
        "[run]",
        "[run",
        "\
error: the text is not TOML: unclosed table, expected `]`
 --> scene.toml:3:5
  |
3 | [run
  |     ^
  = help: tables are `[name]`, values `key = 1.0`, texts in quotes; see https://toml.io",
    ),
    (
        "duration",
        "durration",
        "\
error: unknown key `durration` in `run`
 --> scene.toml:4:1
  |
4 | durration = 0.5
  | ^^^^^^^^^
  = help: did you mean `duration`? valid keys: duration, frame_rate, method, step, start, seed, allow-unstable",
    ),
    (
        "drag = 0.01\n",
        "",
        "\
error: `fabric.plain.drag` [kg/s] is missing
  --> scene.toml:11:1
   |
11 | [fabric.plain]
   | ^^^^^^^^^^^^^^
   = help: write `drag = ...`",
    ),
    (
        "particle_mass = 0.02",
        "particle_mass = \"20 g\"",
        "\
error: `fabric.plain.particle_mass` is a string, but must be a number [kg]
  --> scene.toml:13:17
   |
13 | particle_mass = \"20 g\"
   |                 ^^^^^^",
    ),
    (
        "particle_mass = 0.02",
        "particle_mass = -0.02",
        "\
error: `fabric.plain.particle_mass` is -0.02 kg, but must be positive
  --> scene.toml:13:17
   |
13 | particle_mass = -0.02
   |                 ^^^^^",
    ),
    (
        "-9.81",
        "nan",
        "\
error: `environment.gravity.1` is nan m/s^2, but must be finite
 --> scene.toml:9:17
  |
9 | gravity = [0.0, nan, 0.0]
  |                 ^^^",
    ),
    (
        "columns = 5",
        "columns = 0",
        "\
error: `cloth.0.grid.columns` is 0, but must be at least 1
  --> scene.toml:22:20
   |
22 | grid = { columns = 0, rows = 4, width = 1.0, height = 0.75 }
   |                    ^",
    ),
    (
        "{ column = -1, row = 0 }",
        "{ column = 5, row = 0 }",
        "\
error: `cloth.0.pins.1.column` is 5, but must be from 0 to 4 or from -5 to -1
  --> scene.toml:24:45
   |
24 | pins = [{ column = 0, row = 0 }, { column = 5, row = 0 }]
   |                                             ^
   = help: the grid has 5 columns; negative indices count from the end",
    ),
    (
        "duration = 0.5",
        "duration = 0.52",
        "\
error: `run.duration` is 0.52 s, which is 10.4 frames at 20.0 frames per second, but must be a whole number of frames
 --> scene.toml:4:12
  |
4 | duration = 0.52
  |            ^^^^
  = help: the nearest possible durations are 0.5 and 0.55 s",
    ),
    (
        "constant = 5e-3",
        "constant = 0.004",
        "\
error: `run.step.constant` is 0.004 s, which gives 12.5 steps from frame to frame at 20.0 frames per second, but must \
give a whole number
 --> scene.toml:6:21
  |
6 | step = { constant = 0.004 }
  |                     ^^^^^
  = help: the nearest step that does is 0.00384615385 s",
    ),
];

#[test]
fn a_scene_that_breaks_a_rule() {
    for (old, new, message) in BAD_SCENES {
        let work = Work::with_scene(&[(old, new)]);
        for command in ["run", "check"] {
            work.muslin(&format!("{command} scene.toml")).assert_failure(2, message);
        }
        assert_eq!(work.names("."), ["scene.toml"]);
    }
}

#[test]
fn an_empty_scene() {
    let work = Work::new();
    work.write("scene.toml", "");
    work.muslin("run scene.toml").assert_failure(
        2,
        "error: the scene is empty\n --> scene.toml\n  = help: start from a scene that `muslin new` prints",
    );
}

/// The message names the largest stable step and one to write instead, which is then accepted.
#[test]
fn a_step_larger_than_stable() {
    let work = Work::with_scene(&[("constant = 5e-3", "constant = 50e-3")]);
    let outcome = work.muslin("run scene.toml");
    outcome.assert_failure(
        2,
        "\
error: `run.step.constant` is 5.000000e-2 s, but the largest stable step of this scene is 3.012144e-2 s
  help: leave `step` out, so that it is adaptive, take `step = { constant = 2.500000000000e-2 }`, or try it all the same with `--set run.allow-unstable=true`",
    );
    assert_eq!(work.names("."), ["scene.toml"]);
    let suggestion = outcome.stderr.split('`').find_map(|part| part.strip_prefix("step = "));
    let suggestion = suggestion.expect("a step between backticks");
    work.write("scene.toml", scene(&[("{ constant = 5e-3 }", suggestion)]));
    work.muslin("run scene.toml").assert_success();
}

#[test]
fn a_bad_assignment() {
    let work = Work::with_scene(&[]);
    let value_help = "write a TOML value: 1.0, true, \"text\", [0, 1, 0] or { constant = 1e-3 }";
    let cases = [
        ("run.duration", "it has no `=`", "write `run.duration=1.0`"),
        ("=1.0", "it has no key", "write `run.duration=1.0`"),
        ("run.duration=", "it has no value", value_help),
        ("run.duration=1.0s", "its value is not TOML: invalid float, expected nothing", value_help),
        (
            "cloth.1.name=x",
            "`cloth` has 1 elements, so that 1 is beyond its last index",
            "see the scene for its keys and the number of its elements",
        ),
    ];
    for (assignment, reason, help) in cases {
        work.muslin(&format!("run scene.toml --set {assignment}")).assert_failure(
            2,
            &format!(
                "error: cannot set \"{assignment}\": {reason}\n --> --set {assignment}\n  = help: {help}"
            ),
        );
    }
    let cases = [
        (
            "run.durration=1.0",
            "\
error: unknown key `durration` in `run`
 --> scene.toml (with --set):7:1
  |
7 | durration = 1.0
  | ^^^^^^^^^
  = help: did you mean `duration`? valid keys: duration, frame_rate, method, step, start, seed, allow-unstable",
        ),
        (
            "run.duration=one",
            "\
error: `run.duration` is a string, but must be a number [s]
 --> scene.toml (with --set):4:12
  |
4 | duration = \"one\"
  |            ^^^^^",
        ),
    ];
    for (assignment, message) in cases {
        work.muslin(&format!("run scene.toml --set {assignment}")).assert_failure(2, message);
    }
    assert_eq!(work.names("."), ["scene.toml"]);
}

#[test]
fn bad_arguments() {
    let work = Work::with_scene(&[]);
    for threads in ["0", "1025", "-1", "two"] {
        work.muslin(&format!("run scene.toml --threads={threads}")).assert_failure(
            2,
            &format!(
                "error: invalid value '{threads}' for '--threads <N>': must be a whole number from 1 to 1024\n\n\
                 For more information, try '--help'."
            ),
        );
    }
    work.muslin("simulate scene.toml").assert_failure(
        2,
        "error: unrecognized subcommand 'simulate'\n\nUsage: muslin <COMMAND>\n\n\
         For more information, try '--help'.",
    );
    work.muslin("scene.toml").assert_failure(
        2,
        "error: unrecognized subcommand 'scene.toml'\n\n  tip: to simulate a scene, write `muslin run scene.toml`\n\n\
         Usage: muslin <COMMAND>\n\nFor more information, try '--help'.",
    );
    work.muslin("run").assert_failure(
        2,
        "error: the following required arguments were not provided:\n  <SCENE>\n\nUsage: muslin run <SCENE>\n\n\
         For more information, try '--help'.",
    );
    work.muslin("run scene.toml --resume --force").assert_failure(
        2,
        "error: the argument '--resume' cannot be used with '--force'\n\nUsage: muslin run --resume <SCENE>\n\n\
         For more information, try '--help'.",
    );
    assert_eq!(work.names("."), ["scene.toml"]);
}
