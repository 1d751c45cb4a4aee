//! What the linker must know of WGSL: comments, `#` lines, directives, module-scope names, `struct Params`.
//!
//! The text becomes tokens without comments and blanks (doc comments are kept); one walk over the tokens,
//! counting braces, collects what stands at module scope. Nothing is judged here except `#` lines: what is
//! not understood stays in the text, for naga to say what is wrong with it.

use std::ops::Range;

use crate::token::{Kind, Token, tokens};

/// What an `#import` line asks for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Target {
    /// A file.
    File(String),
    /// Whatever fills this slot.
    Slot(String),
}

/// An `#import` line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Import {
    pub target: Target,
    /// From the `#` to the closing quote.
    pub range: Range<usize>,
}

/// A declaration at module scope.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Declaration {
    pub name: Range<usize>,
    pub docs: Vec<Range<usize>>,
    /// The names of a struct's members.
    pub members: Vec<Range<usize>>,
}

/// A member of a `struct Params`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct ParamMember {
    /// `None` where it is not even near to a member.
    pub name: Option<Range<usize>>,
    pub docs: Vec<Range<usize>>,
    /// From its first doc comment to the end of its type, without the comma.
    pub range: Range<usize>,
}

/// A `struct Params { … }`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct ParamStruct {
    pub name: Range<usize>,
    /// From `struct` to the closing brace.
    pub range: Range<usize>,
    pub members: Vec<ParamMember>,
}

/// What stands at module scope in one file. All ranges are bytes of its text, in rising order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Scan {
    pub imports: Vec<Import>,
    /// `#` lines that are none, each with what is wrong.
    pub bad_imports: Vec<(Range<usize>, String)>,
    /// `enable …;`, `requires …;` and `diagnostic(…);` before the first declaration.
    pub directives: Vec<Range<usize>>,
    pub params: Vec<ParamStruct>,
    /// Whether the file calls `params_select`.
    pub selects_params: bool,
    /// All but `struct Params`.
    pub declarations: Vec<Declaration>,
    /// The byte order mark, where there is one.
    pub mark: Range<usize>,
}

/// The function that makes the parameters those of a row of their table.
pub(crate) const PARAMS_SELECT: &str = "params_select";

const IMPORT_FORMS: &str = "expected `#import \"file.wgsl\"` or `#import slot \"name\"`";

/// Scans one file.
pub(crate) fn scan(text: &str) -> Scan {
    let tokens = tokens(text);
    let mut scan = Scan {
        mark: 0..if text.starts_with('\u{feff}') { 3 } else { 0 },
        selects_params: tokens
            .iter()
            .any(|token| token.kind == Kind::Word && &text[token.range.clone()] == PARAMS_SELECT),
        ..Scan::default()
    };
    let mut docs = Vec::new();
    let (mut depth, mut has_declarations) = (0_usize, false);
    let mut at = 0;
    while let Some(token) = tokens.get(at) {
        at += 1;
        match token.kind {
            Kind::Hash => match import(text, token.range.clone()) {
                Ok(import) => scan.imports.push(import),
                Err(bad) => scan.bad_imports.push(bad),
            },
            Kind::Mark('{') => depth += 1,
            Kind::Mark('}') => {
                depth = depth.saturating_sub(1);
                docs.clear();
            }
            _ if depth > 0 => {}
            Kind::Doc => docs.push(token.range.clone()),
            Kind::Mark(';') => docs.clear(),
            Kind::Mark('@') => has_declarations = true,
            Kind::Mark(_) => {}
            Kind::Word => match &text[token.range.clone()] {
                "enable" | "requires" | "diagnostic" if !has_declarations => {
                    let end = tokens[at..]
                        .iter()
                        .find(|token| {
                            matches!(token.kind, Kind::Mark(';' | '{' | '}') | Kind::Hash)
                        })
                        .filter(|token| token.kind == Kind::Mark(';'));
                    if let Some(end) = end {
                        scan.directives.push(token.range.start..end.range.end);
                        at +=
                            tokens[at..].partition_point(|token| token.range.end <= end.range.end);
                        docs.clear();
                    }
                }
                keyword @ ("fn" | "struct" | "alias" | "const" | "override" | "var") => {
                    has_declarations = true;
                    if keyword == "var" && tokens.get(at).is_some_and(|t| t.kind == Kind::Mark('<'))
                    {
                        at += tokens[at..]
                            .iter()
                            .take_while(|t| !matches!(t.kind, Kind::Mark('>' | ';')))
                            .count()
                            + 1;
                    }
                    let Some(name) = tokens.get(at).filter(|t| t.kind == Kind::Word) else {
                        continue;
                    };
                    let body = (keyword == "struct")
                        .then(|| members(text, &tokens, at + 1))
                        .flatten();
                    at = body.as_ref().map_or(at, |(_, close)| *close) + 1;
                    let docs = std::mem::take(&mut docs);
                    let is_params = &text[name.range.clone()] == "Params";
                    match body {
                        Some((members, close)) if is_params => scan.params.push(ParamStruct {
                            name: name.range.clone(),
                            range: token.range.start..tokens[close].range.end,
                            members,
                        }),
                        body => scan.declarations.push(Declaration {
                            name: name.range.clone(),
                            docs,
                            members: body
                                .into_iter()
                                .flat_map(|(members, _)| members)
                                .filter_map(|member| member.name)
                                .collect(),
                        }),
                    }
                }
                _ => {}
            },
        }
    }
    scan
}

/// Reads the `#` line of these bytes.
fn import(text: &str, range: Range<usize>) -> Result<Import, (Range<usize>, String)> {
    let line = &text[range.clone()];
    let bad = |message: String| (range.clone(), message);
    if line == "#" {
        let message = "`#import` stands on a line of its own".to_owned();
        return Err(bad(message));
    }
    let Some(after) = line
        .strip_prefix("#import")
        .filter(|after| !after.starts_with(|c: char| c == '_' || c.is_alphanumeric()))
    else {
        return Err(bad(IMPORT_FORMS.to_owned()));
    };
    let (is_slot, after) = match after.trim_start().strip_prefix("slot") {
        Some(after) => (true, after),
        None => (false, after),
    };
    let quoted = after
        .trim_start()
        .strip_prefix('"')
        .and_then(|after| after.split_once('"'));
    let Some((name, tail)) = quoted else {
        return Err(bad(IMPORT_FORMS.to_owned()));
    };
    let end = range.end - tail.len();
    if !(tail.trim().is_empty() || tail.trim_start().starts_with("//")) {
        return Err(bad(format!(
            "`#import` stands on a line of its own, but `{}` follows it",
            tail.trim()
        )));
    }
    if name.trim().is_empty() {
        return Err(bad("the name in quotes is empty".to_owned()));
    }
    if is_slot && !is_plain_name(name) {
        return Err(bad(format!(
            "a slot's name has letters, digits, `_` and `-` only, not `{name}`"
        )));
    }
    let target = if is_slot {
        Target::Slot(name.to_owned())
    } else {
        Target::File(name.to_owned())
    };
    Ok(Import {
        target,
        range: range.start..end,
    })
}

/// Whether a slot's or choice's name can be no path.
pub(crate) fn is_plain_name(name: &str) -> bool {
    !name.is_empty()
        && name
            .chars()
            .all(|c| c.is_alphanumeric() || matches!(c, '_' | '-'))
}

/// The members between the brace at token `open` and its closing one, and that one's index.
fn members(text: &str, tokens: &[Token], open: usize) -> Option<(Vec<ParamMember>, usize)> {
    tokens
        .get(open)
        .filter(|token| token.kind == Kind::Mark('{'))?;
    let mut members = Vec::new();
    let (mut nesting, mut angles, mut has_colon) = (0_usize, 0_usize, false);
    let mut first = open + 1;
    for (at, token) in tokens.iter().enumerate().skip(open + 1) {
        let is_end = nesting == 0 && token.kind == Kind::Mark('}');
        match token.kind {
            _ if is_end => {}
            Kind::Hash => return None,
            Kind::Mark('(' | '[' | '{') => nesting += 1,
            Kind::Mark(')' | ']' | '}') => nesting = nesting.saturating_sub(1),
            Kind::Mark(':') => has_colon = true,
            Kind::Mark('<') if has_colon => angles += 1,
            Kind::Mark('>') if has_colon => angles = angles.saturating_sub(1),
            _ => {}
        }
        let is_comma = nesting == 0 && angles == 0 && token.kind == Kind::Mark(',');
        if is_comma || is_end {
            members.extend(member(text, &tokens[first..at]));
            (first, angles, has_colon) = (at + 1, 0, false);
        }
        if is_end {
            return Some((members, at));
        }
    }
    None
}

fn member(text: &str, tokens: &[Token]) -> Option<ParamMember> {
    let last = tokens.iter().rposition(|token| token.kind != Kind::Doc)?;
    let tokens = &tokens[..=last];
    let mut at = 0;
    let mut docs = Vec::new();
    let mut name = None;
    while let Some(token) = tokens.get(at) {
        at += 1;
        match token.kind {
            Kind::Doc => docs.push(token.range.clone()),
            // An attribute: its name, and what it has in parentheses.
            Kind::Mark('@') => {
                at += 1;
                if tokens
                    .get(at)
                    .is_some_and(|t| &text[t.range.clone()] == "(")
                {
                    at += tokens[at..]
                        .iter()
                        .take_while(|t| t.kind != Kind::Mark(')'))
                        .count()
                        + 1;
                }
            }
            Kind::Word => {
                name = Some(token.range.clone());
                break;
            }
            _ => break,
        }
    }
    Some(ParamMember {
        name,
        docs,
        range: tokens[0].range.start..tokens[last].range.end,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(text: &str) -> Vec<&str> {
        scan(text)
            .declarations
            .iter()
            .map(|declaration| &text[declaration.name.clone()])
            .collect()
    }

    #[test]
    fn module_scope_names_are_found_and_inner_ones_are_not() {
        let text = "/* var<private> no: u32; */ @group(0) @binding(1) var<storage, read_write> a: u32;\n\
                    const b = 1; // const no = 2;\n\
                    fn c(x: u32) -> u32 { const no = 1; var no2 = 2; { let no3 = 3; } return x; }\n\
                    struct D { no: u32 } alias e = f32; override f: f32 = 1.0; const_assert true;\n\
                    /* outer /* inner */ const no = 1; */ var<private> g: u32;";
        assert_eq!(names(text), ["a", "b", "c", "D", "e", "f", "g"]);
    }

    #[test]
    fn imports_are_lines_of_their_own_outside_comments() {
        let text = "// #import \"no.wgsl\"\n/*\n#import \"no.wgsl\"\n*/\n  #import \"a//b.wgsl\" // why\r\n\
                    #import slot \"clip\"\n#import\"c.wgsl\"\nconst s = 1;";
        let scan = scan(text);
        let targets: Vec<_> = scan
            .imports
            .iter()
            .map(|import| import.target.clone())
            .collect();
        assert_eq!(
            targets,
            [
                Target::File("a//b.wgsl".into()),
                Target::Slot("clip".into()),
                Target::File("c.wgsl".into())
            ]
        );
        assert_eq!(
            &text[scan.imports[0].range.clone()],
            "#import \"a//b.wgsl\""
        );
        assert!(scan.bad_imports.is_empty());
    }

    #[test]
    fn bad_hash_lines_are_told() {
        for bad in [
            "#include \"a\"",
            "#import a",
            "#import \"a",
            "#import \"\"",
            "#import \"a\" const b = 1;",
            "#imports \"a\"",
            "#import slot \"a/b\"",
            "#import slot",
            "const a = 1; #import \"a\"",
            "#",
        ] {
            let scan = scan(bad);
            assert_eq!(
                (scan.imports.len(), scan.bad_imports.len()),
                (0, 1),
                "{bad}"
            );
        }
    }

    #[test]
    fn directives_stand_before_declarations() {
        let text = "enable f16; requires a, b;\n#import \"x\"\ndiagnostic(off, c.d);\nconst a = 1; enable g;";
        let directives: Vec<_> = scan(text)
            .directives
            .iter()
            .map(|d| &text[d.clone()])
            .collect();
        assert_eq!(
            directives,
            ["enable f16;", "requires a, b;", "diagnostic(off, c.d);"]
        );
    }

    #[test]
    fn params_have_members() {
        let text = "struct Params {\n /// one @default 1\n /// more\n @size(16) a: vec2<f32>, // x, y\n\
                    b: array<vec4<f32>, 2>,\n /// last\n c: f32 /// stray\n}\nfn f() {}";
        let scan = scan(text);
        let members = &scan.params[0].members;
        let texts: Vec<_> = members
            .iter()
            .map(|m| &text[m.name.clone().unwrap()])
            .collect();
        assert_eq!(texts, ["a", "b", "c"]);
        assert_eq!(members[0].docs.len(), 2);
        assert!(text[members[0].range.clone()].ends_with("a: vec2<f32>"));
        assert_eq!(&text[members[1].range.clone()], "b: array<vec4<f32>, 2>");
        assert!(text[members[2].range.clone()].ends_with("c: f32"));
        assert!(text[scan.params[0].range.clone()].ends_with("stray\n}"));
        assert_eq!(scan.declarations.len(), 1);
    }
}
