//! `muslin verify`.

use std::fs;

use serde_json::json;

use crate::work::Work;

/// A small run in `out`.
fn work_with_run() -> Work {
    let work = Work::with_scene(&[]);
    work.muslin("run scene.toml --out out").assert_success();
    work
}

fn assert_faults(work: &Work, faults: &str) {
    work.muslin("verify out").assert_failure(
        1,
        &format!(
            "error: out is not what its summary says\n{faults}\n  help: run the scene again if a file was changed by \
             mistake"
        ),
    );
}

#[test]
fn a_fresh_run_is_verified_on_any_number_of_threads() {
    let work = work_with_run();
    let files = work.summary("out")["files"].as_object().expect("files").len();
    for arguments in ["verify out", "verify out --threads 2"] {
        let outcome = work.muslin(arguments);
        outcome.assert_success();
        let expected =
            format!("out: verified: {files} files unchanged, 11 frames computed again with the same bits\n");
        assert_eq!(outcome.stdout, expected);
    }
}

/// One bit in the positions of frame 7.
#[test]
fn a_changed_position_names_its_frame() {
    let work = work_with_run();
    let mut bytes = work.read("out/trajectory.npz");
    let name = b"positions.npy";
    let header = bytes.windows(name.len()).position(|window| window == name).expect("the array");
    // The array's data begin after its NumPy header, which ends in a line break.
    let data = header + bytes[header..].iter().position(|&byte| byte == b'\n').expect("the header's end") + 1;
    bytes[data + (7 * 20 + 3) * 24 + 5] ^= 1;
    work.write("out/trajectory.npz", bytes);
    assert_faults(&work, "  trajectory.npz was changed\n  trajectory.npz: frame 7 (0.350000 s) differs");
}

#[test]
fn a_changed_scene_is_named() {
    let work = work_with_run();
    work.write("out/scene.toml", work.text("out/scene.toml").replace("-9.81", "-9.8"));
    assert_faults(
        &work,
        "  scene.toml was changed\n  scene.toml is not the scene of this run, so that it was not run again",
    );
}

#[test]
fn a_changed_summary_is_named() {
    let work = work_with_run();
    let text = work.text("out/summary.json");
    let change = |change: &dyn Fn(&mut serde_json::Value)| {
        let mut summary = serde_json::from_str(&text).expect("JSON");
        change(&mut summary);
        work.write("out/summary.json", summary.to_string());
    };
    let other = "0".repeat(64);
    change(&|summary| summary["frame_hashes"][3] = json!(other));
    assert_faults(
        &work,
        "  trajectory.npz: frame 3 (0.150000 s) differs\n  computed again, frame 3 (0.150000 s) differs",
    );
    change(&|summary| summary["final_state_hash"] = json!(other));
    assert_faults(&work, "  summary.json: `final_state_hash` is not the last of `frame_hashes`");
    change(&|summary| summary["files"]["series.csv"] = json!(other));
    assert_faults(&work, "  series.csv was changed");
    change(&|summary| {
        summary["frame_hashes"].as_array_mut().expect("hashes").pop();
        summary["final_state_hash"] = summary["frame_hashes"][9].clone();
    });
    assert_faults(
        &work,
        "  trajectory.npz has 11 frames, but the summary has 10\n  summary.json: not what was computed again: `status`, `frames`, `steps.accepted`, `energy.residual` and 20 more",
    );
    change(&|summary| summary["status"] = json!("failed"));
    assert_faults(&work, "  summary.json: not what was computed again: `status`");
    for key in [
        "error",
        "title",
        "duration",
        "frames",
        "particles",
        "springs.shear",
        "steps.accepted",
        "steps.largest",
        "energy.residual",
        "energy.last.kinetic",
        "strain.structural.max",
        "strain.bend.last.mean",
        "lowest_point.last",
        "lowest_point.lowest",
    ] {
        let pointer = format!("/{}", key.replace('.', "/"));
        change(&|summary| *summary.pointer_mut(&pointer).expect("a value") = json!(1.5));
        assert_faults(&work, &format!("  summary.json: not what was computed again: `{key}`"));
    }
    change(&|summary| {
        summary["springs"] = json!(null);
        summary["energy"] = json!({ "residual": 0.0, "last": summary["energy"]["last"] });
        for key in ["title", "seed", "particles"] {
            summary[key] = json!(7.5);
        }
    });
    assert_faults(
        &work,
        "  summary.json: not what was computed again: `title`, `seed`, `particles`, `springs` and 1 more",
    );
    change(&|summary| summary["frame_hashes"] = json!("none"));
    work.muslin("verify out").assert_failure(
        2,
        "error: out/summary.json is damaged: `frame_hashes` is missing\n  help: name a folder that `muslin run` wrote",
    );
}

#[test]
fn a_missing_file_or_folder_is_named() {
    let work = work_with_run();
    fs::remove_file(work.path("out/series.csv")).expect("removed");
    assert_faults(&work, "  series.csv could not be read: no such file or directory");
    for (folder, reason) in [("nowhere", "no such file or directory"), ("scene.toml", "not a directory")] {
        work.muslin(&format!("verify {folder}")).assert_failure(
            2,
            &format!(
                "error: {folder}/summary.json could not be read: {reason}\n  help: name a folder that `muslin run` \
                 wrote"
            ),
        );
    }
}
