//! Which files hold the voxels: one, a list, or a numbered series, in the words NRRD and MetaImage share.

use std::fmt::Write as _;

use volgraph_volume::VolumeError;

use crate::fields::Field;
use crate::input::Input;

/// Most data files of one volume.
const MOST_FILES: i128 = 100_000;

/// Where the voxels are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DataFiles {
    /// Behind the header in the same file.
    Attached,
    /// In these files, in this order, each with an equal share; relative to the header's folder.
    Detached(Vec<String>),
}

impl DataFiles {
    /// The value of NRRD's `data file` or MetaImage's `ElementDataFile` (but for `LOCAL`): a name, `LIST` with
    /// the names in `listed`, or `name%03d.raw first last step`.
    pub(crate) fn parse(field: &Field, listed: Vec<String>) -> Result<Self, VolumeError> {
        let value = field.value.trim();
        if value.is_empty() {
            return Err(field.bad("no file is named", "name the data file"));
        }
        let words: Vec<&str> = value.split_whitespace().collect();
        if words[0].eq_ignore_ascii_case("list") && words.len() <= 2 {
            if listed.is_empty() {
                let remedy = "write one file name per line after it";
                return Err(field.bad("no files follow", remedy));
            }
            if listed.len() as i128 > MOST_FILES {
                return Err(field.bad(too_many(listed.len() as i128), "join the files"));
            }
            return Ok(Self::Detached(listed));
        }
        // The numbers follow a pattern; a plain name may hold blanks and even a percent sign.
        if words[0].contains('%') && (4..=5).contains(&words.len()) {
            return Self::series(field, words[0], &words[1..4]);
        }
        Ok(Self::Detached(vec![value.to_owned()]))
    }

    fn series(field: &Field, pattern: &str, range: &[&str]) -> Result<Self, VolumeError> {
        let remedy = "write a name with one %d (or %03d), then first, last and step";
        let numbers: Vec<i64> = range.iter().filter_map(|word| word.parse().ok()).collect();
        let &[first, last, step] = numbers.as_slice() else {
            return Err(field.bad("first, last and step are not three integers", remedy));
        };
        let (first, last, step) = (i128::from(first), i128::from(last), i128::from(step));
        if step == 0 || (last - first).signum() * step.signum() < 0 {
            return Err(field.bad(
                format!("a step of {step} does not lead from {first} to {last}"),
                remedy,
            ));
        }
        let count = (last - first) / step + 1;
        if count > MOST_FILES {
            return Err(field.bad(too_many(count), "correct the range"));
        }
        let format = NumberFormat::parse(pattern)
            .ok_or_else(|| field.bad(format!("{pattern:?} is no pattern"), remedy))?;
        Ok(Self::Detached(
            (0..count).map(|i| format.name(first + i * step)).collect(),
        ))
    }

    /// The inputs, opened nowhere yet but known to be files.
    pub(crate) fn inputs<'a>(&self, header: &Input<'a>) -> Result<Vec<Input<'a>>, VolumeError> {
        match self {
            Self::Attached => Ok(vec![header.clone()]),
            Self::Detached(names) => names.iter().map(|name| header.data_file(name)).collect(),
        }
    }
}

fn too_many(count: i128) -> String {
    format!("{count} data files are more than {MOST_FILES}")
}

/// C's `%d`, `%3d`, `%03d`, `%i`, `%u` in a name.
struct NumberFormat<'a> {
    before: &'a str,
    after: &'a str,
    zeros: bool,
    width: usize,
}

impl<'a> NumberFormat<'a> {
    fn parse(pattern: &'a str) -> Option<Self> {
        let (before, rest) = pattern.split_once('%')?;
        let digits = rest.bytes().take_while(u8::is_ascii_digit).count();
        let (number, rest) = rest.split_at(digits);
        let after = rest.strip_prefix(['d', 'i', 'u'])?;
        let width = if number.is_empty() {
            0
        } else {
            number.parse().ok()?
        };
        // No second conversion, and no width that makes endless names.
        (!after.contains('%') && width <= 64).then_some(Self {
            before,
            after,
            zeros: number.starts_with('0'),
            width,
        })
    }

    fn name(&self, number: i128) -> String {
        let mut name = self.before.to_owned();
        let width = self.width;
        // Writing to a string cannot fail.
        let _ = if self.zeros {
            write!(name, "{number:0width$}")
        } else {
            write!(name, "{number:width$}")
        };
        name + self.after
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(value: &str, listed: &[&str]) -> Result<Vec<String>, &'static str> {
        let field = Field {
            key: "data file".into(),
            value: value.into(),
            line: 1,
        };
        let listed = listed.iter().map(|&name| name.into()).collect();
        match DataFiles::parse(&field, listed) {
            Ok(DataFiles::Detached(names)) => Ok(names),
            Ok(DataFiles::Attached) => Err("attached"),
            Err(error) => Err(error.code()),
        }
    }

    #[test]
    fn names_lists_and_series() {
        assert_eq!(parse("my data.raw", &[]).unwrap(), ["my data.raw"]);
        assert_eq!(parse("LIST 2", &["a", "b"]).unwrap(), ["a", "b"]);
        assert_eq!(
            parse("s%03d.raw 8 10 1 2", &[]).unwrap(),
            ["s008.raw", "s009.raw", "s010.raw"]
        );
        assert_eq!(
            parse("s%d.raw 3 1 -1", &[]).unwrap(),
            ["s3.raw", "s2.raw", "s1.raw"]
        );
        for bad in [
            "",
            "LIST",
            "s%d 1 2 0",
            "s%d 1 2 -1",
            "s%x 1 2 1",
            "s%d 1 a 1",
            "s%d 0 1000000000000 1",
            "s%d%d 1 2 1",
            "s%999d 1 2 1",
            "s%d -9223372036854775808 9223372036854775807 1",
        ] {
            assert_eq!(parse(bad, &[]), Err("volume-bad-value"), "{bad}");
        }
    }
}
