//! All errors of one edit, though naga stops at its first.
//!
//! Again and again: parse and validate a draft of the linked text, tell what naga says, set aside the item that it is
//! about, until naga is content. What is set aside becomes blanks, so that every byte keeps its place. A function loses
//! its body and keeps its signature, and nobody who calls it notices; before validation its body becomes the return of
//! a zero. Anything else goes as a whole, together with whatever mentions its name, so that nothing is ever told that
//! is only a consequence. Of an item that is set aside already nothing more is told.

use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

use naga::front::wgsl::ParseError;
use naga::valid::Capabilities;
use naga::{Arena, Block, Expression, Function, Module, Span, Statement};
use volgraph_report::{Finding, Findings};

use crate::check::{declarations, parse, validate};
use crate::items::Items;
use crate::silent::{self, blank};
use crate::{Linked, diagnose, names};

/// At most so many drafts are tried, and so many bytes in all, so that a broken edit is told quickly.
const MAX_TRIES: usize = 20;
const MAX_TRIED_BYTES: usize = 8 << 20;

/// Everything wrong with a text that [`crate::check()`] refuses.
pub(crate) fn all_errors(linked: &Linked, capabilities: Capabilities) -> Findings {
    let items = Items::new(&linked.text);
    let mut search = Search {
        linked,
        capabilities,
        findings: Findings::new(),
        draft: Draft::new(&items),
        may_be_syntax: true,
        are_declarations_told: false,
    };
    let tries = MAX_TRIED_BYTES / linked.text.len().max(1);
    for _ in 0..tries.clamp(2, MAX_TRIES) {
        // Should naga fail on a draft, what was found before still counts.
        match catch_unwind(AssertUnwindSafe(|| search.try_once())) {
            Ok(true) => {}
            Ok(false) => break,
            Err(_) if search.findings.has_errors() => break,
            Err(panic) => resume_unwind(panic),
        }
    }
    search.findings
}

struct Search<'s> {
    linked: &'s Linked,
    capabilities: Capabilities,
    findings: Findings,
    draft: Draft<'s>,
    /// Whether syntax errors may stand behind what the parser has stopped at.
    may_be_syntax: bool,
    are_declarations_told: bool,
}

/// A part of a text that an error is about: an item, and whether its body alone is.
type Part = (usize, bool);

impl Search<'_> {
    /// Tells what is wrong with the draft and sets it aside; `false` where no more can be found.
    fn try_once(&mut self) -> bool {
        match parse(&self.draft.text, self.capabilities) {
            Err(error) => self.parse_error(&error),
            Ok(module) => self.module(module),
        }
    }

    fn parse_error(&mut self, error: &ParseError) -> bool {
        let text = &self.draft.text;
        if self.may_be_syntax && diagnose::is_syntax_error(text, error, self.capabilities) {
            let found = diagnose::syntax_errors(self.linked, error, self.capabilities);
            self.findings.extend(found);
            return false;
        }
        // The parser itself stops at a name that is declared twice in one function.
        self.may_be_syntax = diagnose::is_redefinition(error);
        let clashes = self.linked.name_clashes();
        if !clashes.is_empty() && self.draft.remove_clashing() {
            self.findings.extend(clashes);
            return true;
        }
        let items = self.draft.items;
        let mut ranges = diagnose::labels(error);
        // Where a call does not fit, the call is to blame, not the function that is called.
        if let [(wanted, _), (given, _), ..] = ranges.as_slice()
            && error.message().starts_with("automatic conversions")
            && items.at(wanted.start) != items.at(given.start)
        {
            ranges.swap(0, 1);
        }
        let mut parts: Vec<Part> = ranges
            .iter()
            .filter_map(|(range, _)| items.part(range.start))
            .collect();
        let mut finding = diagnose::type_error(self.linked, error, &ranges);
        match ranges.first() {
            Some((first, _)) => {
                let help = self.near_name(error.message(), first);
                finding = finding.help_opt(help.map(|near| format!("did you mean `{near}`?")));
            }
            // Some of naga's errors come without a place.
            None => {
                let bodies = self.draft.whole_bodies();
                let has_error = |text: &str| {
                    parse(text, self.capabilities)
                        .is_err_and(|other| other.message() == error.message())
                };
                let found = silent::culprit(items, &self.draft.text, &bodies, has_error);
                if let Some((item, range)) = found {
                    parts.push((item, true));
                    finding = finding.at(self.linked.place(range.start, range.len()));
                }
            }
        }
        self.tell_and_set_aside(Some(finding), &parts)
    }

    fn near_name(&self, message: &str, at: &Range<usize>) -> Option<String> {
        let unknown = diagnose::unknown_identifier(message);
        if let Some(unknown) = unknown {
            return names::near_identifier(self.linked, self.draft.items, at.start, unknown);
        }
        let is_member = message.starts_with(diagnose::BAD_ACCESSOR);
        is_member
            .then(|| names::near_member(self.linked, &self.draft.text, at, self.capabilities))?
    }

    fn module(&mut self, mut module: Module) -> bool {
        if !self.are_declarations_told {
            self.are_declarations_told = true;
            self.findings.take_all(declarations(self.linked, &module));
        }
        self.draft.stub(&mut module);
        let Err(error) = validate(&module, self.capabilities) else {
            return false;
        };
        let items = self.draft.items;
        let name = diagnose::blamed_name(error.as_inner()).unwrap_or_default();
        let named: Vec<Part> = items
            .named(name)
            .map(|item| (item, items.all[item].body.is_some()))
            .collect();
        let own = named.first().map(|(item, _)| *item);
        let spans = error.spans().filter_map(|(span, _)| span.to_range());
        let parts: Vec<Part> = named
            .into_iter()
            .chain(spans.filter_map(|range| items.part(range.start)))
            .collect();
        let finding = diagnose::validation_error(self.linked, &module, &error, items, own);
        // Two bindings that clash are told already, with both places.
        let is_told = finding.code == diagnose::BINDING_COLLISION && self.findings.has_errors();
        self.tell_and_set_aside((!is_told).then_some(finding), &parts)
    }

    /// Sets aside the first of `parts` that is still there; `false` where there is none.
    fn tell_and_set_aside(&mut self, finding: Option<Finding>, parts: &[Part]) -> bool {
        let is_touched = |(item, _): &Part| self.draft.states[*item] != State::Whole;
        if !parts.first().is_some_and(is_touched) {
            self.findings.extend(finding);
        }
        parts.iter().any(|part| self.draft.set_aside(*part))
    }
}

/// What is left of an item.
#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    Whole,
    /// A function's signature.
    Signature,
    Gone,
}

/// The linked text without what is set aside.
struct Draft<'s> {
    items: &'s Items<'s>,
    states: Vec<State>,
    /// As long as the linked text.
    text: String,
}

impl<'s> Draft<'s> {
    fn new(items: &'s Items<'s>) -> Self {
        Self {
            items,
            states: vec![State::Whole; items.all.len()],
            text: items.text.to_owned(),
        }
    }

    /// Whether there was anything left to set aside.
    fn set_aside(&mut self, (item, is_in_body): Part) -> bool {
        let all = &self.items.all;
        match (&all[item].body, self.states[item]) {
            (Some(body), State::Whole) if is_in_body => {
                self.states[item] = State::Signature;
                blank(&mut self.text, body.clone());
                true
            }
            (_, State::Gone) => false,
            // Others may need it, and do not say so.
            _ if all[item].is_directive => false,
            _ => {
                self.remove(item);
                true
            }
        }
    }

    /// Removes an item and whatever mentions it.
    fn remove(&mut self, item: usize) {
        let mut open = vec![item];
        while let Some(item) = open.pop() {
            if self.states[item] == State::Gone {
                continue;
            }
            self.states[item] = State::Gone;
            blank(&mut self.text, self.items.all[item].range.clone());
            let Some(name) = self.items.name(item) else {
                continue;
            };
            for (other, its) in self.items.all.iter().enumerate() {
                let (head, body, tail) = match &its.body {
                    Some(body) => (
                        its.range.start..body.start,
                        body.clone(),
                        body.end..its.range.end,
                    ),
                    None => (its.range.clone(), 0..0, 0..0),
                };
                if self.items.mentions(&head, name) || self.items.mentions(&tail, name) {
                    open.push(other);
                } else if self.states[other] == State::Whole && self.items.mentions(&body, name) {
                    self.states[other] = State::Signature;
                    blank(&mut self.text, body);
                }
            }
        }
    }

    /// Removes all items whose names are declared twice; `false` where that is done.
    fn remove_clashing(&mut self) -> bool {
        let items = self.items;
        let clashing: Vec<usize> = (0..items.all.len())
            .filter(|item| self.states[*item] != State::Gone)
            .filter(|item| {
                items
                    .name(*item)
                    .is_some_and(|name| items.named(name).nth(1).is_some())
            })
            .collect();
        for item in &clashing {
            self.remove(*item);
        }
        !clashing.is_empty()
    }

    /// The functions that have their bodies yet, and these.
    fn whole_bodies(&self) -> Vec<(usize, Range<usize>)> {
        let items = self.items.all.iter().enumerate();
        items
            .filter(|(item, _)| self.states[*item] == State::Whole)
            .filter_map(|(item, its)| Some((item, its.body.clone()?)))
            .collect()
    }

    /// Gives functions without a body one that is valid.
    fn stub(&self, module: &mut Module) {
        let is_stub = |function: &Function| {
            let name = function.name.as_deref().unwrap_or_default();
            self.items
                .named(name)
                .any(|item| self.states[item] == State::Signature)
        };
        let functions = module.functions.iter_mut().map(|(_, function)| function);
        let points = module.entry_points.iter_mut();
        for function in functions.chain(points.map(|point| &mut point.function)) {
            if is_stub(function) {
                stub(function);
            }
        }
    }
}

fn stub(function: &mut Function) {
    function.local_variables = Arena::new();
    function.expressions = Arena::new();
    function.named_expressions.clear();
    let value = function.result.as_ref().map(|result| {
        let zero = Expression::ZeroValue(result.ty);
        function.expressions.append(zero, Span::default())
    });
    function.body = Block::from_vec(vec![Statement::Return { value }]);
}
