//! Scenes that name files: found beside the scene, copied into the folder of the run, counted to its inputs.

use std::fs;

use serde_json::json;

use crate::work::{Work, exists};

const TABLE: &str = "strain [%],tension [N]\n2,0.2\n5,0.9\n8,3.0\n";

/// A scene in `scenes` whose structural springs have the table `file` beside it.
fn work_with_table(file: &str, table: &str) -> Work {
    let curve = format!("structural = {{ law = \"curve\", curve = \"{file}\" }}");
    let linear = "structural = { stiffness = 20.0, law = \"linear\" }";
    let work =
        Work::with_scene(&[(linear, &curve), ("step = { constant = 5e-3 }", "step = { constant = 1e-3 }")]);
    let folder = work.path(&format!("scenes/{file}"));
    fs::create_dir_all(folder.parent().expect("a folder")).expect("made");
    fs::rename(work.path("scene.toml"), work.path("scenes/scene.toml")).expect("moved");
    work.write(&format!("scenes/{file}"), table);
    work
}

/// The folder tells all: it is verified when the scene and its data are gone, and its scene runs as it stands.
#[test]
fn a_run_holds_its_data() {
    for file in ["warp.csv", "fabrics/plain 120 g/warp.csv"] {
        let work = work_with_table(file, TABLE);
        work.muslin("check scenes/scene.toml").assert_success();
        work.muslin("run scenes/scene.toml --out out").assert_success();
        assert_eq!(work.text(&format!("out/{file}")), TABLE);
        assert!(work.summary("out")["files"][file].is_string());
        fs::remove_dir_all(work.path("scenes")).expect("removed");
        fs::rename(work.path("out"), work.path("elsewhere")).expect("moved");
        work.muslin("verify elsewhere").assert_success();
        work.muslin("run elsewhere/scene.toml --out again").assert_success();
        let [first, second] = ["elsewhere", "again"].map(|folder| work.summary(folder));
        assert_eq!(first["frame_hashes"], second["frame_hashes"]);
        assert_eq!(first["scene_hash"], second["scene_hash"]);
    }
}

/// The hash of the inputs is that of what `sha256sum scene.toml warp.csv` prints.
#[cfg(target_os = "linux")]
#[test]
fn the_hash_of_the_inputs_is_what_sha256sum_prints() {
    let work = work_with_table("warp.csv", TABLE);
    work.muslin("run scenes/scene.toml --out out").assert_success();
    let script = "cd out && sha256sum scene.toml warp.csv | sha256sum";
    let output = work.shell(script, []).output().expect("the shell starts");
    let printed = String::from_utf8_lossy(&output.stdout).split(' ').next().map(str::to_owned);
    assert_eq!(work.summary("out")["scene_hash"].as_str().map(str::to_owned), printed);
}

#[test]
fn a_missing_data_file() {
    let work = work_with_table("warp.csv", TABLE);
    fs::remove_file(work.path("scenes/warp.csv")).expect("removed");
    let message = "\
error: `fabric.plain.structural.curve` names the file \"warp.csv\", but scenes/warp.csv could not be read: no such file or directory
  --> scenes/scene.toml:15:39
   |
15 | structural = { law = \"curve\", curve = \"warp.csv\" }
   |                                       ^^^^^^^^^^
   = help: put the file beside the scene file: a scene is moved with its files";
    for command in ["run scenes/scene.toml --out out", "check scenes/scene.toml"] {
        work.muslin(command).assert_failure(2, message);
    }
    fs::create_dir(work.path("scenes/warp.csv")).expect("made");
    let message = message.replace("could not be read: no such file or directory", "is not a file");
    work.muslin("run scenes/scene.toml --out out").assert_failure(2, &message);
    assert!(!exists(work.path("out")));
}

#[test]
fn a_data_file_with_a_bad_value() {
    let work = work_with_table("warp.csv", &TABLE.replace("0.9", "0,9"));
    work.muslin("run scenes/scene.toml --out out").assert_failure(
        2,
        "\
error: `warp.csv` line 3: has 3 cells, but the header has 2
  --> scenes/warp.csv:3:1
   |
3  | 5,0,9
   | ^^^^^
  --> scenes/scene.toml:15:39
   |
15 | structural = { law = \"curve\", curve = \"warp.csv\" }
   |                                       ^^^^^^^^^^
   = help: write decimal points, not commas, and no text after the numbers",
    );
    assert!(!exists(work.path("out")));
}

/// With less memory than the file would take.
#[cfg(target_os = "linux")]
#[test]
fn a_data_file_of_100_megabytes() {
    let work = work_with_table("warp.csv", TABLE);
    let file = fs::File::create(work.path("scenes/warp.csv")).expect("a file");
    file.set_len(100_000_000).expect("a sparse file");
    let script = "ulimit -v 98304; exec \"$@\"";
    let outcome = crate::work::Outcome::of(&mut work.shell(script, ["check", "scenes/scene.toml"]));
    assert_eq!(outcome.code, Some(2), "{}", outcome.stderr);
    assert!(outcome.stderr.contains("but it is longer than 16 MiB\n"), "{}", outcome.stderr);
}

/// Copied into the folder, it would take the place of the run's own file.
#[test]
fn a_data_file_with_the_name_of_a_run_file() {
    for file in ["series.csv", "Summary.JSON"] {
        work_with_table(file, TABLE).muslin("run scenes/scene.toml --out out").assert_failure(
            2,
            &format!(
                "error: the data file {file} has the name of a file that a run writes itself\n  help: give it another \
                 name, as it is copied into the output folder"
            ),
        );
    }
}

#[test]
fn a_run_does_not_overwrite_its_own_data() {
    let work = work_with_table("warp.csv", TABLE);
    work.muslin("run scenes/scene.toml --out out").assert_success();
    fs::copy(work.path("scenes/scene.toml"), work.path("out/my.toml")).expect("copied");
    work.muslin("run out/my.toml --out out --force").assert_failure(
        2,
        "error: out/warp.csv would be overwritten by the files of its run\n  help: choose another folder with `--out \
         DIR`",
    );
}

/// `--force` leaves no data of the run that it replaces, but what somebody has changed since.
#[test]
fn forced_runs_take_the_data_of_the_earlier_run_away() {
    let work = work_with_table("warp.csv", TABLE);
    let set = "--set fabric.plain.structural.curve=weft.csv";
    work.write("scenes/weft.csv", TABLE);
    work.muslin("run scenes/scene.toml --out out").assert_success();
    work.muslin(&format!("run scenes/scene.toml --out out --force {set}")).assert_success();
    assert!(!exists(work.path("out/warp.csv")) && exists(work.path("out/weft.csv")));
    work.write("out/weft.csv", "mine");
    work.muslin("run scenes/scene.toml --out out --force").assert_success();
    assert_eq!(work.text("out/weft.csv"), "mine");
    work.muslin("verify out").assert_success();
}

#[test]
fn changed_data_is_found_by_verify() {
    let work = work_with_table("warp.csv", TABLE);
    work.muslin("run scenes/scene.toml --out out").assert_success();
    let assert_faults = |faults: &str| {
        work.muslin("verify out").assert_failure(
            1,
            &format!(
                "error: out is not what its summary says\n{faults}\n  help: run the scene again if a file was changed \
                 by mistake"
            ),
        );
    };
    work.write("out/warp.csv", TABLE.replace("0.9", "0.8"));
    assert_faults(
        "  warp.csv was changed\n  warp.csv is not the data of this run, so that it was not run again",
    );
    fs::remove_file(work.path("out/warp.csv")).expect("removed");
    assert_faults(
        "  warp.csv could not be read: no such file or directory\n  warp.csv is not the data of this run, so that it \
         was not run again",
    );
    work.write("out/warp.csv", TABLE);
    work.muslin("verify out").assert_success();
    // A summary that knows nothing of its data is not that of the scene.
    let mut summary = work.summary("out");
    summary["files"].as_object_mut().expect("files").remove("warp.csv");
    work.write("out/summary.json", json!(summary).to_string());
    assert_faults("  scene.toml is not the scene of this run, so that it was not run again");
}

/// A run goes on with the data that it was started with, and with no other.
#[cfg(unix)]
#[test]
fn a_run_with_changed_data_does_not_go_on() {
    let work = work_with_table("warp.csv", TABLE);
    fs::rename(work.path("scenes/scene.toml"), work.path("scene.toml")).expect("moved");
    work.write("warp.csv", TABLE);
    crate::interruptions::leave_unfinished(&work);
    work.write("warp.csv", TABLE.replace("0.9", "0.8"));
    work.muslin("run scene.toml --out out --resume").assert_failure(
        2,
        "error: the unfinished run in out is of another scene or other data\n  help: give the same scene file, data files \
         and `--set` again, or start again with `--force`",
    );
    work.write("warp.csv", TABLE);
    work.muslin("run scene.toml --out out --resume").assert_success();
    work.muslin("verify out").assert_success();
    work.muslin("run scene.toml --out whole").assert_success();
    work.assert_same_run("out", "whole");
}
