//! WGSL's tokens, as far as the linker needs them: no comments, no blanks, doc comments kept.

use std::ops::Range;

/// What a token is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A name, keyword or number.
    Word,
    /// `/// …`
    Doc,
    /// `#`, with the rest of its line where it is the first on the line.
    Hash,
    /// Any other character, or a text in quotes.
    Mark(char),
}

#[derive(Clone, Debug)]
pub(crate) struct Token {
    pub kind: Kind,
    pub range: Range<usize>,
}

/// Line ends of WGSL, which end a comment.
fn is_line_end(c: char) -> bool {
    matches!(c, '\n'..='\r' | '\u{85}' | '\u{2028}' | '\u{2029}')
}

/// All tokens of a text; whatever it is, they cover it in order and without overlap.
pub(crate) fn tokens(text: &str) -> Vec<Token> {
    let mut tokens = Vec::new();
    let mut at = if text.starts_with('\u{feff}') { 3 } else { 0 };
    while let Some(c) = text[at..].chars().next() {
        let rest = &text[at..];
        let (kind, len) = if rest.starts_with("//") {
            let len = rest.find(is_line_end).unwrap_or(rest.len());
            (rest.starts_with("///").then_some(Kind::Doc), len)
        } else if rest.starts_with("/*") {
            (None, block_comment_len(rest))
        } else if c == '#' {
            let before = &text[..at];
            let line = before.rfind('\n').map_or(0, |end| end + 1);
            let is_first = before[line..]
                .trim_start_matches('\u{feff}')
                .trim()
                .is_empty();
            let len = if is_first {
                rest.find('\n')
                    .map_or(rest.len(), |end| rest[..end].trim_end().len())
            } else {
                1
            };
            (Some(Kind::Hash), len)
        } else if c == '"' {
            let line = &rest[..rest.find('\n').unwrap_or(rest.len())];
            let len = line[1..].find('"').map_or(line.len(), |end| end + 2);
            (Some(Kind::Mark(c)), len)
        } else if c == '_' || c.is_alphanumeric() {
            let len = rest
                .find(|c: char| c != '_' && !c.is_alphanumeric())
                .unwrap_or(rest.len());
            (Some(Kind::Word), len)
        } else if c.is_whitespace() {
            (None, c.len_utf8())
        } else {
            (Some(Kind::Mark(c)), c.len_utf8())
        };
        if let Some(kind) = kind {
            tokens.push(Token {
                kind,
                range: at..at + len,
            });
        }
        at += len;
    }
    tokens
}

fn block_comment_len(text: &str) -> usize {
    let bytes = text.as_bytes();
    let (mut depth, mut at) = (0_usize, 0);
    while at + 1 < bytes.len() {
        match &bytes[at..at + 2] {
            b"/*" => {
                depth += 1;
                at += 2;
            }
            b"*/" => {
                depth -= 1;
                at += 2;
                if depth == 0 {
                    return at;
                }
            }
            _ => at += 1,
        }
    }
    text.len()
}
