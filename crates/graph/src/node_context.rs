//! A node as its kind sees it: parameters, slots, inputs, sizes, and the frame.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DVec3;
use volgraph_report::Finding;
use volgraph_shader::{Binding, ParamValue};

use crate::graph::{Graph, NodeBody, NodeId};
use crate::source::Source;
use crate::{Limits, ResourceKind, View};

/// A node as its kind sees it.
#[derive(Clone, Copy)]
pub struct NodeContext<'g> {
    pub(crate) graph: &'g Graph,
    pub(crate) id: NodeId,
    pub(crate) limits: &'g Limits,
    pub(crate) resources: Option<&'g BTreeMap<(NodeId, String), ResourceKind>>,
    pub(crate) frame: Option<FrameContext<'g>>,
}

#[derive(Clone, Copy)]
pub(crate) struct FrameContext<'g> {
    pub view: &'g View,
    pub variant: Option<&'g str>,
}

impl<'g> NodeContext<'g> {
    pub(crate) fn new(graph: &'g Graph, id: NodeId, limits: &'g Limits) -> Self {
        Self {
            graph,
            id,
            limits,
            resources: None,
            frame: None,
        }
    }

    pub(crate) fn in_view(
        graph: &'g Graph,
        id: NodeId,
        limits: &'g Limits,
        view: &'g View,
    ) -> Self {
        Self {
            frame: Some(FrameContext {
                view,
                variant: None,
            }),
            ..Self::new(graph, id, limits)
        }
    }

    fn node(&self) -> &'g crate::Node {
        &self.graph.nodes[self.id]
    }

    /// The node's name.
    #[must_use]
    pub fn name(&self) -> &'g str {
        &self.node().name
    }

    /// The name of its kind, or the source's type.
    #[must_use]
    pub fn kind_name(&self) -> String {
        self.node().kind_name()
    }

    /// What the device can do.
    #[must_use]
    pub fn limits(&self) -> &'g Limits {
        self.limits
    }

    /// A parameter's value.
    #[must_use]
    pub fn param(&self, name: &str) -> Option<&'g ParamValue> {
        self.node().params.get(name)
    }

    /// A parameter's value as the file or the command line gave it, before its shader, which may declare it, is linked;
    /// whether it fits is not known yet.
    #[must_use]
    pub fn given(&self, name: &str) -> Option<&'g ParamValue> {
        self.node().given.get(name).map(|given| &given.value)
    }

    /// A number parameter; 0 where there is none of that name.
    #[must_use]
    pub fn float(&self, name: &str) -> f64 {
        match self.param(name) {
            Some(ParamValue::Float(value)) => *value,
            #[expect(
                clippy::cast_precision_loss,
                reason = "parameters are small whole numbers"
            )]
            Some(ParamValue::Int(value)) => *value as f64,
            _ => 0.0,
        }
    }

    /// A text or choice parameter; empty where there is none of that name.
    #[must_use]
    pub fn text(&self, name: &str) -> &'g str {
        match self.param(name) {
            Some(ParamValue::Text(value)) => value,
            _ => "",
        }
    }

    /// A whole-number parameter; 0 where there is none of that name or it is negative.
    #[must_use]
    pub fn uint(&self, name: &str) -> u32 {
        match self.param(name) {
            Some(ParamValue::Int(value)) => u32::try_from(*value).unwrap_or(0),
            _ => 0,
        }
    }

    /// Whether an input port is connected.
    #[must_use]
    pub fn is_connected(&self, port: &str) -> bool {
        self.node().inputs.contains_key(port)
    }

    /// Whether somebody reads an output port.
    #[must_use]
    pub fn is_wanted(&self, port: &str) -> bool {
        self.graph.wanted(self.id).contains(port)
    }

    /// Whether the graph itself wants an output port, to be read back.
    #[must_use]
    pub fn is_output(&self, port: &str) -> bool {
        self.graph
            .outputs
            .values()
            .any(|link| link.node == self.id && link.port == port)
    }

    /// The choice of a slot.
    #[must_use]
    pub fn slot(&self, name: &str) -> &'g str {
        self.node()
            .slots
            .get(name)
            .map_or("", |choice| choice.choice.as_str())
    }

    /// Whether the graph or the command line chose for a slot.
    #[must_use]
    pub fn is_slot_given(&self, name: &str) -> bool {
        let choice = self.node().slots.get(name);
        choice.is_some_and(|choice| choice.place.is_some())
    }

    /// Whether the node's shader imports a slot.
    #[must_use]
    pub fn imports_slot(&self, name: &str) -> bool {
        let program = self.node().program.as_ref();
        program.is_some_and(|program| program.module.linked.slots_used.contains_key(name))
    }

    /// The source of type `T` that an input port is connected to.
    #[must_use]
    pub fn source<T: 'static>(&self, port: &str) -> Option<&'g T> {
        let link = self.node().inputs.get(port)?;
        match &self.graph.nodes[link.node].body {
            NodeBody::Source(source) => source.as_any().downcast_ref(),
            NodeBody::Kind(_) => None,
        }
    }

    /// The source at an input port, shared, for work that is done later.
    #[must_use]
    pub fn shared_source(&self, port: &str) -> Option<Arc<dyn Source>> {
        let link = self.node().inputs.get(port)?;
        match &self.graph.nodes[link.node].body {
            NodeBody::Source(source) => Some(Arc::clone(source)),
            NodeBody::Kind(_) => None,
        }
    }

    /// The node that writes an input port, as its own kind sees it.
    #[must_use]
    pub fn writer(&self, port: &str) -> Option<NodeContext<'g>> {
        let link = self.node().inputs.get(port)?;
        Some(NodeContext {
            id: link.node,
            ..*self
        })
    }

    /// Whether one of the entry points uses a binding of this name.
    #[must_use]
    pub fn uses_binding(&self, name: &str) -> bool {
        self.node()
            .program
            .as_ref()
            .is_some_and(|program| program.uses(name))
    }

    /// A binding that one of the entry points uses.
    #[must_use]
    pub fn binding(&self, name: &str) -> Option<&'g Binding> {
        self.node()
            .program
            .as_ref()?
            .used()
            .into_iter()
            .find(|binding| binding.name == name)
    }

    /// The sized resource at an output port; known from the size phase on.
    #[must_use]
    pub fn output_resource(&self, port: &str) -> Option<ResourceKind> {
        self.resources?.get(&(self.id, port.to_owned())).copied()
    }

    /// The sized resource at an input port; known from the size phase on.
    #[must_use]
    pub fn input_resource(&self, port: &str) -> Option<ResourceKind> {
        let link = self.node().inputs.get(port)?;
        self.resources?
            .get(&(link.node, link.port.clone()))
            .copied()
    }

    /// The frame's view; `None` outside of recording.
    #[must_use]
    pub fn view(&self) -> Option<&'g View> {
        self.frame.map(|frame| frame.view)
    }

    /// The variant to record (see [`crate::NodeKind::variants`]).
    #[must_use]
    pub fn variant(&self) -> Option<&'g str> {
        self.frame.and_then(|frame| frame.variant)
    }

    /// The world position that shaders count from (see [`Graph::origin`]).
    #[must_use]
    pub fn origin(&self) -> DVec3 {
        self.graph.origin()
    }

    /// An error at this node's place.
    #[must_use]
    pub fn error(&self, code: &'static str, message: impl Into<String>) -> Finding {
        let finding = Finding::error(code, format!("node `{}`: {}", self.name(), message.into()));
        match self.node().place(self.graph) {
            Some(place) => finding.at(place),
            None => finding,
        }
    }
}
