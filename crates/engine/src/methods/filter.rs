//! The words that narrow a space of methods: `classify=post,preintegrated_2d step=0.25..4`.

/// Which values of a setting are wanted.
#[derive(Clone, Debug, PartialEq)]
pub struct Filter {
    /// The slot's or the parameter's name.
    pub name: String,
    /// What is wanted; any of them.
    pub wanted: Vec<Wanted>,
}

/// One thing that is wanted of a setting.
#[derive(Clone, Debug, PartialEq)]
pub enum Wanted {
    /// A choice or a value, as it was typed.
    Value(String),
    /// The first number, its doubles, and the last number: `0.25..4`.
    Doubles(f64, f64),
    /// All choices: `*`.
    All,
}

/// Most values of a range.
const MAX_DOUBLES: usize = 64;

/// Reads filters, separated by blanks.
///
/// # Errors
/// What is wrong with them, and how they are written.
pub fn parse_filters(text: &str) -> Result<Vec<Filter>, String> {
    let mut filters: Vec<Filter> = Vec::new();
    for word in text.split_whitespace() {
        let filter = Filter::parse(word)?;
        if filters.iter().any(|before| before.name == filter.name) {
            return Err(format!("`{}` is there twice", filter.name));
        }
        filters.push(filter);
    }
    Ok(filters)
}

impl Filter {
    /// Reads `name=value,value`, `name=low..high` or `name=*`.
    ///
    /// # Errors
    /// As [`parse_filters`].
    pub fn parse(word: &str) -> Result<Self, String> {
        let (name, values) = word
            .split_once('=')
            .filter(|(name, values)| !name.is_empty() && !values.is_empty())
            .ok_or_else(|| {
                format!("write `{word}` as NAME=VALUE,VALUE, NAME=LOW..HIGH or NAME=*")
            })?;
        let wanted = values.split(',').map(Wanted::parse);
        Ok(Self {
            name: name.to_owned(),
            wanted: wanted.collect::<Result<_, _>>()?,
        })
    }
}

impl Wanted {
    fn parse(text: &str) -> Result<Self, String> {
        if text == "*" {
            return Ok(Self::All);
        }
        let Some((low, high)) = text.split_once("..") else {
            if text.is_empty() {
                return Err("there is a comma too many".to_owned());
            }
            return Ok(Self::Value(text.to_owned()));
        };
        match (low.parse::<f64>(), high.parse::<f64>()) {
            (Ok(low), Ok(high)) if low > 0.0 && high >= low && high.is_finite() => {
                Ok(Self::Doubles(low, high))
            }
            _ => Err(format!(
                "the range `{text}` doubles from its first number, above 0, to its last"
            )),
        }
    }

    /// The numbers of a range; none of anything else.
    pub(super) fn doubles(&self) -> Vec<f64> {
        let Self::Doubles(low, high) = self else {
            return Vec::new();
        };
        let numbers = std::iter::successors(Some(*low), |number| Some(number * 2.0));
        let mut numbers: Vec<f64> = numbers
            .take(MAX_DOUBLES)
            .take_while(|number| number < high)
            .collect();
        numbers.push(*high);
        numbers
    }
}
