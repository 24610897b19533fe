//! The JSON Schema of the scene file knows the same keys as the parser.

use std::collections::BTreeSet;

use muslin::scene::{JSON_SCHEMA, Scene, SceneErrorKind, set_value};
use serde_json::Value;

/// Where a complete scene has each object of the schema.
const OBJECTS: [(&str, &str); 23] = [
    ("", ""),
    ("/$defs/run", "run."),
    ("/$defs/step", "run.step."),
    ("/$defs/environment", "environment."),
    ("/$defs/particle_wind", "environment.wind.0."),
    ("/$defs/aerodynamic_wind", "environment.wind.1."),
    ("/$defs/springs_fabric", "fabric.paper."),
    ("/$defs/measured_fabric", "fabric.cotton."),
    ("/$defs/library_fabric", "fabric.wool."),
    ("/$defs/membrane_tension", "fabric.cotton.warp."),
    ("/$defs/membrane_shear", "fabric.cotton.shear."),
    ("/$defs/bending", "fabric.cotton.bend."),
    ("/$defs/yarn_rigidity", "fabric.cotton.bend.warp."),
    ("/$defs/rigidity", "fabric.cotton.bend.bias."),
    ("/$defs/springs", "fabric.paper.shear."),
    ("/$defs/limit", "fabric.paper.limit."),
    ("/$defs/cloth", "cloth.0."),
    ("/$defs/grid", "cloth.0.grid."),
    ("/$defs/place", "cloth.0.place."),
    ("/$defs/pin", "cloth.0.pins.0."),
    ("/$defs/motion", "cloth.1.pins.1.motion."),
    ("/$defs/expect", "expect."),
    ("/$defs/range", "expect.max_strain."),
];

#[test]
fn schema_and_parser_know_the_same_keys() {
    let schema: Value = serde_json::from_str(JSON_SCHEMA).expect("the schema is JSON");
    for (pointer, path) in OBJECTS {
        let object = schema.pointer(pointer).unwrap_or_else(|| panic!("no object at `{pointer}`"));
        let documented: BTreeSet<&str> = keys(&object["properties"]);
        let text = set_value(include_str!("scenes/complete.toml"), &format!("{path}no-such-key=1"))
            .expect("the key can be set");
        let error = Scene::parse(&text).expect_err("the key is unknown");
        let SceneErrorKind::UnknownKey { key, valid, .. } = error.kind() else {
            panic!("`{pointer}`: {error}");
        };
        assert_eq!(key, "no-such-key");
        assert_eq!(documented, valid.iter().copied().collect(), "keys at `{pointer}`");
    }
}

/// No object of the schema is left out of the comparison, and none lets unknown keys pass.
#[test]
fn every_object_of_the_schema_is_compared() {
    let schema: Value = serde_json::from_str(JSON_SCHEMA).expect("the schema is JSON");
    let definitions = keys(&schema["$defs"]).into_iter().map(|name| format!("/$defs/{name}"));
    let objects: BTreeSet<String> = definitions
        .chain([String::new()])
        .filter(|pointer| schema.pointer(pointer).is_some_and(|object| object["type"] == "object"))
        .collect();
    assert_eq!(objects, OBJECTS.iter().map(|(pointer, _)| (*pointer).to_owned()).collect());
    for pointer in objects {
        let object = schema.pointer(&pointer).expect("listed above");
        assert_eq!(object["additionalProperties"], false, "at `{pointer}`");
        for key in object["required"].as_array().into_iter().flatten().filter_map(Value::as_str) {
            assert!(keys(&object["properties"]).contains(key), "`{pointer}` requires `{key}`");
        }
    }
}

/// What the schema requires, the parser requires, and nothing else.
#[test]
fn schema_and_parser_require_the_same_keys() {
    let schema: Value = serde_json::from_str(JSON_SCHEMA).expect("the schema is JSON");
    for (pointer, path) in OBJECTS {
        let object = schema.pointer(pointer).expect("listed above");
        let required: BTreeSet<&str> =
            object["required"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
        for key in keys(&object["properties"]) {
            let text = without(&format!("{path}{key}"));
            let missing = Scene::parse(&text).err().is_some_and(|error| {
                matches!(error.kind(), SceneErrorKind::Missing { key: missing, .. } if *missing == format!("{path}{key}"))
            });
            // Required because the grid has more than one column and row, the wind noise, the law a stiffness; because the
            // limit is a cut-off and the motion a sine; and because it has the other keys of a sine.
            let conditional =
                ["width", "height", "noise_time", "stiffness", "strain", "axis", "amplitude", "frequency"];
            let of_sine = ["amplitude", "angular_frequency", "phase"].contains(&key);
            // One of several ways to the same quantity.
            let ways = ["areal_density", "modulus"].contains(&key)
                || (pointer == "/$defs/rigidity" && key == "rigidity");
            // Needed by 2HG5.
            let ways = ways || key == "2hg";
            let conditional =
                conditional.contains(&key) || ways || (pointer == "/$defs/aerodynamic_wind" && of_sine);
            assert_eq!(missing, required.contains(key) || conditional, "`{path}{key}`");
        }
    }
}

/// The complete scene without the value at `path`.
fn without(path: &str) -> String {
    let mut document: toml_edit::DocumentMut =
        include_str!("scenes/complete.toml").parse().expect("the scene is TOML");
    let (parents, key) = path.rsplit_once('.').unwrap_or(("", path));
    let mut item = document.as_item_mut();
    for parent in parents.split('.').filter(|parent| !parent.is_empty()) {
        item = match parent.parse::<usize>() {
            Ok(index) if item.is_value() => {
                let table = item.as_array_mut().and_then(|array| array.get_mut(index)).expect("an element");
                table.as_inline_table_mut().expect("a table").remove(key);
                return document.to_string();
            }
            Ok(index) => &mut item[index],
            Err(_) => &mut item[parent],
        };
    }
    item.as_table_like_mut().expect("a table").remove(key);
    document.to_string()
}

fn keys(object: &Value) -> BTreeSet<&str> {
    object.as_object().expect("an object").keys().map(String::as_str).collect()
}
