//! Where the entries of a RON map, struct or variant stand: what an edit cuts out and puts in.
//!
//! The text is right RON already. It is taken apart into tokens, of which blanks and comments are some, so that the ends of
//! an entry are known to the byte: serde's slices hold the blanks around a value too.

use std::ops::Range;

/// The bytes of one entry.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    /// The name as it stands, quotes included.
    pub name: Range<usize>,
    /// The value without blanks around it.
    pub value: Range<usize>,
    /// Where the comma behind it ends.
    pub comma: Option<usize>,
}

/// A map `{…}`, a struct `(…)` or a variant `name(…)`.
#[derive(Clone, Debug)]
pub(super) struct Container {
    /// Just behind the opening bracket.
    pub open: usize,
    /// At the closing one.
    pub close: usize,
    /// What is named in it.
    pub entries: Vec<Entry>,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Blank,
    Open,
    Close,
    Comma,
    Colon,
    Word,
}

/// The token at a place: its kind and its end.
fn token(text: &str, at: usize) -> Option<(Kind, usize)> {
    let rest = &text[at..];
    let first = rest.chars().next()?;
    let until = |end: Option<usize>| at + end.unwrap_or(rest.len());
    Some(match first {
        '/' if rest.starts_with("//") => (Kind::Blank, until(rest.find('\n'))),
        '/' if rest.starts_with("/*") => (Kind::Blank, until(block_comment(rest))),
        '(' | '[' | '{' => (Kind::Open, at + 1),
        ')' | ']' | '}' => (Kind::Close, at + 1),
        ',' => (Kind::Comma, at + 1),
        ':' => (Kind::Colon, at + 1),
        '"' => (Kind::Word, until(quoted(rest, '"'))),
        '\'' => (Kind::Word, until(quoted(rest, '\''))),
        c if c.is_whitespace() => (Kind::Blank, at + c.len_utf8()),
        _ => (Kind::Word, until(word(rest))),
    })
}

fn block_comment(text: &str) -> Option<usize> {
    let (mut depth, mut at) = (0_usize, 0);
    while at < text.len() {
        let rest = &text.as_bytes()[at..];
        if rest.starts_with(b"/*") {
            (depth, at) = (depth + 1, at + 2);
        } else if rest.starts_with(b"*/") {
            (depth, at) = (depth - 1, at + 2);
            if depth == 0 {
                return Some(at);
            }
        } else {
            at += 1;
        }
    }
    None
}

/// The end of a text in quotes that the slice begins with.
fn quoted(text: &str, quote: char) -> Option<usize> {
    let mut is_escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        match c {
            _ if is_escaped => is_escaped = false,
            '\\' => is_escaped = true,
            c if c == quote => return Some(at + 1),
            _ => {}
        }
    }
    None
}

/// The end of a number, a name or a raw text.
fn word(text: &str) -> Option<usize> {
    let raw = text.trim_start_matches(['b', 'r']);
    let hashes = raw.len() - raw.trim_start_matches('#').len();
    let prefix = text.len() - raw.len();
    if text[..prefix].contains('r') && raw[hashes..].starts_with('"') {
        let body = prefix + hashes + 1;
        let end = format!("\"{}", "#".repeat(hashes));
        return text[body..].find(&end).map(|at| body + at + end.len());
    }
    let ends = |c: char| c.is_whitespace() || "()[]{},:\"'/".contains(c);
    match text.find(ends) {
        Some(0) => text.chars().next().map(char::len_utf8),
        end => end,
    }
}

/// Past blanks and comments.
fn past_blanks(text: &str, mut at: usize) -> usize {
    while let Some((Kind::Blank, end)) = token(text, at) {
        at = end;
    }
    at
}

/// The value of a whole text: past the byte order mark and the extensions that RON may be told to allow.
pub(super) fn root(text: &str) -> Container {
    let mut at = if text.starts_with('\u{feff}') { 3 } else { 0 };
    loop {
        at = past_blanks(text, at);
        if !text[at..].starts_with('#') {
            return container(text, at);
        }
        while let Some((kind, end)) = token(text, at) {
            at = end;
            if kind == Kind::Close && text[..end].ends_with(']') {
                break;
            }
        }
    }
}

/// The container that stands at a place, behind its name where it has one.
pub(super) fn container(text: &str, start: usize) -> Container {
    let mut at = past_blanks(text, start);
    if let Some((Kind::Word, end)) = token(text, at) {
        at = past_blanks(text, end);
    }
    let mut found = Container {
        open: (at + 1).min(text.len()),
        close: text.len(),
        entries: Vec::new(),
    };
    let mut depth = 0_usize;
    let (mut name, mut value): (Option<Range<usize>>, Option<Range<usize>>) = (None, None);
    while let Some((kind, end)) = token(text, at) {
        let (was, here) = (depth, at..end);
        at = end;
        match kind {
            Kind::Blank => continue,
            Kind::Open => depth += 1,
            Kind::Close => depth = depth.saturating_sub(1),
            _ => {}
        }
        if was == 0 {
            continue;
        }
        if depth == 0 || (was == 1 && kind == Kind::Comma) {
            if let (Some(name), Some(value)) = (name.take(), value.take()) {
                let comma = (kind == Kind::Comma).then_some(end);
                found.entries.push(Entry { name, value, comma });
            }
            if depth == 0 {
                found.close = here.start;
                return found;
            }
        } else if was == 1 && kind == Kind::Colon && value.is_none() && name.is_some() {
            value = Some(end..end);
        } else if let Some(value) = &mut value {
            if value.start == value.end {
                value.start = here.start;
            }
            value.end = end;
        } else if name.is_none() {
            name = Some(here);
        }
    }
    found
}

impl Container {
    /// The entry of a name.
    pub(super) fn entry(&self, text: &str, name: &str) -> Option<&Entry> {
        self.entries
            .iter()
            .find(|entry| name_of(&text[entry.name.clone()]) == name)
    }
}

/// A name without quotes, or the mark of a raw identifier.
fn name_of(text: &str) -> String {
    if text.ends_with(['"', '#']) {
        return ron::from_str(text).unwrap_or_default();
    }
    text.strip_prefix("r#").unwrap_or(text).to_owned()
}

/// The comments of a text, in their order.
#[cfg(test)]
pub(super) fn comments(text: &str) -> Vec<&str> {
    let (mut at, mut comments) = (0, Vec::new());
    while let Some((kind, end)) = token(text, at) {
        if kind == Kind::Blank && text[at..].starts_with('/') {
            comments.push(text[at..end].trim_end());
        }
        at = end;
    }
    comments
}

/// Puts an entry behind another of the container, or first where there is none, laid out as its neighbours are.
pub(super) fn insert(
    text: &str,
    container: &Container,
    after: Option<usize>,
    entry: &str,
) -> String {
    let mut edited = text.to_owned();
    let Some(index) = after.filter(|index| *index < container.entries.len()) else {
        let inside = &text[container.open..container.close];
        let blank = if inside.starts_with(' ') { " " } else { "" };
        let comma = if container.entries.is_empty() {
            ""
        } else {
            ","
        };
        edited.insert_str(container.open, &format!("{blank}{entry}{comma}"));
        return edited;
    };
    let before = &container.entries[index];
    let line = text[..before.name.start].rfind('\n').map_or(0, |at| at + 1);
    let indent = &text[line..before.name.start];
    let value_end = before.value.end;
    if line <= container.open || !indent.trim().is_empty() {
        // In one line with what stands before it.
        let (at, added) = match before.comma {
            Some(comma) => (comma, format!(" {entry},")),
            None => (value_end, format!(", {entry}")),
        };
        edited.insert_str(at, &added);
        return edited;
    }
    // A line of its own, behind a comment that ends the line before it.
    let end = before.comma.unwrap_or(value_end);
    let mut at = end;
    while let Some((Kind::Blank, next)) = token(text, at) {
        if text[at..next].contains('\n') || text[at..].starts_with('\r') {
            break;
        }
        at = next;
    }
    let is_last_of_its_line = text[at..].starts_with(['\n', '\r']);
    let at = if is_last_of_its_line { at } else { end };
    let is_windows = text[at..].starts_with("\r\n");
    let newline = if is_windows { "\r\n" } else { "\n" };
    let comma = if before.comma.is_some() { "," } else { "" };
    edited.insert_str(at, &format!("{newline}{indent}{entry}{comma}"));
    if before.comma.is_none() {
        edited.insert(value_end, ',');
    }
    edited
}

/// Takes an entry out, and its line where nothing else is in it. Comments stay.
pub(super) fn remove(text: &str, container: &Container, index: usize) -> String {
    let entry = &container.entries[index];
    let mut from = entry.name.start;
    let mut cuts: Vec<Range<usize>> = Vec::new();
    let end = match entry.comma {
        Some(comma) => {
            if comma > entry.value.end {
                // A comment may stand between the value and its comma.
                cuts.push(comma - 1..comma);
            }
            comma
        }
        None => entry.value.end,
    };
    let is_last = index + 1 == container.entries.len();
    if let (true, None, Some(before)) = (is_last, entry.comma, index.checked_sub(1)) {
        // The comma before it may stay where a line ends with it.
        if let Some(comma) = container.entries[before].comma
            && !text[comma..from].contains('\n')
        {
            cuts.push(comma - 1..comma);
            if text[comma..from].trim().is_empty() {
                from = comma;
            }
        }
    }
    let line = text[..from].rfind('\n').map_or(0, |at| at + 1);
    let rest = text[end..].find('\n').map_or(text.len(), |at| end + at + 1);
    let is_alone = text[line..from].trim().is_empty() && text[end..rest].trim().is_empty();
    let is_plain = entry.comma.is_none_or(|comma| comma == entry.value.end + 1);
    if is_alone && is_plain && line > container.open && rest <= container.close {
        cuts.push(line..rest);
    } else {
        cuts.push(from..entry.value.end);
        if entry.comma.is_some() && text[end..].starts_with(' ') {
            cuts.push(end..end + 1);
        }
    }
    let mut edited = text.to_owned();
    cuts.sort_by_key(|cut| cut.start);
    for at in (0..cuts.len()).rev() {
        let next = cuts.get(at + 1).map_or(usize::MAX, |next| next.start);
        let cut = &cuts[at];
        // Inside of a whole line the comma goes with it.
        let is_covered = cuts[..at].iter().any(|other| other.end >= cut.end);
        if !is_covered && cut.start < next {
            edited.replace_range(cut.clone(), "");
        }
    }
    edited
}
