//! Every scene of the scenes folder runs, meets what it expects and ends in the recorded bits.

mod common;

use std::path::{Path, PathBuf};

use common::{assert_golden, finish, simulation};
use muslin::Scene;
use muslin::integrate::Workers;
use muslin::observe::Recorder;

fn scene_files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let entries = std::fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let paths = entries.map(|entry| entry.unwrap_or_else(|error| panic!("{error}")).path());
    let mut files: Vec<PathBuf> =
        paths.filter(|path| path.extension().is_some_and(|e| e == "toml")).collect();
    files.sort();
    files
}

fn check(file: &Path) {
    let name = file.file_stem().unwrap_or_default().to_string_lossy();
    let text = std::fs::read_to_string(file).unwrap_or_else(|error| panic!("{name}: {error}"));
    let mut load = |data: &str| {
        std::fs::read(file.with_file_name(data)).map_err(|error| format!("{data} could not be read: {error}"))
    };
    let scene =
        Scene::parse_with(&text, &mut load).unwrap_or_else(|error| panic!("{}", error.render(&name, &text)));
    assert!(!scene.expectations().is_empty(), "`{name}` expects nothing");
    let mut recorder = Recorder::default();
    finish(&mut simulation(&scene, Workers::single()), &mut recorder);
    for expectation in scene.expectations() {
        let outcome = expectation.check(&recorder);
        assert!(outcome.met, "`{name}`: {outcome:?}");
    }
    let last = recorder.frames().last().unwrap_or_else(|| panic!("`{name}` has no frames"));
    assert_golden(&name, last.hash);
}

/// All at once, each on a thread of its own.
#[test]
fn every_scene_meets_its_expectations_and_ends_in_its_bits() {
    let files = scene_files();
    assert!(!files.is_empty(), "no scenes");
    std::thread::scope(|scope| {
        for file in &files {
            scope.spawn(|| check(file));
        }
    });
}
