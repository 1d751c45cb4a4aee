//! A method, and what was measured of it.

use std::fmt;

use serde::Serialize;
use volgraph_measure::timing::Summary;
use volgraph_shader::ParamValue;

use super::accuracy::Errors;
use crate::overrides::ParamOverride;
use crate::renderer::{RENDERER, SOFTWARE};

/// One choice of a slot, or one value of a parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Setting {
    /// The slot's or the parameter's name.
    pub name: String,
    /// Whether it is a slot's choice.
    pub is_slot: bool,
    /// The choice as a text, or the value.
    pub value: ParamValue,
}

/// Settings of a raycast that approximate one picture.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Method {
    /// In the order of the space's axes.
    pub settings: Vec<Setting>,
}

impl Method {
    /// What sets a node so.
    #[must_use]
    pub fn overrides(&self, node: &str) -> Vec<ParamOverride> {
        let settings = self.settings.iter();
        settings
            .map(|setting| {
                let slots = if setting.is_slot { "slots." } else { "" };
                ParamOverride {
                    target: node.to_owned(),
                    is_slot: setting.is_slot,
                    name: setting.name.clone(),
                    value: setting.value.clone(),
                    typed: format!("{node}.{slots}{}={}", setting.name, setting.value),
                }
            })
            .collect()
    }

    /// Whether the software raycaster draws it in place of a raycast.
    #[must_use]
    pub fn is_software(&self) -> bool {
        self.text(RENDERER) == SOFTWARE
    }

    /// The value of a setting, as a text; empty where there is none of that name.
    #[must_use]
    pub fn text(&self, name: &str) -> String {
        let setting = self.settings.iter().find(|setting| setting.name == name);
        setting.map_or_else(String::new, |setting| setting.value.to_string())
    }
}

impl fmt::Display for Method {
    /// `classify=post step=0.5`, as filters are written; `software classify=post step=2` of the software raycaster.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (at, setting) in self.settings.iter().enumerate() {
            let space = if at > 0 { " " } else { "" };
            if setting.name == RENDERER {
                write!(f, "{space}{}", setting.value)?;
                continue;
            }
            write!(f, "{space}{}={}", setting.name, setting.value)?;
        }
        Ok(())
    }
}

/// How wrong a method is, and how long it takes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Measurement {
    /// The method.
    pub method: Method,
    /// Its errors in the graph's own view.
    pub errors: Errors,
    /// Milliseconds of a frame: drawn by the device, read back.
    pub time_ms: Summary,
    /// How many times longer than the base method's frame of the same round.
    pub ratio: Summary,
    /// The median ratio times the base's median of all rounds, in milliseconds: the time with slow drifts of the machine
    /// taken out, by which methods are compared.
    pub steady_ms: f64,
    /// Whether it was near enough to the front to be timed for longer.
    pub is_refined: bool,
    /// Whether no other method is faster and more accurate.
    pub is_front: bool,
}

impl Measurement {
    /// Time and error, as fronts are made of.
    #[must_use]
    pub fn point(&self) -> (f64, f64) {
        (self.steady_ms, self.errors.rmse)
    }
}
