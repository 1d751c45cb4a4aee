//! Reads what a shader parameter's doc comments say.

use std::ops::Range;

use volgraph_report::{Finding, Findings, did_you_mean};

use crate::layout::{MemberType, ScalarType};
use crate::linked::{Linked, MergedParam};
use crate::params::{ParamSpec, ParamType, ParamValue};

const TAGS: [&str; 7] = [
    "default", "range", "unit", "choices", "color", "constant", "uniform",
];

/// A piece of a doc comment with its place in its file.
#[derive(Clone, Debug, PartialEq)]
struct Word<'t> {
    text: &'t str,
    range: Range<usize>,
}

/// A tag with its words.
#[derive(Clone, Debug, PartialEq)]
struct Tag<'t> {
    name: Word<'t>,
    words: Vec<Word<'t>>,
}

/// The parameter that a member of `struct Params` is, or all that is wrong with it (`params-doc`).
pub(crate) fn shader_param(
    linked: &Linked,
    param: &MergedParam,
    ty: &MemberType,
) -> Result<ParamSpec, Findings> {
    let text = &linked.files[param.file].text;
    let (doc, tags) = read(text, &param.docs);
    let error = |range: &Range<usize>, message: String| {
        let message = format!("parameter `{}`: {message}", param.name);
        Finding::error("params-doc", message).at(linked.place_in(param.file, range))
    };
    let mut findings = Findings::new();
    let Some(ty) = param_type(ty) else {
        let finding = error(&param.range, format!("`{ty}` is no parameter type"));
        return Err(finding
            .help("parameters are f32, i32, u32, or vectors of 2, 3 or 4 of these")
            .into());
    };
    let mut spec = ParamSpec::new(&param.name, ty, ParamValue::Int(0), doc);
    spec.place = Some(linked.place_in(param.file, &param.range));
    for (at, tag) in tags.iter().enumerate() {
        let name = tag.name.text;
        if !TAGS.contains(&name) {
            let finding = error(&tag.name.range, format!("unknown tag `@{name}`"));
            findings.push(finding.help_opt(did_you_mean(name, TAGS)));
        } else if tags[..at].iter().any(|before| before.name.text == name) {
            findings.push(error(&tag.name.range, format!("`@{name}` is given twice")));
        }
    }
    let find = |name: &str| tags.iter().find(|tag| tag.name.text == name);
    if let Some(tag) = find("choices") {
        match choices(tag, &spec.ty) {
            Ok(choices) => spec.ty = ParamType::Choice(choices),
            Err((range, message)) => findings.push(error(&range, message)),
        }
    }
    if let Some(tag) = find("range") {
        match range(tag, &spec.ty) {
            Ok(range) => spec.range = Some(range),
            Err((range, message)) => findings.push(error(&range, message)),
        }
    }
    if let Some(tag) = find("unit") {
        match tag.words.as_slice() {
            [unit] => spec.unit = Some(unit.text.to_owned()),
            _ => findings.push(error(&tag.name.range, "`@unit` takes one word".to_owned())),
        }
    }
    if let Some(tag) = find("color") {
        spec.is_color = matches!(spec.ty, ParamType::Vector(3 | 4)) && tag.words.is_empty();
        if !spec.is_color {
            let message = "`@color` stands alone, and only vec3f and vec4f are colours";
            findings.push(error(&tag.name.range, message.to_owned()));
        }
    }
    spec.is_constant = matches!(spec.ty, ParamType::Choice(_));
    if let Some(tag) = find("uniform") {
        if !spec.is_constant || !tag.words.is_empty() {
            let message = "`@uniform` stands alone, and only what has `@choices` takes it";
            findings.push(error(&tag.name.range, message.to_owned()));
        }
        spec.is_constant = false;
    }
    if let Some(tag) = find("constant") {
        // Choices are constants already.
        spec.is_constant =
            matches!(spec.ty, ParamType::Int | ParamType::Uint) && tag.words.is_empty();
        if !spec.is_constant {
            let message =
                "`@constant` stands alone, and only u32 and i32 without `@choices` take it";
            findings.push(error(&tag.name.range, message.to_owned()));
        }
    }
    match find("default") {
        // What the choices or the range are is not known where they are wrong.
        Some(_) if findings.has_errors() => {}
        Some(tag) => match default(tag, &spec) {
            Ok(value) => spec.default = value,
            Err((range, message)) => findings.push(error(&range, message)),
        },
        // A misspelt `@default` is told already.
        None if tags.iter().any(|tag| {
            did_you_mean(tag.name.text, ["default"]).is_some_and(|near| near.starts_with("did"))
        }) => {}
        None => {
            let finding = error(&param.range, "no `@default` in its doc comment".to_owned());
            findings.push(finding.help("write `/// What it means. @default 1.0` above it"));
        }
    }
    findings.into_result(spec)
}

fn param_type(ty: &MemberType) -> Option<ParamType> {
    Some(match ty {
        MemberType::Scalar(ScalarType::F32) => ParamType::Float,
        MemberType::Scalar(ScalarType::I32) => ParamType::Int,
        MemberType::Scalar(ScalarType::U32) => ParamType::Uint,
        MemberType::Vector(ScalarType::F32, size) => ParamType::Vector(*size as usize),
        MemberType::Vector(ScalarType::I32, size) => ParamType::IntVector(*size as usize),
        MemberType::Vector(ScalarType::U32, size) => ParamType::UintVector(*size as usize),
        _ => return None,
    })
}

/// The free text and the tags of these doc comments.
fn read<'t>(text: &'t str, docs: &[Range<usize>]) -> (String, Vec<Tag<'t>>) {
    let mut free = Vec::new();
    let mut tags: Vec<Tag> = Vec::new();
    for doc in docs {
        let line = &text[doc.clone()];
        let words = line.trim_start_matches('/').split_whitespace();
        let mut is_tagged = false;
        for word in words {
            let start = doc.start + (word.as_ptr() as usize - line.as_ptr() as usize);
            let word = Word {
                text: word,
                range: start..start + word.len(),
            };
            if let Some(name) = word.text.strip_prefix('@') {
                tags.push(Tag {
                    name: Word { text: name, ..word },
                    words: Vec::new(),
                });
                is_tagged = true;
            } else if let Some(tag) = tags.last_mut().filter(|_| is_tagged) {
                tag.words.push(word);
            } else {
                free.push(word.text);
            }
        }
    }
    (free.join(" "), tags)
}

type Wrong = (Range<usize>, String);

fn choices(tag: &Tag, ty: &ParamType) -> Result<Vec<String>, Wrong> {
    let wrong = |message: &str| Err((tag.name.range.clone(), message.to_owned()));
    if !matches!(ty, ParamType::Int | ParamType::Uint) {
        return wrong("`@choices` are for u32 and i32");
    }
    if tag.words.is_empty() {
        return wrong("`@choices` takes the names of the choices");
    }
    for (at, word) in tag.words.iter().enumerate() {
        if tag.words[..at]
            .iter()
            .any(|before| before.text == word.text)
        {
            return Err((
                word.range.clone(),
                format!("the choice `{}` is given twice", word.text),
            ));
        }
    }
    Ok(tag.words.iter().map(|word| word.text.to_owned()).collect())
}

fn range(tag: &Tag, ty: &ParamType) -> Result<(f64, f64), Wrong> {
    let wrong = |message: &str| Err((tag.name.range.clone(), message.to_owned()));
    if matches!(ty, ParamType::Choice(_)) {
        return wrong("`@range` and `@choices` exclude each other");
    }
    let [least, most] = tag.words.as_slice() else {
        return wrong("`@range` takes two numbers: least and most");
    };
    let (least, most) = (number(least)?, number(most)?);
    if least > most {
        return wrong("`@range` has its larger number first");
    }
    Ok((least, most))
}

fn default(tag: &Tag, spec: &ParamSpec) -> Result<ParamValue, Wrong> {
    let first = tag
        .words
        .first()
        .map_or(tag.name.range.clone(), |word| word.range.clone());
    let last = tag.words.last().map_or(first.end, |word| word.range.end);
    let whole = first.start..last;
    let count = match spec.ty {
        ParamType::Vector(size) | ParamType::IntVector(size) | ParamType::UintVector(size) => size,
        _ => 1,
    };
    if tag.words.len() != count {
        return Err((whole, format!("`@default` takes {}", spec.ty)));
    }
    let value = match (&spec.ty, tag.words.as_slice()) {
        (ParamType::Choice(_), [word]) => ParamValue::Text(word.text.to_owned()),
        (ParamType::Int | ParamType::Uint, [word]) => match word.text.parse() {
            Ok(number) => ParamValue::Int(number),
            Err(_) => return Err((whole, format!("`{}` is not {}", word.text, spec.ty))),
        },
        (ParamType::Float, [word]) => ParamValue::Float(number(word)?),
        (_, words) => ParamValue::Vector(words.iter().map(number).collect::<Result<_, _>>()?),
    };
    spec.check(&value)
        .map_err(|why| (whole, format!("`@default`: {why}")))
}

fn number(word: &Word) -> Result<f64, Wrong> {
    match word.text.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err((word.range.clone(), format!("`{}` is no number", word.text))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tags_end_at_the_next_tag_or_the_line() {
        let text = "/// Length of  a segment. @default 1.0 @range 0 2\n/// More text.";
        let docs = [0..50, 51..text.len()];
        let (doc, tags) = read(text, &docs);
        assert_eq!(doc, "Length of a segment. More text.");
        let shown: Vec<_> = tags
            .iter()
            .map(|tag| {
                (
                    tag.name.text,
                    tag.words.iter().map(|w| w.text).collect::<Vec<_>>(),
                )
            })
            .collect();
        assert_eq!(shown, [("default", vec!["1.0"]), ("range", vec!["0", "2"])]);
        assert_eq!(&text[tags[1].words[1].range.clone()], "2");
    }
}
