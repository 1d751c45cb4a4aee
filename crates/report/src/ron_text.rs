//! RON values that know where they stand, so that everything wrong in a file is found in one run.
//!
//! serde stops at the first mismatch and says little of its place. Here the `ron` crate checks the syntax once
//! and then hands out each part as a borrowed slice of the text; a [`Value`] is such a slice with its offset.
//! A reader walks the values it knows, pushes a [`Finding`] for each that does not fit, and goes on.

use std::path::Path;

use ron::value::RawValue;
use serde::de::Deserializer;

use crate::{Finding, Findings, Place, did_you_mean};
use visit::{EntriesVisitor, ItemsVisitor, NameKind, VariantVisitor, leading_blank};

mod visit;

/// A RON text whose syntax is right, and the file it came from.
#[derive(Clone, Copy, Debug)]
pub struct Document<'s> {
    file: &'s Path,
    text: &'s str,
}

impl<'s> Document<'s> {
    /// Checks the syntax of the whole text.
    ///
    /// # Errors
    /// One `ron-syntax` finding at the place where the text stops being RON.
    pub fn parse(file: &'s Path, text: &'s str) -> Result<Value<'s>, Finding> {
        let doc = Self { file, text };
        // Editors on Windows put a byte order mark before UTF-8.
        let ron = text.strip_prefix('\u{feff}').unwrap_or(text);
        match ron::from_str::<&RawValue>(ron) {
            Ok(raw) => Ok(Value::new(doc, raw)),
            Err(error) => Err(doc.syntax(&error, text.len() - ron.len())),
        }
    }

    fn syntax(self, error: &ron::error::SpannedError, base: usize) -> Finding {
        let (line, column) = (error.span.start.line, error.span.start.col);
        // RON counts lines and columns from the start of the slice it was given.
        let (base_line, base_column) = crate::line_column(self.text, base);
        let line = u32::try_from(line.max(1)).unwrap_or(u32::MAX);
        let column = u32::try_from(column.max(1)).unwrap_or(u32::MAX);
        let column = if line == 1 {
            base_column + column - 1
        } else {
            column
        };
        let place = Place {
            file: self.file.to_path_buf(),
            line: base_line + line - 1,
            column,
            length: 1,
        };
        Finding::error("ron-syntax", error.code.to_string()).at(place)
    }
}

/// One value of a document: a slice of its text.
#[derive(Clone, Copy, Debug)]
pub struct Value<'s> {
    doc: Document<'s>,
    raw: &'s str,
    offset: usize,
}

/// One named part of a value: a struct's field, or an entry of a map with a text key.
#[derive(Clone, Debug)]
pub struct Entry<'s> {
    /// The name, without quotes.
    pub name: String,
    /// Where the name stands.
    pub name_place: Place,
    /// What it is set to.
    pub value: Value<'s>,
}

impl<'s> Value<'s> {
    fn new(doc: Document<'s>, raw: &'s RawValue) -> Self {
        let raw = raw.get_ron();
        let offset = (raw.as_ptr() as usize)
            .saturating_sub(doc.text.as_ptr() as usize)
            .min(doc.text.len());
        let skipped = leading_blank(raw);
        Self {
            doc,
            raw: &raw[skipped..],
            offset: offset + skipped,
        }
    }

    /// Where the value stands (its first line).
    #[must_use]
    pub fn place(&self) -> Place {
        Place::in_text(
            self.doc.file,
            self.doc.text,
            self.offset,
            self.raw.trim_end().len(),
        )
    }

    /// The value's own text.
    #[must_use]
    pub fn text(&self) -> &'s str {
        self.raw.trim_end()
    }

    /// An error at this value's place.
    #[must_use]
    pub fn error(&self, code: &'static str, message: impl Into<String>) -> Finding {
        Finding::error(code, message).at(self.place())
    }

    /// A text.
    ///
    /// # Errors
    /// `wrong-type` where it is something else. The same holds for the readers below.
    pub fn string(&self) -> Result<String, Finding> {
        self.scalar("a text in quotes")
    }

    /// A number, whole or not.
    ///
    /// # Errors
    /// `wrong-type`, also for a number that is not finite.
    pub fn f64(&self) -> Result<f64, Finding> {
        let number: f64 = self.scalar("a number")?;
        if number.is_finite() {
            Ok(number)
        } else {
            Err(self.wrong_type("a finite number"))
        }
    }

    /// A whole number.
    ///
    /// # Errors
    /// `wrong-type`.
    pub fn i64(&self) -> Result<i64, Finding> {
        self.scalar("a whole number")
    }

    /// A whole number of at least 0.
    ///
    /// # Errors
    /// `wrong-type`.
    pub fn u32(&self) -> Result<u32, Finding> {
        self.scalar("a whole number of at least 0")
    }

    /// `true` or `false`.
    ///
    /// # Errors
    /// `wrong-type`.
    pub fn bool(&self) -> Result<bool, Finding> {
        self.scalar("true or false")
    }

    /// `N` numbers: a tuple `(x, y, z)` or a list `[x, y, z]`.
    ///
    /// # Errors
    /// `wrong-type`.
    pub fn f64s<const N: usize>(&self) -> Result<[f64; N], Finding> {
        let items = self.items()?;
        if items.len() != N {
            return Err(self.wrong_type(&format!("{N} numbers")));
        }
        let mut numbers = [0.0; N];
        for (number, item) in numbers.iter_mut().zip(&items) {
            *number = item.f64()?;
        }
        Ok(numbers)
    }

    /// The items of a list `[…]` or tuple `(…)`.
    ///
    /// # Errors
    /// `wrong-type`.
    pub fn items(&self) -> Result<Vec<Value<'s>>, Finding> {
        let is_list = self.raw.starts_with('[');
        let visitor = ItemsVisitor(self.doc);
        self.read("a list", |de| {
            if is_list {
                de.deserialize_seq(visitor)
            } else {
                de.deserialize_tuple(0, visitor)
            }
        })
    }

    /// The fields of a struct `(name: value, …)`, in their order. A field given twice is an error.
    ///
    /// # Errors
    /// `wrong-type` or `duplicate`.
    pub fn fields(&self) -> Result<Vec<Entry<'s>>, Findings> {
        let visitor = EntriesVisitor(self.doc, NameKind::Identifier);
        let entries = self.read("named fields in parentheses", |de| {
            de.deserialize_struct("", &[], visitor)
        })?;
        self.named(entries)
    }

    /// The entries of a map `{"name": value, …}`, in their order. A key given twice is an error.
    ///
    /// # Errors
    /// `wrong-type` or `duplicate`.
    pub fn entries(&self) -> Result<Vec<Entry<'s>>, Findings> {
        let visitor = EntriesVisitor(self.doc, NameKind::Quoted);
        let entries = self.read("a map in braces", |de| de.deserialize_map(visitor))?;
        self.named(entries)
    }

    /// A name with fields, such as `orbit(azimuth: 40)`; a bare name has none.
    ///
    /// # Errors
    /// `wrong-type` or `duplicate`.
    pub fn variant(&self) -> Result<(String, Vec<Entry<'s>>), Findings> {
        let name_end = self
            .raw
            .find(|c: char| !(c.is_alphanumeric() || c == '_' || c == '-'));
        let is_bare = name_end.is_none();
        let (name, entries) = self.read("a name with fields, such as `name(field: 1)`", |de| {
            de.deserialize_enum(
                "",
                &[],
                VariantVisitor {
                    doc: self.doc,
                    is_bare,
                },
            )
        })?;
        Ok((name, self.named(entries)?))
    }

    fn named(&self, entries: Vec<(String, Value<'s>)>) -> Result<Vec<Entry<'s>>, Findings> {
        let mut findings = Findings::new();
        let mut named: Vec<Entry<'s>> = Vec::with_capacity(entries.len());
        let mut searched_from = self.offset;
        for (name, value) in entries {
            // The name stands before its value and after the previous value; the nearest one to the value is it.
            let between = &self.doc.text[searched_from.min(value.offset)..value.offset];
            let start = between
                .rfind(&name)
                .map_or(value.offset, |at| searched_from + at);
            let name_place = Place::in_text(self.doc.file, self.doc.text, start, name.len());
            searched_from = value.offset + value.raw.len();
            if let Some(first) = named.iter().find(|entry| entry.name == name) {
                findings.push(
                    Finding::error("duplicate", format!("`{name}` is given twice"))
                        .at(name_place)
                        .related(first.name_place.clone(), "first here"),
                );
            } else {
                named.push(Entry {
                    name,
                    name_place,
                    value,
                });
            }
        }
        findings.into_result(named)
    }

    fn scalar<T: serde::de::DeserializeOwned>(&self, expected: &str) -> Result<T, Finding> {
        ron::from_str(self.raw).map_err(|_| self.wrong_type(expected))
    }

    fn wrong_type(&self, expected: &str) -> Finding {
        let mut shown: String = self
            .text()
            .lines()
            .next()
            .unwrap_or("")
            .chars()
            .take(40)
            .collect();
        if shown.len() < self.text().len() {
            shown.push('…');
        }
        self.error(
            "wrong-type",
            format!("expected {expected}, found `{shown}`"),
        )
    }

    fn read<T>(
        &self,
        expected: &str,
        read: impl FnOnce(&mut ron::Deserializer<'s>) -> Result<T, ron::Error>,
    ) -> Result<T, Finding> {
        let mut deserializer = ron::Deserializer::from_str(self.raw)
            .map_err(|error| self.doc.syntax(&error, self.offset))?;
        let value = read(&mut deserializer).map_err(|_| self.wrong_type(expected))?;
        deserializer.end().map_err(|_| self.wrong_type(expected))?;
        Ok(value)
    }
}

/// The entries of a struct, map or variant, taken one by one; what is left at the end is unknown.
#[derive(Debug)]
pub struct Fields<'s> {
    entries: Vec<Entry<'s>>,
    asked: Vec<&'static str>,
}

impl<'s> Fields<'s> {
    /// Starts with all of them.
    #[must_use]
    pub fn new(entries: Vec<Entry<'s>>) -> Self {
        Self {
            entries,
            asked: Vec::new(),
        }
    }

    /// Takes the field `name` if it is there.
    pub fn take(&mut self, name: &'static str) -> Option<Value<'s>> {
        self.asked.push(name);
        let at = self.entries.iter().position(|entry| entry.name == name)?;
        Some(self.entries.remove(at).value)
    }

    /// Takes the field `name` and reads it; keeps the finding where it does not fit.
    pub fn read<T>(
        &mut self,
        findings: &mut Findings,
        name: &'static str,
        read: impl FnOnce(&Value<'s>) -> Result<T, Finding>,
    ) -> Option<T> {
        let value = self.take(name)?;
        findings.take(read(&value))
    }

    /// An `unknown-field` finding for each field that nobody took.
    pub fn finish(self, findings: &mut Findings) {
        for entry in self.entries {
            findings.push(
                Finding::error("unknown-field", format!("unknown field `{}`", entry.name))
                    .at(entry.name_place)
                    .help_opt(did_you_mean(&entry.name, self.asked.iter().copied())),
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "(\n  // which\n  a: 1.5, /* c */ b: {\"x\": orbit(azimuth: 40), \"y\": bare},\n  c: [1, 2, 3],\n)";

    fn parse(text: &str) -> Result<Value<'_>, Finding> {
        Document::parse(Path::new("t.ron"), text)
    }

    fn at(place: &Place) -> (u32, u32) {
        (place.line, place.column)
    }

    #[test]
    fn values_know_their_places() {
        let fields = parse(TEXT).unwrap().fields().unwrap();
        assert_eq!(
            fields.iter().map(|e| e.name.as_str()).collect::<Vec<_>>(),
            ["a", "b", "c"]
        );
        assert_eq!(at(&fields[0].name_place), (3, 3));
        assert_eq!(at(&fields[0].value.place()), (3, 6));
        assert_eq!(fields[0].value.f64().unwrap(), 1.5);
        let map = fields[1].value.entries().unwrap();
        assert_eq!(at(&map[0].value.place()), (3, 28));
        let (name, inner) = map[0].value.variant().unwrap();
        assert_eq!(
            (name.as_str(), inner[0].value.i64().unwrap()),
            ("orbit", 40)
        );
        assert_eq!(map[1].value.variant().unwrap().0, "bare");
        assert_eq!(fields[2].value.f64s::<3>().unwrap(), [1.0, 2.0, 3.0]);
    }

    #[test]
    fn what_does_not_fit_is_said_at_its_place() {
        let error = parse("(\n a: 1,\n b 2)").unwrap_err();
        assert_eq!(
            (error.code, at(error.place.as_ref().unwrap())),
            ("ron-syntax", (3, 3))
        );
        let fields = parse("(a: \"x\", b: 3)").unwrap().fields().unwrap();
        let error = fields[0].value.f64().unwrap_err();
        assert_eq!(
            (error.code, at(error.place.as_ref().unwrap())),
            ("wrong-type", (1, 5))
        );
        assert_eq!(error.message, "expected a number, found `\"x\"`");
        let error = parse("(a: 1, a: 2)").unwrap().fields().unwrap_err();
        assert_eq!(error.sorted()[0].code, "duplicate");
        assert_eq!(at(error.sorted()[0].place.as_ref().unwrap()), (1, 8));
    }

    #[test]
    fn unknown_fields_are_all_named() {
        let mut findings = Findings::new();
        let mut fields = Fields::new(parse("(stp: 1, foo: 2)").unwrap().fields().unwrap());
        assert_eq!(fields.read(&mut findings, "step", Value::f64), None);
        fields.finish(&mut findings);
        let codes: Vec<_> = findings
            .sorted()
            .into_iter()
            .map(|f| (f.code, f.help.clone().unwrap()))
            .collect();
        assert_eq!(
            codes[0],
            ("unknown-field", "did you mean `step`?".to_owned())
        );
        assert_eq!(codes.len(), 2);
    }

    #[test]
    fn a_byte_order_mark_is_no_part_of_the_text() {
        let value = parse("\u{feff}(a: 1)").unwrap();
        let fields = value.fields().unwrap();
        assert_eq!(fields[0].name, "a");
        // It is a character of the line, as editors count.
        assert_eq!(at(&fields[0].name_place), (1, 3));
        let error = parse("\u{feff}(a: 1").unwrap_err();
        assert_eq!(at(error.place.as_ref().unwrap()).0, 1);
        assert!(parse("(\u{feff}a: 1)").is_err());
    }

    #[test]
    fn deep_nesting_is_an_error_not_a_crash() {
        let deep = "[".repeat(100_000);
        assert_eq!(parse(&deep).unwrap_err().code, "ron-syntax");
    }
}
