//! Changing one value of a scene text.

use toml_edit::{Array, ArrayOfTables, DocumentMut, InlineTable, Item, Key, Table, Value};

use super::error::{SceneError, SceneErrorKind, quoted, shortened};
use super::read::{check_length, not_toml};

/// The scene text with one value set, as by `--set run.duration=1.0`; everything else stays as it is, comments too.
///
/// `assignment` is `key=value`. The key is a dotted path as in TOML; elements of arrays have their index as key, as in
/// `cloth.0.grid.columns=20`. Tables that are missing on the path are created. The value is a TOML value; a word that
/// is none is a string, as in `run.start=as-printed`. Whether the result is a scene is for [`Scene::parse`] to say.
///
/// # Errors
/// If the text is not TOML or too long, or the assignment has no `=`, no key, no value, or a path that leads through
/// something without keys or to an element that is not there.
///
/// [`Scene::parse`]: super::Scene::parse
pub fn set_value(text: &str, assignment: &str) -> Result<String, SceneError> {
    check_length(text)?;
    let fail = |reason: String, help: &str| {
        SceneError::new(SceneErrorKind::Assignment {
            assignment: quoted(assignment),
            reason,
            help: help.to_owned(),
        })
    };
    let (key, value) =
        split(assignment).ok_or_else(|| fail("it has no `=`".to_owned(), "write `run.duration=1.0`"))?;
    if key.trim().is_empty() {
        return Err(fail("it has no key".to_owned(), "write `run.duration=1.0`"));
    }
    let keys = Key::parse(key.trim()).map_err(|error| {
        fail(format!("its key is not TOML: {}", error.message()), "write `run.duration=1.0`")
    })?;
    let value = parse_value(value.trim()).map_err(|reason| {
        fail(reason, "write a TOML value: 1.0, true, \"text\", [0, 1, 0] or { constant = 1e-3 }")
    })?;

    let mut document: DocumentMut =
        text.parse().map_err(|error: toml_edit::TomlError| not_toml(error.message(), error.span(), text))?;
    assign(document.as_table_mut(), &keys, value)
        .map_err(|reason| fail(reason, "see the scene for its keys and the number of its elements"))?;
    Ok(document.to_string())
}

/// Splits an assignment at its first `=` that is not within quotes.
fn split(assignment: &str) -> Option<(&str, &str)> {
    let mut quote = None;
    let mut escaped = false;
    for (index, character) in assignment.char_indices() {
        match (quote, character) {
            (None, '=') => return Some((&assignment[..index], &assignment[index + 1..])),
            (None, '"' | '\'') => quote = Some(character),
            (Some('"'), '\\') if !escaped => {
                escaped = true;
                continue;
            }
            (Some(open), _) if character == open && !escaped => quote = None,
            _ => {}
        }
        escaped = false;
    }
    None
}

fn parse_value(value: &str) -> Result<Value, String> {
    if value.is_empty() {
        return Err("it has no value".to_owned());
    }
    match value.parse::<Value>() {
        Ok(mut value) => {
            value.decor_mut().clear();
            Ok(value)
        }
        Err(_) if is_word(value) => Ok(Value::from(value)),
        Err(error) => Err(format!("its value is not TOML: {}", error.message())),
    }
}

/// Whether `value` is more probably meant as a name, maybe of a file, than as a number or a table with a slip.
fn is_word(value: &str) -> bool {
    value.starts_with(char::is_alphabetic)
        && value.chars().all(|character| character.is_alphanumeric() || "_-. /".contains(character))
}

/// Something with values in it.
enum Container<'d> {
    Table(&'d mut Table),
    InlineTable(&'d mut InlineTable),
    Tables(&'d mut ArrayOfTables),
    Array(&'d mut Array),
}

/// Puts `value` where `keys` lead from `root`.
fn assign(root: &mut Table, keys: &[Key], value: Value) -> Result<(), String> {
    let Some((last, parents)) = keys.split_last() else {
        return Err("it has no key".to_owned());
    };
    let mut container = Container::Table(root);
    let mut path = String::new();
    for key in parents {
        let child = container.child(key.get(), &path)?;
        if !path.is_empty() {
            path.push('.');
        }
        path.push_str(&shortened(&key.display_repr()));
        container = child.ok_or_else(|| format!("`{path}` is a single value without keys"))?;
    }
    container.put(last.get(), value, &path)
}

impl<'d> Container<'d> {
    /// What is under `key`, created if it is missing from a table; nothing if it is a single value.
    fn child(self, key: &str, path: &str) -> Result<Option<Container<'d>>, String> {
        Ok(match self {
            Self::Table(table) => {
                let item = table.entry(key).or_insert_with(|| Item::Value(InlineTable::new().into()));
                match item {
                    Item::Table(table) => Some(Container::Table(table)),
                    Item::ArrayOfTables(tables) => Some(Container::Tables(tables)),
                    Item::Value(value) => Container::of_value(value),
                    Item::None => None,
                }
            }
            Self::InlineTable(table) => {
                if !table.contains_key(key) {
                    append(table, key, InlineTable::new().into());
                }
                table.get_mut(key).and_then(Container::of_value)
            }
            Self::Tables(tables) => {
                let index = index(key, tables.len(), path)?;
                tables.get_mut(index).map(Container::Table)
            }
            Self::Array(array) => {
                let index = index(key, array.len(), path)?;
                array.get_mut(index).and_then(Container::of_value)
            }
        })
    }

    fn of_value(value: &'d mut Value) -> Option<Self> {
        match value {
            Value::InlineTable(table) => Some(Self::InlineTable(table)),
            Value::Array(array) => Some(Self::Array(array)),
            _ => None,
        }
    }

    /// Replaces what is under `key`, with its comments left in place.
    fn put(self, key: &str, value: Value, path: &str) -> Result<(), String> {
        match self {
            Self::Table(table) => match table.get_mut(key) {
                Some(Item::Value(old)) => replace(old, value),
                _ => {
                    table.insert(key, Item::Value(value));
                }
            },
            Self::InlineTable(table) => match table.get_mut(key) {
                Some(old) => replace(old, value),
                None => append(table, key, value),
            },
            Self::Tables(tables) => {
                let index = index(key, tables.len(), path)?;
                let (Value::InlineTable(new), Some(old)) = (value, tables.get_mut(index)) else {
                    return Err(format!("`{path}.{index}` is a table and can become only another table"));
                };
                let mut new = new.into_table();
                new.set_position(old.position());
                *new.decor_mut() = old.decor().clone();
                *old = new;
            }
            Self::Array(array) => {
                let index = index(key, array.len(), path)?;
                if let Some(old) = array.get_mut(index) {
                    replace(old, value);
                }
            }
        }
        Ok(())
    }
}

/// Replaces a value, but not the space and comments around it.
fn replace(old: &mut Value, mut new: Value) {
    *new.decor_mut() = old.decor().clone();
    *old = new;
}

/// Adds a value after the last one, before the space and comments that follow it.
fn append(table: &mut InlineTable, key: &str, mut value: Value) {
    if let Some((_, last)) = table.iter_mut().last() {
        if let Some(suffix) = last.decor().suffix().cloned() {
            value.decor_mut().set_suffix(suffix);
        }
        last.decor_mut().set_suffix("");
    }
    table.insert(key, value);
}

/// The index that `key` is in an array at `path` of `length` elements.
fn index(key: &str, length: usize, path: &str) -> Result<usize, String> {
    let Ok(index) = key.parse::<usize>() else {
        return Err(format!("`{path}` is an array, and {} is not an index", quoted(key)));
    };
    if index < length {
        Ok(index)
    } else {
        Err(format!("`{path}` has {length} elements, so that {index} is beyond its last index"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const TEXT: &str = "\
# A scene.
title = 'x' # its title
[run] # how long
duration = 3.0   # [s]
[fabric.paper]
drag = 0.0
[[cloth]]
name = 'a'
grid = { columns = 10, rows = 2 } # small
pins = [
    { row = 0 }, # above
    { row = 1 },
]
[[cloth]]
name = 'b'
";

    fn set(assignment: &str) -> String {
        set_value(TEXT, assignment).unwrap_or_else(|error| panic!("{error}"))
    }

    fn reason(assignment: &str) -> String {
        set_value(TEXT, assignment).expect_err("is rejected").to_string()
    }

    #[test]
    fn one_value_changes_and_nothing_else() {
        for (assignment, old, new) in [
            ("run.duration=1", "duration = 3.0   # [s]", "duration = 1   # [s]"),
            (" run . duration = 1e-3 ", "duration = 3.0   #", "duration = 1e-3   #"),
            ("title=Hanging cloth", "'x' # its", "\"Hanging cloth\" # its"),
            ("title='a=b'", "'x' # its", "'a=b' # its"),
            ("title=data/warp.csv", "'x' # its", "\"data/warp.csv\" # its"),
            ("cloth.0.grid.columns=20", "columns = 10,", "columns = 20,"),
            ("cloth.0.pins.1.row=-1", "{ row = 1 },", "{ row = -1 },"),
            ("cloth.0.pins.0={ column = 3 }", "{ row = 0 }, #", "{ column = 3 }, #"),
            ("cloth.1.name=c", "'b'", "\"c\""),
            ("cloth.0.grid={ columns = 1, rows = 1 }", "columns = 10, rows = 2", "columns = 1, rows = 1"),
        ] {
            assert_eq!(set(assignment), TEXT.replace(old, new), "{assignment}");
        }
    }

    #[test]
    fn missing_keys_and_tables_are_created() {
        for (assignment, old, new) in [
            ("run.step.constant=1e-3", "[s]\n", "[s]\nstep = { constant = 1e-3 }\n"),
            ("cloth.0.grid.width=2.0", "rows = 2 }", "rows = 2, width = 2.0 }"),
            ("seed=true", "# its title\n", "# its title\nseed = true\n"),
            ("expect.a.below=1", "# its title\n", "# its title\nexpect = { a = { below = 1 } }\n"),
            ("fabric.paper.\"a=\\\"b\".x=1", "drag = 0.0\n", "drag = 0.0\n'a=\"b' = { x = 1 }\n"),
            ("fabric.silk.drag=1", "[fabric.paper]", "\n[fabric]\nsilk = { drag = 1 }\n[fabric.paper]"),
        ] {
            assert_eq!(set(assignment), TEXT.replacen(old, new, 1), "{assignment}");
        }
        assert_eq!(set_value("", "a.b=1").expect("is set"), "a = { b = 1 }\n");
    }

    #[test]
    fn what_cannot_be_set_says_why() {
        for (assignment, expected) in [
            ("run.duration", "it has no `=`"),
            ("\"run=1", "it has no `=`"),
            ("=1", "it has no key"),
            ("run.duration=", "it has no value"),
            (
                "run..duration=1",
                "its key is not TOML: unquoted keys cannot be empty, expected letters, numbers, `-`, `_`",
            ),
            ("run.duration=1,5", "its value is not TOML: unexpected content, expected nothing"),
            (
                "run.duration=3 s",
                "its value is not TOML: string values must be quoted, expected literal string",
            ),
            ("run.duration.x=1", "`run.duration` is a single value without keys"),
            ("cloth.x.name=1", "`cloth` is an array, and \"x\" is not an index"),
            ("cloth.2.name=c", "`cloth` has 2 elements, so that 2 is beyond its last index"),
            ("cloth.0.pins.9.row=0", "`cloth.0.pins` has 2 elements, so that 9 is beyond its last index"),
            ("cloth.0=1", "`cloth.0` is a table and can become only another table"),
        ] {
            assert_eq!(reason(assignment), format!("cannot set {}: {expected}", quoted(assignment)));
        }
        assert_eq!(
            set_value("[run", "a=1").expect_err("is rejected").to_string(),
            "the text is not TOML: unclosed table, expected `]`"
        );
    }

    proptest! {
        /// Whatever is assigned, the result is TOML that holds the value.
        #[test]
        fn the_result_is_toml_with_the_value(
            path in proptest::sample::select(vec![
                "a", "run", "run.x", "run.x.y", "run.duration", "fabric", "fabric.paper", "fabric.x.y", "cloth",
                "cloth.1", "cloth.0.grid", "cloth.0.grid.x.y.z", "cloth.0.pins.0", "cloth.0.pins.1.x", "x.y.z",
            ]),
            value in "[0-9]{1,3}|\\{ q = [1-9] \\}|\\[[1-9], 'a', \\{ b = 1 \\}\\]|true|[a-z-]{1,9}",
        ) {
            if let Ok(text) = set_value(TEXT, &format!("{path}={value}")) {
                let root = toml::de::DeTable::parse(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
                let mut keys = path.split('.');
                let mut found = &root.get_ref()[keys.next().expect("a key")];
                for key in keys {
                    found = match key.parse::<usize>() {
                        Ok(index) => &found.get_ref()[index],
                        Err(_) => &found.get_ref()[key],
                    };
                }
                let expected = value.parse::<Value>().unwrap_or_else(|_| Value::from(value.as_str()));
                prop_assert_eq!(found.get_ref().is_table(), expected.is_inline_table());
                prop_assert_eq!(found.get_ref().is_array(), expected.is_array());
                prop_assert_eq!(found.get_ref().as_str(), expected.as_str());
            }
        }

        #[test]
        fn no_assignment_panics(assignment in "\\PC{0,40}|[a-z.=\"'\\\\0-9{}\\[\\], ]{0,40}") {
            let _ = set_value(TEXT, &assignment);
        }
    }
}
