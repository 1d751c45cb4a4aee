//! The node kinds and source kinds a graph may name.

use std::collections::BTreeMap;
use std::sync::Arc;

use indexmap::IndexMap;
use volgraph_report::Place;

use crate::graph::{Graph, Node, NodeBody, Origin};
use crate::kind::ProgramSpec;
use crate::node_context::NodeContext;
use crate::resolve::default_slots;
use crate::{Limits, NodeKind, SourceKind};

/// All kinds by name. A program adds its own beside volgraph's.
#[derive(Clone, Default)]
pub struct Registry {
    nodes: BTreeMap<&'static str, Arc<dyn NodeKind>>,
    sources: BTreeMap<&'static str, Arc<dyn SourceKind>>,
}

impl Registry {
    /// No kinds.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a node kind; one of the same name is replaced.
    pub fn add_node(&mut self, kind: impl NodeKind + 'static) -> &mut Self {
        self.nodes.insert(kind.name(), Arc::new(kind));
        self
    }

    /// Adds a source kind; one of the same name is replaced.
    pub fn add_source(&mut self, kind: impl SourceKind + 'static) -> &mut Self {
        self.sources.insert(kind.name(), Arc::new(kind));
        self
    }

    /// The node kind of that name.
    #[must_use]
    pub fn node(&self, name: &str) -> Option<&Arc<dyn NodeKind>> {
        self.nodes.get(name)
    }

    /// The source kind of that name.
    #[must_use]
    pub fn source(&self, name: &str) -> Option<&Arc<dyn SourceKind>> {
        self.sources.get(name)
    }

    /// Lets all kinds go of what they keep between pictures: the next one takes longer, and that is all.
    pub fn forget(&self) {
        for kind in self.nodes.values() {
            kind.forget();
        }
    }

    /// All node kinds, by name.
    pub fn nodes(&self) -> impl Iterator<Item = &Arc<dyn NodeKind>> {
        self.nodes.values()
    }

    /// All source kinds, by name.
    pub fn sources(&self) -> impl Iterator<Item = &Arc<dyn SourceKind>> {
        self.sources.values()
    }

    /// The program of a kind's node that nothing is connected to, all parameters at their defaults.
    #[must_use]
    pub fn default_program(&self, kind: &str) -> Option<ProgramSpec> {
        let kind = self.node(kind)?;
        let mut node = Node {
            name: kind.name().to_owned(),
            body: NodeBody::Kind(Arc::clone(kind)),
            inputs: BTreeMap::new(),
            given: IndexMap::new(),
            params: BTreeMap::new(),
            slots: default_slots(kind.as_ref()),
            origin: Origin::File(Place::whole_file("")),
            program: None,
        };
        node.fill_params(&kind.params());
        let graph = Graph {
            nodes: vec![node],
            outputs: IndexMap::new(),
        };
        kind.program(&NodeContext::new(&graph, 0, &Limits::default()))
    }

    /// The default choice of every slot of every kind, those included that the kinds choose themselves: for
    /// checking shader files alone.
    #[must_use]
    pub fn default_slots(&self) -> BTreeMap<String, String> {
        let mut slots = BTreeMap::new();
        for kind in self.nodes() {
            slots.extend(
                kind.slots()
                    .iter()
                    .map(|slot| (slot.name.to_owned(), slot.default.to_owned())),
            );
            slots.extend(
                self.default_program(kind.name())
                    .map(|program| program.fixed_slots)
                    .unwrap_or_default(),
            );
        }
        slots
    }
}
