//! Header lines as fields with their line number, and the values in them: what NRRD and MetaImage share.

use std::str::FromStr;

use volgraph_volume::{Trouble, VolumeError};

/// Most bytes of a header; a longer one is no header.
pub(crate) const LONGEST_HEADER: u64 = 4 << 20;

/// One line `key: value`.
#[derive(Clone, Debug)]
pub(crate) struct Field {
    pub key: String,
    pub value: String,
    pub line: u32,
}

/// Most warnings about one header; a file of nothing but unknown lines needs no more.
const MOST_WARNINGS: usize = 20;

/// The fields of a header that are read, each key once. Callers add no others, so that it stays short.
#[derive(Clone, Debug, Default)]
pub(crate) struct Fields(Vec<Field>);

impl Fields {
    /// Adds a field; a key that is there already is an error.
    pub fn push(&mut self, field: Field) -> Result<(), VolumeError> {
        if let Some(first) = self.get(&field.key) {
            return Err(VolumeError::HeaderSyntax(Trouble::new(
                format!(
                    "`{}` is said twice, first on line {}",
                    field.key, first.line
                ),
                "keep one of the two lines",
            ))
            .on_line(field.line));
        }
        self.0.push(field);
        Ok(())
    }

    pub fn get(&self, key: &str) -> Option<&Field> {
        self.0.iter().find(|field| field.key == key)
    }

    pub fn require(&self, key: &str) -> Result<&Field, VolumeError> {
        self.get(key).ok_or_else(|| {
            VolumeError::MissingField(Trouble::new(
                format!("the header has no `{key}`"),
                format!("add a line `{key}`"),
            ))
        })
    }
}

impl Field {
    pub fn bad(&self, cause: impl std::fmt::Display, remedy: impl Into<String>) -> VolumeError {
        let value: String = self.value.chars().take(60).collect();
        VolumeError::BadValue(Trouble::new(
            format!("`{}` is {value:?}: {cause}", self.key),
            remedy,
        ))
        .on_line(self.line)
    }

    /// The only number in the field.
    pub fn number<T: FromStr>(&self) -> Result<T, VolumeError> {
        parse_number(&self.value).ok_or_else(|| {
            self.bad(
                "that is no number of the range it needs",
                "write one number",
            )
        })
    }

    /// Exactly `count` numbers between blanks.
    pub fn numbers<T: FromStr>(&self, count: usize) -> Result<Vec<T>, VolumeError> {
        let numbers = self.all_numbers()?;
        if numbers.len() == count {
            return Ok(numbers);
        }
        let have = numbers.len();
        Err(self.bad(
            format!("that is {have} values where {count} are needed"),
            format!("write {count} numbers"),
        ))
    }

    /// All numbers between blanks.
    pub fn all_numbers<T: FromStr>(&self) -> Result<Vec<T>, VolumeError> {
        self.value
            .split_whitespace()
            .map(|word| {
                parse_number(word).ok_or_else(|| {
                    let word: String = word.chars().take(40).collect();
                    self.bad(
                        format!("{word:?} is no number of the range it needs"),
                        "write numbers between blanks",
                    )
                })
            })
            .collect()
    }

    /// `(1,0,0) none (0,1,0)` as vectors, `None` for `none` and for vectors of nothing but NaN.
    pub fn vectors(&self) -> Result<Vec<Option<Vec<f64>>>, VolumeError> {
        let remedy = "write vectors as (1,0,0), and `none` for an axis without direction";
        let mut vectors = Vec::new();
        let mut rest = self.value.trim_start();
        while !rest.is_empty() {
            if let Some(inside) = rest.strip_prefix('(') {
                let (vector, after) = inside
                    .split_once(')')
                    .ok_or_else(|| self.bad("a parenthesis is not closed", remedy))?;
                let numbers: Option<Vec<f64>> = vector.split(',').map(parse_number).collect();
                let numbers =
                    numbers.ok_or_else(|| self.bad(format!("({vector}) is no vector"), remedy))?;
                let nothing = numbers.iter().all(|number| number.is_nan());
                vectors.push((!nothing).then_some(numbers));
                rest = after.trim_start();
            } else {
                let end = rest.find(char::is_whitespace).unwrap_or(rest.len());
                let (word, after) = rest.split_at(end);
                if !word.eq_ignore_ascii_case("none") {
                    return Err(self.bad(format!("{word:?} is no vector"), remedy));
                }
                vectors.push(None);
                rest = after.trim_start();
            }
        }
        Ok(vectors)
    }
}

fn parse_number<T: FromStr>(word: &str) -> Option<T> {
    word.trim().parse().ok()
}

/// A line of a header as text without its end of line; bytes that are no UTF-8 are an error.
pub(crate) fn text_line(bytes: &[u8], line: u32) -> Result<&str, VolumeError> {
    std::str::from_utf8(bytes).map_err(|error| {
        VolumeError::HeaderSyntax(Trouble::new(
            format!("the header is not text: {error}"),
            "a header is ASCII or UTF-8; check that the file is what its name says",
        ))
        .on_line(line)
    })
}

/// The lines of `bytes` without their ends (`\n` or `\r\n`), each with the offset behind it. The flag tells
/// whether the line had an end.
pub(crate) fn lines(bytes: &[u8]) -> impl Iterator<Item = (&[u8], usize, bool)> {
    let mut at = 0;
    std::iter::from_fn(move || {
        let rest = bytes.get(at..).filter(|rest| !rest.is_empty())?;
        let end = rest.iter().position(|&byte| byte == b'\n');
        let line = &rest[..end.unwrap_or(rest.len())];
        at += end.map_or(rest.len(), |end| end + 1);
        Some((line.strip_suffix(b"\r").unwrap_or(line), at, end.is_some()))
    })
}

/// Warns of a key that means nothing here, with the known one that it nearly is; `must_be_near` keeps quiet
/// where there is none.
pub(crate) fn warn_unknown(
    warnings: &mut Vec<String>,
    field: &Field,
    known: &[&'static str],
    must_be_near: bool,
) {
    // Long keys are nobody's typing errors, and measuring how near they are is slow.
    if warnings.len() >= MOST_WARNINGS || field.key.len() > 60 {
        return;
    }
    let near = volgraph_report::did_you_mean(&field.key, known.iter().copied());
    let near = near.filter(|hint| hint.starts_with("did") && field.key.len() > 3);
    if near.is_some() || !must_be_near {
        let hint = near.map(|hint| format!("; {hint}")).unwrap_or_default();
        warnings.push(format!(
            "line {}: `{}` means nothing here{hint}",
            field.line, field.key
        ));
    }
}

/// "Too long to be a header".
pub(crate) fn endless_header() -> VolumeError {
    VolumeError::HeaderSyntax(Trouble::new(
        format!("the header does not end within {LONGEST_HEADER} bytes"),
        "check that the file is what its name says",
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field(value: &str) -> Field {
        Field {
            key: "k".into(),
            value: value.into(),
            line: 7,
        }
    }

    #[test]
    fn vectors_may_hold_blanks_and_none() {
        let vectors = field(" (1, 0,0) none (nan,nan,nan)(0,-2e1,0)")
            .vectors()
            .unwrap();
        assert_eq!(
            vectors,
            [
                Some(vec![1.0, 0.0, 0.0]),
                None,
                None,
                Some(vec![0.0, -20.0, 0.0])
            ]
        );
        for bad in ["(1,0", "(1,,0)", "(a)", "x", "()", "1,0,0"] {
            let error = field(bad).vectors().unwrap_err();
            assert_eq!(
                (error.code(), error.trouble().line),
                ("volume-bad-value", 7),
                "{bad}"
            );
        }
    }

    #[test]
    fn counts_and_numbers_are_checked() {
        assert_eq!(field("1 2  3").numbers::<u64>(3).unwrap(), [1, 2, 3]);
        assert!(field("1 2").numbers::<u64>(3).is_err());
        assert!(field("1 -2 3").numbers::<u64>(3).is_err());
        assert!(field("1 2").number::<f64>().is_err());
    }

    #[test]
    fn lines_lose_either_end() {
        let all: Vec<_> = lines(b"a\r\n\nb").collect();
        assert_eq!(
            all,
            [
                (&b"a"[..], 3, true),
                (&b""[..], 4, true),
                (&b"b"[..], 5, false)
            ]
        );
    }
}
