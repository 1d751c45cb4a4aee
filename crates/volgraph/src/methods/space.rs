//! What a raycast offers: an axis for each setting that approximates the same picture, with all of its values.
//!
//! Choices come from the folders of shaders and from the parameters' own documentation, so that a new choice is compared
//! as soon as its file is there. Which settings only approximate, and which make another picture, nothing can tell but a
//! list: [`METHOD_SLOTS`], [`METHOD_CHOICES`] and [`METHOD_NUMBERS`]. A filter may add any other setting of the node.

use std::path::Path;

use naga::valid::Capabilities;
use volgraph_graph::{Node, NodeId, NodeKind, Plan, Registry, ResourceKind};
use volgraph_nodes::raycast::Raycast;
use volgraph_report::{Finding, Findings, Place, did_you_mean, list_names};
use volgraph_shader::{ParamSpec, ParamType, ParamValue, ShaderRoots, check_file};

use super::filter::{Filter, Wanted};
use super::measurement::{Method, Setting};

/// Slots whose choices approximate one picture.
const METHOD_SLOTS: [&str; 5] = [
    "classify",
    "traverse",
    "reconstruct",
    "gradient",
    "gradient_storage",
];

/// Parameters with choices that approximate one picture.
const METHOD_CHOICES: [&str; 2] = ["volume_storage", "stage"];

/// Numbers that do, and the multiples of the default that are compared.
const METHOD_NUMBERS: [(&str, &[f64]); 2] = [
    ("step", &[0.25, 0.5, 1.0, 2.0, 4.0]),
    ("early_termination", &[0.0, 1.0, 16.0]),
];

/// A choice that only picks one of the others.
const AUTO: &str = "auto";

/// A setting and its values.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// The slot's or the parameter's name.
    pub name: String,
    /// Whether it is a slot.
    pub is_slot: bool,
    /// Its values, each once, at least one.
    pub values: Vec<ParamValue>,
    /// Which of them is the graph's own; the first where that is none of them.
    pub base: usize,
}

/// All methods of a node: the product of its axes.
#[derive(Clone, Debug, PartialEq)]
pub struct MethodSpace {
    /// The raycast's name.
    pub node: String,
    /// The axes: slots, choices, numbers.
    pub axes: Vec<Axis>,
}

/// The raycast that draws the output `color`.
///
/// # Errors
/// `no-raycast`, `no-color-output`.
pub fn raycast_node(plan: &Plan) -> Result<NodeId, Finding> {
    let output = plan.graph.outputs.get("color").ok_or_else(|| {
        Finding::error(
            "no-color-output",
            "the graph names no output `color`, which is the picture",
        )
    })?;
    let node = &plan.graph.nodes[output.node];
    if node.kind_name() != Raycast.name() {
        let message = format!(
            "methods are those of a raycast, and the output `color` is of `{}`, a `{}`",
            node.name,
            node.kind_name()
        );
        return Err(Finding::error("no-raycast", message)
            .help("name the port `color` of a raycast as the output `color`"));
    }
    Ok(output.node)
}

impl MethodSpace {
    /// The methods of the raycast that draws a plan's picture.
    ///
    /// # Errors
    /// Filters that name nothing, and values that do not fit; as [`raycast_node`].
    pub fn of(
        plan: &Plan,
        roots: &ShaderRoots,
        registry: &Registry,
        filters: &[Filter],
    ) -> Result<Self, Findings> {
        let id = raycast_node(plan)?;
        let node = &plan.graph.nodes[id];
        let mut specs = node.specs();
        specs.extend(specs_of_choices(roots, registry, &specs));
        let offered = Offered {
            plan,
            node,
            roots,
            specs,
        };
        let mut findings = Findings::new();
        let mut axes = offered.axes();
        for filter in filters {
            let Some(values) = findings.take(offered.values(filter)) else {
                continue;
            };
            match axes.iter_mut().find(|axis| axis.name == filter.name) {
                Some(axis) => axis.values = values,
                None => axes.push(Axis {
                    name: filter.name.clone(),
                    is_slot: offered.is_slot(&filter.name),
                    values,
                    base: 0,
                }),
            }
        }
        for axis in &mut axes {
            let own = offered.own(&axis.name, axis.is_slot);
            let at = own.and_then(|own| axis.values.iter().position(|value| *value == own));
            axis.base = at.unwrap_or(0);
        }
        findings.into_result(Self {
            node: node.name.clone(),
            axes,
        })
    }

    /// How many methods there are.
    #[must_use]
    pub fn len(&self) -> usize {
        let counts = self.axes.iter().map(|axis| axis.values.len());
        counts.fold(1, usize::saturating_mul)
    }

    /// Whether there are none: never of a space that was made by [`Self::of`].
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The graph's own method: on each axis its value, or the first.
    #[must_use]
    pub fn base(&self) -> Vec<usize> {
        self.axes.iter().map(|axis| axis.base).collect()
    }

    /// The method with these values of each axis.
    #[must_use]
    pub fn method(&self, at: &[usize]) -> Method {
        let settings = self.axes.iter().zip(at).map(|(axis, at)| Setting {
            name: axis.name.clone(),
            is_slot: axis.is_slot,
            value: axis.values[*at].clone(),
        });
        Method {
            settings: settings.collect(),
        }
    }

    /// All combinations of values on these axes, with those of `at` on all others.
    #[must_use]
    pub fn product(&self, at: &[usize], is_varied: impl Fn(&Axis) -> bool) -> Vec<Vec<usize>> {
        let mut all = vec![at.to_vec()];
        for (i, axis) in self.axes.iter().enumerate() {
            if is_varied(axis) {
                let varied = all.iter().flat_map(|at| {
                    (0..axis.values.len()).map(|value| {
                        let mut at = at.clone();
                        at[i] = value;
                        at
                    })
                });
                all = varied.collect();
            }
        }
        all
    }

    /// Those that differ from `at` on one axis.
    #[must_use]
    pub fn neighbours(&self, at: &[usize]) -> Vec<Vec<usize>> {
        let axes = self.axes.iter().enumerate();
        axes.flat_map(|(i, axis)| {
            let others = (0..axis.values.len()).filter(move |value| *value != at[i]);
            others.map(move |value| {
                let mut at = at.to_vec();
                at[i] = value;
                at
            })
        })
        .collect()
    }
}

/// The parameters of choices that the plan does not use, which a filter may name.
fn specs_of_choices(
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
struct Offered<'p> {
    plan: &'p Plan,
    node: &'p Node,
    roots: &'p ShaderRoots,
    specs: Vec<ParamSpec>,
}

impl Offered<'_> {
    fn axes(&self) -> Vec<Axis> {
        let slots = METHOD_SLOTS.iter().filter(|slot| self.uses(slot));
        let slots = slots.map(|slot| (*slot, true, self.choices(slot)));
        let choices = METHOD_CHOICES.iter().filter_map(|name| {
            let values = choices(self.spec(name)?);
            Some((*name, false, values))
        });
        let numbers = METHOD_NUMBERS.iter().filter_map(|(name, multiples)| {
            let values = self.numbers(self.spec(name)?, multiples);
            Some((*name, false, values))
        });
        let axes = slots.chain(choices).chain(numbers);
        axes.filter(|(_, _, values)| !values.is_empty())
            .map(|(name, is_slot, values)| Axis {
                name: name.to_owned(),
                is_slot,
                values,
                base: 0,
            })
            .collect()
    }

    fn uses(&self, slot: &str) -> bool {
        let program = self.node.program.as_ref();
        program.is_some_and(|program| program.module.linked.slots_used.contains_key(slot))
    }

    fn is_slot(&self, name: &str) -> bool {
        self.node.slots.contains_key(name)
    }

    fn spec(&self, name: &str) -> Option<&ParamSpec> {
        self.specs.iter().find(|spec| spec.name == name)
    }

    /// The graph's own choice or value.
    fn own(&self, name: &str, is_slot: bool) -> Option<ParamValue> {
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

    /// Multiples of a number's default inside its range, with the graph's own value, rising.
    fn numbers(&self, spec: &ParamSpec, multiples: &[f64]) -> Vec<ParamValue> {
        let ParamValue::Float(default) = spec.default else {
            return Vec::new();
        };
        let mut values = Vec::new();
        for multiple in multiples {
            add(
                &mut values,
                spec.check(&ParamValue::Float(default * multiple)).ok(),
            );
        }
        add(&mut values, self.own(&spec.name, false));
        values.sort_by(|a, b| match (a, b) {
            (ParamValue::Float(a), ParamValue::Float(b)) => a.total_cmp(b),
            _ => std::cmp::Ordering::Equal,
        });
        values
    }

    /// What a filter wants.
    fn values(&self, filter: &Filter) -> Result<Vec<ParamValue>, Finding> {
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
fn number_of(spec: &ParamSpec, number: f64) -> String {
    match spec.ty {
        ParamType::Int | ParamType::Uint => format!("{number:.0}"),
        _ => format!("{number:?}"),
    }
}

/// The choices of a parameter that are methods of their own.
fn choices(spec: &ParamSpec) -> Vec<ParamValue> {
    let choices = spec.choices().iter().filter(|choice| *choice != AUTO);
    choices.cloned().map(ParamValue::Text).collect()
}

/// Adds a value that is not there yet.
fn add(values: &mut Vec<ParamValue>, value: Option<ParamValue>) {
    if let Some(value) = value.filter(|value| !values.contains(value)) {
        values.push(value);
    }
}
