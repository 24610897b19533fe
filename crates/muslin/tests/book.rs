//! What the book says of scene files is what the library reads.

use std::collections::BTreeSet;

use muslin::Scene;
use muslin::scene::JSON_SCHEMA;
use serde_json::Value;

const REFERENCE: &str = include_str!("../../../book/src/scene.md");
const TUTORIAL: &str = include_str!("../../../book/src/tutorial.md");
const HANGING: &str = include_str!("../../../scenes/hanging.toml");

/// The blocks of code in `page` that are marked as `language`.
fn code_blocks<'a>(page: &'a str, language: &str) -> Vec<&'a str> {
    let opening = format!("```{language}\n");
    page.split(opening.as_str()).skip(1).filter_map(|rest| rest.split("```").next()).collect()
}

fn parse(text: &str) -> Scene {
    Scene::parse(text).unwrap_or_else(|error| panic!("{}", error.render("book", text)))
}

/// Every property of the schema has a row in a table of the reference, and every row is of a property.
#[test]
fn every_key_is_in_the_reference() {
    let schema: Value = serde_json::from_str(JSON_SCHEMA).expect("the schema is JSON");
    let objects = schema["$defs"].as_object().expect("definitions").values().chain([&schema]);
    let keys: BTreeSet<&str> = objects
        .filter_map(|object| object["properties"].as_object())
        .flat_map(|properties| properties.keys().map(String::as_str))
        .collect();
    let rows: BTreeSet<&str> = REFERENCE
        .lines()
        .filter_map(|line| line.strip_prefix("| `")?.split('`').next())
        .filter_map(|key| key.rsplit('.').next())
        .collect();
    assert_eq!(rows, keys, "rows of the reference (left) and properties of the schema (right)");
}

/// Names that a key may have, and defaults, are in the row of their key.
#[test]
fn every_name_and_default_is_in_the_reference() {
    let schema: Value = serde_json::from_str(JSON_SCHEMA).expect("the schema is JSON");
    let objects = schema["$defs"].as_object().expect("definitions").values();
    for (key, property) in objects.filter_map(|object| object["properties"].as_object()).flatten() {
        let names = property["enum"].as_array().into_iter().flatten();
        for value in names.chain(property.get("default")) {
            let found = REFERENCE
                .lines()
                .filter(|line| line.starts_with(&format!("| `{key}`")))
                .any(|line| line.contains(&format!("`{value}`")));
            assert!(found, "the reference says {value} in no row of `{key}`");
        }
    }
}

/// The first block is a whole scene; the others are tables of one.
#[test]
fn examples_of_the_reference_are_scenes() {
    let blocks = code_blocks(REFERENCE, "toml");
    let [whole, parts @ ..] = &blocks[..] else { panic!("no examples") };
    assert!(6 <= parts.len(), "only {} tables", parts.len());
    parse(whole);
    parse(&format!("title = \"together\"\n{}", parts.concat()));
}

/// The tutorial's banner is the scene `hanging` up to its environment, and what the tutorial replaces the rest by.
#[test]
fn scene_of_the_tutorial_is_one() {
    let (head, _) = HANGING.split_once("[environment]").expect("`hanging` has an environment");
    let blocks = code_blocks(TUTORIAL, "toml");
    let [banner] = blocks[..] else { panic!("{} examples", blocks.len()) };
    let scene = parse(&format!("{head}{banner}"));
    assert_eq!(scene.cloths()[0].name, "banner");
}
