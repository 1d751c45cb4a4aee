//! Texels of some voxels at a time: what a volume's texture is filled with, without a copy of the volume.
//!
//! Types of 8 and 16 bits have a table of their values' texels; the others are computed one by one. Both in parallel.

use std::ops::Range;

use half::f16;
use rayon::prelude::*;
use volgraph_volume::{Element, ScalarType, Voxels};
use wgpu_types::TextureFormat;

use super::{Encoding, Scalars, unorm8};

/// Voxels for a thread at a time.
const CHUNK: usize = 1 << 15;

/// The texels of a volume in an encoding.
#[derive(Clone, Debug)]
pub struct Encoder {
    encoding: Encoding,
    scalars: Scalars,
    /// The texel of each value, for types of 8 and 16 bits; as many of its bytes count as the format has.
    table: Vec<[u8; 4]>,
}

impl Encoder {
    /// For the scalars of a volume; its table is made here.
    #[must_use]
    pub fn new(encoding: Encoding, scalars: impl Into<Scalars>) -> Self {
        let scalars = scalars.into();
        let texel = |value: f64| encoding.texel_bytes(&scalars, value);
        let table: Vec<[u8; 4]> = match scalars.ty {
            ScalarType::U8 if encoding.keeps_bytes() => Vec::new(),
            ScalarType::U8 => (0..=u8::MAX).map(|value| texel(value.into())).collect(),
            ScalarType::I8 => (0..=u8::MAX)
                .map(|bits| texel(bits.cast_signed().into()))
                .collect(),
            ScalarType::U16 => (0..=u16::MAX).map(|value| texel(value.into())).collect(),
            ScalarType::I16 => (0..=u16::MAX)
                .map(|bits| texel(bits.cast_signed().into()))
                .collect(),
            _ => Vec::new(),
        };
        Self {
            encoding,
            scalars,
            table,
        }
    }

    /// Writes the texels of the voxels with these numbers, x fastest; `texels` holds exactly as many. What is not finite
    /// is as [`Scalars::drawn`] says.
    pub fn fill(&self, voxels: &Voxels, at: Range<usize>, texels: &mut [u8]) {
        match self.encoding.format {
            TextureFormat::R8Unorm => self.fill_texels::<1>(voxels, at, texels),
            TextureFormat::R16Float => self.fill_texels::<2>(voxels, at, texels),
            _ => self.fill_texels::<4>(voxels, at, texels),
        }
    }

    fn fill_texels<const N: usize>(&self, voxels: &Voxels, at: Range<usize>, texels: &mut [u8]) {
        let one = |value: f64| self.encoding.texel_bytes(&self.scalars, value);
        match voxels {
            Voxels::U8(values) if self.encoding.keeps_bytes() => {
                texels.copy_from_slice(&values[at]);
            }
            Voxels::U8(values) => each::<u8, N>(&values[at], texels, |v| self.known(v.into())),
            Voxels::I8(values) => each::<i8, N>(&values[at], texels, |v| {
                self.known(v.cast_unsigned().into())
            }),
            Voxels::U16(values) => each::<u16, N>(&values[at], texels, |v| self.known(v)),
            Voxels::I16(values) => {
                each::<i16, N>(&values[at], texels, |v| self.known(v.cast_unsigned()));
            }
            Voxels::U32(values) => each::<u32, N>(&values[at], texels, |v| one(v.to_f64())),
            Voxels::I32(values) => each::<i32, N>(&values[at], texels, |v| one(v.to_f64())),
            Voxels::U64(values) => each::<u64, N>(&values[at], texels, |v| one(v.to_f64())),
            Voxels::I64(values) => each::<i64, N>(&values[at], texels, |v| one(v.to_f64())),
            Voxels::F32(values) => each::<f32, N>(&values[at], texels, |v| one(v.to_f64())),
            Voxels::F64(values) => each::<f64, N>(&values[at], texels, one),
        }
    }

    fn known(&self, bits: u16) -> [u8; 4] {
        self.table[usize::from(bits)]
    }
}

fn each<T: Element, const N: usize>(
    values: &[T],
    texels: &mut [u8],
    texel: impl Fn(T) -> [u8; 4] + Sync,
) {
    texels
        .par_chunks_mut(CHUNK * N)
        .zip(values.par_chunks(CHUNK))
        .for_each(|(texels, values)| {
            for (bytes, value) in texels.as_chunks_mut::<N>().0.iter_mut().zip(values) {
                bytes.copy_from_slice(&texel(*value)[..N]);
            }
        });
}

impl Encoding {
    /// Bytes of a texel.
    #[must_use]
    pub fn texel_len(&self) -> usize {
        match self.format {
            TextureFormat::R8Unorm => 1,
            TextureFormat::R16Float => 2,
            _ => 4,
        }
    }

    /// Whether bytes are stored as they are.
    fn keeps_bytes(&self) -> bool {
        self.format == TextureFormat::R8Unorm && self.scale == 255.0
    }

    /// The texel of a data value; as many of its bytes count as the format has.
    #[expect(clippy::cast_possible_truncation, reason = "textures hold f32 at most")]
    fn texel_bytes(&self, scalars: &Scalars, value: f64) -> [u8; 4] {
        let texel = self.texel(scalars.drawn(value));
        match self.format {
            TextureFormat::R8Unorm => [unorm8(texel), 0, 0, 0],
            TextureFormat::R16Float => {
                let [low, high] = f16::from_f64(texel).to_le_bytes();
                [low, high, 0, 0]
            }
            _ => (texel as f32).to_le_bytes(),
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use volgraph_volume::{Grid, Volume};

    use super::*;

    /// All types, over more voxels than one thread takes at a time.
    #[test]
    fn pieces_are_what_each_voxel_is_stored_as() {
        let n = 2 * CHUNK + 123;
        let whole = |i: usize| (i * 7919) % 65536;
        let volumes = [
            Voxels::U8((0..n).map(|i| whole(i) as u8).collect()),
            Voxels::I8((0..n).map(|i| whole(i) as i8).collect()),
            Voxels::U16((0..n).map(|i| whole(i) as u16).collect()),
            Voxels::I16((0..n).map(|i| whole(i) as i16).collect()),
            Voxels::I16((0..n).map(|i| (whole(i) % 4096) as i16 - 1024).collect()),
            Voxels::U32((0..n).map(|i| whole(i) as u32 * 65_536).collect()),
            Voxels::I64((0..n).map(|i| whole(i) as i64 - 5000).collect()),
            Voxels::F32((0..n).map(|i| (whole(i) as f32).ln()).collect()),
            Voxels::F64(
                (0..n)
                    .map(|i| [f64::NAN, 1e9 + whole(i) as f64][i % 2])
                    .collect(),
            ),
        ];
        for voxels in volumes {
            let grid =
                Grid::axis_aligned([u32::try_from(n).unwrap(), 1, 1], DVec3::ONE, DVec3::ZERO);
            let volume = Volume::new("test", grid, voxels).unwrap();
            for storage in ["auto", "r8unorm", "r16float", "r32float"] {
                let encoding = Encoding::choose(&volume, storage);
                let encoder = Encoder::new(encoding, &volume);
                let (from, len) = (77, encoding.texel_len());
                let mut texels = vec![0xaa; (n - from) * len];
                encoder.fill(volume.voxels(), from..n, &mut texels);
                for (at, texel) in texels.chunks(len).enumerate() {
                    let value = volume.voxels().get(from + at);
                    let kind = volume.voxels().scalar_type();
                    let truth = encoding.stored(volume.drawn(value));
                    let texel = match encoding.format {
                        TextureFormat::R8Unorm => f32::from(texel[0]) / 255.0,
                        TextureFormat::R16Float => {
                            f16::from_le_bytes([texel[0], texel[1]]).to_f32()
                        }
                        _ => f32::from_le_bytes([texel[0], texel[1], texel[2], texel[3]]),
                    };
                    let read = texel * encoding.scale as f32 + encoding.offset as f32;
                    assert_eq!(read, truth, "{kind} {storage} {at}: {value}");
                }
            }
        }
    }
}
