//! `muslin new`.

use crate::error::CliError;
use crate::print_text;

/// Scenes to start from: name, what it shows, and text.
const SCENES: [(&str, &str, &str); 8] = [
    ("hanging", "a 10 x 10 cloth hung by two corners", include_str!("../../../scenes/hanging.toml")),
    (
        "hanging-tangent",
        "the same cloth with springs that stiffen",
        include_str!("../../../scenes/hanging-tangent.toml"),
    ),
    (
        "hanging-100",
        "a cloth of 100 x 100 particles, hung the same way",
        include_str!("../../../scenes/hanging-100.toml"),
    ),
    ("flag", "a cloth pinned along one edge, in wind", include_str!("../../../scenes/flag.toml")),
    ("flag-flutter", "a flag that flutters in moving air", include_str!("../../../scenes/flag-flutter.toml")),
    ("free-fall", "a cloth that falls with drag", include_str!("../../../scenes/free-fall.toml")),
    ("wool", "a measured fabric, hung by two corners", include_str!("../../../scenes/wool.toml")),
    ("pendulum", "a column of particles that swings", include_str!("../../../scenes/pendulum.toml")),
];

/// Prints the scene `name`, or the names there are.
pub(crate) fn new(name: Option<&str>) -> Result<(), CliError> {
    let Some(name) = name else {
        let list = SCENES.map(|(name, description, _)| format!("{name:<16} {description}\n")).concat();
        return print_text(&format!("{list}\nwrite one to a file: muslin new hanging > my-scene.toml\n"));
    };
    let wanted = name.trim_end_matches(".toml");
    let Some((_, _, text)) = SCENES.iter().find(|(known, _, _)| *known == wanted) else {
        let names = SCENES.map(|(name, _, _)| name).join(", ");
        return Err(CliError::input(
            format_args!("there is no scene `{name}` to start from"),
            format_args!("scenes: {names}"),
        ));
    };
    print_text(text)
}
