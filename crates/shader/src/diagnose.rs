//! What naga says about a linked text, at the author's places.
//!
//! naga stops at its first error and does not say whether that is one of syntax; a text with two equal structs
//! after it tells: where naga gets as far as their clash, the syntax is right. Where it is not, each file is
//! parsed alone, so that a brace missing in one is not blamed on the next, and each file's first error is told.

use naga::Span;
use naga::front::wgsl::ParseError;
use naga::valid::{Capabilities, EntryPointError, ValidationError};
use volgraph_report::{Finding, Findings, Place, did_you_mean};

use crate::Linked;
use crate::check::parse;
use crate::statements::blamed_statement;

/// The code of a validation error that repeats a `binding-clash`.
pub(crate) const BINDING_COLLISION: &str = "binding-clash";

/// Two structs of one name: no text of right syntax stays valid with them behind it.
const PROBE: &str =
    "\nstruct VolgraphSyntaxProbe { a: u32 }\nstruct VolgraphSyntaxProbe { a: u32 }\n";

/// Findings for a text that naga cannot parse.
pub(crate) fn parse_error(
    linked: &Linked,
    error: &ParseError,
    capabilities: Capabilities,
) -> Findings {
    let in_linked = |span: Span| {
        let range = span.to_range()?;
        Some(linked.place(range.start, range.len()))
    };
    if is_syntax_error(&linked.text, error, capabilities) {
        let alone: Findings = (0..linked.files.len())
            .filter_map(|file| syntax_error(linked, file, capabilities))
            .collect();
        return if alone.is_empty() {
            finding("wgsl-syntax", linked, error, in_linked).into()
        } else {
            alone
        };
    }
    let clashes = linked.name_clashes();
    if !clashes.is_empty() {
        return clashes;
    }
    let is_redefinition = error.message().starts_with("redefinition of");
    let code = if is_redefinition {
        "name-clash"
    } else {
        "wgsl-type"
    };
    let mut finding = finding(code, linked, error, in_linked);
    let unknown = error
        .message()
        .strip_prefix("no definition in scope for identifier: `");
    if let Some(unknown) = unknown.and_then(|rest| rest.strip_suffix('`')) {
        let known = linked
            .declared
            .iter()
            .map(|declared| declared.name.as_str());
        let near = did_you_mean(unknown, known).filter(|help| help.starts_with("did"));
        finding = finding.help_opt(near);
    }
    finding.into()
}

fn is_syntax_error(text: &str, error: &ParseError, capabilities: Capabilities) -> bool {
    let ends_early = error
        .labels()
        .next()
        .and_then(|(span, _)| span.to_range())
        .is_some_and(|range| range.start >= text.len());
    ends_early
        || parse(&format!("{text}{PROBE}"), capabilities)
            .is_err_and(|error| !error.message().starts_with("redefinition of"))
}

/// The syntax error of one file, parsed alone.
fn syntax_error(linked: &Linked, file: usize, capabilities: Capabilities) -> Option<Finding> {
    let text = linked.alone(file);
    let error = parse(&text, capabilities).err()?;
    let start = error
        .labels()
        .next()
        .and_then(|(span, _)| span.to_range())?
        .start;
    // An error in the hoisted directives would be told once for each file.
    if start < linked.directives_len || !is_syntax_error(&text, &error, capabilities) {
        return None;
    }
    let place = |span: Span| {
        let range = span.to_range()?;
        let start = range.start.checked_sub(linked.directives_len)?;
        Some(linked.place_in(file, &(start..start + range.len())))
    };
    Some(finding("wgsl-syntax", linked, &error, place))
}

/// naga's message at its first label, the other labels beside it, its notes as the remedy.
fn finding(
    code: &'static str,
    linked: &Linked,
    error: &ParseError,
    place: impl Fn(Span) -> Option<Place>,
) -> Finding {
    let mut labels = error
        .labels()
        .filter_map(|(span, label)| Some((place(span)?, label)));
    let mut message = error.message().to_owned();
    let mut finding = match labels.next() {
        Some((place, label)) => {
            if !label.is_empty() && !message.contains(label) {
                message = format!("{message} ({label})");
            }
            Finding::error(code, message).at(place)
        }
        None => Finding::error(code, message).at(linked.root_place()),
    };
    for (place, label) in labels {
        finding = finding.related(place, if label.is_empty() { "here" } else { label });
    }
    let notes: Vec<&str> = error.notes().collect();
    finding.help_opt((!notes.is_empty()).then(|| notes.join("; ")))
}

/// A finding for a module that is not valid.
pub(crate) fn validation_error(
    linked: &Linked,
    module: &naga::Module,
    error: &naga::WithSpan<ValidationError>,
) -> Finding {
    let mut parts = vec![without_handles(&error.as_inner().to_string())];
    let mut source = std::error::Error::source(error.as_inner());
    while let Some(next) = source {
        parts.push(without_handles(&next.to_string()));
        source = next.source();
    }
    let mut spans: Vec<_> = error
        .spans()
        .filter_map(|(span, label)| Some((span.to_range()?, label.as_str())))
        .collect();
    // The shortest stretch says most exactly where it is.
    spans.sort_by_key(|(range, _)| range.len());
    let statement = blamed_statement(module, error.as_inner()).and_then(Span::to_range);
    if let Some(range) = statement
        && spans
            .first()
            .is_none_or(|(nearest, _)| range.len() < nearest.len())
    {
        spans.insert(0, (range, ""));
    }
    let code = match error.as_inner() {
        ValidationError::EntryPoint {
            source: EntryPointError::BindingCollision(_),
            ..
        } => BINDING_COLLISION,
        _ => "wgsl-validation",
    };
    let mut finding = Finding::error(code, parts.join(": "));
    for (at, (range, label)) in spans.iter().enumerate() {
        let place = linked.place(range.start, range.len());
        if at == 0 {
            finding = finding.at(place);
        } else if finding.place.as_ref() != Some(&place) {
            finding = finding.related(place, readable(label));
        }
    }
    let (name, variable) = match error.as_inner() {
        ValidationError::EntryPoint { name, source, .. } => (Some(name), entry_variable(source)),
        ValidationError::Function { name, .. }
        | ValidationError::Type { name, .. }
        | ValidationError::Constant { name, .. }
        | ValidationError::Override { name, .. }
        | ValidationError::GlobalVariable { name, .. } => (Some(name), None),
        _ => (None, None),
    };
    let variable = variable.and_then(|handle| {
        module
            .global_variables
            .try_get(handle)
            .ok()?
            .name
            .as_deref()
    });
    if let Some(place) = variable.and_then(|name| linked.declaration_place(name)) {
        finding = finding.related(place, "this variable");
    }
    let named = name.and_then(|name| linked.declaration_place(name));
    finding.or_at(|| named.unwrap_or_else(|| linked.root_place()))
}

fn entry_variable(error: &EntryPointError) -> Option<naga::Handle<naga::GlobalVariable>> {
    match error {
        EntryPointError::InvalidGlobalUsage(handle, _)
        | EntryPointError::BindingCollision(handle) => Some(*handle),
        _ => None,
    }
}

/// naga's messages count things in its own tables, `[12]` or `Some([12])`; that helps no author.
fn without_handles(message: &str) -> String {
    let message = without_options(message);
    let message = message.as_str();
    let mut clean = String::with_capacity(message.len());
    let mut rest = message;
    while let Some(open) = rest.find('[') {
        let digits = rest[open + 1..]
            .bytes()
            .take_while(u8::is_ascii_digit)
            .count();
        let close = open + 1 + digits;
        if digits > 0 && rest[close..].starts_with(']') {
            let before = rest[..open].trim_end();
            clean.push_str(before);
            // After these a noun is missing.
            let is_open = ["of", "in", "for", "to", "and", "with"]
                .contains(&before.rsplit(' ').next().unwrap_or(""));
            clean.push_str(if is_open { " …" } else { "" });
            rest = &rest[close + 1..];
        } else {
            clean.push_str(&rest[..=open]);
            rest = &rest[open + 1..];
        }
    }
    clean + rest
}

/// `Some([12])` as `[12]`.
fn without_options(message: &str) -> String {
    let mut clean = String::with_capacity(message.len());
    let mut rest = message;
    while let Some((before, after)) = rest.split_once("Some([") {
        clean.push_str(before);
        rest = match after.split_once("])") {
            Some((handle, after)) if handle.bytes().all(|c| c.is_ascii_digit()) => {
                clean.push_str(&format!("[{handle}]"));
                after
            }
            _ => {
                clean.push_str("Some([");
                after
            }
        };
    }
    clean + rest
}

/// A label of naga's for people: its automatic ones are Rust type names.
fn readable(label: &str) -> String {
    let Some(kind) = label.strip_prefix("naga::") else {
        return if label.is_empty() {
            "here".to_owned()
        } else {
            without_handles(label)
        };
    };
    let kind = kind.split(' ').next().unwrap_or("");
    match kind.rsplit("::").next().unwrap_or("") {
        "Expression" => "in this expression",
        "Function" => "in this function",
        "Type" => "this type",
        "GlobalVariable" => "this variable",
        "Constant" => "this constant",
        "Override" => "this override",
        "LocalVariable" => "this local variable",
        _ => "here",
    }
    .to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn handles_are_taken_out_and_indices_are_not() {
        assert_eq!(
            without_handles("Function [12] 'f' is invalid"),
            "Function 'f' is invalid"
        );
        assert_eq!(
            without_handles("expression Some([3]) is not Some([1]), Some([x"),
            "expression is not, Some([x"
        );
        assert_eq!(
            without_handles("The type of [3] is not"),
            "The type of … is not"
        );
        assert_eq!(without_handles("a[i] or [x, [3]"), "a[i] or [x,");
        assert_eq!(readable("naga::ir::Expression [3]"), "in this expression");
    }
}
