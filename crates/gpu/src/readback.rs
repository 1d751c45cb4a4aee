//! From device memory to the host.

use wgpu::{
    Buffer, BufferDescriptor, BufferUsages, CommandEncoderDescriptor, Extent3d, MapMode, Origin3d,
    TexelCopyBufferInfo, TexelCopyBufferLayout, TexelCopyTextureInfo, TextureAspect, TextureFormat,
};

use crate::device::Gpu;
use crate::error::GpuError;
use crate::pool::Held;

/// A texture on the host: x fastest, top row first, no padding between rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Texels {
    /// Width, height, depth.
    pub extent: [u32; 3],
    /// Their format.
    pub format: TextureFormat,
    /// Their bytes.
    pub bytes: Vec<u8>,
}

impl Texels {
    /// The texels of an `f32` format as numbers; empty for other formats.
    #[must_use]
    pub fn to_f32(&self) -> Vec<f32> {
        match self.format {
            TextureFormat::R32Float | TextureFormat::Rg32Float | TextureFormat::Rgba32Float => self
                .bytes
                .chunks_exact(4)
                .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
                .collect(),
            _ => Vec::new(),
        }
    }
}

/// Copies a texture to the host.
pub(crate) fn read_texture(gpu: &Gpu, held: &Held, what: &str) -> Result<Texels, GpuError> {
    let Some(texture) = held.texture() else {
        return Err(GpuError::Output {
            name: what.to_owned(),
            reason: "it is not a texture".to_owned(),
        });
    };
    let size = texture.size();
    let extent = [size.width, size.height, size.depth_or_array_layers];
    let texel = texture.format().block_copy_size(None).unwrap_or(4);
    let row = u64::from(extent[0]) * u64::from(texel);
    let padded_row = row.next_multiple_of(u64::from(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT));
    let rows = u64::from(extent[1]) * u64::from(extent[2]);
    let bytes = padded_row * rows;
    let buffer = gpu.scoped(what, 0, || {
        let buffer = gpu.device.create_buffer(&BufferDescriptor {
            label: Some("read-back"),
            size: bytes,
            usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = gpu
            .device
            .create_command_encoder(&CommandEncoderDescriptor {
                label: Some("read-back"),
            });
        encoder.copy_texture_to_buffer(
            TexelCopyTextureInfo {
                texture,
                mip_level: 0,
                origin: Origin3d::ZERO,
                aspect: TextureAspect::All,
            },
            TexelCopyBufferInfo {
                buffer: &buffer,
                layout: TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: u32::try_from(padded_row).ok(),
                    rows_per_image: Some(extent[1]),
                },
            },
            Extent3d {
                width: extent[0],
                height: extent[1],
                depth_or_array_layers: extent[2],
            },
        );
        gpu.queue.submit([encoder.finish()]);
        buffer
    })?;
    let padded = map(gpu, &buffer, bytes)?;
    let (row, padded_row) = (to_usize(row), to_usize(padded_row));
    let bytes = if row == padded_row {
        padded
    } else {
        padded
            .chunks_exact(padded_row)
            .flat_map(|padded| &padded[..row])
            .copied()
            .collect()
    };
    Ok(Texels {
        extent,
        format: texture.format(),
        bytes,
    })
}

/// Waits for a buffer and copies its bytes.
pub(crate) fn map(gpu: &Gpu, buffer: &Buffer, bytes: u64) -> Result<Vec<u8>, GpuError> {
    let failed = |reason: String| GpuError::Device {
        what: "reading back".to_owned(),
        reason,
    };
    let (sender, receiver) = std::sync::mpsc::channel();
    buffer.map_async(MapMode::Read, 0..bytes, move |result| {
        // The receiver lives until the result is there.
        let _ = sender.send(result);
    });
    gpu.wait()?;
    match receiver.recv() {
        Ok(Ok(())) => {}
        Ok(Err(error)) => return Err(failed(error.to_string())),
        Err(error) => return Err(failed(error.to_string())),
    }
    let mapped = buffer
        .get_mapped_range(0..bytes)
        .map_err(|error| failed(error.to_string()))?;
    let copy = mapped.to_vec();
    drop(mapped);
    buffer.unmap();
    Ok(copy)
}

fn to_usize(n: u64) -> usize {
    usize::try_from(n).unwrap_or(usize::MAX)
}
