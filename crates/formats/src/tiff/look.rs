//! Size and type of a page, and its decoded bytes as values.

use std::io::Seek as _;

use tiff::ColorType;
use tiff::decoder::{ChunkType, Decoder};
use tiff::tags::{CompressionMethod, SampleFormat, Tag};
use volgraph_volume::{ScalarType, Trouble, VolumeError, Voxels};

use super::patched::Source;
use crate::slices::{Codec, plausible, values_of};
use crate::stack::Shape;

/// What must be the same for all slices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Look {
    pub shape: Shape,
    pub bits: u8,
    pub color: ColorType,
    pub format: SampleFormat,
}

pub(super) fn broken(error: &tiff::TiffError) -> VolumeError {
    let trouble = |remedy: &str| Trouble::new(format!("cannot be decoded: {error}"), remedy);
    match error {
        tiff::TiffError::UnsupportedError(_) => VolumeError::Unsupported(trouble(
            "save the file as gray or RGB, uncompressed or with deflate",
        )),
        tiff::TiffError::IoError(io) if io.kind() == std::io::ErrorKind::UnexpectedEof => {
            VolumeError::DataTooShort(trouble("the file is cut off: fetch it again"))
        }
        _ => VolumeError::DataCorrupt(trouble("fetch the file again, or save it anew")),
    }
}

/// Size and type of the decoder's page, held against the bytes that it is made of.
pub(super) fn look(decoder: &mut Decoder<Source<'_>>) -> Result<Look, VolumeError> {
    let failed = |error: tiff::TiffError| broken(&error);
    let (width, height) = decoder.dimensions().map_err(failed)?;
    let color = decoder.colortype().map_err(failed)?;
    let bits = color.bit_depth();
    let channels = u64::from(color.num_samples());
    let formats = decoder
        .find_tag_unsigned_vec::<u16>(Tag::SampleFormat)
        .ok()
        .flatten();
    let format = formats
        .and_then(|formats| formats.first().copied())
        .unwrap_or(1);
    let format = SampleFormat::from_u16_exhaustive(format);
    let unsupported = |cause: String| {
        Err(VolumeError::Unsupported(Trouble::new(
            cause,
            "save the file as gray or RGB of 8, 16, 32 or 64 bits",
        )))
    };
    if matches!(
        color,
        ColorType::CMYK(_) | ColorType::CMYKA(_) | ColorType::Lab(_)
    ) {
        return unsupported(format!("pixels are {color:?}"));
    }
    use ScalarType::{F32, F64, I8, I16, I32, I64, U8, U16, U32, U64};
    let scalar_type = match (format, bits) {
        (SampleFormat::Uint | SampleFormat::Void, 1 | 2 | 4) if channels == 1 => U8,
        (SampleFormat::Uint | SampleFormat::Void, 8) => U8,
        (SampleFormat::Uint | SampleFormat::Void, 16) => U16,
        (SampleFormat::Uint | SampleFormat::Void, 32) => U32,
        (SampleFormat::Uint | SampleFormat::Void, 64) => U64,
        (SampleFormat::Int, 8) => I8,
        (SampleFormat::Int, 16) => I16,
        (SampleFormat::Int, 32) => I32,
        (SampleFormat::Int, 64) => I64,
        (SampleFormat::IEEEFP, 16 | 32) => F32,
        (SampleFormat::IEEEFP, 64) => F64,
        _ => return unsupported(format!("samples of {bits} bits in the format {format:?}")),
    };
    let shape = Shape {
        width,
        height,
        channels,
        scalar_type,
    };
    let compression = decoder
        .find_tag_unsigned::<u16>(Tag::Compression)
        .ok()
        .flatten();
    let codec = match CompressionMethod::from_u16_exhaustive(compression.unwrap_or(1)) {
        CompressionMethod::None => Codec::Stored,
        CompressionMethod::LZW => Codec::Lzw,
        CompressionMethod::Deflate | CompressionMethod::OldDeflate => Codec::Deflate,
        CompressionMethod::PackBits => Codec::Runs,
        CompressionMethod::ModernJPEG | CompressionMethod::JPEG => Codec::Jpeg,
        _ => Codec::Sparse,
    };
    let tag = match decoder.get_chunk_type() {
        ChunkType::Strip => Tag::StripByteCounts,
        ChunkType::Tile => Tag::TileByteCounts,
    };
    let counts = decoder.find_tag_unsigned_vec::<u64>(tag).map_err(failed)?;
    let len = decoder.inner().seek(std::io::SeekFrom::End(0));
    let len = len.map_err(|error| broken(&error.into()))?;
    let encoded = counts
        .unwrap_or_default()
        .iter()
        .fold(0_u64, |sum, &count| sum.saturating_add(count));
    let layout = decoder.image_buffer_layout().map_err(failed)?;
    plausible(codec, encoded.min(len), layout.complete_len as u64)?;
    Ok(Look {
        shape,
        bits,
        color,
        format,
    })
}

impl Look {
    /// Decoded bytes as values: planes woven together, bits taken apart, half floats widened, YCbCr turned to RGB.
    pub fn values(&self, bytes: &[u8], planes: usize) -> Voxels {
        let big = cfg!(target_endian = "big");
        let channels = self.shape.channels as usize;
        let woven;
        let bytes = if planes > 1 && planes == channels {
            let size = usize::from(self.bits / 8).max(1);
            woven = weave(bytes, planes, size);
            &woven
        } else {
            bytes
        };
        if self.bits < 8 {
            return Voxels::U8(unpack(bytes, self.shape.width as usize, self.bits));
        }
        if (self.format, self.bits) == (SampleFormat::IEEEFP, 16) {
            let halves = bytes.chunks_exact(2);
            let halves = halves.map(|pair| half::f16::from_ne_bytes([pair[0], pair[1]]).to_f32());
            return Voxels::F32(halves.collect());
        }
        let values = values_of(bytes, self.shape.scalar_type, big);
        match (self.color, values) {
            (ColorType::YCbCr(8), Voxels::U8(mut values)) => {
                values.as_chunks_mut().0.iter_mut().for_each(rgb_of_ycbcr);
                Voxels::U8(values)
            }
            (_, values) => values,
        }
    }
}

/// Full-range YCbCr of Rec. 601, as JPEG has it.
pub(crate) fn rgb_of_ycbcr(pixel: &mut [u8; 3]) {
    let [y, cb, cr] = pixel.map(f64::from);
    let (cb, cr) = (cb - 128.0, cr - 128.0);
    let rgb = [
        y + 1.402 * cr,
        y - 0.344_136 * cb - 0.714_136 * cr,
        y + 1.772 * cb,
    ];
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to a byte"
    )]
    let bytes = rgb.map(|value| value.round().clamp(0.0, 255.0) as u8);
    *pixel = bytes;
}

/// Planes one behind the other to values one beside the other.
pub(crate) fn weave(bytes: &[u8], planes: usize, size: usize) -> Vec<u8> {
    let plane = bytes.len() / planes / size * size;
    let mut woven = Vec::with_capacity(plane * planes);
    for at in (0..plane).step_by(size) {
        for index in 0..planes {
            woven.extend_from_slice(&bytes[index * plane + at..][..size]);
        }
    }
    woven
}

/// Rows of 1, 2 or 4 bits per value, each row beginning with a byte, the highest bits first.
fn unpack(bytes: &[u8], width: usize, bits: u8) -> Vec<u8> {
    let row = (width * usize::from(bits)).div_ceil(8).max(1);
    let in_byte = usize::from(8 / bits);
    let value = |row: &[u8], x: usize| {
        let shift = 8 - bits - bits * (x % in_byte) as u8;
        row[x / in_byte] >> shift & ((1_u16 << bits) - 1) as u8
    };
    let rows = bytes.chunks_exact(row);
    rows.flat_map(|row| (0..width).map(move |x| value(row, x)))
        .collect()
}
