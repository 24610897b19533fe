//! Files that a scene names: what is read from good ones, and what a person is told of bad ones.

use muslin::scene::{Fabric, MAX_DATA_BYTES, Scene, SceneError, SceneErrorKind, SpringLawSettings};
use proptest::prelude::*;

const BASE: &str = include_str!("scenes/base.toml");

/// The base scene with a table for its structural springs.
fn text() -> String {
    let linear = "structural = { stiffness = 60.0, law = \"linear\" }";
    assert!(BASE.contains(linear));
    BASE.replace(linear, "structural = { law = \"curve\", curve = \"data/warp.csv\" }")
}

fn parse(bytes: &[u8]) -> Result<Scene, SceneError> {
    Scene::parse_with(&text(), &mut |name| {
        assert_eq!(name, "data/warp.csv");
        Ok(bytes.to_vec())
    })
}

/// The points that are read from a table.
fn points(bytes: &[u8]) -> Vec<[f64; 2]> {
    let scene = parse(bytes).unwrap_or_else(|error| panic!("{}", error.render("scenes/scene.toml", &text())));
    let [file] = scene.data_files() else { panic!("one file") };
    assert_eq!((file.name(), file.bytes()), ("data/warp.csv", bytes));
    let Fabric::Springs(fabric) = &scene.fabrics()["paper"] else { panic!("springs") };
    let SpringLawSettings::Curve(curve) = &fabric.structural.law else { panic!("a curve") };
    curve.points().to_vec()
}

fn message(bytes: &[u8]) -> String {
    match parse(bytes) {
        Ok(_) => panic!("accepted: {}", String::from_utf8_lossy(bytes)),
        Err(error) => error.render("scenes/scene.toml", &text()),
    }
}

#[test]
fn a_table_is_read_however_it_is_written() {
    let expected = vec![[0.0, 0.0], [0.01, 0.5], [0.025, 2.0]];
    for table in [
        "strain [1],tension [N]\n0,0\n0.01,0.5\n0.025,2\n",
        "strain [1],tension [N]\n0.01,0.5\n0.025,2",
        "\u{feff}strain [1],tension [N]\r\n0.01,0.5\r\n\r\n0.025,2.0\r\n",
        "# measured\n\n tension [N] , strain[1] \n# twice\n +0.5e0 , 1e-2 \n2., .025\n\n",
        "\"strain [1]\",\"tension [N]\"\n\"0.01\",\"0.5\"\n\"0.025\", \"2\"",
        "strain [%],tension [N]\n-0,-0\n1.0,0.5\n2.5,2.0\n",
    ] {
        assert_eq!(points(table.as_bytes()), expected, "{table:?}");
    }
    let table = b"strain [%],tension [N]\n-50,-1\n0,0\n50,1\n";
    assert_eq!(points(table), [[-0.5, -1.0], [0.0, 0.0], [0.5, 1.0]]);
}

/// Blocks of a file's lines after `|` and the message, as in `errors.txt`.
#[test]
fn every_bad_table_has_its_message() {
    let blocks: Vec<&str> = include_str!("scenes/data_errors.txt").split("\n\n").collect();
    assert!(30 <= blocks.len(), "only {} cases were read", blocks.len());
    let mut failures = Vec::new();
    for block in blocks {
        let file = block.lines().filter_map(|line| line.strip_prefix('|'));
        let file: Vec<&str> = file.map(|line| line.strip_prefix(' ').unwrap_or(line)).collect();
        let expected: Vec<&str> = block.lines().filter(|line| !line.starts_with(['#', '|'])).collect();
        let (expected, actual) = (expected.join("\n"), message(file.join("\n").as_bytes()));
        if actual != expected {
            failures.push(format!("{file:?}\nexpected:\n{expected}\nactual:\n{actual}\n"));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn a_file_that_is_not_utf8_has_its_message() {
    assert_eq!(
        message(b"strain [1],tension [N]\n# W\xe4rme\n0.1,1\n0.2,2\n"),
        "\
error: `data/warp.csv` line 2: is not UTF-8 text (byte 26 of the file)
  --> scenes/data/warp.csv:2:4
   |
2  | # W�rme
   |    ^
  --> scenes/scene.toml:22:39
   |
22 | structural = { law = \"curve\", curve = \"data/warp.csv\" }
   |                                       ^^^^^^^^^^^^^^^
   = help: save the file as CSV in UTF-8"
    );
}

#[test]
fn a_file_above_the_limit_has_its_message() {
    let mut bytes = b"strain [1],tension [N]\n0.1,1\n0.2,2\n#".to_vec();
    bytes.resize(MAX_DATA_BYTES, b' ');
    assert_eq!(points(&bytes).len(), 3);
    bytes.push(b' ');
    assert_eq!(
        message(&bytes),
        "\
error: `fabric.paper.structural.curve` names the file \"data/warp.csv\", but it is longer than 16 MiB
  --> scenes/scene.toml:22:39
   |
22 | structural = { law = \"curve\", curve = \"data/warp.csv\" }
   |                                       ^^^^^^^^^^^^^^^
   = help: thin it out: some dozens of points tell as much"
    );
}

#[test]
fn a_file_that_cannot_be_read_has_its_message() {
    let text = text();
    let error = Scene::parse_with(&text, &mut |name| Err(format!("there is no {name} here")));
    assert_eq!(
        error.expect_err("no file").render("scenes/scene.toml", &text),
        "\
error: `fabric.paper.structural.curve` names the file \"data/warp.csv\", but there is no data/warp.csv here
  --> scenes/scene.toml:22:39
   |
22 | structural = { law = \"curve\", curve = \"data/warp.csv\" }
   |                                       ^^^^^^^^^^^^^^^
   = help: put the file beside the scene file: a scene is moved with its files"
    );
}

/// What is wrong in a file, for a program: the file's name and line, and where the scene names it.
#[test]
fn an_error_has_both_places() {
    let error = parse(b"strain [1],tension [N]\n0.1,1.0\n0.2,x\n").expect_err("no number");
    let SceneErrorKind::Data { file, position: Some(position), line, .. } = error.kind() else {
        panic!("{error:?}")
    };
    assert_eq!((file.as_str(), line.as_str()), ("data/warp.csv", "0.2,x"));
    assert_eq!((position.line, position.column, position.length), (3, 5, 1));
    assert_eq!(error.position().map(|position| (position.line, position.column)), Some((22, 39)));
    let message = error.to_string();
    assert_eq!(message, "`data/warp.csv` line 3: tension is \"x\", but must be a finite number");
}

proptest! {
    /// No bytes make the reader panic, and what it accepts is a curve.
    #[test]
    fn no_file_panics(
        bytes in proptest::collection::vec(any::<u8>(), 0..60),
        cells in "(strain \\[[1%]\\],tension \\[N\\]\n)?([-,.0-9e;\"#\r\n]{0,6}){0,8}",
    ) {
        for bytes in [bytes, cells.into_bytes()] {
            match parse(&bytes) {
                Ok(_) => {
                    let points = points(&bytes);
                    prop_assert!(2 <= points.len() && points.contains(&[0.0, 0.0]));
                    prop_assert!(points.windows(2).all(|pair| pair[0][0] < pair[1][0] && pair[0][1] <= pair[1][1]));
                }
                Err(error) => {
                    let message = error.to_string();
                    prop_assert!(!message.contains(['\n', '\r']), "{message:?}");
                    let rendered = error.render("scene.toml", &text());
                    prop_assert!(rendered.starts_with(&format!("error: {message}\n")), "{rendered}");
                }
            }
        }
    }
}
