//! The node kinds and source kinds a graph may name.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::{NodeKind, SourceKind};

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

    /// All node kinds, by name.
    pub fn nodes(&self) -> impl Iterator<Item = &Arc<dyn NodeKind>> {
        self.nodes.values()
    }

    /// All source kinds, by name.
    pub fn sources(&self) -> impl Iterator<Item = &Arc<dyn SourceKind>> {
        self.sources.values()
    }

    /// The default choice of every slot of every kind, for checking shader files alone.
    #[must_use]
    pub fn default_slots(&self) -> BTreeMap<String, String> {
        self.nodes()
            .flat_map(|kind| kind.slots().iter().map(|slot| (slot.name.to_owned(), slot.default.to_owned())))
            .collect()
    }
}
