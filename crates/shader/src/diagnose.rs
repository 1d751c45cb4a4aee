//! What naga says about a linked text, at the author's places.
//!
//! naga stops at its first error and does not say whether that is one of syntax; a text with two equal structs
//! after it tells: where naga gets as far as their clash, the syntax is right. Where it is not, each file is
//! parsed alone, so that a brace missing in one is not blamed on the next, and each file's first error is told.

use std::ops::Range;

use naga::Span;
use naga::front::wgsl::ParseError;
use naga::valid::{Capabilities, EntryPointError, FunctionError, ValidationError};
use volgraph_report::{Finding, Findings, Place};

use crate::check::parse;
use crate::items::Items;
use crate::statements::blamed_statement;
use crate::{Linked, wording};

/// What is noted at the declaration of a function whose call does not fit.
pub const DECLARED_HERE: &str = "declared here";

/// The code of a validation error that repeats a `binding-clash`.
pub(crate) const BINDING_COLLISION: &str = "binding-clash";

/// Two structs of one name: no text of right syntax stays valid with them behind it.
const PROBE: &str =
    "\nstruct VolgraphSyntaxProbe { a: u32 }\nstruct VolgraphSyntaxProbe { a: u32 }\n";

/// How naga's message on an unknown member starts.
pub(crate) const BAD_ACCESSOR: &str = "invalid field accessor";

/// The name that naga's message calls unknown.
pub(crate) fn unknown_identifier(message: &str) -> Option<&str> {
    message
        .strip_prefix("no definition in scope for identifier: `")?
        .strip_suffix('`')
}

/// Whether a name is declared twice.
pub(crate) fn is_redefinition(error: &ParseError) -> bool {
    error.message().starts_with("redefinition of")
}

/// What naga points at, and what it says of each.
pub(crate) fn labels(error: &ParseError) -> Vec<(Range<usize>, &str)> {
    error
        .labels()
        .filter_map(|(span, label)| Some((span.to_range()?, label)))
        .collect()
}

/// The first syntax error of each file of a text that naga cannot parse.
pub(crate) fn syntax_errors(
    linked: &Linked,
    error: &ParseError,
    capabilities: Capabilities,
) -> Findings {
    let alone: Findings = (0..linked.files.len())
        .filter_map(|file| syntax_error(linked, file, capabilities))
        .collect();
    if alone.is_empty() {
        let place = |range: &Range<usize>| Some(linked.place(range.start, range.len()));
        finding("wgsl-syntax", linked, error, &labels(error), place).into()
    } else {
        alone
    }
}

/// An error of a text with right syntax, at the first of `labels`.
pub(crate) fn type_error(
    linked: &Linked,
    error: &ParseError,
    labels: &[(Range<usize>, &str)],
) -> Finding {
    let code = if is_redefinition(error) {
        "name-clash"
    } else {
        "wgsl-type"
    };
    let place = |range: &Range<usize>| Some(linked.place(range.start, range.len()));
    finding(code, linked, error, labels, place)
}

/// Whether it is a syntax error that keeps naga from parsing `text`.
pub(crate) fn is_syntax_error(text: &str, error: &ParseError, capabilities: Capabilities) -> bool {
    let ends_early = error
        .labels()
        .next()
        .and_then(|(span, _)| span.to_range())
        .is_some_and(|range| range.start >= text.len());
    ends_early
        || parse(&format!("{text}{PROBE}"), capabilities)
            .is_err_and(|error| !is_redefinition(&error))
}

/// The syntax error of one file, parsed alone.
fn syntax_error(linked: &Linked, file: usize, capabilities: Capabilities) -> Option<Finding> {
    let text = linked.alone(file);
    let error = parse(&text, capabilities).err()?;
    let labels = labels(&error);
    let start = labels.first()?.0.start;
    // An error in the hoisted directives would be told once for each file.
    if start < linked.directives_len || !is_syntax_error(&text, &error, capabilities) {
        return None;
    }
    let place = |range: &Range<usize>| {
        let start = range.start.checked_sub(linked.directives_len)?;
        Some(linked.place_in(file, &(start..start + range.len())))
    };
    Some(finding("wgsl-syntax", linked, &error, &labels, place))
}

/// naga's message at its first label, the other labels beside it, its notes as the remedy.
fn finding(
    code: &'static str,
    linked: &Linked,
    error: &ParseError,
    labels: &[(Range<usize>, &str)],
    place: impl Fn(&Range<usize>) -> Option<Place>,
) -> Finding {
    let mut labels = labels
        .iter()
        .filter_map(|(range, label)| Some((place(range)?, *label)));
    let mut message = wording::without_handles(error.message());
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

/// A finding for a module that is not valid; `own` is the item that the error names.
pub(crate) fn validation_error(
    linked: &Linked,
    module: &naga::Module,
    error: &naga::WithSpan<ValidationError>,
    items: &Items<'_>,
    own: Option<usize>,
) -> Finding {
    let callee = called(module, error.as_inner());
    let mut parts = vec![wording::readable(&error.as_inner().to_string())];
    let mut source = std::error::Error::source(error.as_inner());
    while let Some(next) = source {
        let part = wording::readable(&next.to_string());
        parts.push(match callee {
            Some(name) => part.replace("Call to …", &format!("Call to `{name}`")),
            None => part,
        });
        source = next.source();
    }
    let mut spans: Vec<_> = error
        .spans()
        .filter_map(|(span, label)| Some((span.to_range()?, label.as_str())))
        .collect();
    // The shortest stretch says most exactly where it is; a type is declared elsewhere.
    let is_elsewhere = |at: usize| own.is_some() && items.at(at) != own;
    spans.sort_by_key(|(range, _)| (is_elsewhere(range.start), range.len()));
    let argument = function_error(error.as_inner()).and_then(|source| match source {
        FunctionError::InvalidArgumentType { name, .. } => items.parameter(own?, name),
        _ => None,
    });
    if let Some(range) = argument {
        spans.insert(0, (range, ""));
    }
    let call = spans.iter().find(|(_, label)| *label == INVALID_CALL);
    let statement = match call {
        Some((range, _)) => Some(range.clone()),
        None => blamed_statement(module, error.as_inner()).and_then(Span::to_range),
    };
    // What stands outside of the statement is where a value was made, not where it is wrong.
    if let Some(range) = statement
        && spans
            .first()
            .is_none_or(|(nearest, _)| nearest.start < range.start || range.end < nearest.end)
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
            finding = finding.related(place, wording::label(label));
        }
    }
    let variable = match error.as_inner() {
        ValidationError::EntryPoint { source, .. } => entry_variable(source),
        _ => None,
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
    if let Some(place) = callee.and_then(|name| linked.declaration_place(name)) {
        finding = finding.related(place, DECLARED_HERE);
    }
    let named = blamed_name(error.as_inner()).and_then(|name| linked.declaration_place(name));
    finding.or_at(|| named.unwrap_or_else(|| linked.root_place()))
}

/// The name of the declaration that a validation error is about.
pub(crate) fn blamed_name(error: &ValidationError) -> Option<&str> {
    match error {
        ValidationError::EntryPoint { name, .. }
        | ValidationError::Function { name, .. }
        | ValidationError::Type { name, .. }
        | ValidationError::Constant { name, .. }
        | ValidationError::Override { name, .. }
        | ValidationError::GlobalVariable { name, .. } => Some(name),
        _ => None,
    }
}

/// naga's label of a call that does not fit.
const INVALID_CALL: &str = "invalid function call";

/// The function whose call is wrong.
fn called<'m>(module: &'m naga::Module, error: &ValidationError) -> Option<&'m str> {
    let FunctionError::InvalidCall { function, .. } = function_error(error)? else {
        return None;
    };
    module.functions.try_get(*function).ok()?.name.as_deref()
}

fn function_error(error: &ValidationError) -> Option<&FunctionError> {
    match error {
        ValidationError::Function { source, .. }
        | ValidationError::EntryPoint {
            source: EntryPointError::Function(source),
            ..
        } => Some(source),
        _ => None,
    }
}

fn entry_variable(error: &EntryPointError) -> Option<naga::Handle<naga::GlobalVariable>> {
    match error {
        EntryPointError::InvalidGlobalUsage(handle, _)
        | EntryPointError::BindingCollision(handle) => Some(*handle),
        _ => None,
    }
}
