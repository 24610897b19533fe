//! Bad scenes, each with the whole message that a person gets.

use muslin::scene::{MAX_SCENE_BYTES, Position, Scene, set_value};
use proptest::prelude::*;

const BASE: &str = include_str!("scenes/base.toml");
const COMPLETE: &str = include_str!("scenes/complete.toml");

/// One change to the base scene, and what it leads to.
struct Case {
    old: String,
    new: String,
    expected: String,
}

/// Cases from text blocks between blank lines: headings after `#`, removed lines after `-`, added ones after `+`, and
/// below them the message. Changes may be parts of lines.
fn cases() -> Vec<Case> {
    let blocks = include_str!("scenes/errors.txt").split("\n\n");
    blocks
        .map(|block| {
            let lines_after = |mark: char| {
                let lines = block.lines().filter_map(|line| line.strip_prefix(mark));
                lines.map(|line| line.strip_prefix(' ').unwrap_or(line)).collect::<Vec<_>>().join("\n")
            };
            let message = block.lines().filter(|line| !line.starts_with(['#', '-', '+']));
            Case {
                old: lines_after('-'),
                new: lines_after('+'),
                expected: message.collect::<Vec<_>>().join("\n"),
            }
        })
        .collect()
}

fn rendered(text: &str) -> String {
    match Scene::parse(text) {
        Ok(_) => panic!("accepted:\n{text}"),
        Err(error) => error.render("scene.toml", text),
    }
}

#[test]
fn every_bad_scene_has_its_message() {
    Scene::parse(BASE).expect("the base scene is good");
    let cases = cases();
    assert!(80 <= cases.len(), "only {} cases were read", cases.len());
    let mut failures = Vec::new();
    for Case { old, new, expected } in cases {
        assert!(BASE.contains(&old), "the base scene has no\n{old}");
        let actual = rendered(&BASE.replacen(&old, &new, 1));
        if actual != expected {
            failures.push(format!("- {old}\n+ {new}\nexpected:\n{expected}\nactual:\n{actual}\n"));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn a_scene_without_cloths_has_its_message() {
    let cloths = BASE.find("[[cloth]]").expect("the base scene has a cloth");
    let text = format!("cloth = []\n{}", &BASE[..cloths]);
    assert_eq!(
        rendered(&text),
        "\
error: `cloth.0` is missing
 --> scene.toml:1:9
  |
1 | cloth = []
  |         ^^
  = help: add a table `[[cloth]]` with name, fabric, grid and place"
    );
}

#[test]
fn an_empty_text_has_its_message() {
    for text in ["", "\n", " \t\r\n", "# a comment\n", "\u{feff}"] {
        assert_eq!(
            rendered(text),
            "\
error: the scene is empty
 --> scene.toml
  = help: start from a scene that `muslin new` prints"
        );
    }
}

#[test]
fn a_text_above_the_limit_has_its_message() {
    let longest = format!("{BASE}#{}", " ".repeat(MAX_SCENE_BYTES - BASE.len() - 1));
    assert_eq!(longest.len(), MAX_SCENE_BYTES);
    Scene::parse(&longest).expect("the longest text is read");
    set_value(&longest, "run.duration=1.0").expect("the longest text is read");
    let expected = "\
error: the scene is 1048577 bytes long, but must be at most 1048576 bytes
 --> scene.toml
  = help: a scene describes a run, it does not hold data";
    let longer = format!("{longest} ");
    assert_eq!(rendered(&longer), expected);
    let error = set_value(&longer, "run.duration=1.0").expect_err("the text is too long");
    assert_eq!(error.render("scene.toml", &longer), expected);
}

#[test]
fn deep_nesting_has_its_message() {
    let text = format!("a = {}", "[".repeat(100_000));
    assert_eq!(
        rendered(&text),
        format!(
            "\
error: the text is not TOML: cannot recurse further; max recursion depth met
 --> scene.toml:1:85
  |
1 | a = {}...
  | {}^
  = help: no part of a scene is nested that deeply",
            "[".repeat(96),
            " ".repeat(84),
        ),
    );
    let text = format!("{} = 1", vec!["a"; 100].join("."));
    assert_eq!(
        rendered(&text),
        "\
error: the text is not TOML: recursion limit
 --> scene.toml
  = help: no part of a scene is nested that deeply"
    );
}

#[test]
fn binary_data_has_its_message() {
    let text = String::from_utf8_lossy(b"\x89PNG\r\n\x1a\n\0\0").into_owned();
    assert_eq!(
        rendered(&text),
        "\
error: the text is not TOML: key with no value, expected `=`
 --> scene.toml:1:5
  |
1 | \u{fffd}PNG
  |     ^
  = help: tables are `[name]`, values `key = 1.0`, texts in quotes; see https://toml.io"
    );
}

#[test]
fn a_name_of_many_characters_is_cut() {
    let text = BASE.replace("fabric = \"paper\"", &format!("fabric = \"{}\"", "é".repeat(10_000)));
    let message = Scene::parse(&text).expect_err("no such fabric").to_string();
    assert_eq!(
        message,
        format!("`cloth.0.fabric` is \"{}...\", but no fabric has that name", "é".repeat(60))
    );
}

#[test]
fn many_names_are_counted_rather_than_listed() {
    let fabric =
        &BASE[BASE.find("[fabric.paper]").expect("a fabric")..BASE.find("[[cloth]]").expect("a cloth")];
    let fabrics: String = (0..100).map(|n| fabric.replace("paper", &format!("paper-{n:02}"))).collect();
    let error = Scene::parse(&BASE.replace(fabric, &fabrics)).expect_err("no such fabric");
    let listed: Vec<String> = (0..12).map(|n| format!("\"paper-{n:02}\"")).collect();
    assert_eq!(error.help(), Some(format!("valid names: {} and 88 more", listed.join(", "))));
}

#[test]
fn columns_are_counted_in_characters() {
    let text = format!("\u{feff}{}", BASE.replace("\"sheet\"", "\"布\"").replace("fabric = \"paper\"\n", ""));
    let text = text.replace("pins = [", "pins = [{ column = 0, row = 0, 'é' = 1 }, ").replace('\n', "\r\n");
    let text = text.replace("name = \"布\"", "name = \"布\"\r\nfabric = \"paper\"");
    let error = Scene::parse(&text).expect_err("an unknown key");
    assert_eq!(error.to_string(), "unknown key `\"é\"` in `cloth.0.pins.0`");
    assert_eq!(error.position(), Some(Position { line: 31, column: 32, length: 3 }));
}

/// Values that are whole or perpendicular but for rounding are accepted and give the same run.
#[test]
fn rounding_is_accepted() {
    for (old, new) in [
        ("constant = 1e-3", "constant = 1.0000000005e-3"),
        ("duration = 0.5", "duration = 0.50000000025"),
        ("height_axis = [0, 0, 1]", "height_axis = [5e-10, 0, 1]"),
        ("rows = 8, width = 1.0, height = 0.8", "rows = 1, width = 1.0"),
        ("pins = [", "pins = [{ column = -10, row = -8 }, { column = 9, row = 7 }, "),
    ] {
        let scene = Scene::parse(&BASE.replace(old, new)).unwrap_or_else(|error| panic!("{new}: {error}"));
        assert_eq!(scene.run(), Scene::parse(BASE).expect("the base scene is good").run());
    }
}

/// Particles count over all cloths.
#[test]
fn cloths_together_stay_below_the_limit() {
    let cloth = &BASE[BASE.find("[[cloth]]").expect("a cloth")..BASE.find("[expect]").expect("the end")];
    let large = cloth.replace("columns = 10, rows = 8", "columns = 65536, rows = 16384");
    let text = BASE.replace(cloth, &format!("{large}{}", large.replace("sheet", "second")));
    Scene::parse(&text).expect("2^31 particles are allowed");
    let error =
        Scene::parse(&text.replace("[expect]", &format!("{}[expect]", cloth.replace("sheet", "third"))));
    assert_eq!(
        error.expect_err("80 particles too many").to_string(),
        "`cloth.2.grid` has 10 x 8 particles, but all cloths together must have at most 2147483648"
    );
}

/// The numbers among the words of a help line.
fn named_numbers(help: &str) -> Vec<f64> {
    help.split_whitespace().filter_map(|word| word.parse().ok()).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    /// The step that an error names is accepted, whatever the step and the frame rate.
    #[test]
    fn the_named_step_is_accepted(
        (step, step_exponent) in (1.0..10.0_f64, -9..1_i32),
        (digits, exponent) in (1.0..10.0_f64, -3..4_i32),
    ) {
        let step = step * 10.0_f64.powi(step_exponent);
        let frame_rate = digits * 10.0_f64.powi(exponent);
        let scene = |step: &str| BASE
            .replace("constant = 1e-3", &format!("constant = {step}"))
            .replace("frame_rate = 50.0", &format!("frame_rate = {frame_rate:?}"))
            .replace("duration = 0.5", &format!("duration = {:?}", 3.0 / frame_rate));
        if let Err(error) = Scene::parse(&scene(&format!("{step:?}"))) {
            let help = error.help().expect("there is a way out");
            prop_assume!(!help.starts_with("raise"));
            let named = help.strip_prefix("the nearest step that does is ").and_then(|rest| rest.strip_suffix(" s"));
            let named = named.unwrap_or_else(|| panic!("{error}\n{help}"));
            prop_assert!(Scene::parse(&scene(named)).is_ok(), "{} is not accepted", named);
            // No other step is nearer: its neighbours are at least half a gap away.
            let interval = 1.0 / frame_rate;
            let steps = (interval / named.parse::<f64>().expect("a number")).round();
            let distance = (interval / steps - step).abs();
            for other in [steps - 1.0, steps + 1.0].into_iter().filter(|count| 1.0 <= *count) {
                prop_assert!(distance <= (interval / other - step).abs() * (1.0 + 1e-9));
            }
        }
    }

    /// So are the durations, and the one asked for lies between them.
    #[test]
    fn the_named_durations_are_accepted(frames in 0.01..1e5_f64, exponent in -3..4_i32, digits in 1.0..10.0_f64) {
        let frame_rate = digits * 10.0_f64.powi(exponent);
        let duration = frames / frame_rate;
        let scene = |duration: f64| BASE
            .replace("constant = 1e-3", &format!("constant = {:?}", 0.25 / frame_rate))
            .replace("frame_rate = 50.0", &format!("frame_rate = {frame_rate:?}"))
            .replace("duration = 0.5", &format!("duration = {duration:?}"));
        if let Err(error) = Scene::parse(&scene(duration)) {
            let help = error.help().expect("there is a way out");
            let named = named_numbers(&help);
            prop_assert_eq!(named.len(), if frames < 1.0 { 1 } else { 2 }, "{}", help);
            prop_assert!(frames < 1.0 || named[0] < duration);
            prop_assert!(duration < named[named.len() - 1]);
            for named in named {
                let scene = Scene::parse(&scene(named));
                prop_assert!(scene.is_ok(), "{} is not accepted", named);
            }
        }
    }

    /// Any text is read or rejected with a message that shows its place.
    #[test]
    fn no_text_panics(text in "\\PC{0,200}|[a-z0-9_.=\"'\\[\\]{}, #\n\r\t-]{0,200}") {
        check_rejection(&text);
    }

    /// A good scene with pieces removed, repeated, exchanged or overwritten.
    #[test]
    fn no_mutation_of_a_good_scene_panics(
        edits in proptest::collection::vec((0.0..1.0_f64, 0.0..1.0_f64, 0..40_usize, 0..5_usize), 1..6),
        inserted in "nan|-inf|-1|0|1e999|99999999999999999999|\\[|\\]|\\{|\\}|\"|=|\\.|\n|布|[a-z_-]{1,9}|[ -~]{1,9}",
    ) {
        let mut characters: Vec<char> = COMPLETE.chars().collect();
        for (from, to, length, kind) in edits {
            let place = |fraction: f64| (fraction * characters.len() as f64) as usize;
            let (from, to) = (place(from), place(to));
            let piece: Vec<char> = characters.iter().copied().skip(from).take(length).collect();
            let from_end = from + piece.len();
            match kind {
                0 => drop(characters.splice(from..from_end, [])),
                1 => drop(characters.splice(to..to, piece)),
                2 => drop(characters.splice(from..from_end, inserted.chars())),
                3 => drop(characters.splice(from..from, inserted.chars())),
                _ => characters.truncate(to.max(1)),
            }
        }
        check_rejection(&characters.into_iter().collect::<String>());
    }

    /// Any assignment to a good scene gives a text that is read or rejected.
    #[test]
    fn no_assignment_to_a_good_scene_panics(
        key in "(title|run|environment|fabric|cloth|expect|[01]|paper|grid|pins|step|x|\\.){1,6}(\\.[a-z_]{1,9})?",
        value in "nan|-1|0|1e999|true|\\{\\}|\\[\\]|\\{ a = 1 \\}|\\[\\{ a = 1 \\}\\]|[ -~]{0,9}",
    ) {
        if let Ok(text) = set_value(COMPLETE, &format!("{key}={value}")) {
            let parsed = check_rejection(&text);
            prop_assert!(!parsed.is_some_and(|error| error.contains("not TOML")), "{}", text);
        }
    }
}

/// Parses and, if the text is rejected, checks the form of the error, whose message it returns.
fn check_rejection(text: &str) -> Option<String> {
    let error = Scene::parse(text).err()?;
    let message = error.to_string();
    assert!(!message.contains('\n') && !message.ends_with('.'), "{message}");
    let rendered = error.render("scene.toml", text);
    assert!(rendered.starts_with(&format!("error: {message}\n")), "{rendered}");
    if let Some(Position { line, column, length }) = error.position() {
        assert!(rendered.contains(&format!("scene.toml:{line}:{column}\n")), "{rendered}");
        assert!(rendered.contains('^') && 1 <= length, "{rendered}");
        assert!(line <= text.split('\n').count());
    }
    Some(message)
}
