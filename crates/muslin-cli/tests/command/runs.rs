//! What a run writes and says.

use muslin::integrate::Workers;
use muslin::observe::StateHash;
use muslin::{Scene, Simulation};
use serde_json::{Value, json};

use crate::work::{Outcome, SMALL, Work, exists, scene};

/// Files that every run writes.
const FILES: [&str; 5] = ["cloth.glb", "scene.toml", "series.csv", "summary.json", "trajectory.npz"];

#[test]
fn a_run_writes_all_files_and_its_summary_tells_of_them() {
    let work = Work::with_scene(&[]);
    let outcome = work.muslin("run scene.toml");
    outcome.assert_success();
    assert!(outcome.stdout.starts_with("out/scene: 11 frames, 500 ms simulated in "), "{}", outcome.stdout);
    let names = work.names("out/scene");
    assert!(FILES.iter().all(|file| names.iter().any(|name| name == file)), "{names:?}");
    assert_eq!(work.text("out/scene/scene.toml"), SMALL);
    assert_eq!(work.text("out/scene/series.csv").lines().count(), 12);

    let summary = work.summary("out/scene");
    for (pointer, value) in [
        ("/muslin", json!(env!("CARGO_PKG_VERSION"))),
        ("/status", json!("complete")),
        ("/error", Value::Null),
        ("/title", json!("Small cloth")),
        ("/method", json!("central-difference")),
        ("/duration", json!(0.5)),
        ("/frames", json!(11)),
        ("/particles", json!(20)),
        ("/springs", json!({ "structural": 31, "shear": 24, "bend": 22 })),
        ("/steps/accepted", json!(100)),
        ("/steps/rejected", json!(0)),
        ("/steps/smallest", json!(5e-3)),
        ("/steps/largest", json!(5e-3)),
        ("/expect", json!([])),
        ("/threads", json!(1)),
    ] {
        assert_eq!(summary.pointer(pointer), Some(&value), "{pointer}");
    }
    for pointer in [
        "/energy/residual",
        "/energy/last/kinetic",
        "/strain/structural/max",
        "/strain/shear/max",
        "/strain/bend/max",
        "/lowest_point/last",
        "/wall_time",
        "/stepping_time",
        "/particle_steps_per_second",
    ] {
        let number = summary.pointer(pointer).and_then(Value::as_f64);
        assert!(number.is_some_and(f64::is_finite), "{pointer}: {number:?}");
    }
    let hashes = summary["frame_hashes"].as_array().expect("hashes");
    assert_eq!(hashes.len(), 11);
    assert_eq!(hashes.last(), summary.get("final_state_hash"));
    let hashed: Vec<&String> = summary["files"].as_object().expect("files").keys().collect();
    let others: Vec<&String> = names.iter().filter(|name| *name != "summary.json").collect();
    assert!(others.iter().all(|name| hashed.contains(name)), "{hashed:?} {others:?}");
}

#[test]
fn a_second_run_needs_force() {
    let work = Work::with_scene(&[]);
    work.muslin("run scene.toml --out out").assert_success();
    let before = work.contents("out");
    work.muslin("run scene.toml --out out --set run.duration=0.25").assert_failure(
        2,
        "error: out exists already and is not empty\n  help: replace its files with `--force`, or choose another \
         folder with `--out DIR`",
    );
    assert!(work.contents("out") == before, "the refused run changed a file");
    work.muslin("run scene.toml --out out --set run.duration=0.25 --force").assert_success();
    assert_eq!(work.summary("out")["frames"], json!(6));
    work.muslin("run scene.toml --out fresh --set run.duration=0.25").assert_success();
    work.assert_same_run("out", "fresh");
}

#[test]
fn assignments_are_part_of_the_scene_as_run() {
    let work = Work::with_scene(&[]);
    work.muslin("run scene.toml --out out --set run.duration=0.25 --set cloth.0.grid.rows=3")
        .assert_success();
    let changed = scene(&[("duration = 0.5", "duration = 0.25"), ("rows = 4", "rows = 3")]);
    assert_eq!(work.text("out/scene.toml"), changed);
    work.muslin("run out/scene.toml --out again").assert_success();
    work.assert_same_run("out", "again");
}

#[test]
fn a_violated_expectation_fails_a_run_that_wrote_all_files() {
    let work =
        Work::with_scene(&[("[environment]", "[expect]\nlowest_point = { above = 2.0 }\n\n[environment]")]);
    let outcome = work.muslin("run scene.toml --out out");
    let value = work.summary("out")["expect"][0]["value"].as_f64().expect("a number");
    outcome.assert_failure(
        1,
        &format!(
            "error: the run does not meet its [expect] table: `lowest_point` is {value:?} m, expected above 2 m\n  \
             help: change the scene or what it expects; all files were written"
        ),
    );
    let outcome = work.muslin("run scene.toml --out longer --set run.duration=1.0");
    let help = "help: `[expect]` was written for the scene without `--set`; all files were written\n";
    assert!(outcome.stderr.ends_with(help), "{}", outcome.stderr);
    assert_eq!(work.summary("out")["status"], json!("complete"));
    assert_eq!(work.summary("out")["expect"][0]["met"], json!(false));
    assert!(FILES.iter().all(|name| exists(work.path("out").join(name))));
    assert!(!exists(work.path("out/.partial")));
}

#[test]
fn the_page_shows_warnings_and_names_the_step() {
    let limit = "drag = 0.01\nlimit = { kind = \"cut-off\", strain = 0.1 }";
    let work = Work::with_scene(&[("step = { constant = 5e-3 }\n", ""), ("drag = 0.01", limit)]);
    work.muslin("run scene.toml --out limited").assert_success();
    let page = work.text("limited/view.html");
    assert!(page.contains("Warning: `fabric.plain.limit` shortens springs"), "the page does not warn");
    assert!(page.contains("[\"longest step\","), "the page does not say which step it shows");

    let work = Work::with_scene(&[]);
    work.muslin("run scene.toml --out plain").assert_success();
    let page = work.text("plain/view.html");
    assert!(page.contains("\"notice\":null") && page.contains("[\"step\","), "a plain run needs no notice");
}

#[test]
fn numbers_have_units_and_paths_are_quoted() {
    let expect = "[expect]\nmax_strain = { below = 10.0 }\nlowest_point = { between = [-50.0, 1e-12] }\n\n[environment]";
    let work = Work::with_scene(&[("[environment]", expect), ("origin = [0.0, 1.0", "origin = [0.0, -1.0")]);
    let outcome = Outcome::of(&mut work.command(["run", "scene.toml", "--out", "my cloth"]));
    outcome.assert_success();
    let summary = work.summary("my cloth");
    let strain = summary["expect"][0]["value"].as_f64().expect("a number");
    let lowest = summary["expect"][1]["value"].as_f64().expect("a number");
    for line in [
        format!("`max_strain` is {strain:.4} ({:.1} %), expected below 10", 100.0 * strain),
        format!("`lowest_point` is {lowest:.3} m, expected between -50 and 1e-12 m"),
        format!("  lowest point at the end    {lowest:.5} m"),
        "look at it: muslin view 'my cloth', or open 'my cloth/view.html'".to_owned(),
    ] {
        assert!(outcome.stdout.contains(&line), "{line}\n{}", outcome.stdout);
    }
    assert_eq!(summary["expect"][1]["range"], json!("between -50 and 1e-12 m"));
}

/// 80 x 80 particles are two blocks of the model.
#[test]
fn threads_change_no_bit() {
    let work = Work::with_scene(&[
        ("columns = 5, rows = 4", "columns = 80, rows = 80"),
        ("duration = 0.5", "duration = 0.15"),
    ]);
    work.muslin("run scene.toml --out one --threads 1").assert_success();
    for threads in ["2", "3"] {
        work.muslin(&format!("run scene.toml --out {threads} --threads {threads}")).assert_success();
        assert_eq!(work.summary(threads)["threads"].to_string(), threads);
        work.assert_same_run("one", threads);
    }
}

/// The command observes every step; here nobody does.
#[test]
fn observers_change_no_bit() {
    let work = Work::with_scene(&[]);
    work.muslin("run scene.toml --out out").assert_success();
    let scene = Scene::parse(SMALL).expect("a scene");
    let integrator = Simulation::integrator(&scene, Workers::single());
    let mut simulation = Simulation::new(&scene, integrator).expect("a stable step");
    for expected in work.summary("out")["frame_hashes"].as_array().expect("hashes") {
        let frame = simulation.frame();
        let hash = StateHash::new(&frame.state.positions, frame.velocities);
        assert_eq!(Some(hash.to_string().as_str()), expected.as_str(), "frame {}", frame.index);
        if !simulation.is_finished() {
            simulation.advance(&mut []).expect("a stable motion");
        }
    }
}

/// Neither a reader who goes away nor one who was never there fails a run.
#[cfg(unix)]
#[test]
fn closed_pipes_are_no_failure() {
    let work = Work::with_scene(&[]);
    for arguments in
        [["run", "scene.toml"].as_slice(), &["schema"], &["new", "hanging"], &["check", "scene.toml"]]
    {
        let script = "{ \"$@\"; echo $? >&2; } | true";
        let outcome = Outcome::of(&mut work.shell(script, arguments.iter().copied()));
        assert_eq!((outcome.code, outcome.messages().as_str()), (Some(0), "0\n"), "{arguments:?}");
    }
    let outcome =
        Outcome::of(&mut work.shell("exec \"$@\" >&- 2>&-", ["run", "scene.toml", "--out", "silent"]));
    assert_eq!(outcome.code, Some(0));
    work.assert_same_run("out/scene", "silent");
}
