//! The picture into the window, by a pass of its own: one sample for each pixel, where the interface's shader does many
//! times the work. On drivers that run on the processor that is most of a frame.

use eframe::egui_wgpu::{Callback, CallbackResources, CallbackTrait, RenderState};
use eframe::wgpu;
use egui::{PaintCallbackInfo, Painter, Rect};

/// What the pass is made of; kept among the interface's own resources.
struct Blit {
    layout: wgpu::BindGroupLayout,
    sampler: wgpu::Sampler,
    pipeline: wgpu::RenderPipeline,
}

/// A picture that can be painted.
#[derive(Clone, Debug)]
pub struct Shot {
    group: wgpu::BindGroup,
    /// Width and height in pixels.
    pub size: [u32; 2],
}

impl Shot {
    /// Of a texture of sRGB codes on the window's device.
    #[must_use]
    pub fn new(state: &RenderState, view: &wgpu::TextureView, size: [u32; 2]) -> Self {
        let mut renderer = state.renderer.write();
        let resources = &mut renderer.callback_resources;
        let blit = resources
            .entry::<Blit>()
            .or_insert_with(|| Blit::new(&state.device, state.target_format));
        let group = state.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("picture"),
            layout: &blit.layout,
            entries: &[
                wgpu::BindGroupEntry {
                    binding: 0,
                    resource: wgpu::BindingResource::TextureView(view),
                },
                wgpu::BindGroupEntry {
                    binding: 1,
                    resource: wgpu::BindingResource::Sampler(&blit.sampler),
                },
            ],
        });
        Self { group, size }
    }

    /// Paints it over a rectangle.
    pub(crate) fn paint(&self, painter: &Painter, rect: Rect) {
        painter.add(Callback::new_paint_callback(
            rect,
            Painted(self.group.clone()),
        ));
    }
}

impl Blit {
    fn new(device: &wgpu::Device, target: wgpu::TextureFormat) -> Self {
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("blit"),
            source: wgpu::ShaderSource::Wgsl(include_str!("blit.wgsl").into()),
        });
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty,
            count: None,
        };
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("blit"),
            entries: &[
                entry(
                    0,
                    wgpu::BindingType::Texture {
                        sample_type: wgpu::TextureSampleType::Float { filterable: true },
                        view_dimension: wgpu::TextureViewDimension::D2,
                        multisampled: false,
                    },
                ),
                entry(
                    1,
                    wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
                ),
            ],
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("blit"),
            bind_group_layouts: &[Some(&layout)],
            ..Default::default()
        });
        let fragment = if target.is_srgb() {
            "blit_linear"
        } else {
            "blit_codes"
        };
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("blit"),
            layout: Some(&pipeline_layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("blit_corner"),
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: Default::default(),
            depth_stencil: None,
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some(fragment),
                compilation_options: Default::default(),
                targets: &[Some(target.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("blit"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        Self {
            layout,
            sampler,
            pipeline,
        }
    }
}

/// One picture in one frame of the interface.
struct Painted(wgpu::BindGroup);

impl CallbackTrait for Painted {
    fn paint(
        &self,
        _info: PaintCallbackInfo,
        pass: &mut wgpu::RenderPass<'static>,
        resources: &CallbackResources,
    ) {
        if let Some(blit) = resources.get::<Blit>() {
            pass.set_pipeline(&blit.pipeline);
            pass.set_bind_group(0, &self.0, &[]);
            pass.draw(0..3, 0..1);
        }
    }
}
