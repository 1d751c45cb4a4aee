//! A place in a text file, as an editor counts it.

use std::fmt;
use std::path::{Path, PathBuf};

use serde::Serialize;

/// A place in a file. `line` and `column` count from 1, columns in characters; a `line` of 0 means the file as
/// a whole (a binary file, or one that could not be read).
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub struct Place {
    /// The file, as the user named it.
    pub file: PathBuf,
    /// Line, from 1; 0 for the whole file.
    pub line: u32,
    /// Column in characters, from 1; 0 for the whole file.
    pub column: u32,
    /// How many characters of that line the place covers; at least 1 where there is a line.
    pub length: u32,
}

impl Place {
    /// The file as a whole.
    #[must_use]
    pub fn whole_file(file: impl Into<PathBuf>) -> Self {
        Self {
            file: file.into(),
            line: 0,
            column: 0,
            length: 0,
        }
    }

    /// The place of the bytes `start..start + len` of `text`; what passes the end of the line is cut.
    #[must_use]
    pub fn in_text(file: &Path, text: &str, start: usize, len: usize) -> Self {
        let (line, column) = line_column(text, start);
        let start = floor_char_boundary(text, start);
        let end = floor_char_boundary(text, start.saturating_add(len));
        let covered = text[start..end.max(start)].lines().next().unwrap_or("");
        let length = u32::try_from(covered.chars().count())
            .unwrap_or(u32::MAX)
            .max(1);
        Self {
            file: file.to_path_buf(),
            line,
            column,
            length,
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.line == 0 {
            write!(f, "{}", self.file.display())
        } else {
            write!(f, "{}:{}:{}", self.file.display(), self.line, self.column)
        }
    }
}

/// Line and column (both from 1, column in characters) of byte `offset` in `text`; an offset past the end is
/// taken as the end.
#[must_use]
pub fn line_column(text: &str, offset: usize) -> (u32, u32) {
    let offset = floor_char_boundary(text, offset);
    let before = &text[..offset];
    let line = before.bytes().filter(|&b| b == b'\n').count() + 1;
    let line_start = before.rfind('\n').map_or(0, |at| at + 1);
    let column = before[line_start..].chars().count() + 1;
    (
        u32::try_from(line).unwrap_or(u32::MAX),
        u32::try_from(column).unwrap_or(u32::MAX),
    )
}

fn floor_char_boundary(text: &str, offset: usize) -> usize {
    let mut at = offset.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_characters_not_bytes() {
        let text = "ab\näöü x\n";
        assert_eq!(line_column(text, text.find('x').unwrap()), (2, 5));
        assert_eq!(line_column(text, 10_000), (3, 1));
        assert_eq!(
            line_column(text, 4),
            (2, 1),
            "inside a character counts as its start"
        );
    }

    #[test]
    fn a_place_stays_on_its_line() {
        let place = Place::in_text(Path::new("a"), "one\ntwo", 1, 5);
        assert_eq!((place.line, place.column, place.length), (1, 2, 2));
    }
}
