//! The library's modules depend on each other only as drawn, and on the machine not at all; read from the sources.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Which module may use which, from the bottom up; in brackets, if not all of it.
///
/// Scene, model, force, integrate and observe are the data flow; statics and the laboratory are beside it. A model builds its forces and limits, and these know what they act
/// on: of the model its grids and particles, nothing else. Nothing knows the run but the commands, and what writes files
/// knows neither methods nor forces.
const MAY_USE: [(&str, &[&str]); 14] = [
    ("aligned", &[]),
    ("points", &["aligned"]),
    ("instructions", &[]),
    ("scene", &[]),
    ("state", &["points"]),
    ("force", &["points", "instructions", "scene", "model::Grid", "model::Particles"]),
    ("limit", &["points", "scene", "model::Grid", "model::Particles"]),
    ("model", &["points", "instructions", "scene", "state", "force", "limit"]),
    ("integrate", &["points", "instructions", "scene", "state", "force", "model"]),
    ("observe", &["points", "instructions", "scene", "state", "force", "model"]),
    ("statics", &["points", "state", "force", "model"]),
    ("lab", &["points", "scene", "state", "force", "model", "integrate", "statics"]),
    ("write", &["points", "model", "observe", "force::Family"]),
    ("run", &["points", "scene", "state", "model", "integrate", "observe"]),
];

/// What decides the bits of a run, or of a test.
const STEPPING: [&str; 12] = [
    "aligned",
    "points",
    "instructions",
    "state",
    "force",
    "limit",
    "model",
    "integrate",
    "observe",
    "run",
    "statics",
    "lab",
];

/// A library that opens no files, reads no clock or environment and prints nothing.
const NOT_IN_THE_LIBRARY: [&str; 8] =
    ["std::fs", "std::time", "std::env", "std::process", "std::net", "println!", "print!", "dbg!"];

/// Functions whose last bits depend on the platform, or on whether the processor fuses operations.
const NOT_WHERE_BITS_ARE_MADE: [&str; 23] = [
    "mul_add",
    ".sin(",
    ".cos(",
    ".sin_cos(",
    ".tan(",
    ".asin(",
    ".acos(",
    ".atan(",
    ".atan2(",
    ".sinh(",
    ".cosh(",
    ".tanh(",
    ".exp(",
    ".exp2(",
    ".exp_m1(",
    ".ln(",
    ".ln_1p(",
    ".log10(",
    ".log2(",
    ".powf(",
    ".powi(",
    ".cbrt(",
    ".hypot(",
];

/// A source file of the library, without comments and unit tests.
struct Source {
    /// Path below `src`.
    path: PathBuf,
    code: String,
}

impl Source {
    /// The top module it belongs to; none for the library's root.
    fn module(&self) -> Option<&str> {
        let first = self.path.iter().next()?.to_str()?;
        let module = first.strip_suffix(".rs").unwrap_or(first);
        (module != "lib").then_some(module)
    }
}

/// All but files of unit tests.
fn sources() -> Vec<Source> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut sources = Vec::new();
    let mut folders = vec![root.clone()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).unwrap_or_else(|error| panic!("{error}")) {
            let path = entry.unwrap_or_else(|error| panic!("{error}")).path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs")
                && !path.ends_with("tests.rs")
            {
                let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{error}"));
                let path = path.strip_prefix(&root).unwrap_or_else(|error| panic!("{error}")).to_owned();
                sources.push(Source { path, code: code(&text) });
            }
        }
    }
    assert!(sources.len() > 30, "the sources were found");
    sources
}

/// `text` without line comments and without unit tests, which stand last in a file.
fn code(text: &str) -> String {
    let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let lines = text.lines().map(|line| line.split("//").next().unwrap_or_default());
    lines.collect::<Vec<_>>().join("\n")
}

/// Adds to `paths` what the use tree at the start of `text` names, each after `prefix`; the rest of `text`.
fn read_tree<'a>(text: &'a str, prefix: &str, paths: &mut BTreeSet<String>) -> &'a str {
    let text = text.trim_start();
    if let Some(mut rest) = text.strip_prefix('{') {
        loop {
            rest = rest.trim_start();
            if let Some(rest) = rest.strip_prefix('}') {
                return rest;
            }
            rest = read_tree(rest, prefix, paths).trim_start();
            rest = rest.strip_prefix(',').unwrap_or(rest);
        }
    }
    let end = text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len());
    assert!(0 < end, "a path after `{prefix}` in `{}`", &text[..text.len().min(40)]);
    let path = if prefix.is_empty() { text[..end].to_owned() } else { format!("{prefix}::{}", &text[..end]) };
    match text[end..].strip_prefix("::") {
        Some(rest) => read_tree(rest, &path, paths),
        None => {
            paths.insert(path);
            &text[end..]
        }
    }
}

/// Every path of the crate that `code` names, without `crate::`.
fn crate_paths(code: &str) -> BTreeSet<String> {
    let mut paths = BTreeSet::new();
    for (position, _) in code.match_indices("crate::") {
        read_tree(&code[position + "crate::".len()..], "", &mut paths);
    }
    paths
}

/// Names at the library's root, with the module that each comes from.
fn root_names(sources: &[Source]) -> Vec<(String, String)> {
    let root = sources.iter().find(|source| source.module().is_none()).unwrap_or_else(|| panic!("no root"));
    let mut names = Vec::new();
    for (position, _) in root.code.match_indices("pub use ") {
        let mut paths = BTreeSet::new();
        read_tree(&root.code[position + "pub use ".len()..], "", &mut paths);
        for path in paths {
            let (module, _) = path.split_once("::").unwrap_or((&path, ""));
            let name = path.rsplit("::").next().unwrap_or_default();
            names.push((name.to_owned(), module.to_owned()));
        }
    }
    names
}

#[test]
fn modules_use_only_what_they_may() {
    let sources = sources();
    let names = root_names(&sources);
    let mut wrong = Vec::new();
    for source in &sources {
        let Some(module) = source.module() else { continue };
        let allowed = MAY_USE.iter().find(|(name, _)| *name == module);
        let (_, allowed) = allowed.unwrap_or_else(|| panic!("module `{module}` is not drawn"));
        for path in crate_paths(&source.code) {
            let first = path.split("::").next().unwrap_or_default();
            let full = match names.iter().find(|(name, _)| name == first) {
                Some((_, origin)) => format!("{origin}::{path}"),
                None => path.clone(),
            };
            let may = |allowed: &&str| full == **allowed || full.starts_with(&format!("{allowed}::"));
            if full.split("::").next() != Some(module) && !allowed.iter().any(may) {
                wrong.push(format!("{} uses {full}", source.path.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// `super` must not lead out of a module unseen.
#[test]
fn modules_reach_the_root_by_name_only() {
    for source in sources() {
        let inside = source.path.iter().count() - 1;
        let is_module_root = source.path.file_name().is_some_and(|name| name == "mod.rs");
        // Levels that `super` may climb and still be inside the top module.
        let levels = if is_module_root { inside.saturating_sub(1) } else { inside };
        let too_many = "super::".repeat(levels + 1);
        assert!(!source.code.contains(&too_many), "{} leaves its module", source.path.display());
    }
}

fn assert_absent(words: &[&str], modules: Option<&[&str]>) {
    let mut found = Vec::new();
    for source in sources() {
        let is_meant = modules.is_none_or(|modules| source.module().is_some_and(|m| modules.contains(&m)));
        let words = words.iter().filter(|word| is_meant && source.code.contains(**word));
        found.extend(words.map(|word| format!("`{word}` in {}", source.path.display())));
    }
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn the_library_touches_nothing_outside() {
    assert_absent(&NOT_IN_THE_LIBRARY, None);
}

#[test]
fn bits_are_the_same_on_every_machine() {
    assert_absent(&NOT_WHERE_BITS_ARE_MADE, Some(&STEPPING));
}

/// The reader of paths sees what it should, or the tests above would hold for anything.
#[test]
fn paths_are_read_from_nested_uses() {
    let code =
        code("use crate::force::{self, Force, law::{A, B}}; // crate::no\nfn f(_: crate::Points) {}\n");
    let expected = ["Points", "force::Force", "force::law::A", "force::law::B", "force::self"];
    assert_eq!(crate_paths(&code).iter().map(String::as_str).collect::<Vec<_>>(), expected);
}
