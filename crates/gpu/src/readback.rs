//! From device memory to the host.

use std::sync::Mutex;

use bytemuck::Pod;
use wgpu::{
    Buffer, BufferDescriptor, BufferUsages, CommandEncoderDescriptor, MapMode, Origin3d,
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
    /// Their numbers.
    pub values: TexelValues,
}

/// The numbers of texels.
#[derive(Clone, Debug, PartialEq)]
pub enum TexelValues {
    /// One number each.
    Scalars(Vec<f32>),
    /// Two numbers each.
    Pairs(Vec<[f32; 2]>),
    /// Four numbers each.
    Colors(Vec<[f32; 4]>),
    /// Of other formats, the bytes.
    Bytes(Vec<u8>),
}

/// The buffer that textures are copied through: kept, since a fresh one costs more than the copy.
#[derive(Debug, Default)]
pub(crate) struct Staging(Mutex<Option<Buffer>>);

impl Staging {
    /// A buffer of exactly so many bytes.
    fn take(&self, gpu: &Gpu, bytes: u64) -> Buffer {
        let kept = self.0.lock().ok().and_then(|mut kept| kept.take());
        if let Some(buffer) = kept.filter(|buffer| buffer.size() == bytes) {
            return buffer;
        }
        gpu.device.create_buffer(&BufferDescriptor {
            label: Some("read-back"),
            size: bytes,
            usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
            mapped_at_creation: false,
        })
    }

    fn keep(&self, buffer: Buffer) {
        if let Ok(mut kept) = self.0.lock() {
            *kept = Some(buffer);
        }
    }
}

/// Copies a texture to the host.
pub(crate) fn read_texture(
    gpu: &Gpu,
    staging: &Staging,
    held: &Held,
    what: &str,
) -> Result<Texels, GpuError> {
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
        let buffer = staging.take(gpu, bytes);
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
            size,
        );
        gpu.queue.submit([encoder.finish()]);
        buffer
    })?;
    let (row, padded_row) = (to_usize(row), to_usize(padded_row));
    let format = texture.format();
    let values = mapped(gpu, &buffer, bytes, |bytes| match format {
        TextureFormat::R32Float => TexelValues::Scalars(unpadded(bytes, row, padded_row)),
        TextureFormat::Rg32Float => TexelValues::Pairs(unpadded(bytes, row, padded_row)),
        TextureFormat::Rgba32Float => TexelValues::Colors(unpadded(bytes, row, padded_row)),
        _ => TexelValues::Bytes(unpadded(bytes, row, padded_row)),
    })?;
    staging.keep(buffer);
    Ok(Texels {
        extent,
        format,
        values,
    })
}

/// Rows without what is between them.
fn unpadded<T: Pod>(bytes: &[u8], row: usize, padded_row: usize) -> Vec<T> {
    if row == padded_row {
        return bytemuck::pod_collect_to_vec(bytes);
    }
    let rows = bytes.chunks_exact(padded_row.max(1));
    let mut values = Vec::with_capacity(rows.len() * row / size_of::<T>());
    for padded in rows {
        values.extend(bytemuck::pod_collect_to_vec::<u8, T>(&padded[..row]));
    }
    values
}

/// Waits for a buffer and copies its bytes.
pub(crate) fn map(gpu: &Gpu, buffer: &Buffer, bytes: u64) -> Result<Vec<u8>, GpuError> {
    mapped(gpu, buffer, bytes, <[u8]>::to_vec)
}

/// Waits for a buffer and makes something of its bytes.
fn mapped<R>(
    gpu: &Gpu,
    buffer: &Buffer,
    bytes: u64,
    make: impl FnOnce(&[u8]) -> R,
) -> Result<R, GpuError> {
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
    let range = buffer
        .get_mapped_range(0..bytes)
        .map_err(|error| failed(error.to_string()))?;
    let made = make(&range);
    drop(range);
    buffer.unmap();
    Ok(made)
}

fn to_usize(n: u64) -> usize {
    usize::try_from(n).unwrap_or(usize::MAX)
}
