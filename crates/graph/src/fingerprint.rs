//! The memory of work: a digest of everything that a node's result depends on.
//!
//! Two frames in which a node has the same fingerprint give the same result, so the second need not run it. A
//! fingerprint takes in the kind, the parameters, the linked shader and its entry points, the inputs'
//! fingerprints (of a source that the kind reads in part, that part), the sizes of the outputs, and of the view only what the node really reads: the lens where
//! its shader uses `lens`, the pose where it uses `camera`.

use std::collections::BTreeMap;

use crate::camera::View;
use crate::graph::{Graph, NodeBody, NodeId};
use crate::kind::PortType;
use crate::limits::Limits;
use crate::node_context::NodeContext;
use crate::size::Resources;

/// A blake3 digest.
pub type Digest = [u8; 32];

/// Hashes parts, each preceded by its length, so that no two lists of parts run together.
#[derive(Default)]
pub struct Hasher(blake3::Hasher);

impl Hasher {
    /// Nothing hashed yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a part.
    pub fn part(&mut self, bytes: &[u8]) {
        self.0.update(&(bytes.len() as u64).to_le_bytes());
        self.0.update(bytes);
    }

    /// The digest of all parts.
    #[must_use]
    pub fn finish(&self) -> Digest {
        *self.0.finalize().as_bytes()
    }
}

/// The fingerprints of all nodes for one view.
#[must_use]
pub fn fingerprints(
    graph: &Graph,
    order: &[NodeId],
    resources: &Resources,
    limits: &Limits,
    view: &View,
) -> BTreeMap<NodeId, Digest> {
    let mut fingerprints: BTreeMap<NodeId, Digest> = BTreeMap::new();
    let origin = graph.origin();
    for &id in order {
        let node = &graph.nodes[id];
        let mut hasher = Hasher::new();
        let mut part = |bytes: &[u8]| hasher.part(bytes);
        match &node.body {
            NodeBody::Source(source) => part(&source.digest()),
            NodeBody::Kind(kind) => {
                part(kind.name().as_bytes());
                for (name, value) in &node.params {
                    part(name.as_bytes());
                    part(format!("{value:?}").as_bytes());
                }
                if let Some(program) = &node.program {
                    part(&program.module.linked.digest);
                    for entry in &program.spec.entries {
                        part(entry.as_bytes());
                    }
                }
                // Without a shader to look at, every slot's choice may matter.
                if node.program.is_none() {
                    for (name, slot) in &node.slots {
                        part(name.as_bytes());
                        part(slot.choice.as_bytes());
                    }
                }
                // Triangles are made relative to the origin, as the camera is.
                if kind.outputs().iter().any(|port| port.ty == PortType::Mesh) {
                    part(format!("{origin:?}").as_bytes());
                }
                // A node without a shader may follow the camera as well.
                let reads = |uniform: &str| {
                    node.program
                        .as_ref()
                        .is_some_and(|program| program.uses(uniform))
                };
                if reads("lens") || kind.passes_follow_camera() {
                    part(format!("{:?}", view.lens()).as_bytes());
                }
                if reads("camera") || kind.passes_follow_camera() {
                    part(format!("{:?} {origin:?}", view.camera).as_bytes());
                }
                // What cannot be said here, recording says.
                if let Ok(Some(state)) = kind.state(&NodeContext::in_view(graph, id, limits, view))
                {
                    part(&state.token.to_le_bytes());
                }
                for (port, link) in &node.inputs {
                    part(port.as_bytes());
                    part(link.port.as_bytes());
                    let context = NodeContext::new(graph, id, limits);
                    match kind.depends_on(port, &context) {
                        Some(bytes) => part(&bytes),
                        None => part(&fingerprints[&link.node]),
                    }
                }
                for ((_, port), resource) in
                    resources.range((id, String::new())..(id + 1, String::new()))
                {
                    part(port.as_bytes());
                    part(format!("{resource:?}").as_bytes());
                }
            }
        }
        fingerprints.insert(id, hasher.finish());
    }
    fingerprints
}

/// A digest as lower-case hexadecimal.
#[must_use]
pub fn hex(digest: &[u8]) -> String {
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}
