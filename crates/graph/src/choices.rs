//! Which parameters of a node's shader are constants of its pipelines.
//!
//! Parameters with `@choices` or `@constant` are: their values are known where a pipeline is built, and a change builds another one.
//! Where labels have parameters of their own, a choice on which they do not agree stays in the table.

use volgraph_shader::{Choices, ParamSpec, ParamValue};

use crate::check::PARAMS_TABLE;
use crate::graph::NodeId;
use crate::node_context::NodeContext;
use crate::plan::Plan;

impl Plan {
    /// Parameter → the index of its choice or its value, for those of a node's shader that are the same in all of the node's passes.
    #[must_use]
    pub fn choices(&self, id: NodeId) -> Choices {
        let node = &self.graph.nodes[id];
        let (Some(program), Some(kind)) = (&node.program, node.kind()) else {
            return Choices::new();
        };
        let specs = program.module.params().iter();
        let mut specs = specs.filter(|spec| spec.is_constant).peekable();
        if specs.peek().is_none() {
            return Choices::new();
        }
        let rows = if program.uses(PARAMS_TABLE) {
            kind.param_rows(&NodeContext::new(&self.graph, id, &self.limits))
        } else {
            Vec::new()
        };
        let mut choices = Choices::new();
        for spec in specs {
            let Some(choice) = node.params.get(&spec.name).and_then(|it| index(spec, it)) else {
                continue;
            };
            let mut given = rows.iter().filter_map(|row| row.get(&spec.name));
            if given.all(|given| index(spec, &given.value) == Some(choice)) {
                choices.insert(spec.name.clone(), choice);
            }
        }
        choices
    }
}

/// A whole number, or the index of a choice, which may be given by its name or by its index.
fn index(spec: &ParamSpec, value: &ParamValue) -> Option<i64> {
    match spec.check(value).ok()? {
        ParamValue::Text(name) => spec.choice_index(&name)?.try_into().ok(),
        ParamValue::Int(number) => Some(number),
        _ => None,
    }
}
