//! Output folders that cannot be used, or fill up.

use std::fs;

use crate::work::{Outcome, Work};

#[test]
fn a_folder_that_is_not_empty() {
    let work = Work::with_scene(&[]);
    fs::create_dir(work.path("out")).expect("a folder");
    work.write("out/notes.txt", "mine");
    work.muslin("run scene.toml --out out").assert_failure(
        2,
        "error: out exists already and is not empty\n  help: choose another folder with `--out DIR`",
    );
    assert_eq!(work.contents("out"), [("notes.txt".to_owned(), b"mine".to_vec())]);
}

#[test]
fn force_replaces_nothing_but_a_run() {
    let work = Work::with_scene(&[]);
    fs::create_dir(work.path("out")).expect("a folder");
    for other in ["{}", "[]", "no JSON", r#"{ "muslin": "0.1.0", "files": {} }"#] {
        work.write("out/summary.json", other);
        work.write("out/scene.toml", "mine");
        let before = work.contents("out");
        work.muslin("run scene.toml --out out --force").assert_failure(
            2,
            "error: out holds other files than those of a run, which `--force` does not replace\n  help: choose another \
             folder with `--out DIR`",
        );
        assert_eq!(work.contents("out"), before);
    }
}

#[test]
fn a_run_does_not_overwrite_its_own_scene() {
    let work = Work::with_scene(&[]);
    let help = "choose another folder with `--out DIR`";
    for way in ["", "--force"] {
        work.muslin(&format!("run scene.toml --out . --set run.duration=0.25 {way}")).assert_failure(
            2,
            &format!("error: scene.toml would be overwritten by the files of its run\n  help: {help}"),
        );
        assert_eq!(work.names("."), ["scene.toml"]);
    }
    work.muslin("run scene.toml --out out").assert_success();
    let before = work.contents("out");
    work.muslin("run out/scene.toml --out ./out --set run.duration=0.25 --force").assert_failure(
        2,
        &format!("error: out/scene.toml would be overwritten by the files of its run\n  help: {help}"),
    );
    assert!(work.contents("out") == before, "the refused run changed a file");
}

#[cfg(target_os = "linux")]
#[test]
fn an_output_that_is_full() {
    let work = Work::with_scene(&[]);
    for arguments in [
        ["new", "hanging"].as_slice(),
        &["new"],
        &["schema"],
        &["check", "scene.toml"],
        &["run", "scene.toml"],
        &["verify", "out/scene"],
    ] {
        let script = "exec \"$@\" > /dev/full";
        Outcome::of(&mut work.shell(script, arguments.iter().copied())).assert_failure(
            1,
            "error: the standard output could not be written: no space left on device\n  help: check where it goes",
        );
    }
    work.muslin("verify out/scene").assert_success();
}

#[test]
fn a_folder_that_is_empty() {
    let work = Work::with_scene(&[]);
    fs::create_dir(work.path("out")).expect("a folder");
    work.muslin("run scene.toml --out out").assert_success();
}

#[test]
fn a_file_or_a_place_below_one() {
    let work = Work::with_scene(&[]);
    work.muslin("run scene.toml --out scene.toml").assert_failure(
        2,
        "error: scene.toml is a file, but must be a folder or not exist\n  help: choose another name with `--out DIR`",
    );
    work.muslin("run scene.toml --out scene.toml/a/b").assert_failure(
        2,
        "error: scene.toml/a/b cannot be written: not a directory\n  help: choose a folder that you may write to \
         with `--out DIR`",
    );
    assert_eq!(work.names("."), ["scene.toml"]);
}

/// No permissions bind the superuser, but nobody makes folders in sysfs.
#[cfg(target_os = "linux")]
#[test]
fn a_read_only_folder() {
    let work = Work::with_scene(&[]);
    let outcome = work.muslin("run scene.toml --out /sys/muslin-test");
    let reasons = ["operation not permitted", "permission denied", "read-only file system"];
    let message = |reason: &str| {
        format!(
            "error: /sys/muslin-test cannot be written: {reason}\n  help: choose a folder that you may write to with \
             `--out DIR`\n"
        )
    };
    assert!(reasons.iter().any(|reason| message(reason) == outcome.stderr), "{}", outcome.stderr);
    assert_eq!(outcome.code, Some(2));
}

#[cfg(unix)]
#[test]
fn a_folder_without_permission() {
    use std::os::unix::fs::PermissionsExt;
    let work = Work::with_scene(&[]);
    fs::create_dir(work.path("out")).expect("a folder");
    fs::set_permissions(work.path("out"), fs::Permissions::from_mode(0o555)).expect("permissions");
    if fs::create_dir(work.path("out/probe")).is_ok() {
        return; // The superuser may do anything.
    }
    work.muslin("run scene.toml --out out").assert_failure(
        2,
        "error: out cannot be written: permission denied\n  help: choose a folder that you may write to with \
         `--out DIR`",
    );
}

/// A limit on the size of files stands for a full disk: first one that the frames exceed, then one that they keep but
/// `trajectory.npz`, with twice their size, does not. What else there is room for is written.
#[cfg(target_os = "linux")]
#[test]
fn a_disk_that_fills_up_half_way() {
    // 100 frames of 24 x 24 particles: 1.4 MB of positions.
    let work = Work::with_scene(&[
        ("duration = 0.5", "duration = 5.0"),
        ("columns = 5, rows = 4", "columns = 24, rows = 24"),
    ]);
    work.muslin("run scene.toml --out whole").assert_success();
    let cases = [
        (2400, ".partial/positions.f64", [".partial"].as_slice()),
        (
            4000,
            ".partial/trajectory.npz",
            &[".partial", "cloth.glb", "poster.png", "scene.toml", "series.csv", "view.html"],
        ),
    ];
    for (blocks, file, names) in cases {
        let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$@\"");
        let arguments = ["run", "scene.toml", "--out", "out"];
        Outcome::of(&mut work.shell(&script, arguments)).assert_failure(
            1,
            &format!(
                "error: out/{file} could not be written: file too large\n  help: make room and go on with `--resume`, \
                 or choose another folder with `--out DIR`"
            ),
        );
        assert_eq!(work.names("out"), names);
        work.muslin("run scene.toml --out out --resume").assert_success();
        work.assert_same_run("out", "whole");
        fs::remove_dir_all(work.path("out")).expect("the folder goes");
    }
}
