//! Finds the statement that an error without a place is about.
//!
//! naga has a few of them (an index out of bounds). The function to blame is the one without whose body the error is
//! gone; the statement, the first that brings it back when the body is given statement by statement.

use std::ops::Range;

use crate::items::Items;
use crate::token::Kind;

/// The item, and the bytes to point at, of an error that `has_error` finds in a text; `bodies` are those of all
/// functions that may have it. `text` is as long as the items' text.
pub(crate) fn culprit(
    items: &Items<'_>,
    text: &str,
    bodies: &[(usize, Range<usize>)],
    has_error: impl Fn(&str) -> bool,
) -> Option<(usize, Range<usize>)> {
    let (item, body) = bodies
        .iter()
        .find(|(_, body)| !has_error(&blanked(text, std::slice::from_ref(body))))?;
    let ends = ends(items, body);
    // All of the body has the error; how many of its statements must there be at least?
    let needed = ends.partition_point(|end| !has_error(&blanked(text, &rest(items, body, *end))));
    let start = match needed {
        0 => body.start,
        needed => ends[needed - 1],
    };
    let end = ends.get(needed).copied().unwrap_or(body.end);
    let tokens = &items.tokens[items.within(&(start..end))];
    let place = match (tokens.first(), tokens.last()) {
        (Some(first), Some(last)) => first.range.start..last.range.end,
        _ => items.all[*item].name.clone()?,
    };
    Some((*item, place))
}

/// Where statements end, and where blocks start and end.
fn ends(items: &Items<'_>, body: &Range<usize>) -> Vec<usize> {
    let mut ends = Vec::new();
    let mut parentheses = 0_usize;
    for token in &items.tokens[items.within(body)] {
        match token.kind {
            Kind::Mark('(') => parentheses += 1,
            Kind::Mark(')') => parentheses = parentheses.saturating_sub(1),
            Kind::Mark(';' | '{' | '}') if parentheses == 0 => ends.push(token.range.end),
            _ => {}
        }
    }
    ends
}

/// What stands behind `end` in a body, without the braces that close what is open there.
fn rest(items: &Items<'_>, body: &Range<usize>, end: usize) -> Vec<Range<usize>> {
    let mut rest = Vec::new();
    let (mut depth, mut start) = (0_usize, end);
    for token in &items.tokens[items.within(&(end..body.end))] {
        match token.kind {
            Kind::Mark('{') => depth += 1,
            Kind::Mark('}') if depth == 0 => {
                rest.push(start..token.range.start);
                start = token.range.end;
            }
            Kind::Mark('}') => depth -= 1,
            _ => {}
        }
    }
    rest.push(start..body.end);
    rest
}

/// A text with blanks for these bytes; all other bytes keep their places.
pub(crate) fn blanked(text: &str, ranges: &[Range<usize>]) -> String {
    let mut text = text.to_owned();
    for range in ranges {
        blank(&mut text, range.clone());
    }
    text
}

/// Puts blanks for these bytes.
pub(crate) fn blank(text: &mut String, range: Range<usize>) {
    let blanks = " ".repeat(range.len());
    text.replace_range(range, &blanks);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_statement_that_brings_the_error_back_is_found() {
        for (text, place) in [
            ("fn f() { } fn g() { a; BAD; b; }", "BAD;"),
            ("fn g() { a; if x { b; BAD; } else { c; } d; }", "BAD;"),
            ("fn g() { for (a; BAD; b) { c; } d; }", "for (a; BAD; b) {"),
            ("fn g() { { } if x { } else if BAD { } }", "else if BAD {"),
            ("fn g() { BAD }", "BAD"),
        ] {
            let items = Items::new(text);
            let bodies: Vec<_> = (0..items.all.len())
                .filter_map(|item| Some((item, items.all[item].body.clone()?)))
                .collect();
            let balance = |text: &str| text.matches('{').count() == text.matches('}').count();
            let (item, range) = culprit(&items, text, &bodies, |text| {
                assert!(balance(text), "{text}");
                text.contains("BAD")
            })
            .unwrap();
            assert_eq!((items.name(item), &text[range]), (Some("g"), place));
            assert_eq!(culprit(&items, text, &bodies, |_| true), None);
        }
    }
}
