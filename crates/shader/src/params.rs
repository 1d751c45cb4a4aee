//! Parameters: of shaders (`struct Params`) and of node kinds.
//!
//! A member of `struct Params` carries its contract in its doc comments (`///`): on each line free text, then
//! tags; a tag's words end at the next tag or at the end of the line.
//!
//! ```wgsl
//! struct Params {
//!     /// Length of a segment. @default 1.0 @range 0.01 16.0 @unit voxel
//!     step: f32,
//!     /// Whether rays end early. @default on @choices off on
//!     early: u32,
//!     /// Colour behind everything. @default 0.1 0.1 0.2 @color
//!     background_color: vec3f,
//! }
//! ```
//!
//! `@default` is required: one number, as many as the vector has, or a choice (its name or index). `@range`:
//! least and most, both allowed, of each number. `@unit`: one word. `@choices`: names of `u32` or `i32` 0, 1, …
//! `@color`: three or four numbers are a linear colour. `@constant`: a `u32` or `i32` for whose value pipelines are built,
//! as they are for that of a choice (see [`crate::specialise`]), unless it has `@uniform`. Types: `f32`, `i32`, `u32` and their vectors.
//! From here come the RON check, the command line's `--set`, the viewer's controls and the tests' sweeps.

use std::fmt;

use serde::Serialize;
use volgraph_report::{Place, did_you_mean, list_names};

pub(crate) mod doc;

/// The type of a parameter.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize)]
pub enum ParamType {
    /// `true` or `false`; not in WGSL.
    Bool,
    /// A whole number (`i32`).
    Int,
    /// A whole number of at least 0 (`u32`).
    Uint,
    /// A finite number (`f32`).
    Float,
    /// That many finite numbers (`vec2f`, `vec3f`, `vec4f`).
    Vector(usize),
    /// That many whole numbers (`vec2i`, …).
    IntVector(usize),
    /// That many whole numbers of at least 0 (`vec2u`, …).
    UintVector(usize),
    /// One of these names (`u32` or `i32` with `@choices`: the index).
    Choice(Vec<String>),
    /// Any text; not in WGSL.
    Text,
}

/// The value of a parameter. Choices are the choice's name as `Text`; all vectors are `Vector`.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum ParamValue {
    /// `true` or `false`.
    Bool(bool),
    /// A whole number.
    Int(i64),
    /// A number.
    Float(f64),
    /// Numbers.
    Vector(Vec<f64>),
    /// A text, or a choice's name.
    Text(String),
}

/// What a parameter is called, means and may be.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParamSpec {
    /// Its name.
    pub name: String,
    /// Its type.
    pub ty: ParamType,
    /// Its meaning.
    pub doc: String,
    /// Its value where nobody sets it.
    pub default: ParamValue,
    /// Smallest and largest value, both allowed; of each number of a vector.
    pub range: Option<(f64, f64)>,
    /// Its unit, such as `voxel`.
    pub unit: Option<String>,
    /// Whether it is a colour: three or four linear numbers.
    pub is_color: bool,
    /// Whether pipelines are built for its value: of choices without `@uniform`, and with `@constant`.
    pub is_constant: bool,
    /// Where it is declared; `None` in Rust.
    pub place: Option<Place>,
}

impl ParamSpec {
    /// A parameter with neither range nor unit nor place.
    #[must_use]
    pub fn new(
        name: impl Into<String>,
        ty: ParamType,
        default: ParamValue,
        doc: impl Into<String>,
    ) -> Self {
        Self {
            name: name.into(),
            ty,
            doc: doc.into(),
            default,
            range: None,
            unit: None,
            is_color: false,
            is_constant: false,
            place: None,
        }
    }

    /// A number.
    #[must_use]
    pub fn float(name: impl Into<String>, default: f64, doc: impl Into<String>) -> Self {
        Self::new(name, ParamType::Float, ParamValue::Float(default), doc)
    }

    /// A whole number.
    #[must_use]
    pub fn int(name: impl Into<String>, default: i64, doc: impl Into<String>) -> Self {
        Self::new(name, ParamType::Int, ParamValue::Int(default), doc)
    }

    /// A whole number of at least 0.
    #[must_use]
    pub fn uint(name: impl Into<String>, default: u32, doc: impl Into<String>) -> Self {
        Self::new(name, ParamType::Uint, ParamValue::Int(default.into()), doc)
    }

    /// `true` or `false`.
    #[must_use]
    pub fn bool(name: impl Into<String>, default: bool, doc: impl Into<String>) -> Self {
        Self::new(name, ParamType::Bool, ParamValue::Bool(default), doc)
    }

    /// Numbers.
    #[must_use]
    pub fn vector(name: impl Into<String>, default: &[f64], doc: impl Into<String>) -> Self {
        let ty = ParamType::Vector(default.len());
        Self::new(name, ty, ParamValue::Vector(default.to_vec()), doc)
    }

    /// One of `choices`.
    #[must_use]
    pub fn choice(
        name: impl Into<String>,
        choices: &[&str],
        default: &str,
        doc: impl Into<String>,
    ) -> Self {
        let choices = choices.iter().map(|&choice| choice.to_owned()).collect();
        Self::new(
            name,
            ParamType::Choice(choices),
            ParamValue::Text(default.to_owned()),
            doc,
        )
    }

    /// Any text.
    #[must_use]
    pub fn text(name: impl Into<String>, default: &str, doc: impl Into<String>) -> Self {
        Self::new(
            name,
            ParamType::Text,
            ParamValue::Text(default.to_owned()),
            doc,
        )
    }

    /// Sets the range, both ends allowed.
    #[must_use]
    pub fn range(mut self, least: f64, most: f64) -> Self {
        self.range = Some((least, most));
        self
    }

    /// Sets the unit.
    #[must_use]
    pub fn unit(mut self, unit: impl Into<String>) -> Self {
        self.unit = Some(unit.into());
        self
    }

    /// Marks it as a colour.
    #[must_use]
    pub fn color(mut self) -> Self {
        self.is_color = true;
        self
    }

    /// The names it may be; empty where it is no choice.
    #[must_use]
    pub fn choices(&self) -> &[String] {
        match &self.ty {
            ParamType::Choice(choices) => choices,
            _ => &[],
        }
    }

    /// The index of a choice, by its name.
    #[must_use]
    pub fn choice_index(&self, choice: &str) -> Option<usize> {
        self.choices().iter().position(|name| name == choice)
    }

    /// The value in this parameter's own type (a whole number becomes a `Float`, a choice's index its name), where
    /// it is allowed.
    ///
    /// # Errors
    /// Why not, and what is allowed; without the parameter's name.
    pub fn check(&self, value: &ParamValue) -> Result<ParamValue, String> {
        let wrong = || format!("expected {}, found `{value}`", self.ty);
        match (&self.ty, value) {
            (ParamType::Bool, ParamValue::Bool(_)) | (ParamType::Text, ParamValue::Text(_)) => {
                Ok(value.clone())
            }
            // A number is a name where names are asked for: `component: 1`.
            (ParamType::Text, ParamValue::Int(number)) => Ok(ParamValue::Text(number.to_string())),
            (ParamType::Int | ParamType::Uint, ParamValue::Int(number)) => {
                // Every i32 and u32 is exact in f64; what is not is out of bounds anyway.
                self.number(*number as f64)?;
                Ok(value.clone())
            }
            (ParamType::Float, ParamValue::Float(number)) => {
                Ok(ParamValue::Float(self.number(*number)?))
            }
            (ParamType::Float, ParamValue::Int(number)) => {
                Ok(ParamValue::Float(self.number(*number as f64)?))
            }
            (
                ParamType::Vector(size) | ParamType::IntVector(size) | ParamType::UintVector(size),
                ParamValue::Vector(numbers),
            ) if numbers.len() == *size => {
                let numbers = numbers.iter().map(|number| self.number(*number));
                Ok(ParamValue::Vector(numbers.collect::<Result<_, _>>()?))
            }
            (ParamType::Choice(choices), ParamValue::Text(_) | ParamValue::Int(_)) => {
                let text = value.to_string();
                if choices.contains(&text) {
                    return Ok(ParamValue::Text(text));
                }
                let by_index = text
                    .parse()
                    .ok()
                    .and_then(|index: usize| choices.get(index));
                by_index.cloned().map(ParamValue::Text).ok_or_else(|| {
                    let names = || choices.iter().map(String::as_str);
                    let near = did_you_mean(&text, names()).filter(|near| near.starts_with("did"));
                    let near = near.map(|near| format!("; {near}")).unwrap_or_default();
                    format!(
                        "`{text}` is no choice; choices: {}{near}",
                        list_names(names())
                    )
                })
            }
            _ => Err(wrong()),
        }
    }

    /// Reads a value from a command line (`1.5`, `true`, `on`, `0.1,0.2,0.3`) and checks it.
    ///
    /// # Errors
    /// As [`Self::check`].
    pub fn parse_cli(&self, text: &str) -> Result<ParamValue, String> {
        let trimmed = text.trim();
        let wrong = || format!("expected {}, found `{trimmed}`", self.ty);
        let value = match &self.ty {
            ParamType::Text => ParamValue::Text(text.to_owned()),
            ParamType::Choice(_) => ParamValue::Text(trimmed.to_owned()),
            ParamType::Bool => ParamValue::Bool(trimmed.parse().map_err(|_| wrong())?),
            ParamType::Int | ParamType::Uint => {
                ParamValue::Int(trimmed.parse().map_err(|_| wrong())?)
            }
            ParamType::Float => ParamValue::Float(trimmed.parse().map_err(|_| wrong())?),
            ParamType::Vector(_) | ParamType::IntVector(_) | ParamType::UintVector(_) => {
                let inner = trimmed
                    .strip_prefix('(')
                    .and_then(|inner| inner.strip_suffix(')'))
                    .unwrap_or(trimmed);
                let numbers = inner.split(',').map(|number| number.trim().parse::<f64>());
                ParamValue::Vector(numbers.collect::<Result<_, _>>().map_err(|_| wrong())?)
            }
        };
        self.check(&value)
    }

    /// One number, where the type and the range allow it.
    fn number(&self, number: f64) -> Result<f64, String> {
        let (least, most, is_whole) = match self.ty {
            ParamType::Int | ParamType::IntVector(_) => {
                (f64::from(i32::MIN), f64::from(i32::MAX), true)
            }
            ParamType::Uint | ParamType::UintVector(_) => (0.0, f64::from(u32::MAX), true),
            _ => (f64::from(f32::MIN), f64::from(f32::MAX), false),
        };
        let shown = ParamValue::Float(number);
        if !number.is_finite() {
            return Err(format!("`{shown}` is no finite number"));
        }
        if is_whole && number.fract() != 0.0 {
            return Err(format!("`{shown}` is no whole number"));
        }
        let (least, most) = match self.range {
            Some((from, to)) => (from.max(least), to.min(most)),
            None => (least, most),
        };
        if number < least || number > most {
            let unit = self
                .unit
                .as_deref()
                .map(|unit| format!(" {unit}"))
                .unwrap_or_default();
            let side = if number < least { "below" } else { "above" };
            return Err(format!(
                "`{number}` is {side} what is allowed: {least} to {most}{unit}"
            ));
        }
        Ok(number)
    }
}

impl fmt::Display for ParamValue {
    /// As [`ParamSpec::parse_cli`] reads it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bool(value) => write!(f, "{value}"),
            Self::Int(value) => write!(f, "{value}"),
            // Debug keeps the point: 1.0.
            Self::Float(value) => write!(f, "{value:?}"),
            Self::Vector(values) => {
                f.write_str("(")?;
                for (at, value) in values.iter().enumerate() {
                    let comma = if at > 0 { ", " } else { "" };
                    write!(f, "{comma}{value}")?;
                }
                f.write_str(")")
            }
            Self::Text(value) => f.write_str(value),
        }
    }
}

impl fmt::Display for ParamType {
    /// As part of a sentence: `a number`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bool => f.write_str("true or false"),
            Self::Int => f.write_str("a whole number"),
            Self::Uint => f.write_str("a whole number of at least 0"),
            Self::Float => f.write_str("a number"),
            Self::Vector(size) => write!(f, "{size} numbers"),
            Self::IntVector(size) => write!(f, "{size} whole numbers"),
            Self::UintVector(size) => write!(f, "{size} whole numbers of at least 0"),
            Self::Choice(choices) => write!(
                f,
                "one of {}",
                list_names(choices.iter().map(String::as_str))
            ),
            Self::Text => f.write_str("a text"),
        }
    }
}
