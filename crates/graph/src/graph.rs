//! A graph whose names are looked up: nodes by index, edges by writer and port.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use glam::DVec3;
use indexmap::IndexMap;
use volgraph_report::Place;
use volgraph_shader::{Binding, Module, ParamSpec, ParamValue};

use crate::desc::ParamDesc;
use crate::kind::{NodeKind, PortType, ProgramSpec};
use crate::source::Source;

/// A node's index in [`Graph::nodes`].
pub type NodeId = usize;

/// Nodes and the outputs that are wanted of them.
#[derive(Clone, Default)]
pub struct Graph {
    /// Sources first, then the file's nodes in the file's order, then those that shaders called for.
    pub nodes: Vec<Node>,
    /// Output name → writer.
    pub outputs: IndexMap<String, Link>,
}

/// A node.
#[derive(Clone)]
pub struct Node {
    /// Its name, unique in the graph.
    pub name: String,
    /// What it is.
    pub body: NodeBody,
    /// Input port → writer.
    pub inputs: BTreeMap<String, Link>,
    /// Parameters as the file or the command line gave them.
    pub given: IndexMap<String, ParamDesc>,
    /// Values of all parameters.
    pub params: BTreeMap<String, ParamValue>,
    /// Choices of all slots that the kind knows.
    pub slots: BTreeMap<String, SlotChoice>,
    /// Where it comes from.
    pub origin: Origin,
    /// Its shader, once linked.
    pub program: Option<Program>,
}

/// A source or a node kind.
#[derive(Clone)]
pub enum NodeBody {
    /// A loaded source.
    Source(Arc<dyn Source>),
    /// A node kind.
    Kind(Arc<dyn NodeKind>),
}

/// The writing end of an edge.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Link {
    /// The writer.
    pub node: NodeId,
    /// Its output port.
    pub port: String,
    /// Where the edge is written; `None` for one that a shader called for.
    pub place: Option<Place>,
}

/// A slot's choice and where it was made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SlotChoice {
    /// A name, or a path that ends in `.wgsl`.
    pub choice: String,
    /// `None` for a default.
    pub place: Option<Place>,
}

/// Why a node is in the graph.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The file names it here.
    File(Place),
    /// A used binding called for it.
    Demanded {
        /// The node whose shader uses the binding.
        by: NodeId,
        /// The binding.
        binding: String,
    },
}

/// A linked and checked shader, and what the node's entry points use of it.
#[derive(Clone)]
pub struct Program {
    /// What was asked for.
    pub spec: ProgramSpec,
    /// The checked module.
    pub module: Arc<Module>,
    /// Entry point → bindings that it really uses.
    pub bindings: BTreeMap<&'static str, Vec<Binding>>,
}

impl Program {
    /// Whether an entry point uses a binding of this name.
    #[must_use]
    pub fn uses(&self, name: &str) -> bool {
        self.bindings
            .values()
            .flatten()
            .any(|binding| binding.name == name)
    }

    /// The bindings that any of the entry points uses, each once.
    #[must_use]
    pub fn used(&self) -> Vec<&Binding> {
        let mut used: Vec<&Binding> = self.bindings.values().flatten().collect();
        used.sort_by_key(|binding| (binding.group, binding.binding));
        used.dedup_by_key(|binding| (binding.group, binding.binding));
        used
    }
}

impl Node {
    /// The kind's or source's output port types: (name, type), the default port first.
    #[must_use]
    pub fn output_types(&self) -> Vec<(&'static str, PortType)> {
        match &self.body {
            NodeBody::Source(source) => vec![(SOURCE_PORT, source.ty())],
            NodeBody::Kind(kind) => kind
                .outputs()
                .iter()
                .map(|port| (port.name, port.ty))
                .collect(),
        }
    }

    /// The node kind; `None` for a source.
    #[must_use]
    pub fn kind(&self) -> Option<&Arc<dyn NodeKind>> {
        match &self.body {
            NodeBody::Kind(kind) => Some(kind),
            NodeBody::Source(_) => None,
        }
    }

    /// The kind's name, or the source's type.
    #[must_use]
    pub fn kind_name(&self) -> String {
        match &self.body {
            NodeBody::Kind(kind) => kind.name().to_owned(),
            NodeBody::Source(source) => format!("source {}", source.ty()),
        }
    }

    /// Where the file names the node, or the node whose shader called for it.
    #[must_use]
    pub fn place(&self, graph: &Graph) -> Option<Place> {
        match &self.origin {
            Origin::File(place) => Some(place.clone()),
            Origin::Demanded { by, .. } => graph.nodes[*by].place(graph),
        }
    }

    /// All parameters: the kind's and those that its shader declares.
    #[must_use]
    pub fn specs(&self) -> Vec<ParamSpec> {
        let mut specs = self.kind().map(|kind| kind.params()).unwrap_or_default();
        if let Some(program) = &self.program {
            specs.extend(program.module.params().iter().cloned());
        }
        specs
    }

    /// Sets the value of each of `specs`: the given one where it fits, else the default. What does not fit is
    /// reported by [`crate::check`].
    pub fn fill_params(&mut self, specs: &[ParamSpec]) {
        for spec in specs {
            let given = self
                .given
                .get(&spec.name)
                .and_then(|given| spec.check(&given.value).ok());
            self.params.insert(
                spec.name.clone(),
                given.unwrap_or_else(|| spec.default.clone()),
            );
        }
    }
}

/// The name of a source's only port.
pub const SOURCE_PORT: &str = "value";

impl Graph {
    /// The node of that name.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<NodeId> {
        self.nodes.iter().position(|node| node.name == name)
    }

    /// The corners of the boxes that cameras fit, in world space: of the sources that proxy geometry is made of; of all
    /// sources where there is none. What only cuts or colours a volume may lie anywhere.
    #[must_use]
    pub fn corners(&self) -> Vec<DVec3> {
        let is_proxy = |node: &&Node| {
            let types = node.output_types();
            types.iter().any(|(_, ty)| *ty == PortType::Mesh)
        };
        let started: BTreeSet<NodeId> = self
            .nodes
            .iter()
            .filter(is_proxy)
            .flat_map(|node| node.inputs.values().map(|link| link.node))
            .collect();
        let fitted = |among: &dyn Fn(NodeId) -> bool| -> Vec<DVec3> {
            let sources = (0..self.nodes.len()).filter(|id| among(*id));
            sources
                .filter_map(|id| match &self.nodes[id].body {
                    NodeBody::Source(source) => Some(source.corners()),
                    NodeBody::Kind(_) => None,
                })
                .flatten()
                .collect()
        };
        let corners = fitted(&|id| started.contains(&id));
        if corners.is_empty() {
            fitted(&|_| true)
        } else {
            corners
        }
    }

    /// The world position that shaders count from: the middle of [`Self::corners`]. They compute in f32, which far from the
    /// world's own origin has no digits left for voxels.
    #[must_use]
    pub fn origin(&self) -> DVec3 {
        let corners = self.corners();
        let low = corners.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = corners
            .iter()
            .copied()
            .fold(DVec3::NEG_INFINITY, DVec3::max);
        if corners.is_empty() {
            DVec3::ZERO
        } else {
            0.5 * (low + high)
        }
    }

    /// The nodes that the outputs need, themselves included.
    #[must_use]
    pub fn live(&self) -> BTreeSet<NodeId> {
        let mut live = BTreeSet::new();
        let mut open: Vec<NodeId> = self.outputs.values().map(|link| link.node).collect();
        while let Some(id) = open.pop() {
            if live.insert(id) {
                open.extend(self.nodes[id].inputs.values().map(|link| link.node));
            }
        }
        live
    }

    /// The output ports of a node that an output or a live node reads.
    #[must_use]
    pub fn wanted(&self, id: NodeId) -> BTreeSet<&str> {
        self.outputs
            .values()
            .chain(
                self.live()
                    .into_iter()
                    .flat_map(|reader| self.nodes[reader].inputs.values()),
            )
            .filter(|link| link.node == id)
            .map(|link| link.port.as_str())
            .collect()
    }
}
