//! Attributes by name, as numbers and texts.

use hdf5_reader::Attribute;

use super::element::Number;
use crate::choice::cut;

/// Most numbers of an attribute: placements have few.
const MOST_NUMBERS: u64 = 64;

pub(super) struct Attributes(Vec<Attribute>);

impl Attributes {
    pub fn of(list: Vec<Attribute>) -> Self {
        Self(list)
    }

    pub fn get(&self, name: &str) -> Option<&Attribute> {
        self.0.iter().find(|attribute| attribute.name == name)
    }

    /// The numbers of an attribute; `None` where it is not there, or has others than numbers.
    pub fn numbers(&self, name: &str) -> Option<Vec<f64>> {
        let attribute = self.get(name)?;
        if attribute.num_elements().ok()? > MOST_NUMBERS {
            return None;
        }
        let numbers: Vec<Number> = attribute.read_1d().ok()?;
        Some(numbers.into_iter().map(|Number(value)| value).collect())
    }

    /// The only number of an attribute.
    pub fn number(&self, name: &str) -> Option<f64> {
        let [one] = *self.numbers(name)?.as_slice() else {
            return None;
        };
        Some(one)
    }

    /// The text of an attribute, without what cannot be written on a line.
    pub fn text(&self, name: &str) -> Option<String> {
        let text = self.get(name)?.read_string().ok()?;
        let text = cut(text.trim_end_matches(['\0', ' ']));
        Some(text).filter(|text| !text.is_empty())
    }

    /// The text of an attribute, however long.
    pub fn long_text(&self, name: &str) -> Option<String> {
        self.get(name)?.read_string().ok()
    }

    /// Texts of an attribute; one for an element.
    pub fn texts(&self, name: &str) -> Option<Vec<String>> {
        let texts = self.get(name)?.read_strings().ok()?;
        Some(
            texts
                .iter()
                .map(|text| cut(text.trim_end_matches('\0')))
                .collect(),
        )
    }
}
