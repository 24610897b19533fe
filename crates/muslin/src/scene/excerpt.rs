//! Places in a text, and the line around a place with a caret under it.

use std::ops::Range;
use std::path::Path;

use unicode_width::UnicodeWidthChar;

use super::data::CellError;
use super::error::{Position, SceneError, SceneErrorKind};

/// The most characters of a line that an excerpt shows.
const SHOWN_CHARACTERS: usize = 100;

/// The place of a range of bytes. A range beyond the text is its end; one of several lines ends with its first.
pub(super) fn position(text: &str, span: Range<usize>) -> Position {
    let start = floor_boundary(text, span.start);
    let end = floor_boundary(text, span.end).max(start);
    let before = &text[..start];
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    let in_line = text[line_start..start].trim_start_matches(BYTE_ORDER_MARK);
    let marked = text[start..end].lines().next().unwrap_or_default();
    Position {
        line: before.matches('\n').count() + 1,
        column: in_line.chars().count() + 1,
        length: marked.chars().count().max(1),
    }
}

/// See [`SceneError::render`].
pub(super) fn render(error: &SceneError, name: &str, text: &str) -> String {
    let mut places = Vec::new();
    if let SceneErrorKind::Data { file, position, line, .. } = error.kind() {
        // Beside the scene, wherever that is.
        let path = Path::new(name).with_file_name(file).display().to_string();
        places.push((path, *position, line.clone()));
    }
    let position = error.position();
    let content = position.map_or(String::new(), |position| line(text, position.line));
    places.push((name.to_owned(), position, content));

    lines_of(&error.to_string(), &places, error.help().as_deref())
}

/// See [`CellError::render`].
pub(super) fn render_cell(error: &CellError, name: &str) -> String {
    let place = (name.to_owned(), error.position, error.line.clone());
    let line = error.position.map_or(String::new(), |position| format!(" line {}:", position.line));
    lines_of(&format!("`{name}`{line} {}", error.message), &[place], Some(&error.help))
}

/// `message`, its `places` in files with their lines, and help.
fn lines_of(message: &str, places: &[(String, Option<Position>, String)], help: Option<&str>) -> String {
    let numbers =
        places.iter().filter_map(|(_, position, _)| position.map(|position| position.line.to_string().len()));
    let gutter = " ".repeat(numbers.max().unwrap_or(1));
    let mut lines = vec![format!("error: {message}")];
    for (name, position, content) in places {
        let Some(Position { line, column, length }) = *position else {
            lines.push(format!("{gutter}--> {name}"));
            continue;
        };
        lines.push(format!("{gutter}--> {name}:{line}:{column}"));
        let (shown, caret) = line_and_caret(content, column - 1, length);
        lines.push(format!("{gutter} |"));
        lines.push(format!("{line:<width$} | {shown}", width = gutter.len()).trim_end().to_owned());
        lines.push(format!("{gutter} | {caret}"));
    }
    if let Some(help) = help {
        lines.push(format!("{gutter} = help: {help}"));
    }
    lines.join("\n")
}

/// The line of `text` that is counted as `number` from 1, without its end.
pub(super) fn line(text: &str, number: usize) -> String {
    text.trim_start_matches(BYTE_ORDER_MARK).lines().nth(number - 1).unwrap_or_default().to_owned()
}

const BYTE_ORDER_MARK: char = '\u{feff}';

/// The part of a line around a place, and a line of carets below the `length` characters that begin at `start`.
fn line_and_caret(line: &str, start: usize, length: usize) -> (String, String) {
    let from = if start < SHOWN_CHARACTERS { 0 } else { start - SHOWN_CHARACTERS / 2 };
    let mut shown = String::from(if 0 < from { "..." } else { "" });
    let mut caret = " ".repeat(shown.len());
    let mut characters = line.chars().skip(from);
    for (index, character) in characters.by_ref().take(SHOWN_CHARACTERS).enumerate() {
        // A control character would move the cursor.
        let visible = match character {
            '\t' => ' ',
            _ if character.is_control() => char::REPLACEMENT_CHARACTER,
            _ => character,
        };
        shown.push(visible);
        let mark = if from + index < start {
            " "
        } else if from + index < start + length {
            "^"
        } else {
            ""
        };
        caret.push_str(&mark.repeat(visible.width().unwrap_or(0)));
    }
    if characters.next().is_some() {
        shown.push_str("...");
    }
    if !caret.contains('^') {
        // The place is the line's end.
        caret.push('^');
    }
    (shown, caret)
}

/// The last place at or before `index` where a character of `text` begins or the text ends.
fn floor_boundary(text: &str, index: usize) -> usize {
    (0..=index.min(text.len())).rev().find(|&index| text.is_char_boundary(index)).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_count_characters_from_one() {
        let text = "\u{feff}a = 1\r\nnäme = 'ü'\n";
        let at = |needle: &str| {
            let start = text.find(needle).expect("in the text");
            position(text, start..start + needle.len())
        };
        assert_eq!(at("a ="), Position { line: 1, column: 1, length: 3 });
        assert_eq!(at("'ü'"), Position { line: 2, column: 8, length: 3 });
        assert_eq!(at("1\r\nnäme"), Position { line: 1, column: 5, length: 1 });
        assert_eq!(position(text, 999..999), Position { line: 3, column: 1, length: 1 });
        assert_eq!(position("", 0..0), Position { line: 1, column: 1, length: 1 });
    }

    #[test]
    fn carets_stand_below_wide_characters_and_tabs() {
        assert_eq!(line_and_caret("\t布 = 布x", 5, 1), (" 布 = 布x".into(), "      ^^".into()));
    }

    #[test]
    fn a_long_line_is_cut_around_the_place() {
        let line = format!("{}X{}", "a".repeat(1000), "b".repeat(1000));
        let (shown, caret) = line_and_caret(&line, 1000, 1);
        assert_eq!(shown, format!("...{}X{}...", "a".repeat(50), "b".repeat(49)));
        assert_eq!(caret.find('^'), shown.find('X'));
    }

    #[test]
    fn a_place_at_the_end_of_the_line_has_a_caret() {
        assert_eq!(line_and_caret("a =", 3, 1), ("a =".into(), "   ^".into()));
    }
}
