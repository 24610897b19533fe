//! Steps beyond the stable one, forced.

use std::fs::File;
use std::io::BufReader;

use muslin::Points;
use muslin::write::{FrameSource, MotionSource, TrajectoryReader};
use serde_json::json;

use crate::work::Work;

/// Once with a frame after every step, once with ten steps between: forces overflow before positions do, and a frame
/// may lie between the two.
#[test]
fn an_unstable_run_stops_at_the_first_value_that_is_not_finite() {
    for (rate, place, suggestion, least_frames) in [
        (
            "20.0",
            "particle 0 (column 0, row 0 of cloth `sheet`) has no finite position or velocity at 1.250000 s",
            "2.500000000000e-2",
            10,
        ),
        (
            "2.0",
            "particle 0 (column 0, row 0 of cloth `sheet`) has no finite position or velocity at 1.300000 s",
            "2.631578947368e-2",
            2,
        ),
    ] {
        let work = Work::with_scene(&[
            ("constant = 5e-3", "constant = 50e-3"),
            ("duration = 0.5", "duration = 100.0"),
            ("frame_rate = 20.0", &format!("frame_rate = {rate}")),
            ("pins = [{ column = 0, row = 0 }, { column = -1, row = 0 }]", "pins = [{ row = -1 }]"),
        ]);
        let outcome = work.muslin("run scene.toml --out out --set run.allow-unstable=true");
        outcome.assert_failure(
            1,
            &format!(
                "error: {place}; out holds the frames before it\n  help: the motion has become unstable: the largest \
                 stable step in the initial shape is 30.2 ms; take `step = {{ constant = {suggestion} }}`"
            ),
        );
        let summary = work.summary("out");
        assert_eq!((&summary["status"], &summary["error"]), (&json!("failed"), &json!(place)));
        let files = ["cloth.glb", "scene.toml", "series.csv", "summary.json", "trajectory.npz"];
        let names = work.names("out");
        assert!(files.iter().all(|file| names.iter().any(|name| name == file)), "{names:?}");
        assert!(!names.iter().any(|name| name == ".partial"));

        let file = BufReader::new(File::open(work.path("out/trajectory.npz")).expect("a trajectory"));
        let mut trajectory = TrajectoryReader::new(file).expect("a whole trajectory");
        assert_eq!(Some(trajectory.frame_count()), summary["frame_hashes"].as_array().map(Vec::len));
        assert!(least_frames < trajectory.frame_count());
        let mut points = Points::default();
        for frame in 0..trajectory.frame_count() {
            trajectory.read_positions(frame, &mut points).expect("positions");
            assert!(points.is_finite(), "frame {frame}");
            trajectory.read_velocities(frame, &mut points).expect("velocities");
            assert!(points.is_finite(), "frame {frame}");
        }
        work.muslin("verify out").assert_success();
    }
}

/// Steps and forces so large that the third step leaves the range of numbers.
#[test]
fn a_run_that_fails_early_has_advice() {
    let work = Work::with_scene(&[
        ("-9.81", "-1e30"),
        ("duration = 0.5", "duration = 5e27"),
        ("frame_rate = 20.0", "frame_rate = 1e-25"),
        ("constant = 5e-3", "constant = 1e25"),
    ]);
    let outcome = work.muslin("run scene.toml --out out --set run.allow-unstable=true");
    assert_eq!(outcome.code, Some(1));
    let advice = "help: the motion has become unstable: the largest stable step in the initial shape is 30.1 ms; take `step = ";
    assert!(outcome.stderr.contains(advice), "{}", outcome.stderr);
    assert!(work.summary("out")["frames"].as_u64() < Some(6));
    work.muslin("verify out").assert_success();
}

/// A step that is stable for the flat cloth may be too long once springs have stiffened.
#[test]
fn springs_that_stiffen_need_a_smaller_step() {
    let work = Work::with_scene(&[
        (
            "structural = { stiffness = 20.0, law = \"linear\"",
            "structural = { stiffness = 20.0, law = \"tangent\", strain_scale = 0.01",
        ),
        ("constant = 5e-3", "constant = 25e-3"),
        ("duration = 0.5", "duration = 20.0"),
    ]);
    let outcome = work.muslin("run scene.toml --out out");
    assert_eq!(outcome.code, Some(1), "{}", outcome.stderr);
    let help = "help: take a smaller step: this one is stable in the initial shape, but springs that stiffen need less; or \
                check the quantities of the scene\n";
    assert!(outcome.stderr.ends_with(help), "{}", outcome.stderr);
}

/// The smallest tolerance that a scene can have is below what any step keeps.
#[test]
fn a_tolerance_that_no_step_keeps_ends_the_run() {
    let work = Work::with_scene(&[("{ constant = 5e-3 }", "{ tolerance = 1e-30 }")]);
    let outcome = work.muslin("run scene.toml --out out");
    outcome.assert_failure(
        1,
        "error: at 0.000000 s the adaptive step would have to be shorter than 1.164e-11 s: the motion is no longer \
         finite there, or no step is short enough for the stiffness or the tolerance; out holds the frames before it\n  \
         help: raise the tolerance, or check the quantities of the scene",
    );
    let summary = work.summary("out");
    assert_eq!((&summary["status"], &summary["frames"]), (&json!("failed"), &json!(1)));
    let file = BufReader::new(File::open(work.path("out/trajectory.npz")).expect("a trajectory"));
    assert_eq!(TrajectoryReader::new(file).expect("a whole trajectory").frame_count(), 1);
    work.muslin("verify out").assert_success();
}
