//! What ports carry once it has a size: textures and buffers.

use serde::Serialize;
use wgpu_types::TextureFormat;

/// How large an output is, before the view and the inputs are known.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum Size {
    /// So many texels (unused axes are 1).
    Absolute([u32; 3]),
    /// As large as the picture, times a factor.
    ViewRelative(f32),
    /// As large as the texture at the node's own input port, times a factor.
    InputRelative(&'static str, f32),
}

/// What an output port writes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum ResourceDesc {
    /// A texture.
    Texture {
        /// Number of axes: 1, 2 or 3.
        dimensions: u8,
        /// Its size.
        size: Size,
        /// Its format.
        format: TextureFormat,
    },
    /// A buffer of so many bytes.
    Buffer {
        /// Bytes.
        bytes: u64,
    },
    /// A buffer with so many bytes for each pixel of the picture, and some before them.
    ViewBuffer {
        /// Bytes before those of pixels.
        head: u64,
        /// Bytes of a pixel.
        per_pixel: u64,
    },
}

/// A resource with all sizes known: what the pools compare. Equal kinds may share memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
pub enum ResourceKind {
    /// A texture.
    Texture {
        /// Number of axes: 1, 2 or 3.
        dimensions: u8,
        /// Width, height, depth in texels.
        extent: Extent,
        /// Its format.
        format: TextureFormat,
    },
    /// A buffer.
    Buffer {
        /// Bytes.
        bytes: u64,
    },
}

/// Width, height and depth in texels.
pub type Extent = [u32; 3];

impl ResourceKind {
    /// The memory it takes, in bytes.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        match self {
            Self::Texture { extent, format, .. } => {
                // Saturating: three axes of 32 bits each pass 64 bits.
                let texels = extent
                    .iter()
                    .fold(1_u64, |product, &n| product.saturating_mul(n.into()));
                texels.saturating_mul(format.block_copy_size(None).unwrap_or(4).into())
            }
            Self::Buffer { bytes } => *bytes,
        }
    }
}
