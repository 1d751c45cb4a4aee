//! The plan: a graph with everything decided, and what it answers for each frame.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use glam::DVec3;
use indexmap::IndexMap;
use serde::Serialize;
use volgraph_report::{Finding, Findings};
use volgraph_shader::{Binding, BindingKind, UniformValue, UniformWriter};

use crate::camera::{Camera, CameraDesc, View};
use crate::check::{BindingSource, binding_source, check};
use crate::cull::cull;
use crate::demand::{ShaderLibrary, demand};
use crate::desc::GraphDesc;
use crate::fingerprint::{Digest, fingerprints};
use crate::graph::{Graph, NodeBody, NodeId};
use crate::kind::{FrameContext, NodeContext, Source, Uniform};
use crate::lifetime::{following_camera, lifetime};
use crate::order::order;
use crate::pass::Pass;
use crate::registry::Registry;
use crate::resolve::resolve;
use crate::resource::ResourceKind;
use crate::size::{Resources, size};

/// What a device can do, as far as a plan depends on it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Limits {
    /// Texels along a 1D texture.
    pub max_texture_1d: u64,
    /// Texels along an axis of a 2D texture.
    pub max_texture_2d: u64,
    /// Texels along an axis of a 3D texture.
    pub max_texture_3d: u64,
    /// Bytes of one buffer.
    pub max_buffer_bytes: u64,
    /// Bytes of one resource; the user's own limit.
    pub max_resource_bytes: u64,
    /// Workgroups along one axis.
    pub max_workgroups: u32,
    /// Whether f32 textures can be sampled linearly.
    pub float32_filterable: bool,
    /// Whether `r16unorm` textures can be made and sampled.
    pub norm16: bool,
    /// Whether compute shaders can write 3D textures. wgpu 30 binds only the first slice of one on GL.
    pub storage_3d: bool,
}

impl Default for Limits {
    /// What WebGPU guarantees everywhere.
    fn default() -> Self {
        Self {
            max_texture_1d: 8192,
            max_texture_2d: 8192,
            max_texture_3d: 2048,
            max_buffer_bytes: 256 << 20,
            max_resource_bytes: 8 << 30,
            max_workgroups: 65535,
            float32_filterable: false,
            norm16: false,
            storage_3d: true,
        }
    }
}

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

/// A node of a plan, for printing.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlannedNode {
    /// Its name.
    pub name: String,
    /// Its kind.
    pub kind: String,
    /// Input port → `node.port`.
    pub inputs: BTreeMap<String, String>,
    /// Parameter → value.
    pub params: BTreeMap<String, volgraph_shader::ParamValue>,
    /// Slot → choice, for the slots that its shader imports.
    pub slots: BTreeMap<String, String>,
    /// Entry point → the bindings that it uses, with what fills each.
    pub entries: BTreeMap<String, Vec<PlannedBinding>>,
    /// What it writes.
    pub outputs: Vec<PlannedResource>,
    /// The binding that called for it; `None` for a node of the file.
    pub called_for_by: Option<String>,
    /// Whether a moving camera makes it run again.
    pub follows_camera: bool,
}

/// A binding of a planned node.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlannedBinding {
    /// Its name.
    pub name: String,
    /// `@group`
    pub group: u32,
    /// `@binding`
    pub binding: u32,
    /// What fills it.
    pub source: BindingSource,
}

/// A resource of a planned node.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlannedResource {
    /// Output port.
    pub port: String,
    /// What it is.
    pub resource: ResourceKind,
    /// Index of its allocation.
    pub allocation: usize,
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
        let demanded = demand(resolved, request.registry, request.shaders, request.limits)?;
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

    /// The corners of all sources' boxes, in world space.
    #[must_use]
    pub fn corners(&self) -> Vec<DVec3> {
        self.graph
            .nodes
            .iter()
            .filter_map(|node| match &node.body {
                NodeBody::Source(source) => Some(source.corners()),
                NodeBody::Kind(_) => None,
            })
            .flatten()
            .collect()
    }

    /// The graph's camera, fitted to its volumes.
    #[must_use]
    pub fn view(&self) -> View {
        View {
            camera: self.fit(&self.camera),
            size: self.size,
        }
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
        fingerprints(&self.graph, &self.order, &self.resources, view)
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
        let mut writer = UniformWriter::new(layout);
        let mut result = Ok(());
        let source = binding_source(node, binding)?;
        let members: Uniform = match &source {
            BindingSource::Lens => lens_members(view),
            BindingSource::Camera => camera_members(&view.camera),
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

    /// The nodes in their order, for printing.
    #[must_use]
    pub fn nodes(&self) -> Vec<PlannedNode> {
        self.order
            .iter()
            .filter(|id| !self.graph.nodes[**id].is_source())
            .map(|id| self.planned(*id))
            .collect()
    }

    fn planned(&self, id: NodeId) -> PlannedNode {
        let node = &self.graph.nodes[id];
        let name_of = |link: &crate::Link| {
            let writer = &self.graph.nodes[link.node];
            if writer.is_source() {
                writer.name.clone()
            } else {
                format!("{}.{}", writer.name, link.port)
            }
        };
        let entries = node
            .program
            .iter()
            .flat_map(|program| &program.bindings)
            .map(|(entry, bindings)| {
                let planned = bindings.iter().filter_map(|binding| {
                    Some(PlannedBinding {
                        name: binding.name.clone(),
                        group: binding.group,
                        binding: binding.binding,
                        source: binding_source(node, binding).ok()?,
                    })
                });
                ((*entry).to_owned(), planned.collect())
            });
        let imported = |slot: &str| {
            node.program
                .as_ref()
                .is_some_and(|program| program.module.linked.slots_used.contains_key(slot))
        };
        PlannedNode {
            name: node.name.clone(),
            kind: node.kind_name(),
            inputs: node
                .inputs
                .iter()
                .map(|(port, link)| (port.clone(), name_of(link)))
                .collect(),
            params: node.params.clone(),
            slots: node
                .slots
                .iter()
                .filter(|(slot, _)| imported(slot))
                .map(|(slot, choice)| (slot.clone(), choice.choice.clone()))
                .collect(),
            entries: entries.collect(),
            outputs: self
                .resources
                .range((id, String::new())..(id + 1, String::new()))
                .map(|((_, port), resource)| PlannedResource {
                    port: port.clone(),
                    resource: *resource,
                    allocation: self.allocation_of[&(id, port.clone())],
                })
                .collect(),
            called_for_by: match &node.origin {
                crate::Origin::Demanded { by, binding } => Some(format!(
                    "{} (binding {binding})",
                    self.graph.nodes[*by].name
                )),
                crate::Origin::File(_) => None,
            },
            follows_camera: self.following_camera.contains(&id),
        }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "shaders compute in f32")]
fn lens_members(view: &View) -> Uniform {
    let lens = view.lens();
    vec![
        ("size", UniformValue::Vec2(lens.size.map(|n| n as f32))),
        (
            "half_extent",
            UniformValue::Vec2(lens.half_extent.map(|n| n as f32)),
        ),
        (
            "is_orthographic",
            UniformValue::U32(u32::from(lens.is_orthographic)),
        ),
    ]
}

fn camera_members(camera: &Camera) -> Uniform {
    let vec3 = |v: DVec3| UniformValue::Vec3(v.as_vec3().to_array());
    vec![
        ("eye", vec3(camera.eye)),
        ("right", vec3(camera.right)),
        ("up", vec3(camera.up)),
        ("forward", vec3(camera.forward)),
    ]
}
