//! Runs that stop before their end, and go on.
#![cfg(unix)]

use std::fs;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use serde_json::{Value, json};

use crate::work::{Outcome, Work, exists};

const WIND: &str = r#"[[environment.wind]]
law = "particle-force"
amplitude = 0.05
angular_frequency = 3.0
phase = 0.5
direction = [0.0, 0.0, 1.0]
"#;

/// Particles enough that a run of springs takes its time.
const MANY: (&str, &str) = ("columns = 5, rows = 4", "columns = 32, rows = 32");

/// A fabric with friction in tension, shear and bending, whose yarns do not stiffen in the wind.
const HELD: &str = r#"[fabric.held]
kind = "measured"
areal_density = 0.2
drag = 0.5
warp = { modulus = 1500.0, rt_percent = 65 }
weft = { modulus = 1000.0, rt_percent = 65 }
shear = { g_gf_per_cm_deg = 0.6, 2hg_gf_per_cm = 0.9, 2hg5_gf_per_cm = 1.8 }
bend = { warp = { rigidity = 12e-6, 2hb = 6e-4 }, weft = { rigidity = 8e-6, 2hb = 4e-4 } }
"#;

/// A folder with `scene.toml` whose run in `out` was stopped by `stop` before its end, once `is_ready`.
///
/// How long a run must be for that depends on the machine.
fn stopped_run(is_ready: impl Fn(&Work) -> bool, stop: impl Fn(Child) -> Outcome) -> (Work, Outcome) {
    stopped_run_of(&[MANY], is_ready, stop)
}

/// The same of a scene with pieces replaced.
fn stopped_run_of(
    changes: &[(&str, &str)],
    is_ready: impl Fn(&Work) -> bool,
    stop: impl Fn(Child) -> Outcome,
) -> (Work, Outcome) {
    for duration in ["10.0", "40.0", "160.0", "640.0", "2560.0"] {
        let (duration, wind) = (format!("duration = {duration}"), format!("{WIND}\n[fabric.plain]"));
        let long = [("duration = 0.5", duration.as_str()), ("[fabric.plain]", wind.as_str())];
        let work = Work::with_scene(&[changes, &long].concat());
        let mut command = work.command(["run", "scene.toml", "--out", "out"]);
        let mut run =
            command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the command starts");
        while !is_ready(&work) && run.try_wait().expect("a state").is_none() {
            sleep(Duration::from_millis(2));
        }
        let outcome = stop(run);
        if outcome.code != Some(0) {
            return (work, outcome);
        }
    }
    panic!("no run was long enough");
}

/// Sends Ctrl-C and waits for the end.
fn interrupt(run: Child) -> Outcome {
    // Fails if the run has ended already.
    let _ = Command::new("sh").args(["-c", &format!("kill -INT {} 2> /dev/null", run.id())]).status();
    Outcome::of_output(run.wait_with_output().expect("the run ends"))
}

fn kill(mut run: Child) -> Outcome {
    run.kill().expect("killed or ended already");
    Outcome::of_output(run.wait_with_output().expect("the run ends"))
}

fn checkpoint_frame(work: &Work) -> Option<u64> {
    let bytes = fs::read(work.path("out/.partial/checkpoint.json")).ok()?;
    serde_json::from_slice::<Value>(&bytes).ok()?["frame_index"].as_u64()
}

/// Whether a checkpoint was written after the first frame's.
fn is_under_way(work: &Work) -> bool {
    checkpoint_frame(work).is_some_and(|frame| 0 < frame)
}

/// The whole reproduction takes a minute, so that it cannot end before it is stopped.
#[test]
fn an_interrupted_reproduction_leaves_nothing() {
    let work = Work::new();
    let mut command = work.command(["reproduce", "page"]);
    let run = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the command starts");
    while !exists(work.path("page/.reproduction/lock")) {
        sleep(Duration::from_millis(2));
    }
    work.muslin("reproduce page").assert_failure(
        2,
        "error: another muslin is at work in page\n  help: wait until it ends or stop it, or choose another folder",
    );
    let outcome = interrupt(run);
    assert_eq!(outcome.code, Some(1), "{}", outcome.stderr);
    let message = "error: stopped; nothing was written\n  help: start it again\n";
    assert!(outcome.stderr.ends_with(message), "{}", outcome.stderr);
    assert!(!exists(work.path("page")));
}

#[test]
fn an_interrupted_run_goes_on_to_the_same_bits() {
    let (work, outcome) = stopped_run(is_under_way, interrupt);
    let summary = work.summary("out");
    let frames = summary["frames"].as_u64().expect("a number");
    assert!(1 < frames, "{frames} frames");
    let message = format!(
        "error: stopped at {:.6} s; out holds the frames so far\n  help: go on with the same command and \
         `--resume`\n",
        (frames - 1) as f64 / 20.0
    );
    // Lines of progress may come before.
    assert!(outcome.stderr.ends_with(&message), "{}", outcome.stderr);
    assert_eq!(outcome.code, Some(1));
    assert_eq!(summary["status"], json!("interrupted"));
    assert_eq!(summary["steps"]["accepted"], json!(10 * (frames - 1)));
    assert_eq!(checkpoint_frame(&work), Some(frames - 1));
    work.muslin("run scene.toml --out whole").assert_success();
    let whole = work.summary("whole");
    let hashes = |summary: &Value| summary["frame_hashes"].as_array().expect("hashes").clone();
    assert_eq!(hashes(&summary), hashes(&whole)[..frames as usize]);
    work.muslin("verify out").assert_success();

    work.muslin("run scene.toml --out out").assert_failure(
        2,
        "error: out holds an unfinished run\n  help: go on with it by `--resume`, start again with `--force`, or \
         choose another folder with `--out DIR`",
    );
    work.muslin("run scene.toml --out out --resume --threads 2").assert_success();
    work.assert_same_run("out", "whole");
    work.muslin("verify out").assert_success();
}

/// What the rule for the step remembers is in the checkpoint.
#[test]
fn an_adaptive_run_goes_on_to_the_same_bits() {
    let rule = ("step = { constant = 5e-3 }", "step = { tolerance = 1e-2 }");
    let (work, outcome) = stopped_run_of(&[MANY, rule], is_under_way, interrupt);
    assert_eq!(outcome.code, Some(1));
    work.muslin("run scene.toml --out out --resume --threads 2").assert_success();
    work.muslin("run scene.toml --out whole").assert_success();
    work.assert_same_run("out", "whole");
    work.muslin("verify out").assert_success();
}

/// What friction remembers is in the checkpoint: all of it is needed, and without it the rest of the run is another.
#[test]
fn a_run_with_friction_goes_on_to_the_same_bits() {
    let fabric = format!("{HELD}\n[fabric.plain]");
    let changes = [
        ("step = { constant = 5e-3 }", "step = \"adaptive\""),
        ("columns = 5, rows = 4", "columns = 8, rows = 6"),
        ("fabric = \"plain\"", "fabric = \"held\""),
        ("[fabric.plain]", fabric.as_str()),
    ];
    let (work, outcome) = stopped_run_of(&changes, is_under_way, interrupt);
    assert_eq!(outcome.code, Some(1), "{}", outcome.stderr);
    let partial = |folder: &str, name: &str| format!("{folder}/.partial/{name}");
    let frame = checkpoint_frame(&work).expect("a checkpoint");
    let slips = format!("half-step-velocities-{frame}.f64");
    let bytes = work.read(&partial("out", &slips));
    let velocities = 8 * 6 * 3 * size_of::<f64>();
    let is_remembered = |bytes: &[u8]| bytes.iter().any(|byte| *byte != 0);
    assert!(is_remembered(&bytes[velocities..]), "nothing has slipped");
    for folder in ["short", "forgotten"] {
        fs::create_dir_all(work.path(&partial(folder, ""))).expect("a folder");
        for name in work.names("out/.partial") {
            work.write(&partial(folder, &name), work.read(&partial("out", &name)));
        }
    }
    work.write(&partial("short", &slips), &bytes[..bytes.len() - 1]);
    work.muslin("run scene.toml --out short --resume").assert_failure(
        2,
        &format!(
            "error: short/.partial/{slips} could not be read: it is shorter than its checkpoint says\n  help: start \
             again with `--force`"
        ),
    );
    let forgotten = [&bytes[..velocities], &vec![0; bytes.len() - velocities]].concat();
    work.write(&partial("forgotten", &slips), forgotten);
    for folder in ["out", "forgotten"] {
        work.muslin(&format!("run scene.toml --out {folder} --resume --threads 2")).assert_success();
    }
    work.muslin("run scene.toml --out whole").assert_success();
    work.assert_same_run("out", "whole");
    work.muslin("verify out").assert_success();
    let last = |folder: &str| work.summary(folder)["final_state_hash"].clone();
    assert_ne!(last("forgotten"), last("whole"));
    let lost = &work.summary("whole")["energy"]["last"]["friction_loss"];
    assert!(lost.as_f64().is_some_and(|lost| 0.0 < lost), "{lost} J");
}

#[test]
fn a_killed_run_goes_on_to_the_same_bits() {
    let (work, _) = stopped_run(is_under_way, kill);
    assert_eq!(work.names("out"), [".partial"]);
    // As if the end had come in the middle of a frame.
    let mut velocities = work.read("out/.partial/velocities.f64");
    velocities.extend([1; 1000]);
    work.write("out/.partial/velocities.f64", velocities);
    work.muslin("run scene.toml --out out --resume").assert_success();
    work.muslin("run scene.toml --out whole").assert_success();
    work.assert_same_run("out", "whole");
}

#[test]
fn nothing_to_resume() {
    let work = Work::with_scene(&[]);
    work.muslin("run scene.toml --out out --resume").assert_failure(
        2,
        "error: there is no unfinished run in out\n  help: name its folder with `--out DIR`, or leave out `--resume` \
         to start one",
    );
    assert!(!exists(work.path("out")));
    work.muslin("run scene.toml --out out").assert_success();
    let before = work.contents("out");
    work.muslin("run scene.toml --out out --resume").assert_failure(
        2,
        "error: the run in out has ended, there is nothing to resume\n  help: run it again with `--force`, or into \
         another folder with `--out DIR`",
    );
    assert!(work.contents("out") == before, "the refused run changed a file");
}

#[test]
fn an_unfinished_run_is_neither_verified_nor_viewed() {
    let work = Work::with_scene(&[]);
    leave_unfinished(&work);
    for command in ["verify", "view"] {
        work.muslin(&format!("{command} out")).assert_failure(
            2,
            "error: out holds an unfinished run\n  help: go on with the same command and `--resume`",
        );
    }
}

/// A run that was killed before its first checkpoint has left nothing of worth.
#[test]
fn a_folder_without_checkpoint_can_be_used() {
    let work = Work::with_scene(&[]);
    fs::create_dir_all(work.path("out/.partial")).expect("a folder");
    work.write("out/.partial/positions.f64", "");
    work.muslin("run scene.toml --out out").assert_success();
    assert!(!exists(work.path("out/.partial")));
}

/// Leaves an unfinished run of [`SMALL`] in `out`: its first frame, on a disk with room for no more.
pub(crate) fn leave_unfinished(work: &Work) {
    let script = "trap '' XFSZ; ulimit -f 3; exec \"$@\"";
    let outcome = Outcome::of(&mut work.shell(script, ["run", "scene.toml", "--out", "out"]));
    assert_eq!(outcome.code, Some(1), "{}", outcome.stderr);
    assert_eq!(checkpoint_frame(work), Some(0));
}

#[test]
fn another_scene_or_version_does_not_go_on() {
    let work = Work::with_scene(&[]);
    leave_unfinished(&work);
    work.muslin("run scene.toml --out out --resume --set run.seed=1").assert_failure(
        2,
        "error: the unfinished run in out is of another scene or other data\n  help: give the same scene file, data files \
         and `--set` again, or start again with `--force`",
    );
    let checkpoint = work.text("out/.partial/checkpoint.json");
    let version = env!("CARGO_PKG_VERSION");
    let older = checkpoint.replace(&format!("\"muslin\":\"{version}\""), "\"muslin\":\"0.0.1\"");
    assert_ne!(older, checkpoint);
    work.write("out/.partial/checkpoint.json", older);
    work.muslin("run scene.toml --out out --resume").assert_failure(
        2,
        &format!(
            "error: the unfinished run in out is of muslin 0.0.1, but this is {version}, which may compute other bits\n  \
             help: go on with that version, or start again with `--force`"
        ),
    );
    work.muslin("run scene.toml --out out --force").assert_success();
    assert!(!exists(work.path("out/.partial")));
}

#[test]
fn a_damaged_unfinished_run_says_so() {
    let work = Work::with_scene(&[]);
    leave_unfinished(&work);
    let checkpoint = work.text("out/.partial/checkpoint.json");
    work.write("out/.partial/positions.f64", [0; 100]);
    work.muslin("run scene.toml --out out --resume").assert_failure(
        2,
        "error: out/.partial/positions.f64 could not be read: it is shorter than its checkpoint says\n  help: start \
         again with `--force`",
    );
    work.write("out/.partial/checkpoint.json", &checkpoint[..checkpoint.len() / 2]);
    let outcome = work.muslin("run scene.toml --out out --resume");
    let start = "error: out/.partial/checkpoint.json is damaged: ";
    assert!(outcome.stderr.starts_with(start), "{}", outcome.stderr);
    assert!(outcome.stderr.ends_with("\n  help: start again with `--force`\n"), "{}", outcome.stderr);
    assert_eq!(outcome.code, Some(2));
}

#[test]
fn two_commands_do_not_work_on_one_run() {
    let work = Work::with_scene(&[("duration = 0.5", "duration = 1e4")]);
    let mut command = work.command(["run", "scene.toml", "--out", "out"]);
    let mut run = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("the command starts");
    while checkpoint_frame(&work).is_none() {
        sleep(Duration::from_millis(2));
    }
    for way in ["--resume", "--force", ""] {
        work.muslin(&format!("run scene.toml --out out {way}")).assert_failure(
            2,
            "error: another muslin is at work in out\n  help: wait until it ends or stop it, or choose another folder \
             with `--out DIR`",
        );
    }
    assert!(run.try_wait().expect("a state").is_none(), "the run ended too early");
    run.kill().expect("killed");
    run.wait().expect("ended");
}
