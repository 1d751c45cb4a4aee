//! From a pass to its pipeline and bind groups: each binding is filled by what its name stands for.

use std::collections::BTreeMap;
use std::sync::Arc;

use volgraph_graph::check::{BindingSource, SamplerKind, binding_source};
use volgraph_graph::{NodeId, Pass, View};
use volgraph_shader::Binding;
use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindingResource, Buffer, BufferDescriptor,
    BufferUsages,
};

use super::frame::internal;
use super::{Installation, Runner};
use crate::error::GpuError;
use crate::pipelines::Pipeline;

/// A pipeline and its bind groups by group.
pub(super) struct Bound {
    pub pipeline: Arc<Pipeline>,
    pub groups: Vec<(u32, BindGroup)>,
}

impl Runner {
    /// The pipeline of a pass and its bind groups; `bound` are those of the node's passes before.
    pub(super) fn bound(
        &mut self,
        installation: &Installation,
        id: NodeId,
        view: &View,
        variant: Option<&str>,
        pass: &Pass,
        bound: &mut Vec<Arc<Bound>>,
    ) -> Result<Arc<Bound>, GpuError> {
        let plan = installation.plan.as_ref();
        let node = &plan.graph.nodes[id];
        let pipeline = self
            .pipelines
            .get(&self.gpu, plan, id, pass)?
            .ok_or_else(|| internal(plan, id, "pipeline"))?;
        // Bindings go by their names, so a pipeline's are the same in all of a node's passes.
        if let Some(same) = bound
            .iter()
            .find(|bound| Arc::ptr_eq(&bound.pipeline, &pipeline))
        {
            return Ok(Arc::clone(same));
        }
        let mut groups = Vec::new();
        for (group, (layout, bindings)) in &pipeline.groups {
            let mut uniforms: BTreeMap<u32, Buffer> = BTreeMap::new();
            for binding in bindings {
                if matches!(binding.kind, volgraph_shader::BindingKind::Uniform(_)) {
                    let bytes = plan.uniform_bytes(id, binding, view, variant)?;
                    uniforms.insert(binding.binding, self.uniform(&bytes));
                }
            }
            let mut entries = Vec::new();
            for binding in bindings {
                let resource = self.resource(installation, id, binding, &uniforms)?;
                entries.push(BindGroupEntry {
                    binding: binding.binding,
                    resource,
                });
            }
            if let Some(guard) = pipeline.guard.as_ref().filter(|it| it.group == *group) {
                entries.push(BindGroupEntry {
                    binding: guard.binding,
                    resource: guard.counters.as_entire_binding(),
                });
            }
            let what = format!("binding the resources of node `{}`", node.name);
            let bind_group = self.gpu.scoped(&what, installation.bytes(), || {
                self.gpu.device.create_bind_group(&BindGroupDescriptor {
                    label: Some(&node.name),
                    layout,
                    entries: &entries,
                })
            })?;
            groups.push((*group, bind_group));
        }
        let new = Arc::new(Bound { pipeline, groups });
        bound.push(Arc::clone(&new));
        Ok(new)
    }

    fn resource<'a>(
        &'a self,
        installation: &'a Installation,
        id: NodeId,
        binding: &Binding,
        uniforms: &'a BTreeMap<u32, Buffer>,
    ) -> Result<BindingResource<'a>, GpuError> {
        if let Some(buffer) = uniforms.get(&binding.binding) {
            return Ok(buffer.as_entire_binding());
        }
        let plan = installation.plan.as_ref();
        let held = match binding_source(&plan.graph.nodes[id], binding)? {
            BindingSource::Sampler(SamplerKind::Linear) => {
                return Ok(BindingResource::Sampler(&self.samplers.linear));
            }
            BindingSource::Sampler(SamplerKind::Nearest) => {
                return Ok(BindingResource::Sampler(&self.samplers.nearest));
            }
            BindingSource::Sampler(SamplerKind::Repeat) => {
                return Ok(BindingResource::Sampler(&self.samplers.repeat));
            }
            BindingSource::Input(port) => installation.input(id, &port)?,
            BindingSource::Output(port) => installation.output(id, &port)?,
            _ => return Err(internal(plan, id, &binding.name)),
        };
        match (held.view(), held.buffer()) {
            (Some(view), _) => Ok(BindingResource::TextureView(view)),
            (None, Some(buffer)) => Ok(buffer.as_entire_binding()),
            (None, None) => Err(internal(plan, id, &binding.name)),
        }
    }

    fn uniform(&self, bytes: &[u8]) -> Buffer {
        let buffer = self.gpu.device.create_buffer(&BufferDescriptor {
            label: Some("uniform"),
            size: (bytes.len() as u64).next_multiple_of(16),
            usage: BufferUsages::UNIFORM | BufferUsages::STORAGE | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        self.gpu.queue.write_buffer(&buffer, 0, bytes);
        buffer
    }
}
