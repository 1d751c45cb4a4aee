//! What a raycast offers: an axis for each setting that approximates the same picture, with all of its values.

use volgraph_graph::{NodeId, Plan, Registry};
use volgraph_report::{Finding, Findings};
use volgraph_shader::{ParamValue, ShaderRoots};

use super::filter::Filter;
use super::measurement::{Method, Setting};
use super::offered::{Offered, specs_of_choices};

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
    if !volgraph_nodes::draws_volumes(&node.kind_name()) {
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
