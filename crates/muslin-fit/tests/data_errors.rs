//! Bad data, each with the whole message that a person gets.

use muslin_fit::{FabricFit, FabricText, Label, Measurement};
use proptest::prelude::*;

/// One file, and what it leads to.
struct Case {
    label: String,
    text: String,
    expected: String,
}

/// Cases from text blocks between blank lines: headings after `#`, the label after `=`, lines of the file after `|`, and below
/// them the message.
fn cases() -> Vec<Case> {
    let blocks = include_str!("data_errors.txt").split("\n\n");
    blocks
        .map(|block| {
            let lines_after = |mark: char| {
                let lines = block.lines().filter_map(|line| line.strip_prefix(mark));
                lines.map(|line| line.strip_prefix(' ').unwrap_or(line)).collect::<Vec<_>>()
            };
            let message = block.lines().filter(|line| !line.starts_with(['#', '=', '|']));
            Case {
                label: lines_after('=').join("\n"),
                text: lines_after('|').iter().map(|line| format!("{line}\n")).collect(),
                expected: message.collect::<Vec<_>>().join("\n").trim_end().to_owned(),
            }
        })
        .collect()
}

/// The message of a file called `data.csv` that `text` stands in.
fn rendered(label: &str, text: &str) -> String {
    let label = if label.is_empty() { Ok(Label::default()) } else { Label::parse(label) };
    let measured = label.and_then(|label| Measurement::read("data.csv", text.as_bytes(), label));
    match measured.and_then(|measurement| FabricFit::new(0.2, &[measurement])) {
        Ok(_) => panic!("accepted:\n{text}"),
        Err(error) => error.render(),
    }
}

#[test]
fn every_bad_file_has_its_message() {
    let cases = cases();
    assert!(30 <= cases.len(), "only {} cases were read", cases.len());
    let mut failures = Vec::new();
    for Case { label, text, expected } in cases {
        let actual = rendered(&label, &text);
        if actual != expected {
            failures.push(format!("= {label}\n{text}expected:\n{expected}\nactual:\n{actual}\n"));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn a_file_that_is_not_utf8_has_its_message() {
    let label = Label::parse("warp").expect("a label");
    let error = Measurement::read("data.csv", b"strain [%],tension [N/m]\n0,\xff\n", label);
    assert_eq!(
        error.expect_err("no text").render(),
        "error: `data.csv` line 2: is not UTF-8 text (byte 27 of the file)\n \
         --> data.csv:2:3\n  |\n2 | 0,\u{fffd}\n  |   ^\n  = help: save the file as CSV in UTF-8"
    );
}

#[test]
fn two_files_of_one_test_have_their_message() {
    let label = Label::parse("warp").expect("a label");
    let read = |file| Measurement::read(file, b"bending_length [mm]\n20\n", label).expect("a measurement");
    let error = FabricFit::new(0.2, &[read("a.csv"), read("b.csv")]).expect_err("twice");
    assert_eq!(
        error.render(),
        "error: `a.csv` and `b.csv` both hold a cantilever test along the warp\n  \
         help: fit each specimen by itself, or give one file of the mean curve"
    );
}

/// Headers of all kinds of tables, each with a label.
const HEADERS: [(&str, &str); 8] = [
    ("warp", "strain [%],tension [gf/cm]"),
    ("warp", "emt [%],lt [1],force [gf/cm]"),
    ("shear", "angle [deg],force [gf/cm]"),
    ("shear", "g [gf/(cm deg)]"),
    ("weft", "curvature [1/cm],moment [gf cm/cm]"),
    ("weft", "b [gf cm^2/cm]"),
    ("bias", "overhang [mm],angle [deg]"),
    ("bias", "bending_length [mm]"),
];

/// A file of some kind whose rows have as many numbers as its header.
fn any_file() -> impl Strategy<Value = (&'static str, String)> {
    let number = prop_oneof![
        80 => (0.5..15.0).prop_map(|number: f64| format!("{number:.2}")),
        3 => (-9.0..0.0).prop_map(|number: f64| format!("{number:.2}")),
        6 => Just("0".to_owned()),
        1 => any::<f64>().prop_map(|number| format!("{number:?}")),
    ];
    let rows = prop::collection::vec([number.clone(), number.clone(), number], 0..30);
    (prop::sample::select(&HEADERS[..]), rows, any::<bool>()).prop_map(
        |((label, header), mut rows, is_sorted)| {
            if is_sorted {
                let value = |text: &String| text.parse().unwrap_or(0.0_f64);
                rows.sort_by(|a, b| value(&a[0]).total_cmp(&value(&b[0])));
            }
            let columns = header.split(',').count();
            let rows = rows.iter().map(|row| format!("{}\n", row[..columns].join(",")));
            (label, format!("{header}\n{}", rows.collect::<String>()))
        },
    )
}

proptest! {
    /// Whatever a file holds, it is fitted or has a message, and what is fitted has numbers alone.
    #[test]
    fn no_file_panics((label, text) in any_file()) {
        let label = Label::parse(label).expect("a label");
        let measured = Measurement::read("data.csv", text.as_bytes(), label);
        match measured.and_then(|measurement| FabricFit::new(0.2, &[measurement])) {
            Err(error) => prop_assert!(error.render().contains("help: ")),
            Ok(fit) => {
                let toml = FabricText::new(&fit, "cloth", "given").toml;
                let values = toml.lines().filter_map(|line| line.split('#').next());
                for value in values {
                    prop_assert!(!value.contains("NaN") && !value.contains("inf"), "{toml}");
                }
            }
        }
    }

    /// Nor does any text, whatever its header.
    #[test]
    fn no_text_panics(text in "[a-z0-9 ,;\\[\\]%/.#:\n-]{0,200}") {
        let measured = Measurement::read("data.csv", text.as_bytes(), Label::default());
        if let Err(error) = measured {
            prop_assert!(error.render().starts_with("error: "));
        }
    }
}
