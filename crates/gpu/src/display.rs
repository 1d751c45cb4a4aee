//! Pictures for windows: the linear colours of an output as sRGB codes, in a texture of the same device, without a copy
//! over the host. Codes are those of a PNG of the picture over black, within 1/255.

use std::sync::Arc;

use wgpu::{
    BindGroupDescriptor, BindGroupEntry, BindGroupLayout, BindGroupLayoutDescriptor,
    BindGroupLayoutEntry, BindingResource, BindingType, Color, CommandEncoderDescriptor, Extent3d,
    FragmentState, LoadOp, Operations, PipelineLayoutDescriptor, RenderPassColorAttachment,
    RenderPassDescriptor, RenderPipeline, RenderPipelineDescriptor, ShaderModuleDescriptor,
    ShaderSource, ShaderStages, StoreOp, Texture, TextureDescriptor, TextureDimension,
    TextureFormat, TextureSampleType, TextureUsages, TextureView, TextureViewDimension,
    VertexState,
};

use crate::device::Gpu;
use crate::error::GpuError;
use crate::pool::Held;

/// sRGB codes as they are, without the hardware's decoding: what interfaces mix in.
const FORMAT: TextureFormat = TextureFormat::Rgba8Unorm;

/// A picture that a window can show. It stays as it is until the next one of the same size is shown.
#[derive(Clone, Debug)]
pub struct Shown {
    /// The device that it lies on.
    pub gpu: Arc<Gpu>,
    /// sRGB codes, opaque.
    pub view: TextureView,
    /// Width and height in pixels.
    pub size: [u32; 2],
}

/// The pass that makes it.
pub(crate) struct Display {
    layout: BindGroupLayout,
    pipeline: RenderPipeline,
    target: Option<(Texture, TextureView)>,
}

impl Display {
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        gpu.scoped("the display pass", 0, || Self::build(gpu))
    }

    fn build(gpu: &Gpu) -> Self {
        let module = gpu.device.create_shader_module(ShaderModuleDescriptor {
            label: Some("display"),
            source: ShaderSource::Wgsl(include_str!("display.wgsl").into()),
        });
        let layout = gpu
            .device
            .create_bind_group_layout(&BindGroupLayoutDescriptor {
                label: Some("display"),
                entries: &[BindGroupLayoutEntry {
                    binding: 0,
                    visibility: ShaderStages::FRAGMENT,
                    ty: BindingType::Texture {
                        sample_type: TextureSampleType::Float { filterable: false },
                        view_dimension: TextureViewDimension::D2,
                        multisampled: false,
                    },
                    count: None,
                }],
            });
        let pipeline_layout = gpu
            .device
            .create_pipeline_layout(&PipelineLayoutDescriptor {
                label: Some("display"),
                bind_group_layouts: &[Some(&layout)],
                ..Default::default()
            });
        let pipeline = gpu
            .device
            .create_render_pipeline(&RenderPipelineDescriptor {
                label: Some("display"),
                layout: Some(&pipeline_layout),
                vertex: VertexState {
                    module: &module,
                    entry_point: Some("display_corner"),
                    compilation_options: Default::default(),
                    buffers: &[],
                },
                primitive: Default::default(),
                depth_stencil: None,
                multisample: Default::default(),
                fragment: Some(FragmentState {
                    module: &module,
                    entry_point: Some("display_pixel"),
                    compilation_options: Default::default(),
                    targets: &[Some(FORMAT.into())],
                }),
                multiview_mask: None,
                cache: None,
            });
        Self {
            layout,
            pipeline,
            target: None,
        }
    }

    /// Shows what `held` holds now.
    pub fn show(&mut self, gpu: &Arc<Gpu>, held: &Held, output: &str) -> Result<Shown, GpuError> {
        let (texture, colors) = match (held.texture(), held.view()) {
            (Some(texture), Some(view)) if texture.dimension() == TextureDimension::D2 => {
                (texture, view)
            }
            _ => {
                return Err(GpuError::Output {
                    name: output.to_owned(),
                    reason: "it is not a picture".to_owned(),
                });
            }
        };
        let size = [texture.width(), texture.height()];
        gpu.scoped("showing a picture", 0, || {
            let fits =
                |(target, _): &(Texture, TextureView)| [target.width(), target.height()] == size;
            let (_, target) = match self.target.take().filter(fits) {
                Some(target) => self.target.insert(target),
                None => self.target.insert(new_target(gpu, size)),
            };
            let group = gpu.device.create_bind_group(&BindGroupDescriptor {
                label: Some("display"),
                layout: &self.layout,
                entries: &[BindGroupEntry {
                    binding: 0,
                    resource: BindingResource::TextureView(colors),
                }],
            });
            let mut encoder = gpu
                .device
                .create_command_encoder(&CommandEncoderDescriptor {
                    label: Some("display"),
                });
            let mut pass = encoder.begin_render_pass(&RenderPassDescriptor {
                label: Some("display"),
                color_attachments: &[Some(RenderPassColorAttachment {
                    view: target,
                    depth_slice: None,
                    resolve_target: None,
                    ops: Operations {
                        load: LoadOp::Clear(Color::BLACK),
                        store: StoreOp::Store,
                    },
                })],
                ..Default::default()
            });
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.draw(0..3, 0..1);
            drop(pass);
            gpu.queue.submit([encoder.finish()]);
            Shown {
                gpu: Arc::clone(gpu),
                view: target.clone(),
                size,
            }
        })
    }
}

fn new_target(gpu: &Gpu, [width, height]: [u32; 2]) -> (Texture, TextureView) {
    let texture = gpu.device.create_texture(&TextureDescriptor {
        label: Some("display"),
        size: Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: TextureDimension::D2,
        format: FORMAT,
        usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    let view = texture.create_view(&Default::default());
    (texture, view)
}
