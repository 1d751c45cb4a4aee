//! The elements of a data set by their tags, and their values as texts and numbers.

use std::collections::BTreeMap;

use dicom_core::{Tag, VR};
use dicom_dictionary_std::tags;

/// A value as it lies in the file, or the items of a sequence.
#[derive(Clone, Debug)]
pub(super) enum Value {
    Bytes {
        vr: VR,
        bytes: Vec<u8>,
        big_endian: bool,
    },
    Items(Vec<Dataset>),
}

/// Elements by their tags.
#[derive(Clone, Debug, Default)]
pub(super) struct Dataset {
    pub elements: BTreeMap<Tag, Value>,
}

impl Dataset {
    /// The text of an element, without the blanks around it.
    pub fn text(&self, tag: Tag) -> Option<String> {
        let Value::Bytes { bytes, .. } = self.elements.get(&tag)? else {
            return None;
        };
        let text = match std::str::from_utf8(bytes) {
            Ok(text) => text.to_owned(),
            // Latin letters are the common other way to write them.
            Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect(),
        };
        let text = text.trim_matches(|c: char| c == '\0' || c.is_whitespace());
        let text: String = text.chars().filter(|c| !c.is_control()).take(200).collect();
        Some(text).filter(|text| !text.is_empty())
    }

    /// The element for people: as text, or its first number.
    pub fn text_or_number(&self, tag: Tag) -> Option<String> {
        match self.elements.get(&tag)? {
            Value::Bytes {
                vr: VR::US | VR::SS | VR::UL | VR::SL | VR::FL | VR::FD,
                ..
            } => self.number(tag).map(|value| value.to_string()),
            _ => self.text(tag),
        }
    }

    /// All numbers of an element, written as text or in binary.
    pub fn numbers(&self, tag: Tag) -> Vec<f64> {
        let Some(Value::Bytes {
            vr,
            bytes,
            big_endian,
        }) = self.elements.get(&tag)
        else {
            return Vec::new();
        };
        macro_rules! binary {
            ($type:ty) => {
                bytes
                    .chunks_exact(size_of::<$type>())
                    .map(|chunk| {
                        let mut array = [0; size_of::<$type>()];
                        array.copy_from_slice(chunk);
                        let value = if *big_endian {
                            <$type>::from_be_bytes(array)
                        } else {
                            <$type>::from_le_bytes(array)
                        };
                        value as f64
                    })
                    .collect()
            };
        }
        match vr {
            VR::US | VR::OW => binary!(u16),
            VR::SS => binary!(i16),
            VR::UL => binary!(u32),
            VR::SL => binary!(i32),
            VR::FL => binary!(f32),
            VR::FD => binary!(f64),
            VR::OV | VR::UV => binary!(u64),
            VR::DS | VR::IS => {
                let text = String::from_utf8_lossy(bytes);
                let parts = text.split('\\');
                let numbers = parts.map(|part| part.trim_matches(['\0', ' ']).parse().ok());
                numbers.collect::<Option<_>>().unwrap_or_default()
            }
            _ => Vec::new(),
        }
    }

    /// The first number of an element, if it is finite.
    pub fn number(&self, tag: Tag) -> Option<f64> {
        let first = self.numbers(tag).first().copied();
        first.filter(|value| value.is_finite())
    }

    /// A whole number from 0 on.
    pub fn count(&self, tag: Tag) -> Option<u32> {
        let value = self.number(tag)?;
        let whole = value.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&value);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "it was seen to fit"
        )]
        whole.then_some(value as u32)
    }

    /// So many finite numbers, and no other.
    pub fn array<const N: usize>(&self, tag: Tag) -> Option<[f64; N]> {
        let numbers: [f64; N] = self.numbers(tag).try_into().ok()?;
        numbers
            .iter()
            .all(|value| value.is_finite())
            .then_some(numbers)
    }

    /// The items of a sequence.
    pub fn items(&self, tag: Tag) -> &[Dataset] {
        match self.elements.get(&tag) {
            Some(Value::Items(items)) => items,
            _ => &[],
        }
    }

    /// Lets go of what is said of each frame.
    pub fn forget_frames(&mut self) {
        self.elements
            .remove(&tags::PER_FRAME_FUNCTIONAL_GROUPS_SEQUENCE);
        self.elements.remove(&tags::GRID_FRAME_OFFSET_VECTOR);
    }

    /// The first item of a sequence.
    pub fn item(&self, tag: Tag) -> Option<&Dataset> {
        self.items(tag).first()
    }
}
