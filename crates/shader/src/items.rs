//! The declarations of a linked text: where each starts and ends, what it is called and which names it mentions.
//!
//! What counts is a text of right syntax; of any other the items mean little, and it is no trouble. An item goes from its first attribute to its
//! semicolon or closing brace. A name counts as mentioned wherever its word stands, but not behind a dot or an `@`:
//! what only looks like a mention (a local variable of the same name) costs a finding, and never makes one up.

use std::ops::Range;

use crate::token::{Kind, Token, tokens};

/// A declaration at module scope.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Item {
    /// From its first attribute to its end.
    pub range: Range<usize>,
    /// `None` for `const_assert` and directives.
    pub name: Option<Range<usize>>,
    /// What stands between a function's braces.
    pub body: Option<Range<usize>>,
    /// Whether it is `enable`, `requires` or `diagnostic`.
    pub is_directive: bool,
}

/// All declarations of a text, in order.
pub(crate) struct Items<'t> {
    pub text: &'t str,
    pub tokens: Vec<Token>,
    pub all: Vec<Item>,
}

impl<'t> Items<'t> {
    pub fn new(text: &'t str) -> Self {
        let tokens = tokens(text);
        let mut all = Vec::new();
        let mut at = 0;
        while at < tokens.len() {
            let (item, next) = item(text, &tokens, at);
            all.extend(item);
            at = next;
        }
        Self { text, tokens, all }
    }

    /// The item that byte `offset` belongs to.
    pub fn at(&self, offset: usize) -> Option<usize> {
        self.all
            .iter()
            .position(|item| item.range.contains(&offset))
    }

    /// The item that byte `offset` belongs to, and whether it lies in its body.
    pub fn part(&self, offset: usize) -> Option<(usize, bool)> {
        let item = self.at(offset)?;
        let body = &self.all[item].body;
        Some((item, body.as_ref().is_some_and(|b| b.contains(&offset))))
    }

    /// The name of an item.
    pub fn name(&self, item: usize) -> Option<&'t str> {
        Some(&self.text[self.all[item].name.clone()?])
    }

    /// The items of this name; more than one where names clash.
    pub fn named(&self, name: &str) -> impl Iterator<Item = usize> {
        (0..self.all.len()).filter(move |item| self.name(*item) == Some(name))
    }

    /// Where a function's parameter of this name stands.
    pub fn parameter(&self, item: usize, name: &str) -> Option<Range<usize>> {
        let item = &self.all[item];
        let head = item.name.as_ref()?.end..item.body.as_ref()?.start;
        let at = self.within(&head).find(|at| {
            let next = self.tokens.get(at + 1);
            self.is_word(*at, name) && next.is_some_and(|token| token.kind == Kind::Mark(':'))
        })?;
        Some(self.tokens[at].range.clone())
    }

    /// Whether `name` stands in these bytes as more than a member's or an attribute's name.
    pub fn mentions(&self, range: &Range<usize>, name: &str) -> bool {
        let inside = self.within(range);
        inside.clone().any(|at| {
            let is_part = at > 0 && matches!(self.tokens[at - 1].kind, Kind::Mark('.' | '@'));
            self.is_word(at, name) && !is_part
        })
    }

    /// The names that may be known at byte `offset` besides those at module scope: the parameters of its function, and
    /// the local variables declared before it, whose block may have ended.
    pub fn locals(&self, offset: usize) -> Vec<&'t str> {
        let Some(item) = self.at(offset).map(|item| &self.all[item]) else {
            return Vec::new();
        };
        let (Some(name), Some(body)) = (&item.name, &item.body) else {
            return Vec::new();
        };
        let word = |at: usize| {
            let token = self
                .tokens
                .get(at)
                .filter(|token| token.kind == Kind::Word)?;
            Some(&self.text[token.range.clone()])
        };
        let params = self
            .within(&(name.end..body.start))
            .filter(|at| {
                self.tokens
                    .get(at + 1)
                    .is_some_and(|t| t.kind == Kind::Mark(':'))
            })
            .filter_map(word);
        let variables = self
            .within(&(body.start..offset.min(body.end)))
            .filter(|at| ["let", "var", "const"].iter().any(|k| self.is_word(*at, k)))
            .filter_map(|at| word(skip_template(&self.tokens, at + 1)));
        params.chain(variables).collect()
    }

    fn is_word(&self, at: usize, word: &str) -> bool {
        let token = &self.tokens[at];
        token.kind == Kind::Word && &self.text[token.range.clone()] == word
    }

    /// The indices of the tokens in these bytes.
    pub fn within(&self, range: &Range<usize>) -> Range<usize> {
        let first = self
            .tokens
            .partition_point(|token| token.range.start < range.start);
        let last = self
            .tokens
            .partition_point(|token| token.range.start < range.end);
        first..last.max(first)
    }
}

/// The item that starts at token `at`, and the token behind it; no item for doc comments and lone semicolons.
fn item(text: &str, tokens: &[Token], mut at: usize) -> (Option<Item>, usize) {
    if matches!(tokens[at].kind, Kind::Doc | Kind::Mark(';')) {
        return (None, at + 1);
    }
    let start = tokens[at].range.start;
    let is = |at: usize, kind: Kind| tokens.get(at).is_some_and(|token| token.kind == kind);
    while is(at, Kind::Mark('@')) || is(at, Kind::Doc) {
        at += if is(at, Kind::Doc) { 1 } else { 2 };
        if is(at, Kind::Mark('(')) {
            at = end_of_group(tokens, at);
        }
    }
    at = at.min(tokens.len() - 1);
    let keyword = &text[tokens[at].range.clone()];
    let name = match keyword {
        "fn" | "struct" | "alias" | "const" | "override" => at + 1,
        "var" => skip_template(tokens, at + 1),
        _ => tokens.len(),
    };
    let name = tokens.get(name).filter(|token| token.kind == Kind::Word);
    let has_braces = matches!(keyword, "fn" | "struct");
    let mut body = None;
    while let Some(token) = tokens.get(at) {
        match token.kind {
            Kind::Mark('{') => {
                let end = end_of_group(tokens, at);
                if has_braces {
                    let inner = token.range.end..tokens[end - 1].range.start.max(token.range.end);
                    body = (keyword == "fn").then_some(inner);
                    at = end;
                    break;
                }
                at = end;
            }
            Kind::Mark('(' | '[') => at = end_of_group(tokens, at),
            Kind::Mark(';') => {
                at += 1;
                break;
            }
            _ => at += 1,
        }
    }
    let item = Item {
        range: start..tokens[at - 1].range.end,
        name: name.map(|token| token.range.clone()),
        body,
        is_directive: matches!(keyword, "enable" | "requires" | "diagnostic"),
    };
    (Some(item), at)
}

/// The token behind a `var`'s address space.
fn skip_template(tokens: &[Token], at: usize) -> usize {
    let is_open = tokens.get(at).is_some_and(|t| t.kind == Kind::Mark('<'));
    if !is_open {
        return at;
    }
    let inner = tokens[at..]
        .iter()
        .take_while(|token| !matches!(token.kind, Kind::Mark('>' | ';')));
    at + inner.count() + 1
}

/// The token behind the one that closes what token `at` opens; the end where nothing does.
fn end_of_group(tokens: &[Token], at: usize) -> usize {
    let mut depth = 0_usize;
    for (index, token) in tokens.iter().enumerate().skip(at) {
        match token.kind {
            Kind::Mark('(' | '[' | '{') => depth += 1,
            Kind::Mark(')' | ']' | '}') => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth == 0 {
            return index + 1;
        }
    }
    tokens.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "enable f16;\n/// doc\n@group(0) @binding(1) var<storage, read_write> a: array<u32>;\n\
        @compute @workgroup_size(S, 1)\nfn main(@builtin(position) p: vec4f) -> @location(0) vec4f { // b\n\
        { let q = a[0].c; } var<function> r = 1; return vec4f(z); }\n\
        struct T { x: f32, } const_assert S > 1; const S = 2;";

    #[test]
    fn items_go_from_attribute_to_end() {
        let items = Items::new(TEXT);
        let starts: Vec<_> = items
            .all
            .iter()
            .map(|item| TEXT[item.range.clone()].split_whitespace().next().unwrap())
            .collect();
        assert_eq!(
            starts,
            [
                "enable",
                "@group(0)",
                "@compute",
                "struct",
                "const_assert",
                "const"
            ]
        );
        let names: Vec<_> = (0..items.all.len()).map(|item| items.name(item)).collect();
        assert_eq!(
            names,
            [None, Some("a"), Some("main"), Some("T"), None, Some("S")]
        );
        let body = items.all[2].body.clone().unwrap();
        assert!(TEXT[body.clone()].starts_with(" // b") && TEXT[body].ends_with("vec4f(z); "));
        assert!(TEXT[items.all[1].range.clone()].ends_with("array<u32>;"));
        assert!(items.all[0].is_directive && !items.all[1].is_directive);
    }

    #[test]
    fn mentions_are_words_but_no_members_and_no_comments() {
        let items = Items::new(TEXT);
        let all = 0..TEXT.len();
        for (name, is_mentioned) in [("a", true), ("S", true), ("c", false), ("b", false)] {
            assert_eq!(items.mentions(&all, name), is_mentioned, "{name}");
        }
        assert!(!items.mentions(&all, "binding"));
    }

    #[test]
    fn locals_are_parameters_and_what_was_declared_before() {
        let items = Items::new(TEXT);
        assert_eq!(items.locals(TEXT.find("z)").unwrap()), ["p", "q", "r"]);
        assert_eq!(items.locals(TEXT.find("a[0]").unwrap()), ["p", "q"]);
        assert_eq!(items.locals(TEXT.find("x: f32").unwrap()), [""; 0]);
    }
}
