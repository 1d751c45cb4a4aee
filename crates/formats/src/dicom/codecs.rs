//! From the pixels of a frame, native or compressed, to values of the stored type.
//!
//! JPEG is decoded by `jpeg-decoder`, JPEG 2000 by `hayro-jpeg2000`, runs here. What comes out is as many bits as the
//! file stores: bits beside them (overlays of old files) are cut off, and the sign is carried to the full width.

use hayro_jpeg2000::{DecodeSettings, DecoderContext};
use jpeg_decoder::ColorTransform;
use volgraph_volume::{ScalarType, Trouble, VolumeError, Voxels};

use super::dataset::{BIG_ENDIAN, EXPLICIT, IMPLICIT, Pixels, Samples};
use super::image::Image;
use crate::input::Input;
use crate::slices::{Codec, guarded, plausible, values_of};
use crate::stack::decode_jpeg_stream;
use crate::tiff::{rgb_of_ycbcr, weave};

/// The codec of a transfer syntax.
pub(super) fn codec_of(syntax: &str) -> Result<Codec, VolumeError> {
    let name = match syntax {
        IMPLICIT | EXPLICIT | BIG_ENDIAN | "1.2.840.10008.1.2.1.98" => return Ok(Codec::Stored),
        "1.2.840.10008.1.2.5" => return Ok(Codec::Runs),
        "1.2.840.10008.1.2.4.50"
        | "1.2.840.10008.1.2.4.51"
        | "1.2.840.10008.1.2.4.57"
        | "1.2.840.10008.1.2.4.70" => return Ok(Codec::Jpeg),
        "1.2.840.10008.1.2.4.90" | "1.2.840.10008.1.2.4.91" => return Ok(Codec::Sparse),
        "1.2.840.10008.1.2.4.80" | "1.2.840.10008.1.2.4.81" => "JPEG-LS",
        "1.2.840.10008.1.2.4.92" | "1.2.840.10008.1.2.4.93" => "JPEG 2000 part 2",
        "1.2.840.10008.1.2.4.201" | "1.2.840.10008.1.2.4.202" | "1.2.840.10008.1.2.4.203" => {
            "high-throughput JPEG 2000"
        }
        "1.2.840.10008.1.2.4.110" | "1.2.840.10008.1.2.4.111" | "1.2.840.10008.1.2.4.112" => {
            "JPEG XL"
        }
        other => other,
    };
    Err(VolumeError::Unsupported(Trouble::new(
        format!("the pixels are compressed with {name}, which is not read here"),
        "decompress the series, as with `gdcmconv --raw` or `dcmdjpls`",
    )))
}

fn corrupt(cause: String) -> VolumeError {
    VolumeError::DataCorrupt(Trouble::new(
        cause,
        "fetch the file again, or decompress the series",
    ))
}

/// The values of a frame, samples fastest.
pub(super) fn decode(
    input: &Input<'_>,
    image: &Image,
    frame: usize,
) -> Result<Voxels, VolumeError> {
    let big_endian = image.syntax == BIG_ENDIAN;
    let count = image.rows as usize * image.columns as usize * image.samples as usize;
    let size = (image.allocated as usize / 8).max(1);
    let (bytes, big_endian) = match &image.pixels {
        Pixels::Native { offset, .. } => {
            let from = frame as u64 * image.frame_bits();
            let to = from + image.frame_bits();
            let begin = from / 8;
            let bytes = input.bytes_at(offset + begin, to.div_ceil(8) - begin)?;
            if image.allocated == 1 {
                // The lowest bit first; a frame may begin within a byte.
                let skip = (from % 8) as usize;
                let bit = |i: usize| bytes[(skip + i) / 8] >> ((skip + i) % 8) & 1;
                return Ok(Voxels::U8((0..count).map(bit).collect()));
            }
            let woven = image.planar && image.samples > 1;
            let bytes = if woven {
                weave(&bytes, image.samples as usize, size)
            } else {
                bytes
            };
            (bytes, big_endian)
        }
        Pixels::Fragments { starts, parts } => {
            let encoded = fragments_of(input, image, starts, parts, frame)?;
            match codec_of(&image.syntax)? {
                Codec::Runs => {
                    let planes = runs(&encoded, image)?;
                    // Each byte of each sample is a plane, the highest byte first.
                    (weave_runs(&planes, image.samples as usize, size), false)
                }
                Codec::Stored => (encoded, false),
                codec => {
                    plausible(codec, encoded.len() as u64, image.frame_bits() / 8)?;
                    let values = guarded("pixel", || match codec {
                        Codec::Jpeg => jpeg(&encoded, image),
                        _ => jpeg_2000(&encoded, image),
                    })?;
                    if values.len() != count {
                        return Err(corrupt(format!(
                            "a frame is decoded to {} values, {count} are needed",
                            values.len()
                        )));
                    }
                    return Ok(finish(values, image, true));
                }
            }
        }
    };
    let unsigned = match (image.kind, image.allocated) {
        (Samples::Floats, _) => ScalarType::F32,
        (Samples::Doubles, _) => ScalarType::F64,
        (_, 32) => ScalarType::U32,
        (_, 16) => ScalarType::U16,
        _ => ScalarType::U8,
    };
    Ok(finish(
        values_of(&bytes, unsigned, big_endian),
        image,
        false,
    ))
}

/// The compressed bytes of a frame.
fn fragments_of(
    input: &Input<'_>,
    image: &Image,
    starts: &[u64],
    parts: &[(u64, u64)],
    frame: usize,
) -> Result<Vec<u8>, VolumeError> {
    let frames = image.frames.len();
    let of_frame: Vec<(u64, u64)> = if frames == 1 {
        parts.to_vec()
    } else if parts.len() == frames {
        vec![parts[frame]]
    } else if starts.len() == frames {
        // Offsets count from the first fragment's header, eight bytes before it.
        let first = parts.first().map_or(0, |(at, _)| *at);
        let begin = first + starts[frame];
        let end = starts
            .get(frame + 1)
            .map_or(u64::MAX, |start| first + start);
        parts
            .iter()
            .filter(|(at, _)| (begin..end).contains(at))
            .copied()
            .collect()
    } else {
        return Err(VolumeError::Unsupported(Trouble::new(
            format!(
                "{} fragments of pixels, and no table that says which of {frames} frames they are",
                parts.len()
            ),
            "decompress the series, as with `gdcmconv --raw`",
        )));
    };
    let mut bytes = Vec::new();
    for (at, len) in of_frame {
        bytes.append(&mut input.bytes_at(at, len)?);
    }
    Ok(bytes)
}

/// Bits that the file does not store are cut off, the sign is carried on, and YBR becomes RGB.
fn finish(values: Voxels, image: &Image, decoded: bool) -> Voxels {
    // Decoders put the lowest stored bit at the bottom.
    let shift = if decoded {
        0
    } else {
        image.high_bit + 1 - image.stored
    };
    let unused = image.allocated - image.stored;
    macro_rules! fix {
        ($values:expr, $signed:ty, $type:ident, $signed_type:ident) => {{
            let mut values = $values;
            if unused > 0 {
                values
                    .iter_mut()
                    .for_each(|value| *value = *value >> shift << unused >> unused);
            }
            if image.signed {
                let carry = |value: $signed| {
                    if unused > 0 {
                        value << unused >> unused
                    } else {
                        value
                    }
                };
                let signed = values.iter().map(|&value| carry(value.cast_signed()));
                Voxels::$signed_type(signed.collect())
            } else {
                Voxels::$type(values)
            }
        }};
    }
    match values {
        Voxels::U8(mut values) => {
            let full = image.photometric == "YBR_FULL" && image.samples == 3 && !decoded;
            if full {
                values.as_chunks_mut().0.iter_mut().for_each(rgb_of_ycbcr);
            }
            fix!(values, i8, U8, I8)
        }
        Voxels::U16(values) => fix!(values, i16, U16, I16),
        Voxels::U32(values) => fix!(values, i32, U32, I32),
        other => other,
    }
}

/// The segments of runs, one behind the other. Source: DICOM part 5, annex G.
fn runs(encoded: &[u8], image: &Image) -> Result<Vec<u8>, VolumeError> {
    let word = |at: usize| -> Option<usize> {
        let four = encoded.get(at..at + 4)?;
        Some(u32::from_le_bytes([four[0], four[1], four[2], four[3]]) as usize)
    };
    let segments = (image.samples * image.allocated / 8) as usize;
    if word(0) != Some(segments) {
        return Err(corrupt(format!("the runs are not in {segments} segments")));
    }
    let each = image.rows as usize * image.columns as usize;
    plausible(Codec::Runs, encoded.len() as u64, (each * segments) as u64)?;
    let mut planes = Vec::with_capacity(each * segments);
    for segment in 0..segments {
        let begin = word(4 + 4 * segment).unwrap_or(usize::MAX);
        let mut rest = encoded.get(begin..).unwrap_or(&[]);
        let end = (segment + 1) * each;
        while planes.len() < end {
            let room = end - planes.len();
            match rest {
                [count @ 0..=127, after @ ..] if after.len() > usize::from(*count) => {
                    let (run, after) = after.split_at(usize::from(*count) + 1);
                    planes.extend_from_slice(&run[..run.len().min(room)]);
                    rest = after;
                }
                [128, after @ ..] => rest = after,
                [count @ 129..=255, value, after @ ..] => {
                    let count = 257 - usize::from(*count);
                    planes.resize(planes.len() + count.min(room), *value);
                    rest = after;
                }
                _ => {
                    return Err(VolumeError::DataTooShort(Trouble::new(
                        format!(
                            "a segment of runs ends after {} of {each} bytes",
                            planes.len() + each - end
                        ),
                        "the file is cut off: fetch it again",
                    )));
                }
            }
        }
    }
    Ok(planes)
}

/// Planes of bytes, the highest byte of a sample first, to little-endian samples beside each other.
fn weave_runs(planes: &[u8], samples: usize, size: usize) -> Vec<u8> {
    let each = planes.len() / (samples * size).max(1);
    let mut bytes = Vec::with_capacity(planes.len());
    for pixel in 0..each {
        for sample in 0..samples {
            let byte = |byte: usize| planes[(sample * size + size - 1 - byte) * each + pixel];
            bytes.extend((0..size).map(byte));
        }
    }
    bytes
}

/// Eight bits in a type of sixteen.
fn widen(values: Voxels, image: &Image) -> Voxels {
    match values {
        Voxels::U8(values) if image.allocated == 16 => {
            Voxels::U16(values.into_iter().map(u16::from).collect())
        }
        Voxels::U16(values) if image.allocated == 32 => {
            Voxels::U32(values.into_iter().map(u32::from).collect())
        }
        other => other,
    }
}

fn jpeg(encoded: &[u8], image: &Image) -> Result<Voxels, VolumeError> {
    let mut decoder = jpeg_decoder::Decoder::new(encoded);
    if image.samples == 3 && image.photometric == "RGB" {
        decoder.set_color_transform(ColorTransform::RGB);
    } else if image.samples == 3 {
        decoder.set_color_transform(ColorTransform::YCbCr);
    }
    let values = decode_jpeg_stream(decoder, encoded.len() as u64)?;
    Ok(widen(values, image))
}

fn jpeg_2000(encoded: &[u8], image: &Image) -> Result<Voxels, VolumeError> {
    let failed = |error: &dyn std::fmt::Debug| corrupt(format!("JPEG 2000: {error:?}"));
    // The decoder makes all components before it tells how many there are.
    let count = siz(encoded).get(40..42);
    let count = count.map_or(0, |two| u32::from(two[0]) << 8 | u32::from(two[1]));
    if count > image.samples {
        return Err(corrupt(format!("a frame has {count} components")));
    }
    let settings = DecodeSettings::default();
    let picture = hayro_jpeg2000::Image::new(encoded, &settings).map_err(|e| failed(&e))?;
    if (picture.width(), picture.height()) != (image.columns, image.rows) {
        return Err(corrupt(format!(
            "a frame is compressed as {}×{} pixels, the file says {}×{}",
            picture.width(),
            picture.height(),
            image.columns,
            image.rows
        )));
    }
    let mut context = DecoderContext::default();
    let decoded = picture.decode(&mut context).map_err(|e| failed(&e))?;
    let components = decoded.components();
    if components.len() != image.samples as usize {
        return Err(corrupt(format!(
            "a frame has {} components",
            components.len()
        )));
    }
    let count = image.rows as usize * image.columns as usize;
    if components
        .iter()
        .any(|component| component.samples().len() != count)
    {
        return Err(corrupt("a component of a frame has another size".into()));
    }
    // The decoder adds half of the range whether the samples are signed or not.
    let signed = signed_components(encoded);
    let offset = |depth: u8| {
        if signed {
            0.5 * f32::from(depth).exp2()
        } else {
            0.0
        }
    };
    let mut values = Vec::with_capacity(count * components.len());
    for pixel in 0..count {
        for component in components {
            let value = component.samples()[pixel] - offset(component.bit_depth());
            values.push(value.round());
        }
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the bits of a negative number are wanted; others were clamped by the decoder"
    )]
    Ok(match image.allocated {
        8 => Voxels::U8(values.iter().map(|&value| value as i32 as u8).collect()),
        16 => Voxels::U16(values.iter().map(|&value| value as i32 as u16).collect()),
        _ => Voxels::U32(values.iter().map(|&value| value as i64 as u32).collect()),
    })
}

/// A code stream from its start, with the SIZ segment: the number of components stands at 40, their depths from 42 on.
fn siz(encoded: &[u8]) -> &[u8] {
    let start = encoded
        .windows(4)
        .position(|four| four == [0xff, 0x4f, 0xff, 0x51]);
    start.map_or(&[], |start| &encoded[start..])
}

/// Whether the first component of a code stream is signed: the highest bit of its depth.
fn signed_components(encoded: &[u8]) -> bool {
    siz(encoded).get(42).is_some_and(|depth| depth & 0x80 != 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_woven_to_little_endian_samples() {
        assert_eq!(weave_runs(&[1, 2, 3, 4], 1, 2), [3, 1, 4, 2]);
        assert_eq!(weave_runs(&[1, 2, 3, 4, 5, 6], 3, 1), [1, 3, 5, 2, 4, 6]);
    }
}
