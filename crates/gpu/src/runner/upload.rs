//! From the host to device memory.

use volgraph_graph::ResourceKind;
use volgraph_report::Finding;
use wgpu::{Extent3d, Origin3d, TexelCopyBufferLayout, TexelCopyTextureInfo, TextureAspect};

use super::Runner;
use crate::error::GpuError;
use crate::pool::Held;

impl Runner {
    /// Fills a whole resource. Textures go slab by slab, so that the staging memory stays small.
    pub(super) fn upload(
        &self,
        held: &Held,
        bytes: &[u8],
        node: &str,
        held_bytes: u64,
    ) -> Result<(), GpuError> {
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
                    self.gpu.scoped(&what, held_bytes, || {
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
                    self.gpu.scoped(&what, held_bytes, || {
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
