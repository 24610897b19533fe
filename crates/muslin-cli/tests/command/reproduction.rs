//! The page that recomputes the paper.

use muslin::integrate::Workers;
use muslin::observe::Recorder;
use muslin::scene::set_value;
use muslin::{Scene, Simulation};
use serde_json::{Value, json};

use crate::work::{Outcome, Work, exists};

const HANGING: &str = include_str!("../../../../scenes/hanging.toml");

/// Sections of the page.
const SECTIONS: [&str; 7] = ["springs", "stretch", "hanging", "limit", "refinement", "particles", "steps"];

/// Readings of the paper's limit, in every table of them.
const READINGS: [&str; 5] = ["none", "cut-off", "projection", "tangent", "softening"];

fn reproduced() -> (Work, Outcome) {
    let work = Work::new();
    let outcome = work.muslin("reproduce page --quick");
    assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
    (work, outcome)
}

fn figures(work: &Work) -> Value {
    serde_json::from_slice(&work.read("page/figures.json")).expect("JSON")
}

/// The rows of a table of figures.json in which `column` is `name`.
fn rows<'f>(figures: &'f Value, table: &str, column: &str, name: &str) -> Vec<&'f Value> {
    let rows = figures["tables"][table]["rows"].as_array().expect("rows");
    rows.iter().filter(|row| row[column] == name).collect()
}

#[test]
fn the_page_has_every_section_and_needs_nothing_else() {
    let (work, outcome) = reproduced();
    assert!(outcome.stdout.starts_with("page: "), "{}", outcome.stdout);
    assert!(outcome.stdout.ends_with("look at it: open page/index.html\n"), "{}", outcome.stdout);
    let page = work.text("page/index.html");
    for section in SECTIONS {
        assert!(page.contains(&format!("<section id=\"{section}\">")), "{section}");
        assert!(page.contains(&format!("<a href=\"#{section}\">")), "{section}");
    }
    assert_eq!(page.matches("<section").count(), SECTIONS.len());
    for outside in ["http:", "https:", "src=\"f", "<script", "<link", "@import", "url(f"] {
        assert!(!page.contains(outside), "{outside}");
    }
    let names = work.names("page");
    for name in names.iter().filter(|name| !name.ends_with(".png")) {
        let text = work.text(&format!("page/{name}"));
        for wrong in ["NaN", "inf,", "Infinity", "unstable", "unbounded"] {
            assert!(!text.contains(wrong), "{wrong} in {name}");
        }
        // One colour scheme would be unreadable in the other.
        assert!(!name.ends_with(".svg") || text.contains("prefers-color-scheme: dark"), "{name}");
    }
    for (ending, count) in [(".svg", 12), (".csv", 18), (".png", 2)] {
        let found = names.iter().filter(|name| name.ends_with(ending)).count();
        assert!(count <= found, "{found} files end in {ending}: {names:?}");
    }
    assert!(!exists(work.path("page/.reproduction")));
}

/// Every reading of every grid, against a run by the library.
#[test]
fn numbers_agree_with_runs_of_their_own() {
    let (work, _) = reproduced();
    let figures = figures(&work);
    for reading in READINGS {
        assert_eq!(rows(&figures, "table-5-refinement", "reading", reading).len(), 2, "{reading}");
        assert_eq!(rows(&figures, "table-4-steps", "reading", reading).len(), 1, "{reading}");
    }
    // The tangent law on 6 x 6 particles for 0.25 s, 60 steps per frame.
    let assignments = [
        "run.duration=0.25",
        "run.step.constant=2.777777777777778e-4",
        "cloth.0.grid.columns=6",
        "cloth.0.grid.rows=6",
        "fabric.paper.particle_mass=5.555555555555556e-3",
        "fabric.paper.drag=5.555555555555556e-3",
        "fabric.paper.structural.law=tangent",
        "fabric.paper.structural.strain_scale=0.06",
    ];
    let text = assignments.iter().try_fold(HANGING.to_owned(), |text, change| set_value(&text, change));
    let scene = Scene::parse(&text.expect("assignments")).expect("a scene");
    let integrator = Simulation::integrator(&scene, Workers::single());
    let mut simulation = Simulation::new(&scene, integrator).expect("a stable step");
    let mut recorder = Recorder::default();
    simulation.observe(&mut [&mut recorder]);
    while !simulation.is_finished() {
        simulation.advance(&mut [&mut recorder]).expect("a stable motion");
    }
    let expected = recorder.max_strains()[0].expect("structural springs");
    let found = rows(&figures, "table-4-steps", "reading", "tangent")[0]["largest strain at h"].as_f64();
    assert_eq!(found, Some(expected));
}

/// Everything but times has the same bits in every reproduction.
#[test]
fn a_second_reproduction_differs_in_times_alone() {
    let (work, _) = reproduced();
    let before = work.contents("page");
    let refused = work.muslin("reproduce page --quick");
    refused.assert_failure(
        2,
        "error: page exists already and is not empty\n  help: replace its files with `--force`, or choose another folder",
    );
    assert!(work.contents("page") == before, "the refused reproduction changed a file");
    let outcome = work.muslin("reproduce page --quick --force");
    assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
    let after = work.contents("page");
    let names = |files: &[(String, Vec<u8>)]| files.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
    assert_eq!(names(&before), names(&after));
    // Of the SVG files those of Fig. 6 show times; the tables have a column of them.
    for ((name, old), (_, new)) in before.iter().zip(&after) {
        let is_timeless = name == "paper-figures.md"
            || name.ends_with(".png")
            || (name.starts_with("figure-") && !name.starts_with("figure-6"));
        assert!(!is_timeless || old == new, "{name} differs");
    }
}

#[test]
fn other_folders_are_left_alone() {
    let work = Work::with_scene(&[]);
    work.muslin("run scene.toml --out run").assert_success();
    let before = work.contents("run");
    work.muslin("reproduce run --quick --force").assert_failure(
        2,
        "error: run holds other files than those of a reproduction, which `--force` does not replace\n  help: choose another folder",
    );
    assert!(work.contents("run") == before);
    work.muslin("reproduce scene.toml --quick").assert_failure(
        2,
        "error: scene.toml is a file, but must be a folder or not exist\n  help: choose another name",
    );
    let (reproduction, _) = reproduced();
    assert_eq!(figures(&reproduction)["quick"], json!(true));
    let outcome = reproduction.muslin("verify page");
    assert_eq!(outcome.code, Some(2), "a reproduction is no run: {}", outcome.stderr);
}
