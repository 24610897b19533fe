//! Every scene of the scenes folder runs, meets what it expects and ends in the recorded bits; but those that take minutes
//! are only read here, and run by the command in a release build, in what CI runs.

mod common;

use std::path::{Path, PathBuf};

use common::{assert_golden, finish, simulation};
use muslin::Scene;
use muslin::integrate::Workers;
use muslin::observe::Recorder;

/// Scenes that take minutes in a build for tests.
const BY_COMMAND: [&str; 1] = ["shaken"];

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
    if BY_COMMAND.contains(&name.as_ref()) {
        return;
    }
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

/// The curves of suiting are the tangent law that its EMT, LT and force of the KES tensile test give, as their headers say:
///
/// ```text
/// LT = −2 ln(cos u) / (u tan u)    a = EMT / u    f = F w tan(e / a) / tan u
/// ```
#[test]
fn curves_of_suiting_have_the_published_values() {
    use muslin::force::{CurveLaw, TensionLaw};
    use muslin::scene::{Fabric, SpringLawSettings};
    const WIDTH: f64 = 0.05;
    const FORCE: f64 = 490.3325;
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let text = std::fs::read_to_string(folder.join("suiting.toml")).expect("the scene is there");
    for (name, extension) in [("warp", 0.047), ("weft", 0.1275)] {
        let text = text.replace("suiting-warp.csv\"", &format!("suiting-{name}.csv\""));
        let mut load = |file: &str| std::fs::read(folder.join(file)).map_err(|error| error.to_string());
        let scene = Scene::parse_with(&text, &mut load).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(scene.data_files()[0].name(), format!("fabrics/suiting-{name}.csv"));
        let Fabric::Springs(fabric) = &scene.fabrics()["suiting"] else { panic!("springs") };
        let SpringLawSettings::Curve(curve) = &fabric.structural.law else { panic!("a curve") };
        let linearity = |u: f64| -2.0 * u.cos().ln() / (u * u.tan());
        let (mut low, mut high) = (0.1, 1.5);
        for _ in 0..60 {
            let u = 0.5 * (low + high);
            if 0.55 < linearity(u) { low = u } else { high = u }
        }
        let scale = extension / low;
        for &[strain, tension] in curve.points() {
            let exact = FORCE * WIDTH * (strain / scale).tan() / low.tan();
            // The file has five decimals, and six digits of the strain.
            assert!(
                (tension - exact).abs() < 5e-6 + 5e-6 * exact,
                "{name}: {tension} N for {exact} N at {strain}"
            );
        }
        // What the instrument would give of the law: EMT at its force, and LT from the work up to there. Twelve intervals
        // of a curve that PCHIP meets to third order leave about 12⁻³ = 6e-4.
        let law = CurveLaw::new(curve);
        assert!((law.tension(extension, 1.0) / WIDTH - FORCE).abs() < 1e-3);
        let found = law.energy(extension, 1.0) / (0.5 * FORCE * WIDTH * extension);
        assert!((found - 0.55).abs() < 1e-3, "{name}: LT = {found}");
    }
}
