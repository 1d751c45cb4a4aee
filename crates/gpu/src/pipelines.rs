//! Pipelines by everything that they depend on, built once and kept while an installation uses them.

use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;
use std::time::Instant;

use volgraph_graph::{Blend, Digest, Geometry, NodeId, Pass, Plan, Program, ResourceKind};
use volgraph_report::{Finding, Findings};
use volgraph_shader::{
    Binding, Choices, GuardRequest, guard, hoist_uniforms, specialise, with_room,
};
use wgpu::{
    BindGroupLayout, BindGroupLayoutDescriptor, BlendComponent, BlendFactor, BlendOperation,
    BlendState, ColorTargetState, ColorWrites, CompareFunction, ComputePipeline,
    ComputePipelineDescriptor, DepthBiasState, DepthStencilState, Face, FragmentState, FrontFace,
    PipelineCompilationOptions, PipelineLayout, PipelineLayoutDescriptor, PrimitiveState,
    PrimitiveTopology, RenderPipeline, RenderPipelineDescriptor, ShaderModule,
    ShaderModuleDescriptor, ShaderSource, ShaderStages, StencilState, TextureFormat,
    VertexAttribute, VertexBufferLayout, VertexFormat, VertexState, VertexStepMode,
};

use crate::bindings::{layout_entry, with_uniforms_as_storage};
use crate::device::Gpu;
use crate::error::GpuError;
use crate::guard::Guard;
use crate::runner::Building;

/// Everything that makes two pipelines different. `override` values go by their bits.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct PipelineKey {
    module: Digest,
    entries: Vec<&'static str>,
    constants: Vec<(String, u64)>,
    /// The parameters that are constants of the module.
    choices: Choices,
    /// `None` for compute passes.
    drawing: Option<Drawing>,
}

/// What makes the pipelines of two draw passes different beside their shaders.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct Drawing {
    has_mesh: bool,
    targets: Vec<(TextureFormat, Blend)>,
    /// Whether depths are compared, and then whether they are written.
    depth: Option<bool>,
}

/// A pipeline, its bind group layouts by group, and the bindings that its entry points use.
#[derive(Debug)]
pub(crate) struct Pipeline {
    pub kind: PipelineKind,
    pub groups: BTreeMap<u32, (BindGroupLayout, Vec<Binding>)>,
    /// What watches its loops and loads; `None` where there is nothing to watch.
    pub guard: Option<Arc<Guard>>,
}

#[derive(Debug)]
pub(crate) enum PipelineKind {
    Compute(ComputePipeline),
    Render(RenderPipeline),
}

/// The loop turns of one invocation. Far over what a ray through the largest volume takes with shadow rays of its own;
/// a GPU takes a fraction of a second for them, and then every invocation ends at once.
const MAX_STEPS: u32 = 1 << 24;

/// The format of the target that draw passes have and do not write.
pub(crate) const SCRATCH_FORMAT: TextureFormat = TextureFormat::R8Unorm;

/// A module on the device, and what watches it.
#[derive(Clone, Debug)]
struct Built {
    module: Arc<ShaderModule>,
    guard: Option<Arc<Guard>>,
}

/// Everything that makes two modules different: linked text, choices, entry points, and whether uniforms are read as
/// storage buffers.
type ModuleKey = (Digest, Choices, Vec<&'static str>, bool);

/// All pipelines built so far.
#[derive(Debug, Default)]
pub(crate) struct Pipelines {
    modules: BTreeMap<ModuleKey, Built>,
    built: HashMap<PipelineKey, Arc<Pipeline>>,
    /// What was built since somebody asked.
    pub(crate) building: Building,
}

impl Pipelines {
    /// How many there are.
    pub(crate) fn len(&self) -> usize {
        self.built.len()
    }

    /// Lets go of all but these.
    pub(crate) fn retain(&mut self, used: &[PipelineKey]) {
        self.built.retain(|key, _| used.contains(key));
        self.modules.retain(|(digest, choices, ..), _| {
            let is_used = |key: &PipelineKey| key.module == *digest && key.choices == *choices;
            used.iter().any(is_used)
        });
    }

    /// The pipeline of a pass of a node; `None` for passes that need none.
    pub(crate) fn get(
        &mut self,
        gpu: &Gpu,
        plan: &Plan,
        id: NodeId,
        pass: &Pass,
    ) -> Result<Option<Arc<Pipeline>>, GpuError> {
        let node = &plan.graph.nodes[id];
        let (Some(program), Some(key)) = (&node.program, key(plan, id, pass)) else {
            return Ok(None);
        };
        let node = &node.name;
        if let Some(pipeline) = self.built.get(&key) {
            return Ok(Some(Arc::clone(pipeline)));
        }
        let entries = key.entries.join("` and `");
        let what = format!(
            "building `{entries}` of `{}` for node `{node}`",
            program.spec.root
        );
        let uniforms_as_storage = gpu.uniforms_as_storage() && may_crash(pass);
        let module_key = (
            key.module,
            key.choices.clone(),
            key.entries.clone(),
            uniforms_as_storage,
        );
        let known = self.modules.get(&module_key).cloned();
        // naga, wgpu and the driver recurse over the shader. Error scopes belong to a thread, so they are all in there.
        let made = with_room(|| {
            let start = Instant::now();
            let built = match &known {
                Some(built) => built.clone(),
                None => module(gpu, program, &key, uniforms_as_storage, &what)?,
            };
            let module_time = start.elapsed();
            let guard = built.guard.as_deref();
            let groups = groups(gpu, program, &key, guard, uniforms_as_storage, &what)?;
            let start = Instant::now();
            let kind = gpu.scoped(&what, 0, || build(gpu, &built.module, &key, &groups))?;
            Ok((built, groups, kind, module_time, start.elapsed()))
        });
        let (built, groups, kind, module_time, pipeline_time) =
            made.unwrap_or_else(|_| Err(failed(program, &what)))?;
        if known.is_none() {
            self.modules.insert(module_key, built.clone());
            self.building.module_time += module_time;
        }
        self.building.pipeline_time += pipeline_time;
        let name = format!("{node} ({})", key.entries[key.entries.len() - 1]);
        self.building.pipelines.push(name);
        let pipeline = Arc::new(Pipeline {
            kind,
            groups,
            guard: built.guard,
        });
        self.built.insert(key, Arc::clone(&pipeline));
        Ok(Some(pipeline))
    }
}

/// What is told where building panics instead of giving an error.
fn failed(program: &Program, what: &str) -> GpuError {
    let linked = &program.module.linked;
    Finding::error("wgsl-internal", format!("{what}: the compiler failed"))
        .at(linked.root_place())
        .help("take away parts of the shader until it compiles, and report what made it fail")
        .into()
}

/// Hands a program to the device, guarded: every invocation ends, and what goes wrong is counted where it does.
fn module(
    gpu: &Gpu,
    program: &Program,
    key: &PipelineKey,
    uniforms_as_storage: bool,
    what: &str,
) -> Result<Built, GpuError> {
    let request = GuardRequest {
        max_steps: MAX_STEPS,
        entries: &key.entries,
    };
    // What cannot be specialised draws the same from its uniform.
    let special = specialise(&program.module, &key.choices, gpu.capabilities()).ok();
    let special = special.as_ref().unwrap_or(&program.module);
    let hoisted = gpu
        .reads_uniforms_slowly()
        .then(|| hoist_uniforms(special, gpu.capabilities()).ok())
        .flatten();
    let special = hoisted.as_ref().unwrap_or(special);
    let mut guarded = guard(special, request, gpu.capabilities());
    // Without its guard a loop that does not end would take the device with it.
    if let Some(reason) = &guarded.unguarded {
        let message = format!("{what}: its loops and loads cannot be watched: {reason}");
        return Err(Finding::error("unguarded", message)
            .at(program.module.linked.root_place())
            .into());
    }
    let naga = std::mem::take(&mut guarded.module);
    let naga = if uniforms_as_storage {
        with_uniforms_as_storage(naga)
    } else {
        naga
    };
    let descriptor = ShaderModuleDescriptor {
        label: Some(program.spec.root),
        source: ShaderSource::Naga(Cow::Owned(naga)),
    };
    let module = gpu.scoped(what, 0, || gpu.device.create_shader_module(descriptor))?;
    let guard = match guarded.binding {
        Some(_) => Some(Arc::new(Guard::new(gpu, guarded, what)?)),
        None => None,
    };
    Ok(Built {
        module: Arc::new(module),
        guard,
    })
}

/// The key of a pass's pipeline; `None` for passes that need none.
pub(crate) fn key(plan: &Plan, id: NodeId, pass: &Pass) -> Option<PipelineKey> {
    let program = plan.graph.nodes[id].program.as_ref()?;
    let (entries, constants) = match pass {
        Pass::Compute {
            entry, constants, ..
        }
        | Pass::ComputeIndirect {
            entry, constants, ..
        } => (vec![*entry], constants),
        Pass::Draw {
            vertex,
            fragment,
            constants,
            ..
        } => (vec![*vertex, *fragment], constants),
        Pass::Upload { .. } | Pass::Tiles { .. } => return None,
    };
    Some(PipelineKey {
        module: program.module.linked.digest,
        entries,
        constants: constants
            .iter()
            .map(|(name, value)| (name.clone(), value.to_bits()))
            .collect(),
        choices: plan.choices(id),
        drawing: drawing(plan, id, pass),
    })
}

/// Whether drivers that must not have uniforms (see [`with_uniforms_as_storage`]) have been seen to crash in such a pass:
/// in draw passes that store everything themselves they have not.
fn may_crash(pass: &Pass) -> bool {
    match pass {
        Pass::Compute { .. } | Pass::ComputeIndirect { .. } => true,
        Pass::Draw { targets, .. } => !targets.is_empty(),
        Pass::Upload { .. } | Pass::Tiles { .. } => false,
    }
}

fn drawing(plan: &Plan, id: NodeId, pass: &Pass) -> Option<Drawing> {
    let Pass::Draw {
        geometry,
        targets,
        depth,
        ..
    } = pass
    else {
        return None;
    };
    // A port that is no texture is told of where it is drawn into.
    let targets = targets.iter().filter_map(|target| {
        match plan.resources.get(&(id, target.port.to_owned())) {
            Some(ResourceKind::Texture { format, .. }) => Some((*format, target.blend)),
            _ => None,
        }
    });
    Some(Drawing {
        has_mesh: matches!(geometry, Geometry::Mesh(_)),
        targets: targets.collect(),
        depth: depth.map(|depth| depth.is_written),
    })
}

fn groups(
    gpu: &Gpu,
    program: &Program,
    key: &PipelineKey,
    guard: Option<&Guard>,
    uniforms_as_storage: bool,
    what: &str,
) -> Result<BTreeMap<u32, (BindGroupLayout, Vec<Binding>)>, GpuError> {
    let stages: &[ShaderStages] = if key.entries.len() == 1 {
        &[ShaderStages::COMPUTE]
    } else {
        &[ShaderStages::VERTEX, ShaderStages::FRAGMENT]
    };
    let mut used: BTreeMap<(u32, u32), (Binding, ShaderStages)> = BTreeMap::new();
    for (entry, stage) in key.entries.iter().zip(stages) {
        let Some(bindings) = program.bindings.get(entry) else {
            return Err(Finding::error(
                "internal",
                format!("{what}: the node kind runs `{entry}` without naming it in its program"),
            )
            .into());
        };
        for binding in bindings {
            used.entry((binding.group, binding.binding))
                .or_insert_with(|| (binding.clone(), ShaderStages::NONE))
                .1 |= *stage;
        }
    }
    let mut findings = Findings::new();
    let mut entries: BTreeMap<u32, (Vec<wgpu::BindGroupLayoutEntry>, Vec<Binding>)> =
        BTreeMap::new();
    for ((group, _), (binding, visibility)) in used {
        if let Some(entry) = findings.take(layout_entry(&binding, visibility, uniforms_as_storage))
        {
            let (layout, bindings) = entries.entry(group).or_default();
            layout.push(entry);
            bindings.push(binding);
        }
    }
    if let Some(guard) = guard {
        let visibility = stages[stages.len() - 1];
        let (layout, _) = entries.entry(guard.group).or_default();
        layout.push(guard.layout_entry(visibility));
    }
    let entries = findings.into_result(entries)?;
    gpu.scoped(what, 0, || {
        entries
            .into_iter()
            .map(|(group, (entries, bindings))| {
                let layout = gpu
                    .device
                    .create_bind_group_layout(&BindGroupLayoutDescriptor {
                        label: None,
                        entries: &entries,
                    });
                (group, (layout, bindings))
            })
            .collect()
    })
}

fn build(
    gpu: &Gpu,
    module: &ShaderModule,
    key: &PipelineKey,
    groups: &BTreeMap<u32, (BindGroupLayout, Vec<Binding>)>,
) -> PipelineKind {
    let layout = layout(gpu, groups);
    let constants: Vec<(&str, f64)> = key
        .constants
        .iter()
        .map(|(name, bits)| (name.as_str(), f64::from_bits(*bits)))
        .collect();
    let compilation_options = PipelineCompilationOptions {
        constants: &constants,
        zero_initialize_workgroup_memory: true,
    };
    let label = Some(key.entries[key.entries.len() - 1]);
    let [vertex, fragment] = key.entries.as_slice() else {
        return PipelineKind::Compute(gpu.device.create_compute_pipeline(
            &ComputePipelineDescriptor {
                label,
                layout: Some(&layout),
                module,
                entry_point: Some(key.entries[0]),
                compilation_options,
                cache: None,
            },
        ));
    };
    let attributes = [VertexAttribute {
        format: VertexFormat::Float32x3,
        offset: 0,
        shader_location: 0,
    }];
    let mesh = VertexBufferLayout {
        array_stride: 12,
        step_mode: VertexStepMode::Vertex,
        attributes: &attributes,
    };
    let meshes = [Some(mesh)];
    let drawing = key.drawing.as_ref();
    let has_mesh = drawing.is_none_or(|drawing| drawing.has_mesh);
    let targets = color_targets(drawing);
    let depth = drawing.and_then(|drawing| drawing.depth);
    PipelineKind::Render(
        gpu.device
            .create_render_pipeline(&RenderPipelineDescriptor {
                label,
                layout: Some(&layout),
                vertex: VertexState {
                    module,
                    entry_point: Some(vertex),
                    compilation_options: compilation_options.clone(),
                    buffers: if has_mesh { &meshes } else { &[] },
                },
                primitive: PrimitiveState {
                    topology: PrimitiveTopology::TriangleList,
                    front_face: FrontFace::Ccw,
                    cull_mode: has_mesh.then_some(Face::Front),
                    ..PrimitiveState::default()
                },
                depth_stencil: depth.map(|is_written| DepthStencilState {
                    format: TextureFormat::Depth32Float,
                    depth_write_enabled: Some(is_written),
                    depth_compare: Some(CompareFunction::Less),
                    stencil: StencilState::default(),
                    bias: DepthBiasState::default(),
                }),
                multisample: wgpu::MultisampleState::default(),
                fragment: Some(FragmentState {
                    module,
                    entry_point: Some(fragment),
                    compilation_options,
                    targets: &targets,
                }),
                multiview_mask: None,
                cache: None,
            }),
    )
}

fn color_targets(drawing: Option<&Drawing>) -> Vec<Option<ColorTargetState>> {
    let given = drawing.map_or(&[][..], |drawing| &drawing.targets);
    if given.is_empty() && drawing.is_none_or(|drawing| drawing.depth.is_none()) {
        // The pass needs a target of the picture's size; nothing is written to it.
        return vec![Some(ColorTargetState {
            format: SCRATCH_FORMAT,
            blend: None,
            write_mask: ColorWrites::empty(),
        })];
    }
    let target = |&(format, blend): &(TextureFormat, Blend)| {
        Some(ColorTargetState {
            format,
            blend: blend_state(blend),
            write_mask: ColorWrites::ALL,
        })
    };
    given.iter().map(target).collect()
}

fn blend_state(blend: Blend) -> Option<BlendState> {
    let (src_factor, dst_factor) = match blend {
        Blend::Replace => return None,
        Blend::Under => (BlendFactor::OneMinusDstAlpha, BlendFactor::One),
        Blend::Over => (BlendFactor::One, BlendFactor::OneMinusSrcAlpha),
    };
    let component = BlendComponent {
        src_factor,
        dst_factor,
        operation: BlendOperation::Add,
    };
    Some(BlendState {
        color: component,
        alpha: component,
    })
}

fn layout(gpu: &Gpu, groups: &BTreeMap<u32, (BindGroupLayout, Vec<Binding>)>) -> PipelineLayout {
    let count = groups.keys().next_back().map_or(0, |last| last + 1);
    let layouts: Vec<Option<&BindGroupLayout>> = (0..count)
        .map(|group| groups.get(&group).map(|(layout, _)| layout))
        .collect();
    gpu.device
        .create_pipeline_layout(&PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &layouts,
            immediate_size: 0,
        })
}
