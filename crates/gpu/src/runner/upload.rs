//! From the host to device memory, piece by piece: while one is copied, the next is made.

use volgraph_graph::{Piece, ResourceKind, UploadBytes};
use volgraph_report::Finding;
use wgpu::{Extent3d, Origin3d, TexelCopyBufferLayout, TexelCopyTextureInfo, TextureAspect};

use super::Runner;
use crate::error::GpuError;
use crate::pool::Held;

impl Runner {
    /// Fills a whole resource. No more than two pieces are on the host at a time: one as it was made, and one that is
    /// staged.
    pub(super) fn upload(
        &self,
        held: &Held,
        bytes: &UploadBytes,
        node: &str,
        held_bytes: u64,
    ) -> Result<(), GpuError> {
        let what = format!("uploading for node `{node}`");
        let (layers, layer_bytes) = layers(&held.resource);
        let of_node = |finding: Finding| Finding {
            message: format!("node `{node}`: {}", finding.message),
            ..finding
        };
        let mut pieces = bytes.pieces(layers, layer_bytes).map_err(of_node)?;
        let mut is_first = true;
        while let Some(piece) = pieces.next_piece()? {
            // What is staged is let go before more is staged.
            if !is_first {
                self.gpu.wait()?;
            }
            is_first = false;
            self.gpu
                .scoped(&what, held_bytes, || self.write(held, &piece))?;
            self.gpu.queue.submit([]);
        }
        Ok(())
    }

    fn write(&self, held: &Held, piece: &Piece<'_>) {
        let queue = &self.gpu.queue;
        match held.resource {
            ResourceKind::Buffer { .. } => {
                if let Some(buffer) = held.buffer() {
                    queue.write_buffer(buffer, 0, piece.bytes);
                }
            }
            ResourceKind::Texture { extent, format, .. } => {
                let texel = format.block_copy_size(None).unwrap_or(4);
                let Some(texture) = held.texture() else {
                    return;
                };
                let z = piece.layers.start;
                queue.write_texture(
                    TexelCopyTextureInfo {
                        texture,
                        mip_level: 0,
                        origin: Origin3d { x: 0, y: 0, z },
                        aspect: TextureAspect::All,
                    },
                    piece.bytes,
                    TexelCopyBufferLayout {
                        offset: 0,
                        bytes_per_row: Some(extent[0] * texel),
                        rows_per_image: Some(extent[1]),
                    },
                    Extent3d {
                        width: extent[0],
                        height: extent[1],
                        depth_or_array_layers: piece.layers.end - z,
                    },
                );
            }
        }
    }
}

/// How many layers a resource has, and the bytes of each. A buffer is one.
fn layers(resource: &ResourceKind) -> (u32, u64) {
    match *resource {
        ResourceKind::Buffer { bytes } => (1, bytes),
        ResourceKind::Texture { extent, .. } => {
            let layers = extent[2].max(1);
            (layers, resource.bytes() / u64::from(layers))
        }
    }
}
