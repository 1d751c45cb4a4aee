//! How scalars become texels: the format that holds a volume's values best, and the way back.
//!
//! `scalar = texel · scale + offset`, where shaders count scalars from a reference: 0, so that they are data units, or
//! the smallest value where the data lies so far from 0 that f32 has no digits left for it. Whole numbers that span at most 4096 are exact in half floats, which are
//! filtered in float on every adapter; 8-bit formats are filtered with 8-bit weights by software drivers. Wider
//! ranges take single floats; where the device cannot filter those, shaders do it from loads.

mod encoder;

use half::f16;
use volgraph_graph::Limits;
use volgraph_volume::{ScalarType, Volume, drawn};
use wgpu_types::TextureFormat;

pub use encoder::Encoder;

/// What is known of a volume's scalars, wherever its voxels are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scalars {
    /// Their type.
    pub ty: ScalarType,
    /// The smallest and the largest finite one; `None` where none is finite.
    pub range: Option<(f64, f64)>,
}

impl Scalars {
    /// What is drawn for a voxel's value, as [`Volume::drawn`] says.
    #[must_use]
    pub fn drawn(&self, value: f64) -> f64 {
        drawn(value, self.range)
    }
}

impl From<&Volume> for Scalars {
    fn from(volume: &Volume) -> Self {
        Self {
            ty: volume.voxels().scalar_type(),
            range: volume.statistics().range(),
        }
    }
}

/// How a volume's scalars are stored in a texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Encoding {
    /// The texture's format.
    pub format: TextureFormat,
    /// scalar = texel · scale + offset
    pub scale: f64,
    /// See `scale`.
    pub offset: f64,
    /// The data value that is 0 in shaders.
    pub reference: f64,
    /// The largest error of a voxel that this storage makes, in data units; 0 where it is exact.
    pub error: f64,
    /// Smallest and largest finite scalar.
    pub range: (f64, f64),
}

impl Encoding {
    /// The encoding for a storage choice: `auto`, `r8unorm`, `r16float` or `r32float`.
    #[must_use]
    pub fn choose(scalars: impl Into<Scalars>, storage: &str) -> Self {
        let scalars = scalars.into();
        let (lo, hi) = scalars.range.unwrap_or((0.0, 0.0));
        let span = hi - lo;
        let is_whole = !scalars.ty.is_float();
        let half_is_exact = is_whole && span <= 4096.0;
        let format = match storage {
            "r8unorm" => TextureFormat::R8Unorm,
            "r16float" => TextureFormat::R16Float,
            "r32float" => TextureFormat::R32Float,
            _ if half_is_exact => TextureFormat::R16Float,
            _ => TextureFormat::R32Float,
        };
        let unit_span = if span > 0.0 { span } else { 1.0 };
        let (scale, offset, error) = match format {
            TextureFormat::R8Unorm => {
                let is_exact = is_whole && (lo >= 0.0 && hi <= 255.0);
                if is_exact {
                    (255.0, 0.0, 0.0)
                } else {
                    (unit_span, lo, span / 510.0)
                }
            }
            TextureFormat::R16Float => {
                // Half floats hold every whole number up to 2048, of either sign.
                let middle = if lo >= 0.0 && hi <= 2048.0 {
                    0.0
                } else {
                    (0.5 * (lo + hi)).floor()
                };
                if half_is_exact {
                    (1.0, middle, 0.0)
                } else {
                    // -1..1, so that the sign bit counts as well.
                    (0.5 * unit_span, 0.5 * (lo + hi), span / 8192.0)
                }
            }
            _ => match scalars.ty {
                ScalarType::F32
                | ScalarType::U8
                | ScalarType::I8
                | ScalarType::U16
                | ScalarType::I16 => (1.0, 0.0, 0.0),
                _ => (unit_span, lo, span * f64::from(f32::EPSILON)),
            },
        };
        // Further out than this, a part in 10⁶ of the range would be lost.
        let reference = if lo.abs().max(hi.abs()) > 16.0 * span {
            lo
        } else {
            0.0
        };
        Self {
            format,
            scale,
            offset: offset - reference,
            reference,
            error,
            range: (lo, hi),
        }
    }

    fn texel(&self, scalar: f64) -> f64 {
        (scalar - self.reference - self.offset) / self.scale
    }

    /// What shaders read of a voxel with a data value: it has been rounded to the storage.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, reason = "shaders compute in f32")]
    pub fn stored(&self, scalar: f64) -> f32 {
        self.stored_texel(scalar) * self.scale as f32 + self.offset as f32
    }

    /// The texel of a data value, as shaders read it.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, reason = "shaders compute in f32")]
    pub fn stored_texel(&self, scalar: f64) -> f32 {
        let texel = self.texel(scalar);
        match self.format {
            TextureFormat::R8Unorm => f32::from(unorm8(texel)) / 255.0,
            TextureFormat::R16Float => f16::from_f64(texel).to_f32(),
            _ => texel as f32,
        }
    }

    /// The choice of the slot `volume_filter` that can read it: the device's filter, or loads where it has none.
    #[must_use]
    pub fn filter(&self, limits: &Limits) -> &'static str {
        if self.format == TextureFormat::R32Float && !limits.float32_filterable {
            "loads"
        } else {
            "hardware"
        }
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "clamped to a byte"
)]
fn unorm8(texel: f64) -> u8 {
    (texel * 255.0).round().clamp(0.0, 255.0) as u8
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use volgraph_volume::{Grid, Voxels};

    use super::*;

    fn volume(voxels: Voxels) -> Volume {
        let n = u32::try_from(voxels.len()).unwrap();
        Volume::new(
            "test",
            Grid::axis_aligned([n, 1, 1], DVec3::ONE, DVec3::ZERO),
            voxels,
        )
        .unwrap()
    }

    fn encoded(encoding: &Encoding, volume: &Volume) -> Vec<u8> {
        let count = volume.voxels().len();
        let mut bytes = vec![0; count * encoding.texel_len()];
        Encoder::new(*encoding, volume).fill(volume.voxels(), 0..count, &mut bytes);
        bytes
    }

    fn decoded(encoding: &Encoding, bytes: &[u8]) -> Vec<f64> {
        let texels: Vec<f64> = match encoding.format {
            TextureFormat::R8Unorm => bytes.iter().map(|b| f64::from(*b) / 255.0).collect(),
            TextureFormat::R16Float => bytes
                .chunks(2)
                .map(|b| f16::from_le_bytes([b[0], b[1]]).to_f64())
                .collect(),
            _ => bytes
                .chunks(4)
                .map(|b| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]])))
                .collect(),
        };
        // As shaders do, in f32.
        let (scale, offset) = (encoding.scale as f32, encoding.offset as f32);
        texels
            .into_iter()
            .map(|texel| f64::from(texel as f32 * scale + offset) + encoding.reference)
            .collect()
    }

    #[test]
    fn stored_scalars_come_back_within_the_stated_error() {
        let volumes = [
            Voxels::U8((0..=255).collect()),
            Voxels::I16((-1024..=3071).collect()),
            Voxels::I16((-30..30).map(|i| i * 1000).collect()),
            Voxels::U16((0..60).map(|i| i * 1000).collect()),
            Voxels::F32((0..60).map(|i| (i as f32).sin() * 1e-3).collect()),
            Voxels::F64((0..60).map(|i| 1e6 + (i as f64).sin()).collect()),
            Voxels::U64((0..60).map(|i| u64::MAX - i).collect()),
        ];
        for voxels in volumes {
            let volume = volume(voxels);
            for storage in ["auto", "r8unorm", "r16float", "r32float"] {
                let encoding = Encoding::choose(&volume, storage);
                let bytes = encoded(&encoding, &volume);
                for (at, value) in decoded(&encoding, &bytes).into_iter().enumerate() {
                    let truth = volume.voxels().get(at);
                    // Shaders lose up to a part in 10⁶ of the range to f32.
                    let span = encoding.range.1 - encoding.range.0;
                    let allowed = encoding.error * 1.001 + 1e-6 * span;
                    assert!(
                        (value - truth).abs() <= allowed,
                        "{storage} {encoding:?}: {value} for {truth}"
                    );
                }
            }
        }
    }

    #[test]
    fn bytes_and_ct_are_exact_in_half_floats() {
        let ct = volume(Voxels::I16((-1024..=3071).collect()));
        let encoding = Encoding::choose(&ct, "auto");
        assert_eq!(
            (encoding.format, encoding.error),
            (TextureFormat::R16Float, 0.0)
        );
        let wide = volume(Voxels::U16(vec![0, 65535]));
        let encoding = Encoding::choose(&wide, "auto");
        assert_eq!(
            (encoding.format, encoding.error),
            (TextureFormat::R32Float, 0.0)
        );
        assert_eq!(encoding.filter(&Limits::default()), "loads");
        assert!(Encoding::choose(&wide, "r16float").error > 0.0);
    }

    #[test]
    fn what_is_not_a_number_becomes_the_smallest_value() {
        let volume = volume(Voxels::F32(vec![
            f32::NAN,
            -2.0,
            5.0,
            f32::INFINITY,
            f32::NEG_INFINITY,
        ]));
        let encoding = Encoding::choose(&volume, "auto");
        assert_eq!(
            decoded(&encoding, &encoded(&encoding, &volume)),
            [-2.0, -2.0, 5.0, 5.0, -2.0]
        );
    }
}
