//! The twin of `node/gradient.wgsl` for devices that cannot write 3D textures.

use std::sync::Arc;

use glam::{DVec3, IVec3};
use half::f16;
use rayon::prelude::*;
use volgraph_graph::{NodeContext, Pass, UploadBytes};
use volgraph_report::Finding;
use volgraph_volume::Volume;
use wgpu_types::TextureFormat;

use crate::encoding::Encoding;
use crate::placement;
use crate::source::volume::VolumeSource;

/// The slot `gradient_method`.
#[derive(Clone, Copy)]
enum Method {
    Central,
    Sobel,
}

/// The slot `gradient_storage`.
#[derive(Clone, Copy)]
pub(super) enum Storage {
    Rgba8,
    Rgba16f,
    Rgba32f,
}

impl Storage {
    /// The choice of the slot.
    pub(super) fn named(node: &NodeContext<'_>) -> Result<Self, Finding> {
        match node.slot("gradient_storage") {
            "rgba8" => Ok(Self::Rgba8),
            "rgba16f" => Ok(Self::Rgba16f),
            "rgba32f" => Ok(Self::Rgba32f),
            other => Err(own_shader(node, "gradient_storage", other)),
        }
    }

    pub(super) fn format(self) -> TextureFormat {
        match self {
            Self::Rgba8 => TextureFormat::Rgba8Snorm,
            Self::Rgba16f => TextureFormat::Rgba16Float,
            Self::Rgba32f => TextureFormat::Rgba32Float,
        }
    }

    /// Bytes of a texel.
    fn texel_len(self) -> usize {
        match self {
            Self::Rgba8 => 4,
            Self::Rgba16f => 8,
            Self::Rgba32f => 16,
        }
    }

    /// `gradient_encode` of the slot's files; `stored` is what the volume's own texture has for the voxel.
    fn encode(self, gradient: DVec3, stored: impl Fn() -> f32, texel: &mut [u8]) {
        match self {
            Self::Rgba16f => {
                let values = [gradient.x, gradient.y, gradient.z, 0.0];
                for (bytes, value) in texel.chunks_exact_mut(2).zip(values) {
                    bytes.copy_from_slice(&f16::from_f64(value).to_le_bytes());
                }
            }
            Self::Rgba32f => {
                #[expect(clippy::cast_possible_truncation, reason = "shares of the range")]
                let [x, y, z] = gradient.to_array().map(|value| value as f32);
                for (bytes, value) in texel.chunks_exact_mut(4).zip([x, y, z, stored()]) {
                    bytes.copy_from_slice(&value.to_le_bytes());
                }
            }
            Self::Rgba8 => {
                let magnitude = gradient.length();
                let direction = gradient / magnitude.max(1e-12);
                let root = (magnitude / 3.0_f64.sqrt()).sqrt();
                let values = [direction.x, direction.y, direction.z, root];
                for (byte, value) in texel.iter_mut().zip(values) {
                    *byte = snorm8(value);
                }
            }
        }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "clamped to a signed byte")]
fn snorm8(value: f64) -> u8 {
    ((value.clamp(-1.0, 1.0) * 127.0).round() as i8).to_le_bytes()[0]
}

fn own_shader(node: &NodeContext<'_>, slot: &str, choice: &str) -> Finding {
    node.error(
        "unsupported-slot",
        format!("slot `{slot}`: this device cannot write 3D textures, so `{choice}` cannot run on it"),
    )
    .help("use volgraph's own choice, the gradient slot's `central`, or another adapter, such as `--adapter vulkan`")
}

pub(super) fn record(node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
    let method = match node.slot("gradient_method") {
        "central" => Method::Central,
        "sobel" => Method::Sobel,
        other => return Err(own_shader(node, "gradient_method", other)),
    };
    let storage = Storage::named(node)?;
    let encoding = placement::encoding(node)?;
    let volume = node
        .source::<VolumeSource>("volume")
        .map(|source| Arc::clone(&source.volume));
    let bytes = UploadBytes::by_layers(move || {
        let volume = volume.clone();
        Ok(Box::new(move |layers, texels| {
            if let Some(volume) = &volume {
                let voxels = placement::voxels_of(volume, layers);
                gradients(volume, method, (storage, encoding), voxels.start, texels);
            }
            Ok(())
        }))
    });
    Ok(vec![Pass::Upload {
        port: "gradient",
        bytes,
    }])
}

/// Fills in the encoded gradients of the voxels from one on.
fn gradients(
    volume: &Volume,
    method: Method,
    (storage, encoding): (Storage, Encoding),
    first: usize,
    texels: &mut [u8],
) {
    let (low, high) = volume.statistics().range().unwrap_or((0.0, 0.0));
    let span = if high > low { high - low } else { 1.0 };
    let dims = IVec3::from_array(
        volume
            .grid()
            .dims
            .map(|n| i32::try_from(n).unwrap_or(i32::MAX)),
    );
    let [nx, ny] = [dims.x as usize, dims.y as usize];
    let voxels = volume.voxels();
    let scalar = |index: IVec3| {
        let at = index.clamp(IVec3::ZERO, dims - 1).as_usizevec3();
        volume.drawn(voxels.get((at.z * ny + at.y) * nx + at.x))
    };
    texels
        .par_chunks_exact_mut(storage.texel_len())
        .enumerate()
        .for_each(|(at, texel)| {
            let at = first + at;
            let index = glam::USizeVec3::new(at % nx, at / nx % ny, at / (nx * ny)).as_ivec3();
            let stored = || encoding.stored_texel(scalar(index));
            storage.encode(estimate(method, index, &scalar) / span, stored, texel);
        });
}

/// `gradient_estimate` of the slot's files: data units per voxel along the index axes.
fn estimate(method: Method, index: IVec3, scalar: &impl Fn(IVec3) -> f64) -> DVec3 {
    match method {
        Method::Central => {
            let along = |axis: IVec3| 0.5 * (scalar(index + axis) - scalar(index - axis));
            DVec3::new(along(IVec3::X), along(IVec3::Y), along(IVec3::Z))
        }
        Method::Sobel => {
            let mut sum = DVec3::ZERO;
            for (z, y, x) in (0..27).map(|i| (i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1)) {
                let offset = IVec3::new(x, y, z);
                let smoothing = DVec3::splat(2.0) - offset.abs().as_dvec3();
                let across = DVec3::new(
                    smoothing.y * smoothing.z,
                    smoothing.x * smoothing.z,
                    smoothing.x * smoothing.y,
                );
                sum += scalar(index + offset) * offset.as_dvec3() * across;
            }
            sum / 32.0
        }
    }
}

#[cfg(test)]
mod tests {
    use volgraph_volume::{Grid, Voxels};

    use super::*;

    #[test]
    fn a_linear_field_has_its_own_gradient() {
        let slope = DVec3::new(3.0, -2.0, 0.5);
        let scalar = |index: IVec3| slope.dot(index.as_dvec3()) + 7.0;
        for method in [Method::Central, Method::Sobel] {
            let estimated = estimate(method, IVec3::new(4, 5, 6), &scalar);
            assert!(estimated.distance(slope) < 1e-12, "{estimated}");
        }
    }

    #[test]
    fn every_voxel_gets_a_texel() {
        let values: Vec<f32> = (0..24).map(|i| i as f32).collect();
        let grid = Grid::axis_aligned([2, 3, 4], DVec3::ONE, DVec3::ZERO);
        let volume = Volume::new("t", grid, Voxels::F32(values)).unwrap();
        let mut all = vec![0xaa; 24 * 8];
        let encoding = Encoding::choose(&volume, "auto");
        let half = (Storage::Rgba16f, encoding);
        gradients(&volume, Method::Sobel, half, 0, &mut all);
        // The last two layers alone are the same.
        let mut bytes = vec![0xaa; 12 * 8];
        gradients(&volume, Method::Sobel, half, 12, &mut bytes);
        assert_eq!(bytes, all[12 * 8..]);
        let bytes = all;
        // In the middle of y the values rise by 2 a row, of 23 in all.
        let texel = &bytes[(6 + 2) * 8..];
        assert!((f16::from_le_bytes([texel[2], texel[3]]).to_f64() - 2.0 / 23.0).abs() < 1e-3);
    }
}
