//! Parameters of a node as one label sees them: its own where the label's segment gives none.

use volgraph_graph::{NodeContext, ParamRow};
use volgraph_shader::ParamValue;

/// A node and the parameters that one label has of its own.
#[derive(Clone, Copy)]
pub(super) struct Values<'g> {
    pub(super) node: NodeContext<'g>,
    pub(super) row: Option<&'g ParamRow>,
}

impl<'g> Values<'g> {
    /// The node's own.
    pub(super) fn own(node: &NodeContext<'g>) -> Self {
        Self {
            node: *node,
            row: None,
        }
    }

    fn value(&self, name: &str) -> Option<&'g ParamValue> {
        match self.row.and_then(|row| row.get(name)) {
            Some(given) => Some(&given.value),
            None => self.node.param(name),
        }
    }

    /// A number; 0 where there is none of that name.
    pub(super) fn float(&self, name: &str) -> f64 {
        match self.value(name) {
            Some(ParamValue::Float(value)) => *value,
            #[expect(
                clippy::cast_precision_loss,
                reason = "parameters are small whole numbers"
            )]
            Some(ParamValue::Int(value)) => *value as f64,
            _ => 0.0,
        }
    }

    /// A whole number; 0 where there is none of that name or it is negative.
    pub(super) fn uint(&self, name: &str) -> usize {
        match self.value(name) {
            Some(ParamValue::Int(value)) => usize::try_from(*value).unwrap_or(0),
            _ => 0,
        }
    }

    /// A text or choice; empty where there is none of that name.
    pub(super) fn text(&self, name: &str) -> &'g str {
        match self.value(name) {
            Some(ParamValue::Text(value)) => value,
            _ => "",
        }
    }

    /// So many numbers; zeros where there are none of that name.
    pub(super) fn vector<const N: usize>(&self, name: &str) -> [f64; N] {
        let mut vector = [0.0; N];
        if let Some(ParamValue::Vector(values)) = self.value(name) {
            for (to, from) in vector.iter_mut().zip(values) {
                *to = *from;
            }
        }
        vector
    }
}
