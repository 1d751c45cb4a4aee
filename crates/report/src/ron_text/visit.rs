//! How serde's visitors hand out the parts of a value as slices of the text.

use ron::value::RawValue;
use serde::de::{
    DeserializeSeed, Deserializer, EnumAccess, MapAccess, SeqAccess, VariantAccess, Visitor,
};

use super::{Document, Value};

/// Bytes of blanks and comments before a value.
pub(super) fn leading_blank(raw: &str) -> usize {
    let mut rest = raw;
    loop {
        let trimmed = rest.trim_start();
        let after = if let Some(comment) = trimmed.strip_prefix("//") {
            comment.find('\n').map_or("", |end| &comment[end..])
        } else if trimmed.starts_with("/*") {
            block_comment_end(trimmed).map_or("", |end| &trimmed[end..])
        } else {
            return raw.len() - trimmed.len();
        };
        if after.is_empty() {
            return raw.len() - trimmed.len();
        }
        rest = after;
    }
}

fn block_comment_end(text: &str) -> Option<usize> {
    let bytes = text.as_bytes();
    let (mut depth, mut at) = (0_usize, 0);
    while at + 1 < bytes.len() {
        match &bytes[at..at + 2] {
            b"/*" => {
                depth += 1;
                at += 2;
            }
            b"*/" => {
                depth -= 1;
                at += 2;
                if depth == 0 {
                    return Some(at);
                }
            }
            _ => at += 1,
        }
    }
    None
}

pub(super) struct ItemsVisitor<'s>(pub Document<'s>);

impl<'s> Visitor<'s> for ItemsVisitor<'s> {
    type Value = Vec<Value<'s>>;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a list")
    }

    fn visit_seq<A: SeqAccess<'s>>(self, mut seq: A) -> Result<Self::Value, A::Error> {
        let mut items = Vec::new();
        while let Some(raw) = seq.next_element::<&'s RawValue>()? {
            items.push(Value::new(self.0, raw));
        }
        Ok(items)
    }
}

pub(super) struct EntriesVisitor<'s>(pub Document<'s>, pub NameKind);

impl<'s> Visitor<'s> for EntriesVisitor<'s> {
    type Value = Vec<(String, Value<'s>)>;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("named values")
    }

    fn visit_map<A: MapAccess<'s>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let mut entries = Vec::new();
        while let Some(name) = map.next_key_seed(NameSeed(self.1))? {
            entries.push((name, Value::new(self.0, map.next_value()?)));
        }
        Ok(entries)
    }

    fn visit_unit<E: serde::de::Error>(self) -> Result<Self::Value, E> {
        Ok(Vec::new())
    }
}

/// Names are identifiers in structs and variants, quoted texts in maps.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum NameKind {
    Identifier,
    Quoted,
}

struct NameSeed(NameKind);

impl<'s> DeserializeSeed<'s> for NameSeed {
    type Value = String;

    fn deserialize<D: Deserializer<'s>>(self, deserializer: D) -> Result<String, D::Error> {
        match self.0 {
            NameKind::Identifier => deserializer.deserialize_identifier(NameVisitor),
            NameKind::Quoted => deserializer.deserialize_str(NameVisitor),
        }
    }
}

struct NameVisitor;

impl Visitor<'_> for NameVisitor {
    type Value = String;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a name")
    }

    fn visit_str<E>(self, name: &str) -> Result<String, E> {
        Ok(name.to_owned())
    }
}

pub(super) struct VariantVisitor<'s> {
    pub doc: Document<'s>,
    pub is_bare: bool,
}

impl<'s> Visitor<'s> for VariantVisitor<'s> {
    type Value = (String, Vec<(String, Value<'s>)>);

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a name with fields")
    }

    fn visit_enum<A: EnumAccess<'s>>(self, data: A) -> Result<Self::Value, A::Error> {
        let (name, content) = data.variant_seed(NameSeed(NameKind::Identifier))?;
        if self.is_bare {
            content.unit_variant()?;
            Ok((name, Vec::new()))
        } else {
            let entries =
                content.struct_variant(&[], EntriesVisitor(self.doc, NameKind::Identifier))?;
            Ok((name, entries))
        }
    }
}
