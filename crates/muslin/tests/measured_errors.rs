//! Bad scenes with a measured fabric, each with the whole message that a person gets.

use muslin::Scene;

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
