//! No text and no assignment makes the scene reader panic; its errors are well-formed, and what it accepts is in range.
//!
//! The input is a scene text, or a text and an assignment with a zero byte between them.

#![no_main]

use libfuzzer_sys::fuzz_target;
use muslin::scene::{MAX_FRAME_INTERVALS, MAX_PARTICLES, Scene, SceneError, set_value};

fuzz_target!(|input: &str| {
    match input.split_once('\0') {
        None => read(input),
        Some((text, assignment)) => match set_value(text, assignment) {
            Ok(text) => read(&text),
            Err(error) => check_error(&error, text),
        },
    }
});

/// What every file that a scene names holds.
const TABLE: &[u8] = b"strain [%],tension [N]\n1,0.5\n2,1.7\n";

fn read(text: &str) {
    match Scene::parse_with(text, &mut |_| Ok(TABLE.to_vec())) {
        Ok(scene) => check_scene(&scene),
        Err(error) => check_error(&error, text),
    }
}

fn check_error(error: &SceneError, text: &str) {
    let message = error.to_string();
    assert!(!message.contains('\n'), "{message:?}");
    let rendered = error.render("scene.toml", text);
    assert!(rendered.starts_with(&format!("error: {message}\n")), "{rendered:?}");
    if let Some(position) = error.position() {
        assert!(position.line <= text.split('\n').count(), "{position:?}");
        assert!(1 <= position.column && 1 <= position.length, "{position:?}");
        assert!(rendered.contains('^'), "{rendered:?}");
    }
}

fn check_scene(scene: &Scene) {
    let run = scene.run();
    assert!((1..=MAX_FRAME_INTERVALS).contains(&run.frame_intervals));
    assert!(0.0 < run.duration && run.duration.is_finite());
    let particles = scene.cloths().iter().map(|cloth| cloth.grid.columns as u64 * cloth.grid.rows as u64);
    assert!((1..=MAX_PARTICLES).contains(&particles.sum::<u64>()));
    for cloth in scene.cloths() {
        assert!(scene.fabrics().contains_key(&cloth.fabric));
        let place = cloth.place;
        assert!(place.origin.is_finite());
        assert!((place.width_axis.length() - 1.0).abs() < 1e-12);
        assert!((place.height_axis.length() - 1.0).abs() < 1e-12);
        assert!(place.width_axis.dot(place.height_axis).abs() < 1e-8);
    }
}
