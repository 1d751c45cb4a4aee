//! What a raycast's slots and parameters offer, and which of it makes the same picture in another way.
//!
//! Choices come from the folders of shaders and from the parameters' own documentation, so that a new choice is compared
//! as soon as its file is there. Which settings only approximate, and which make another picture, nothing can tell but a
//! list: [`METHOD_SLOTS`], [`METHOD_CHOICES`] and [`METHOD_NUMBERS`]. A filter may add any other setting of the node.

use std::path::Path;

use naga::valid::Capabilities;
use volgraph_graph::{Node, Plan, Registry, ResourceKind};
use volgraph_report::{Finding, Place, did_you_mean, list_names};
use volgraph_shader::{ParamSpec, ParamType, ParamValue, ShaderRoots, check_file};

use super::filter::{Filter, Wanted};
use super::space::Axis;
use crate::renderer::is_software;

/// Slots whose choices approximate one picture.
const METHOD_SLOTS: [&str; 5] = [
    "classify",
    "traverse",
    "reconstruct",
    "gradient",
    "gradient_storage",
];

/// Parameters with choices that approximate one picture.
const METHOD_CHOICES: [&str; 6] = [
    "volume_storage",
    "stage",
    "format",
    "steps_per_pass",
    "slab_classify",
    "lookup",
];

/// Those of the software raycaster; a raycast has slots of these names.
pub(super) const SOFTWARE_CHOICES: [&str; 3] = ["classify", "attenuation", "traverse"];

/// Numbers that do, and the multiples of the default that are compared.
pub(super) const METHOD_NUMBERS: [(&str, &[f64]); 4] = [
    ("step", &[0.25, 0.5, 1.0, 2.0, 4.0]),
    ("early_termination", &[0.0, 1.0, 16.0]),
    ("scale", &[0.5, 1.0, 2.0, 4.0]),
    ("slices_per_voxel", &[1.0, 2.0, 4.0]),
];

/// A choice that only picks one of the others.
const AUTO: &str = "auto";

/// The parameters of choices that the plan does not use, which a filter may name.
pub(super) fn specs_of_choices(
    roots: &ShaderRoots,
    registry: &Registry,
    known: &[ParamSpec],
) -> Vec<ParamSpec> {
    let defaults = registry.default_slots();
    let mut found: Vec<ParamSpec> = Vec::new();
    for slot in METHOD_SLOTS {
        for choice in roots.choices(slot) {
            let path = Path::new("slot").join(slot).join(format!("{choice}.wgsl"));
            // A shader with findings is refused where it is used.
            let Ok(module) = check_file(roots, &path, &defaults, Capabilities::default()) else {
                continue;
            };
            for spec in module.params() {
                let is_named = |other: &ParamSpec| other.name == spec.name;
                if !known.iter().any(is_named) && !found.iter().any(is_named) {
                    found.push(spec.clone());
                }
            }
        }
    }
    found
}

/// What a node offers.
pub(super) struct Offered<'p> {
    pub plan: &'p Plan,
    pub node: &'p Node,
    pub roots: &'p ShaderRoots,
    pub specs: Vec<ParamSpec>,
}

impl Offered<'_> {
    pub fn axes(&self) -> Vec<Axis> {
        let slots = METHOD_SLOTS.iter().filter(|slot| self.uses(slot));
        let slots = slots.map(|slot| (*slot, true, self.choices(slot)));
        let names: &[&str] = if is_software(&self.node.kind_name()) {
            &SOFTWARE_CHOICES
        } else {
            &METHOD_CHOICES
        };
        let choices = names.iter().filter_map(|name| {
            let values = choices(self.spec(name)?);
            Some((*name, false, values))
        });
        let numbers = METHOD_NUMBERS.iter().filter_map(|(name, multiples)| {
            let values = numbers(self.spec(name)?, multiples, self.own(name, false));
            Some((*name, false, values))
        });
        let axes = slots.chain(choices).chain(numbers);
        axes.filter(|(_, _, values)| !values.is_empty())
            .map(|(name, is_slot, values)| Axis {
                name: name.to_owned(),
                is_slot,
                values,
                base: 0,
                is_software: false,
                of_choice: self.choice_of(name),
            })
            .collect()
    }

    fn uses(&self, slot: &str) -> bool {
        // A kind may fill a slot itself.
        let mut slots = self.node.kind().into_iter().flat_map(|kind| kind.slots());
        let program = self.node.program.as_ref();
        slots.any(|it| it.name == slot)
            && program.is_some_and(|program| program.module.linked.slots_used.contains_key(slot))
    }

    pub fn is_slot(&self, name: &str) -> bool {
        self.node.slots.contains_key(name)
    }

    fn spec(&self, name: &str) -> Option<&ParamSpec> {
        self.specs.iter().find(|spec| spec.name == name)
    }

    /// The slot among those that are compared, and the choice for it, whose file declares a parameter.
    pub fn choice_of(&self, name: &str) -> Option<(String, String)> {
        let place = self.spec(name)?.place.as_ref()?;
        let file = Path::new(&place.file);
        let slot = file.parent()?.file_name()?.to_str()?;
        if !METHOD_SLOTS.contains(&slot) || !self.is_slot(slot) {
            return None;
        }
        // A choice of the user's own may be named by its path.
        let program = self.node.program.as_ref();
        let used = program.and_then(|program| program.module.linked.slots_used.get(slot));
        let choice = match self.node.slots.get(slot) {
            Some(own) if used == Some(&place.file) => own.choice.clone(),
            _ => file.file_stem()?.to_str()?.to_owned(),
        };
        Some((slot.to_owned(), choice))
    }

    /// The graph's own choice or value.
    pub fn own(&self, name: &str, is_slot: bool) -> Option<ParamValue> {
        if is_slot {
            let own = self.node.slots.get(name)?;
            return Some(ParamValue::Text(own.choice.clone()));
        }
        match self.node.params.get(name)? {
            ParamValue::Text(text) if text == AUTO => self.format(name).map(ParamValue::Text),
            value => Some(value.clone()),
        }
    }

    /// The storage that the plan chose where the graph leaves it open: the format of the texture that the parameter
    /// `<what>_storage` is about.
    fn format(&self, name: &str) -> Option<String> {
        let texture = format!("{}_texture", name.strip_suffix("_storage")?);
        let writer = self.node.inputs.get(&texture)?;
        let written = (writer.node, writer.port.clone());
        match self.plan.resources.get(&written)? {
            ResourceKind::Texture { format, .. } => Some(format!("{format:?}").to_lowercase()),
            ResourceKind::Buffer { .. } => None,
        }
    }

    /// The choices of a slot, with the graph's own, which may be a file of the user's.
    fn choices(&self, slot: &str) -> Vec<ParamValue> {
        let choices = self.roots.choices(slot).into_iter().map(ParamValue::Text);
        let mut values: Vec<ParamValue> = choices.collect();
        add(&mut values, self.own(slot, true));
        values
    }

    /// What a filter wants.
    pub fn values(&self, filter: &Filter) -> Result<Vec<ParamValue>, Finding> {
        let place = || Place::whole_file(format!("--methods {}", filter.name));
        let spec = self.spec(&filter.name);
        if spec.is_none() && !self.is_slot(&filter.name) {
            let slots = self.node.slots.keys().map(String::as_str);
            let known = slots.chain(self.specs.iter().map(|spec| spec.name.as_str()));
            let message = format!(
                "the raycast `{}` has no slot or parameter `{}`",
                self.node.name, filter.name
            );
            return Err(Finding::error("unknown-setting", message)
                .at(place())
                .help_opt(did_you_mean(&filter.name, known)));
        }
        let mut values = Vec::new();
        for wanted in &filter.wanted {
            let found = match (wanted, spec) {
                (Wanted::All, None) => self.choices(&filter.name),
                (Wanted::All, Some(spec)) => choices(spec),
                (Wanted::Doubles(..), None) => Vec::new(),
                (Wanted::Doubles(..), Some(spec)) => {
                    let numbers = wanted.doubles().into_iter();
                    numbers
                        .map(|number| self.checked(spec, &number_of(spec, number)))
                        .collect::<Result<_, _>>()?
                }
                (Wanted::Value(text), None) => vec![self.choice(&filter.name, text)?],
                (Wanted::Value(text), Some(spec)) => vec![self.checked(spec, text)?],
            };
            if found.is_empty() {
                let message = format!("`{}` has no such list of values", filter.name);
                return Err(Finding::error("bad-methods", message)
                    .at(place())
                    .help("list its values, separated by commas"));
            }
            for value in found {
                add(&mut values, Some(value));
            }
        }
        Ok(values)
    }

    fn choice(&self, slot: &str, text: &str) -> Result<ParamValue, Finding> {
        let choices = self.roots.choices(slot);
        if text.ends_with(".wgsl") || choices.iter().any(|choice| choice == text) {
            return Ok(ParamValue::Text(text.to_owned()));
        }
        let known = list_names(choices.iter().map(String::as_str));
        let message = format!("the slot `{slot}` has no choice `{text}`");
        Err(Finding::error("unknown-choice", message)
            .at(Place::whole_file(format!("--methods {slot}")))
            .help(format!("choose of: {known}")))
    }

    /// A value from a text, as `--set` would take it.
    fn checked(&self, spec: &ParamSpec, text: &str) -> Result<ParamValue, Finding> {
        spec.parse_cli(text).map_err(|why| {
            Finding::error("bad-methods", format!("`{}` {why}", spec.name))
                .at(Place::whole_file(format!("--methods {}={text}", spec.name)))
        })
    }
}

/// A number as it is written for a parameter of this type.
pub(super) fn number_of(spec: &ParamSpec, number: f64) -> String {
    match spec.ty {
        ParamType::Int | ParamType::Uint => format!("{number:.0}"),
        _ => format!("{number:?}"),
    }
}

/// Multiples of a number's default inside its range, with the graph's own value, rising.
pub(super) fn numbers(
    spec: &ParamSpec,
    multiples: &[f64],
    own: Option<ParamValue>,
) -> Vec<ParamValue> {
    let of_default = |multiple: f64| match spec.default {
        ParamValue::Float(default) => Some(ParamValue::Float(default * multiple)),
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_precision_loss,
            reason = "parameters are small"
        )]
        ParamValue::Int(default) => Some(ParamValue::Int((default as f64 * multiple) as i64)),
        _ => None,
    };
    let mut values = Vec::new();
    for value in multiples.iter().filter_map(|by| of_default(*by)) {
        add(&mut values, spec.check(&value).ok());
    }
    if values.is_empty() {
        return values;
    }
    add(&mut values, own);
    values.sort_by(|a, b| match (a, b) {
        (ParamValue::Float(a), ParamValue::Float(b)) => a.total_cmp(b),
        (ParamValue::Int(a), ParamValue::Int(b)) => a.cmp(b),
        _ => std::cmp::Ordering::Equal,
    });
    values
}

/// The choices of a parameter that are methods of their own.
pub(super) fn choices(spec: &ParamSpec) -> Vec<ParamValue> {
    let choices = spec.choices().iter().filter(|choice| *choice != AUTO);
    choices.cloned().map(ParamValue::Text).collect()
}

/// Adds a value that is not there yet.
pub(super) fn add(values: &mut Vec<ParamValue>, value: Option<ParamValue>) {
    if let Some(value) = value.filter(|value| !values.contains(value)) {
        values.push(value);
    }
}
