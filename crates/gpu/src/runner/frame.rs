//! One frame: recording and submitting the passes of the nodes that must run.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

use volgraph_graph::check::{BindingSource, SamplerKind, binding_source};
use volgraph_graph::{NodeId, Pass, Plan, ResourceKind, View};
use volgraph_report::Finding;
use volgraph_shader::Binding;
use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindingResource, Buffer, BufferDescriptor,
    BufferUsages, Color, CommandEncoder, CommandEncoderDescriptor, Extent3d, LoadOp, Operations,
    Origin3d, RenderPassColorAttachment, RenderPassDescriptor, StoreOp, TexelCopyBufferLayout,
    TexelCopyTextureInfo, TextureAspect, TextureDescriptor, TextureDimension, TextureUsages,
    TextureView,
};

use super::schedule::must_run;
use super::{FrameReport, NodeReport, Runner};
use crate::error::GpuError;
use crate::pipelines::{Pipeline, PipelineKind, SCRATCH_FORMAT};
use crate::pool::Held;
use crate::timing::Timer;

/// The side of the view on which variants are measured.
const MEASURE_SIZE: u32 = 128;

/// A pipeline and its bind groups by group.
type Bound = (Arc<Pipeline>, Vec<(u32, BindGroup)>);

/// Commands recorded and not yet submitted.
struct Recording {
    encoder: CommandEncoder,
    timer: Option<Timer>,
}

impl Runner {
    /// Draws one frame and waits for it. Nodes whose result still holds do not run.
    ///
    /// # Errors
    /// What a node kind or the device refused; what the frame did not finish is then not remembered as done.
    pub fn frame(&mut self, view: &View) -> Result<FrameReport, GpuError> {
        let Some(plan) = self.plan.clone() else {
            return Err(GpuError::Output {
                name: "any".to_owned(),
                reason: "no plan is installed".to_owned(),
            });
        };
        let fingerprints = plan.fingerprints(view);
        let contents: Vec<_> = self.held.iter().map(|held| held.content.clone()).collect();
        let running = must_run(&plan, &fingerprints, &contents);
        let mut recording = Recording {
            encoder: self.encoder(),
            timer: Timer::new(&self.gpu, running.len()),
        };
        let mut written = Vec::new();
        let mut variants: BTreeMap<NodeId, &'static str> = BTreeMap::new();
        for &id in plan.order.iter().filter(|id| running.contains(id)) {
            // Until the whole frame has succeeded, nobody may rely on what is overwritten here.
            for ((_, port), allocation) in plan
                .allocation_of
                .range((id, String::new())..(id + 1, String::new()))
            {
                self.held[*allocation].content = None;
                written.push((*allocation, (fingerprints[&id], port.clone())));
            }
            let variant = self.variant(&plan, id, view, &mut recording)?;
            if let Some(variant) = variant {
                variants.insert(id, variant);
            }
            if let Some(timer) = &mut recording.timer {
                timer.mark(&mut recording.encoder);
            }
            self.node(&plan, id, view, variant, &mut recording)?;
            if let Some(timer) = &mut recording.timer {
                timer.mark(&mut recording.encoder);
            }
        }
        let Recording { mut encoder, timer } = recording;
        if let Some(timer) = &timer {
            timer.resolve(&mut encoder);
        }
        self.gpu.queue.submit([encoder.finish()]);
        self.gpu.wait()?;
        let times = match &timer {
            Some(timer) => timer.milliseconds(&self.gpu)?,
            None => Vec::new(),
        };
        for (allocation, content) in written {
            self.held[allocation].content = Some(content);
        }
        let mut times = times.into_iter();
        let nodes = plan
            .order
            .iter()
            .filter(|id| !plan.graph.nodes[**id].is_source())
            .map(|id| {
                let node = &plan.graph.nodes[*id];
                let ran = running.contains(id);
                let measured = self
                    .chosen_variant(&plan, *id)
                    .map(|(_, measured)| measured);
                NodeReport {
                    name: node.name.clone(),
                    kind: node.kind_name(),
                    ran,
                    variant: variants.get(id).map(|variant| (*variant).to_owned()),
                    measured_ms: measured
                        .filter(|_| variants.contains_key(id))
                        .map(|times| {
                            times
                                .iter()
                                .map(|(name, ms)| ((*name).to_owned(), *ms))
                                .collect()
                        })
                        .unwrap_or_default(),
                    gpu_ms: if ran { times.next() } else { None },
                }
            });
        Ok(FrameReport {
            nodes: nodes.collect(),
            memory: self.memory(),
            pipelines: self.pipelines.len(),
        })
    }

    fn encoder(&self) -> CommandEncoder {
        self.gpu
            .device
            .create_command_encoder(&CommandEncoderDescriptor {
                label: Some("frame"),
            })
    }

    fn flush(&self, recording: &mut Recording) {
        let encoder = std::mem::replace(&mut recording.encoder, self.encoder());
        self.gpu.queue.submit([encoder.finish()]);
    }

    /// The variant to run: the only one, the one chosen before, or the fastest of all on a small view, measured now
    /// with the inputs that the frame has made so far.
    fn variant(
        &mut self,
        plan: &Plan,
        id: NodeId,
        view: &View,
        recording: &mut Recording,
    ) -> Result<Option<&'static str>, GpuError> {
        let variants = plan.variants(id);
        let Some(&first) = variants.first() else {
            return Ok(None);
        };
        if variants.len() == 1 {
            return Ok(Some(first));
        }
        if let Some((chosen, _)) = self
            .chosen_variant(plan, id)
            .filter(|(chosen, _)| variants.contains(chosen))
        {
            return Ok(Some(*chosen));
        }
        self.flush(recording);
        self.gpu.wait()?;
        let small = View {
            size: view.size.map(|n| n.min(MEASURE_SIZE)),
            ..*view
        };
        let mut times = BTreeMap::new();
        for variant in variants {
            // The first run compiles; the second is measured.
            for _ in 0..2 {
                let mut recording = Recording {
                    encoder: self.encoder(),
                    timer: None,
                };
                let start = Instant::now();
                self.node(plan, id, &small, Some(variant), &mut recording)?;
                self.gpu.queue.submit([recording.encoder.finish()]);
                self.gpu.wait()?;
                times.insert(variant, start.elapsed().as_secs_f64() * 1e3);
            }
        }
        let fastest = times
            .iter()
            .min_by(|a, b| a.1.total_cmp(b.1))
            .map_or(first, |(variant, _)| *variant);
        if let Some(program) = &plan.graph.nodes[id].program {
            self.chosen
                .insert(program.module.linked.digest, (fastest, times));
        }
        Ok(Some(fastest))
    }

    fn node(
        &mut self,
        plan: &Plan,
        id: NodeId,
        view: &View,
        variant: Option<&'static str>,
        recording: &mut Recording,
    ) -> Result<(), GpuError> {
        let name = &plan.graph.nodes[id].name;
        for pass in plan.record(id, view, variant)? {
            match &pass {
                Pass::Upload { port, bytes } => {
                    // Writes through the queue come before what is recorded but not submitted.
                    self.flush(recording);
                    self.upload(self.output(plan, id, port)?, &bytes.make()?, name)?;
                }
                Pass::Compute { workgroups, .. } => {
                    let (pipeline, groups) = self.bound(plan, id, view, variant, &pass)?;
                    if let PipelineKind::Compute(compute) = &pipeline.kind {
                        let mut encoder = recording.encoder.begin_compute_pass(&Default::default());
                        encoder.set_pipeline(compute);
                        for (group, bind_group) in &groups {
                            encoder.set_bind_group(*group, bind_group, &[]);
                        }
                        encoder.dispatch_workgroups(workgroups[0], workgroups[1], workgroups[2]);
                    }
                }
                Pass::Draw { mesh, .. } => {
                    let (pipeline, groups) = self.bound(plan, id, view, variant, &pass)?;
                    let scratch = self.scratch(view.size)?;
                    let vertices = self.input(plan, id, mesh.port)?.buffer();
                    let attachment = RenderPassColorAttachment {
                        view: &scratch,
                        depth_slice: None,
                        resolve_target: None,
                        ops: Operations {
                            load: LoadOp::Clear(Color::BLACK),
                            store: StoreOp::Discard,
                        },
                    };
                    let mut encoder = recording.encoder.begin_render_pass(&RenderPassDescriptor {
                        label: Some(name),
                        color_attachments: &[Some(attachment)],
                        ..Default::default()
                    });
                    if let (PipelineKind::Render(render), Some(buffer)) = (&pipeline.kind, vertices)
                    {
                        encoder.set_pipeline(render);
                        for (group, bind_group) in &groups {
                            encoder.set_bind_group(*group, bind_group, &[]);
                        }
                        encoder.set_vertex_buffer(0, buffer.slice(..));
                        encoder.draw(0..mesh.vertices, 0..1);
                    }
                }
            }
        }
        Ok(())
    }

    /// The target of draw passes, made anew when the view has another size.
    fn scratch(&mut self, [width, height]: [u32; 2]) -> Result<TextureView, GpuError> {
        let size = Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        };
        let texture = match self.scratch.take().filter(|texture| texture.size() == size) {
            Some(texture) => texture,
            None => self.gpu.scoped(
                "making the target of draw passes",
                self.memory().bytes,
                || {
                    self.gpu.device.create_texture(&TextureDescriptor {
                        label: Some("scratch"),
                        size,
                        mip_level_count: 1,
                        sample_count: 1,
                        dimension: TextureDimension::D2,
                        format: SCRATCH_FORMAT,
                        usage: TextureUsages::RENDER_ATTACHMENT,
                        view_formats: &[],
                    })
                },
            )?,
        };
        let view = texture.create_view(&Default::default());
        self.scratch = Some(texture);
        Ok(view)
    }

    fn output(&self, plan: &Plan, id: NodeId, port: &str) -> Result<&Held, GpuError> {
        let at = plan
            .allocation_of
            .get(&(id, port.to_owned()))
            .ok_or_else(|| internal(plan, id, port))?;
        Ok(&self.held[*at])
    }

    fn input(&self, plan: &Plan, id: NodeId, port: &str) -> Result<&Held, GpuError> {
        let link = plan.graph.nodes[id]
            .inputs
            .get(port)
            .ok_or_else(|| internal(plan, id, port))?;
        self.output(plan, link.node, &link.port)
    }

    /// The pipeline of a pass and its bind groups.
    fn bound(
        &mut self,
        plan: &Plan,
        id: NodeId,
        view: &View,
        variant: Option<&str>,
        pass: &Pass,
    ) -> Result<Bound, GpuError> {
        let node = &plan.graph.nodes[id];
        let program = node
            .program
            .as_ref()
            .ok_or_else(|| internal(plan, id, "program"))?;
        let pipeline = self
            .pipelines
            .get(&self.gpu, program, pass)?
            .ok_or_else(|| internal(plan, id, "pipeline"))?;
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
                let resource = self.resource(plan, id, binding, &uniforms)?;
                entries.push(BindGroupEntry {
                    binding: binding.binding,
                    resource,
                });
            }
            let bind_group = self.gpu.device.create_bind_group(&BindGroupDescriptor {
                label: Some(&node.name),
                layout,
                entries: &entries,
            });
            groups.push((*group, bind_group));
        }
        Ok((pipeline, groups))
    }

    fn resource<'a>(
        &'a self,
        plan: &Plan,
        id: NodeId,
        binding: &Binding,
        uniforms: &'a BTreeMap<u32, Buffer>,
    ) -> Result<BindingResource<'a>, GpuError> {
        if let Some(buffer) = uniforms.get(&binding.binding) {
            return Ok(buffer.as_entire_binding());
        }
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
            BindingSource::Input(port) => self.input(plan, id, &port)?,
            BindingSource::Output(port) => self.output(plan, id, &port)?,
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

    /// Fills a whole resource. Textures go slab by slab, so that the staging memory stays small.
    fn upload(&self, held: &Held, bytes: &[u8], node: &str) -> Result<(), GpuError> {
        const SLAB_BYTES: usize = 64 << 20;
        let expected = held.resource.bytes();
        if bytes.len() as u64 != expected {
            return Err(Finding::error(
                "internal",
                format!(
                    "node `{node}` uploads {} bytes into {expected}",
                    bytes.len()
                ),
            )
            .into());
        }
        let what = format!("uploading for node `{node}`");
        match held.resource {
            ResourceKind::Buffer { .. } => {
                if let Some(buffer) = held.buffer() {
                    self.gpu.scoped(&what, expected, || {
                        self.gpu.queue.write_buffer(buffer, 0, bytes);
                    })?;
                }
            }
            ResourceKind::Texture { extent, format, .. } => {
                let texel = format.block_copy_size(None).unwrap_or(4);
                let row = extent[0] * texel;
                let layer = row as usize * extent[1] as usize;
                let layers_at_once = (SLAB_BYTES / layer.max(1)).max(1);
                let Some(texture) = held.texture() else {
                    return Ok(());
                };
                for (slab, bytes) in bytes.chunks(layer * layers_at_once).enumerate() {
                    let z = u32::try_from(slab * layers_at_once).unwrap_or(u32::MAX);
                    let depth = u32::try_from(bytes.len() / layer).unwrap_or(u32::MAX);
                    self.gpu.scoped(&what, expected, || {
                        self.gpu.queue.write_texture(
                            TexelCopyTextureInfo {
                                texture,
                                mip_level: 0,
                                origin: Origin3d { x: 0, y: 0, z },
                                aspect: TextureAspect::All,
                            },
                            bytes,
                            TexelCopyBufferLayout {
                                offset: 0,
                                bytes_per_row: Some(row),
                                rows_per_image: Some(extent[1]),
                            },
                            Extent3d {
                                width: extent[0],
                                height: extent[1],
                                depth_or_array_layers: depth,
                            },
                        );
                    })?;
                    // What is staged is let go before more is staged.
                    self.gpu.queue.submit([]);
                    if bytes.len() >= SLAB_BYTES {
                        self.gpu.wait()?;
                    }
                }
            }
        }
        Ok(())
    }
}

fn internal(plan: &Plan, id: NodeId, what: &str) -> GpuError {
    let name = &plan.graph.nodes[id].name;
    Finding::error("internal", format!("node `{name}`: `{what}` has no resource; the node kind records what its ports do not say"))
        .into()
}
