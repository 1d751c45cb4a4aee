//! The plan: a graph with everything decided, and what it answers for each frame.

pub(crate) mod late;
mod members;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use glam::DVec3;
use indexmap::IndexMap;
use serde::Serialize;
use volgraph_report::{Finding, Findings};
use volgraph_shader::{Binding, BindingKind, MemberType, StructLayout, UniformWriter};

use self::late::link_late;
use self::members::{camera_members, lens_members};
use crate::camera::{Camera, CameraDesc, View};
use crate::check::{BindingSource, PARAMS_TABLE, binding_source, check};
use crate::cull::cull;
use crate::demand::{ShaderLibrary, demand};
use crate::desc::GraphDesc;
use crate::fingerprint::{Digest, fingerprints};
use crate::graph::{Graph, NodeId};
use crate::kind::Uniform;
use crate::lifetime::{following_camera, lifetime};
use crate::limits::Limits;
use crate::node_context::{FrameContext, NodeContext};
use crate::order::order;
use crate::pass::Pass;
use crate::registry::Registry;
use crate::resolve::resolve;
use crate::resource::ResourceKind;
use crate::size::{Resources, size};
use crate::source::Source;
use crate::tiles::State;

/// All that a plan is made of.
#[derive(Clone, Copy)]
pub struct PlanRequest<'a> {
    /// The graph.
    pub desc: &'a GraphDesc,
    /// Its loaded sources.
    pub sources: &'a IndexMap<String, Arc<dyn Source>>,
    /// The kinds it may use.
    pub registry: &'a Registry,
    /// The shaders.
    pub shaders: &'a ShaderLibrary,
    /// The device.
    pub limits: &'a Limits,
    /// The picture's width and height in pixels.
    pub size: [u32; 2],
    /// Outputs wanted beside the file's: output name → (output of the file, port of the same node). One whose
    /// node has no such port is left out.
    pub extra_outputs: &'a [(&'a str, &'a str, &'a str)],
}

/// Memory that resources share.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Allocation {
    /// What is allocated.
    pub resource: ResourceKind,
    /// Whether it may be given away once its last reader has run.
    pub is_transient: bool,
    /// The `node.port`s that live in it, in their order.
    pub users: Vec<String>,
}

/// A graph with everything decided: plain data that prints, compares and tests without a GPU.
#[derive(Clone)]
pub struct Plan {
    /// The nodes that run, and the sources.
    pub graph: Graph,
    /// The order in which they run.
    pub order: Vec<NodeId>,
    /// What each writes.
    pub resources: Resources,
    /// Memory.
    pub allocations: Vec<Allocation>,
    /// (node, port) → index of its allocation.
    pub allocation_of: BTreeMap<(NodeId, String), usize>,
    /// The nodes that a moving camera makes run again.
    pub following_camera: BTreeSet<NodeId>,
    /// The names of the nodes that no output needs.
    pub culled: Vec<String>,
    /// The picture's width and height.
    pub size: [u32; 2],
    /// The camera as the graph describes it.
    pub camera: CameraDesc,
    /// What it was made for.
    pub limits: Limits,
}

impl Plan {
    /// Runs all phases.
    ///
    /// # Errors
    /// All findings of the first phase that has any.
    pub fn build(request: PlanRequest<'_>) -> Result<Self, Findings> {
        let mut resolved = resolve(request.desc, request.sources, request.registry)?;
        for (name, of, port) in request.extra_outputs {
            let Some(link) = resolved.outputs.get(*of).cloned() else {
                continue;
            };
            let has_port = resolved.nodes[link.node]
                .output_types()
                .iter()
                .any(|(name, _)| name == port);
            if has_port && !resolved.outputs.contains_key(*name) {
                let link = crate::Link {
                    port: (*port).to_owned(),
                    ..link
                };
                resolved.outputs.insert((*name).to_owned(), link);
            }
        }
        let mut demanded = demand(resolved, request.registry, request.shaders, request.limits)?;
        link_late(&mut demanded, request.desc)?;
        check(&demanded)?;
        let (graph, culled) = cull(&demanded);
        let order = order(&graph);
        let resources = size(&graph, &order, request.size, request.limits)?;
        let following_camera = following_camera(&graph, &order);
        let (allocation_of, allocations) = lifetime(&graph, &order, &resources, &following_camera);
        let plan = Self {
            graph,
            order,
            resources,
            allocations,
            allocation_of,
            following_camera,
            culled,
            size: request.size,
            camera: request.desc.camera.clone().unwrap_or_default(),
            limits: *request.limits,
        };
        plan.check_uniforms()?;
        Ok(plan)
    }

    /// Fills every used uniform once, so that a member that nobody fills is found now and not in a frame.
    fn check_uniforms(&self) -> Result<(), Findings> {
        let view = self.view();
        let mut findings = Findings::new();
        for &id in &self.order {
            for binding in self.graph.nodes[id]
                .program
                .iter()
                .flat_map(|program| program.used())
            {
                if matches!(binding.kind, BindingKind::Uniform(_)) {
                    findings.take(self.uniform_bytes(id, binding, &view, None));
                }
            }
        }
        findings.into_result(())
    }

    /// The corners of the boxes that cameras fit, in world space (see [`Graph::corners`]).
    #[must_use]
    pub fn corners(&self) -> Vec<DVec3> {
        self.graph.corners()
    }

    /// The graph's camera, fitted to its volumes.
    #[must_use]
    pub fn view(&self) -> View {
        View {
            camera: self.fit(&self.camera),
            size: self.size,
            window: None,
        }
    }

    /// Whether windows of a picture can be drawn ([`View::window`]), each as that part of the whole.
    ///
    /// # Errors
    /// `no-window` for each node that works on the whole picture.
    pub fn check_windows(&self) -> Result<(), Findings> {
        let mut findings = Findings::new();
        for &id in &self.order {
            let context = NodeContext::new(&self.graph, id, &self.limits);
            let kind = self.graph.nodes[id].kind();
            if kind.is_some_and(|kind| !kind.draws_windows(&context)) {
                findings.push(
                    context
                        .error("no-window", "it works on the whole picture, and cannot draw it in parts")
                        .help("choose a size that is drawn as a whole, or draw this with another node or slot"),
                );
            }
        }
        findings.into_result(())
    }

    /// A camera fitted to the graph's volumes.
    #[must_use]
    pub fn fit(&self, camera: &CameraDesc) -> Camera {
        camera.fit(
            &self.corners(),
            f64::from(self.size[0]) / f64::from(self.size[1].max(1)),
        )
    }

    /// The fingerprints of all nodes in a view.
    #[must_use]
    pub fn fingerprints(&self, view: &View) -> BTreeMap<NodeId, Digest> {
        fingerprints(
            &self.graph,
            &self.order,
            &self.resources,
            &self.limits,
            view,
        )
    }

    /// How a node is whose result is made from frame to frame; `None` for all others.
    #[must_use]
    pub fn state(&self, id: NodeId, view: &View) -> Option<State> {
        let kind = self.graph.nodes[id].kind()?;
        // What is wrong, recording says.
        kind.state(&self.context(id, view, None)).ok().flatten()
    }

    /// A node as its kind sees it, in a frame.
    #[must_use]
    pub fn context<'a>(
        &'a self,
        id: NodeId,
        view: &'a View,
        variant: Option<&'a str>,
    ) -> NodeContext<'a> {
        NodeContext {
            resources: Some(&self.resources),
            frame: Some(FrameContext { view, variant }),
            ..NodeContext::new(&self.graph, id, &self.limits)
        }
    }

    /// The variants among which the fastest is to be found; empty for nodes with one way.
    #[must_use]
    pub fn variants(&self, id: NodeId) -> Vec<&'static str> {
        let context = NodeContext::new(&self.graph, id, &self.limits);
        self.graph.nodes[id]
            .kind()
            .map(|kind| kind.variants(&context))
            .unwrap_or_default()
    }

    /// The passes of one node in a frame.
    ///
    /// # Errors
    /// What the kind refuses.
    pub fn record(
        &self,
        id: NodeId,
        view: &View,
        variant: Option<&str>,
    ) -> Result<Vec<Pass>, Finding> {
        match self.graph.nodes[id].kind() {
            Some(kind) => kind.record(&self.context(id, view, variant)),
            None => Ok(Vec::new()),
        }
    }

    /// The table of parameters, the node's own in its first row. Rows that nobody selects are zeros.
    fn param_rows(
        &self,
        id: NodeId,
        binding: &Binding,
        table: &StructLayout,
    ) -> Result<Vec<u8>, Finding> {
        let node = &self.graph.nodes[id];
        let layout = node
            .program
            .as_ref()
            .and_then(|program| program.module.struct_layout("Params"));
        let array = table.members.first().map(|member| &member.ty);
        let (
            Some(kind),
            Some(layout),
            Some(MemberType::Array {
                count: Some(count),
                stride,
                ..
            }),
        ) = (node.kind(), layout, array)
        else {
            let message = format!("node `{}` has no parameters to select", node.name);
            return Err(Finding::error("internal", message));
        };
        let context = NodeContext::new(&self.graph, id, &self.limits);
        let rows = kind.param_rows(&context);
        if rows.len() >= *count as usize {
            let message = format!(
                "{} labels have parameters of their own, of {} at most",
                rows.len(),
                count - 1
            );
            return Err(context
                .error("over-limit", message)
                .help("give labels the same parameters where they need no others"));
        }
        let mut bytes = Vec::new();
        for row in std::iter::once(None).chain(rows.into_iter().map(Some)) {
            let mut writer = UniformWriter::new(&layout);
            let mut result = Ok(());
            for spec in node.specs() {
                let given = row.and_then(|row| row.get(&spec.name));
                let value = given.map(|given| &given.value);
                let value = value.or_else(|| node.params.get(&spec.name));
                if let (true, Some(value)) = (writer.has(&spec.name), value) {
                    result = result.and(writer.set_param(&spec, value).map(|_| ()));
                }
            }
            let row = result.and_then(|()| writer.finish()).map_err(|error| {
                Finding::error("uniform", format!("a row of the parameters: {error}"))
                    .at(binding.place.clone())
            })?;
            let end = bytes.len() + *stride as usize;
            bytes.extend(row);
            bytes.resize(end, 0);
        }
        bytes.resize(table.size as usize, 0);
        Ok(bytes)
    }

    /// The bytes of a uniform binding of one node in a frame.
    ///
    /// # Errors
    /// Where the shader's struct asks for a member that nobody fills, or of another type.
    pub fn uniform_bytes(
        &self,
        id: NodeId,
        binding: &Binding,
        view: &View,
        variant: Option<&str>,
    ) -> Result<Vec<u8>, Finding> {
        let node = &self.graph.nodes[id];
        let BindingKind::Uniform(layout) = &binding.kind else {
            return Err(Finding::error(
                "internal",
                format!("`{}` is no uniform", binding.name),
            ));
        };
        if binding.name == PARAMS_TABLE {
            return self.param_rows(id, binding, layout);
        }
        let mut writer = UniformWriter::new(layout);
        let mut result = Ok(());
        let source = binding_source(node, binding)?;
        let members: Uniform = match &source {
            BindingSource::Lens => lens_members(view),
            BindingSource::Camera => {
                let origin = self.graph.origin();
                let distances = self
                    .graph
                    .corners()
                    .into_iter()
                    .map(|it| it.distance(origin));
                camera_members(&view.camera, origin, distances.fold(0.0, f64::max))
            }
            BindingSource::Uniform(name) => match node.kind() {
                Some(kind) => kind.uniform(name, &self.context(id, view, variant))?,
                None => Vec::new(),
            },
            _ => Vec::new(),
        };
        for (name, value) in members {
            if writer.has(name) {
                result = result.and(writer.set(name, value).map(|_| ()));
            }
        }
        if source == BindingSource::Params {
            for spec in node.specs() {
                if let (true, Some(value)) = (writer.has(&spec.name), node.params.get(&spec.name)) {
                    result = result.and(writer.set_param(&spec, value).map(|_| ()));
                }
            }
        }
        result.and_then(|()| writer.finish()).map_err(|error| {
            Finding::error("uniform", format!("uniform `{}`: {error}", binding.name))
                .at(binding.place.clone())
        })
    }
}
