//! What a device can do.

use serde::Serialize;

/// What a device can do, as far as a plan depends on it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Limits {
    /// Texels along a 1D texture.
    pub max_texture_1d: u64,
    /// Texels along an axis of a 2D texture.
    pub max_texture_2d: u64,
    /// Texels along an axis of a 3D texture.
    pub max_texture_3d: u64,
    /// Bytes of one buffer.
    pub max_buffer_bytes: u64,
    /// Bytes of one resource; the user's own limit.
    pub max_resource_bytes: u64,
    /// Whether f32 textures can be sampled linearly.
    pub float32_filterable: bool,
    /// Whether f32 textures are sampled as fast as those of half floats, which drivers on the processor convert.
    pub float32_fast: bool,
    /// Whether draw passes can blend into f32 textures.
    pub float32_blendable: bool,
    /// Whether compute shaders can write 3D textures. wgpu 30 binds only the first slice of one on GL.
    pub storage_3d: bool,
    /// Whether a shader may read one texture through several samplers; a sampler of GLSL is of one texture.
    pub shared_samplers: bool,
}

impl Default for Limits {
    /// What WebGPU guarantees everywhere.
    fn default() -> Self {
        Self {
            max_texture_1d: 8192,
            max_texture_2d: 8192,
            max_texture_3d: 2048,
            max_buffer_bytes: 256 << 20,
            max_resource_bytes: 8 << 30,
            float32_filterable: false,
            float32_fast: false,
            float32_blendable: false,
            storage_3d: true,
            shared_samplers: true,
        }
    }
}
