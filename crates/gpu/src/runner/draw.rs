//! Draw passes: what is drawn, and into what.

use volgraph_graph::{Geometry, NodeId, Pass, View};
use wgpu::{
    Color, CommandEncoder, Extent3d, LoadOp, Operations, RenderPassColorAttachment,
    RenderPassDepthStencilAttachment, RenderPassDescriptor, StoreOp, TextureDescriptor,
    TextureDimension, TextureUsages, TextureView,
};

use super::bind::Bound;
use super::frame::internal;
use super::{Installation, Runner};
use crate::error::GpuError;
use crate::pipelines::{PipelineKind, SCRATCH_FORMAT};

impl Runner {
    /// Records a draw pass.
    pub(super) fn draw(
        &self,
        installation: &mut Installation,
        id: NodeId,
        view: &View,
        pass: &Pass,
        bound: &Bound,
        encoder: &mut CommandEncoder,
    ) -> Result<(), GpuError> {
        let Pass::Draw {
            geometry,
            targets,
            depth,
            ..
        } = pass
        else {
            return Ok(());
        };
        let has_own = !targets.is_empty() || depth.is_some();
        let scratch = if has_own {
            None
        } else {
            Some(self.scratch(installation, view.size)?)
        };
        let plan = &installation.plan;
        let mut attachments: Vec<_> = scratch
            .iter()
            .map(|view| {
                Some(attachment(
                    view,
                    LoadOp::Clear(Color::BLACK),
                    StoreOp::Discard,
                ))
            })
            .collect();
        for target in targets {
            let held = installation.output(id, target.port)?;
            let view = held.view().ok_or_else(|| internal(plan, id, target.port))?;
            let load = if target.is_cleared {
                LoadOp::Clear(Color::TRANSPARENT)
            } else {
                LoadOp::Load
            };
            attachments.push(Some(attachment(view, load, StoreOp::Store)));
        }
        let depth = match depth {
            Some(depth) => {
                let held = installation.output(id, depth.port)?;
                let load = if depth.is_cleared {
                    LoadOp::Clear(1.0)
                } else {
                    LoadOp::Load
                };
                Some(RenderPassDepthStencilAttachment {
                    view: held.view().ok_or_else(|| internal(plan, id, depth.port))?,
                    depth_ops: Some(Operations {
                        load,
                        store: StoreOp::Store,
                    }),
                    stencil_ops: None,
                })
            }
            None => None,
        };
        let mut encoder = encoder.begin_render_pass(&RenderPassDescriptor {
            label: Some(&plan.graph.nodes[id].name),
            color_attachments: &attachments,
            depth_stencil_attachment: depth,
            ..Default::default()
        });
        let PipelineKind::Render(render) = &bound.pipeline.kind else {
            return Ok(());
        };
        encoder.set_pipeline(render);
        for (group, bind_group) in &bound.groups {
            encoder.set_bind_group(*group, bind_group, &[]);
        }
        match *geometry {
            Geometry::Mesh(mesh) => {
                let held = installation.input(id, mesh.port)?;
                let buffer = held.buffer().ok_or_else(|| internal(plan, id, mesh.port))?;
                encoder.set_vertex_buffer(0, buffer.slice(..));
                encoder.draw(0..mesh.vertices, 0..1);
            }
            Geometry::Made {
                vertices,
                instances,
            } => encoder.draw(0..vertices, 0..instances),
        }
        Ok(())
    }

    /// The target of draw passes, made anew when the view has another size.
    fn scratch(
        &self,
        installation: &mut Installation,
        [width, height]: [u32; 2],
    ) -> Result<TextureView, GpuError> {
        let size = Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        };
        let texture = match installation
            .scratch
            .clone()
            .filter(|texture| texture.size() == size)
        {
            Some(texture) => texture,
            None => self.gpu.scoped(
                "making the target of draw passes",
                installation.bytes(),
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
        installation.scratch = Some(texture);
        Ok(view)
    }
}

fn attachment(
    view: &TextureView,
    load: LoadOp<Color>,
    store: StoreOp,
) -> RenderPassColorAttachment<'_> {
    RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: Operations { load, store },
    }
}
