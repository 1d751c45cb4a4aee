//! From the host to device memory, piece by piece: while one is copied, the next is made.

use volgraph_graph::{Piece, ResourceKind, Tiles, UploadBytes};
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

    /// Writes those of some tiles that are not there, a batch of them at a time.
    pub(super) fn write_tiles(
        &self,
        held: &Held,
        tiles: &Tiles,
        node: &str,
        held_bytes: u64,
    ) -> Result<(), GpuError> {
        let what = format!("uploading for node `{node}`");
        let (Some(texture), ResourceKind::Texture { format, .. }) = (held.texture(), held.resource)
        else {
            return Ok(());
        };
        let texel = format.block_copy_size(None).unwrap_or(4);
        let [width, height, depth] = tiles.extent;
        let bytes = (width * height * depth * texel) as usize;
        held.set_tile_extent(tiles.extent);
        let missing: Vec<usize> = (0..tiles.tiles.len())
            .filter(|at| {
                let (origin, tag) = tiles.tiles[*at];
                !held.has_tile(origin, tag)
            })
            .collect();
        let mut batch = Vec::new();
        for some in missing.chunks((Tiles::BATCH_BYTES / bytes.max(1)).max(1)) {
            batch.resize(some.len() * bytes, 0);
            tiles.read(some, &mut batch)?;
            self.gpu.scoped(&what, held_bytes, || {
                for (at, texels) in some.iter().zip(batch.chunks_exact(bytes)) {
                    let origin = tiles.tiles[*at].0;
                    held.set_tile(origin, None);
                    self.gpu.queue.write_texture(
                        TexelCopyTextureInfo {
                            texture,
                            mip_level: 0,
                            origin: Origin3d {
                                x: origin[0],
                                y: origin[1],
                                z: origin[2],
                            },
                            aspect: TextureAspect::All,
                        },
                        texels,
                        TexelCopyBufferLayout {
                            offset: 0,
                            bytes_per_row: Some(width * texel),
                            rows_per_image: Some(height),
                        },
                        Extent3d {
                            width,
                            height,
                            depth_or_array_layers: depth,
                        },
                    );
                }
            })?;
            self.gpu.queue.submit([]);
            // What is staged is let go before more is staged.
            self.gpu.wait()?;
            for at in some {
                let (origin, tag) = tiles.tiles[*at];
                held.set_tile(origin, Some(tag));
            }
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
