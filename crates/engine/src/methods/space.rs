//! What a raycast offers: an axis for each setting that approximates the same picture, with all of its values.
//!
//! Where the software raycaster draws the same picture, the first axis is the renderer, and axes of the software
//! raycaster's own stand behind the others. A place in the space holds a value of every axis; those of axes that do not
//! apply there ([`MethodSpace::applies`]) are the base's, so that each method has one place.

use std::collections::BTreeSet;

use volgraph_graph::{NodeId, Plan, Registry};
use volgraph_report::{Finding, Findings};
use volgraph_shader::{ParamValue, ShaderRoots};

use super::filter::Filter;
use super::measurement::{Method, Setting};
use super::offered::{Offered, specs_of_choices};
use super::software;
use crate::renderer::{RENDERER, SOFTWARE, is_software};

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
    /// Whether it is one of the software raycaster in place of the node.
    pub is_software: bool,
    /// The slot and the choice for it whose file declares it: others know nothing of it.
    pub of_choice: Option<(String, String)>,
}

impl Axis {
    fn text(&self, at: usize) -> String {
        self.values
            .get(at)
            .map_or_else(String::new, ToString::to_string)
    }
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
    let kind = node.kind_name();
    if !volgraph_nodes::draws_volumes(&kind) && !is_software(&kind) {
        let message = format!(
            "methods are those of a raycast, and the output `color` is of `{}`, a `{}`",
            node.name, kind
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
        // A renderer without slots has no choices that could bring parameters.
        if !node.slots.is_empty() {
            specs.extend(specs_of_choices(roots, registry, &specs));
        }
        let offered = Offered {
            plan,
            node,
            roots,
            specs,
        };
        let mut findings = Findings::new();
        let mut axes = offered.axes();
        let of_node = |filter: &&Filter| filter.name != RENDERER;
        for filter in filters.iter().filter(of_node) {
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
                    is_software: false,
                    of_choice: offered.choice_of(&filter.name),
                }),
            }
        }
        let (renderer, software) = software::axes(plan, id, filters);
        if let Some(renderer) = renderer {
            axes.insert(0, renderer);
        } else if let Some(filter) = filters.iter().find(|filter| filter.name == RENDERER) {
            findings.push(software::unoffered(plan, id, filter));
        }
        for axis in axes.iter_mut().filter(|axis| axis.name != RENDERER) {
            let own = offered.own(&axis.name, axis.is_slot);
            let at = own.and_then(|own| axis.values.iter().position(|value| *value == own));
            axis.base = at.unwrap_or(0);
        }
        axes.extend(software);
        // Only integrals have an attenuation.
        let has_integrals = |is_software: bool| {
            let mut axes = axes.iter();
            let classify =
                axes.find(|axis| axis.name == "classify" && axis.is_software == is_software);
            classify.is_none_or(|axis| (0..axis.values.len()).any(|at| axis.text(at) != "post"))
        };
        let has_integrals = [false, true].map(has_integrals);
        axes.retain(|axis| {
            axis.name != "attenuation" || has_integrals[usize::from(axis.is_software)]
        });
        let offers = |(slot, choice): &(String, String)| {
            let of_slot = |axis: &&Axis| axis.name == *slot && !axis.is_software;
            let slot = axes.iter().find(of_slot);
            slot.is_some_and(|axis| (0..axis.values.len()).any(|at| axis.text(at) == *choice))
        };
        let is_offered = |axis: &Axis| axis.of_choice.as_ref().is_none_or(offers);
        let offered: Vec<bool> = axes.iter().map(is_offered).collect();
        let mut offered = offered.into_iter();
        axes.retain(|_| offered.next().unwrap_or(true));
        findings.into_result(Self {
            node: node.name.clone(),
            axes,
        })
    }

    /// How many methods there are.
    #[must_use]
    pub fn len(&self) -> usize {
        // Few enough to be counted one by one are those of axes on which others depend.
        let base = self.base();
        let is_deciding = |axis: &Axis| [RENDERER, "classify"].contains(&axis.name.as_str());
        let deciding = self.product(&base, is_deciding);
        let counts = deciding.iter().map(|at| {
            let free = self.axes.iter().enumerate();
            let free = free.filter(|(i, axis)| !is_deciding(axis) && self.applies(*i, at));
            free.fold(1, |count: usize, (_, axis)| {
                count.saturating_mul(axis.values.len())
            })
        });
        counts.fold(0, usize::saturating_add)
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

    /// The value of an axis at a place, as a text.
    fn value(&self, at: &[usize], name: &str, is_software: bool) -> Option<String> {
        let mut axes = self.axes.iter().zip(at);
        let (axis, at) =
            axes.find(|(axis, _)| axis.name == name && axis.is_software == is_software)?;
        Some(axis.text(*at))
    }

    /// Whether an axis says something of the method at a place: those of the software raycaster only where it draws, and
    /// the attenuation only where there are integrals.
    #[must_use]
    pub fn applies(&self, axis: usize, at: &[usize]) -> bool {
        let Some(axis) = self.axes.get(axis) else {
            return false;
        };
        if axis.name == RENDERER {
            return true;
        }
        let draws = self.value(at, RENDERER, false).as_deref() == Some(SOFTWARE);
        let is_post = || self.value(at, "classify", axis.is_software).as_deref() == Some("post");
        let is_chosen = |(slot, choice): &(String, String)| {
            self.value(at, slot, axis.is_software).as_ref() == Some(choice)
        };
        draws == axis.is_software
            && !(axis.name == "attenuation" && is_post())
            && axis.of_choice.as_ref().is_none_or(is_chosen)
    }

    /// A place with the base's value on the axes that do not apply there.
    fn settled(&self, mut at: Vec<usize>) -> Vec<usize> {
        // Twice: the attenuation depends on a classification that depends on the renderer.
        for _ in 0..2 {
            for i in 0..at.len() {
                if !self.applies(i, &at) {
                    at[i] = self.axes[i].base;
                }
            }
        }
        at
    }

    /// The method with these values of each axis.
    #[must_use]
    pub fn method(&self, at: &[usize]) -> Method {
        let settings = self.axes.iter().zip(at).enumerate();
        // The node's own kind needs no words.
        let settings = settings.filter(|(i, (axis, value))| {
            self.applies(*i, at) && (axis.name != RENDERER || axis.text(**value) == SOFTWARE)
        });
        let settings = settings.map(|(_, (axis, at))| Setting {
            name: axis.name.clone(),
            is_slot: axis.is_slot,
            value: axis.values[*at].clone(),
        });
        Method {
            settings: settings.collect(),
        }
    }

    /// All combinations of values on these axes, with those of `at` on all others; each once.
    #[must_use]
    pub fn product(&self, at: &[usize], is_varied: impl Fn(&Axis) -> bool) -> Vec<Vec<usize>> {
        let mut all = vec![at.to_vec()];
        for (i, axis) in self.axes.iter().enumerate() {
            if is_varied(axis) {
                let varied = all.iter().flat_map(|at| {
                    let values = if self.applies(i, at) {
                        axis.values.len()
                    } else {
                        0
                    };
                    let with = move |value| {
                        let mut at = at.clone();
                        at[i] = value;
                        at
                    };
                    let unvaried = (values == 0).then(|| at.clone());
                    (0..values).map(with).chain(unvaried)
                });
                all = varied.collect();
            }
        }
        let mut known = BTreeSet::new();
        let all = all.into_iter().map(|at| self.settled(at));
        all.filter(|at| known.insert(at.clone())).collect()
    }

    /// Those that differ from `at` on one axis.
    #[must_use]
    pub fn neighbours(&self, at: &[usize]) -> Vec<Vec<usize>> {
        let axes = self.axes.iter().enumerate();
        axes.filter(|(i, _)| self.applies(*i, at))
            .flat_map(|(i, axis)| {
                let others = (0..axis.values.len()).filter(move |value| *value != at[i]);
                others.map(move |value| {
                    let mut at = at.to_vec();
                    at[i] = value;
                    self.settled(at)
                })
            })
            .collect()
    }
}
