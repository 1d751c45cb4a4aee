//! PNG: linear premultiplied colour to sRGB codes and back.
//!
//! Out: where every alpha is 1 (within 1e-6) the file has RGB, else RGBA, for which the colour is divided by
//! its alpha first, as PNG wants it; then each component is clamped, encoded and rounded to the nearest code.
//! An sRGB chunk says what the codes mean. In: palette, gray and low bits are expanded, codes are decoded with
//! the same curve and multiplied by alpha. Alpha is linear in both directions.

use std::io::{BufRead, Seek, Write};

use png::{
    BitDepth, ColorType, Compression, Decoder, Encoder, Limits, SrgbRenderingIntent,
    Transformations,
};

use crate::files::check_ratio;
use crate::srgb::{code_from_linear, linear_from_srgb, srgb_from_linear};
use crate::{KEY_PREFIX, Picture, PngBits, SaveOptions, SaveReport, check_size};

/// Alphas this near to 1 are opaque: f32 compositing does not end at 1 exactly.
const OPAQUE: f32 = 1.0 - 1e-6;

/// Excess over the range of 0 to 1 that is rounding, not clipping.
const SLACK: f64 = 1e-5;

/// Most memory that text chunks and a row may take while decoding.
const MAX_DECODER_BYTES: usize = 64 << 20;

pub(crate) fn encode(
    picture: &Picture,
    options: SaveOptions,
) -> Result<(Vec<u8>, SaveReport), String> {
    let has_alpha = !is_opaque(picture);
    let (data, report) = codes(picture, options.png_bits, has_alpha);
    let bytes = write(picture, options, has_alpha, &data).map_err(|error| error.to_string())?;
    Ok((bytes, report))
}

fn is_opaque(picture: &Picture) -> bool {
    picture.color.iter().all(|color| color[3] >= OPAQUE)
}

/// The codes of all pixels, row by row, as PNG has them: RGB, or RGBA where alpha is asked for.
pub(crate) fn codes(picture: &Picture, bits: PngBits, has_alpha: bool) -> (Vec<u8>, SaveReport) {
    let is_opaque = is_opaque(picture);
    let channels = if has_alpha { 4 } else { 3 };
    let code_bytes = match bits {
        PngBits::Eight => 1,
        PngBits::Sixteen => 2,
    };
    let mut data = Vec::with_capacity(picture.color.len() * channels * code_bytes);
    let mut report = SaveReport::default();
    for &color in &picture.color {
        let (linear, alpha, pixel) = straight(color, is_opaque);
        report.nan_pixels += u64::from(pixel.has_nan);
        report.clipped_pixels += u64::from(pixel.is_clipped);
        match bits {
            PngBits::Eight => {
                data.extend(linear.map(code_from_linear));
                if has_alpha {
                    data.push((alpha * 255.0).round() as u8);
                }
            }
            PngBits::Sixteen => {
                let [r, g, b] = linear.map(srgb_from_linear);
                for component in &[r, g, b, alpha][..channels] {
                    data.extend(((component * 65_535.0).round() as u16).to_be_bytes());
                }
            }
        }
    }
    (data, report)
}

struct PixelReport {
    has_nan: bool,
    is_clipped: bool,
}

/// Linear components of 0 to 1, no longer premultiplied, and alpha.
fn straight(color: [f32; 4], is_opaque: bool) -> ([f64; 3], f64, PixelReport) {
    let has_nan = color.iter().any(|c| c.is_nan());
    let [red, green, blue, alpha] = color.map(|c| if c.is_nan() { 0.0 } else { f64::from(c) });
    let held = alpha.clamp(0.0, 1.0);
    let mut is_clipped = (alpha - held).abs() > SLACK;
    let components = [red, green, blue].map(|component| {
        let straight = match held {
            _ if is_opaque => component,
            0.0 if component == 0.0 => 0.0,
            // Light without alpha: PNG has no code for it.
            0.0 => f64::INFINITY.copysign(component),
            _ => component / held,
        };
        is_clipped |= !(-SLACK..=1.0 + SLACK).contains(&straight);
        straight.clamp(0.0, 1.0)
    });
    (
        components,
        held,
        PixelReport {
            has_nan,
            is_clipped,
        },
    )
}

fn write(
    picture: &Picture,
    options: SaveOptions,
    has_alpha: bool,
    data: &[u8],
) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = encoder(&mut bytes, picture, options.png_bits, has_alpha)?;
    if options.is_live {
        encoder.set_compression(Compression::Fast);
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(data)?;
    writer.finish()?;
    Ok(bytes)
}

/// An encoder for the codes of a picture, with its metadata.
pub(crate) fn encoder<W: Write>(
    to: W,
    picture: &Picture,
    bits: PngBits,
    has_alpha: bool,
) -> Result<Encoder<'static, W>, png::EncodingError> {
    let mut encoder = Encoder::new(to, picture.width, picture.height);
    encoder.set_color(if has_alpha {
        ColorType::Rgba
    } else {
        ColorType::Rgb
    });
    encoder.set_depth(match bits {
        PngBits::Eight => BitDepth::Eight,
        PngBits::Sixteen => BitDepth::Sixteen,
    });
    encoder.set_source_srgb(SrgbRenderingIntent::RelativeColorimetric);
    for (key, value) in &picture.metadata {
        encoder.add_itxt_chunk(format!("{KEY_PREFIX}{key}"), value.clone())?;
    }
    Ok(encoder)
}

pub(crate) fn decode(reader: impl BufRead + Seek, file_len: u64) -> Result<Picture, String> {
    let mut decoder = Decoder::new_with_limits(
        reader,
        Limits {
            bytes: MAX_DECODER_BYTES,
        },
    );
    decoder.set_transformations(Transformations::EXPAND);
    let header = decoder
        .read_header_info()
        .map_err(|error| error.to_string())?;
    let (width, height) = (header.width, header.height);
    let pixels = check_size(width, height).map_err(|error| error.to_string())?;
    let row_bytes = header.raw_row_length() as u64;
    check_ratio(row_bytes * u64::from(height), file_len)?;

    let mut reader = decoder.read_info().map_err(|error| error.to_string())?;
    let is_linear = reader.info().srgb.is_none()
        && reader
            .info()
            .gama_chunk
            .is_some_and(|gamma| !(0.44..0.47).contains(&gamma.into_value()));
    if is_linear {
        return Err("its gamma is not that of sRGB; convert it to sRGB".to_owned());
    }
    let size = reader
        .output_buffer_size()
        .ok_or("it is too large for this machine")?;
    let mut data = vec![0; size];
    let frame = reader
        .next_frame(&mut data)
        .map_err(|error| error.to_string())?;
    reader.finish().map_err(|error| error.to_string())?;
    data.truncate(frame.buffer_size());

    let color = match frame.bit_depth {
        BitDepth::Sixteen => {
            let codes = data
                .as_chunks()
                .0
                .iter()
                .map(|code| u16::from_be_bytes(*code));
            colors(codes, 65_535, frame.color_type, pixels)
        }
        _ => colors(
            data.iter().copied().map(u16::from),
            255,
            frame.color_type,
            pixels,
        ),
    };
    if color.len() != pixels {
        return Err(format!(
            "it has {} pixels where {pixels} belong",
            color.len()
        ));
    }
    Ok(Picture {
        width,
        height,
        color,
        metadata: metadata(reader.info()),
        ..Picture::default()
    })
}

fn colors(
    codes: impl Iterator<Item = u16>,
    max: u16,
    kind: ColorType,
    pixels: usize,
) -> Vec<[f32; 4]> {
    // Few codes and many pixels: each code is decoded once.
    let unit = |code: u16| f64::from(code) / f64::from(max);
    let linear: Vec<f64> = (0..=max).map(|code| linear_from_srgb(unit(code))).collect();
    let (channels, has_alpha) = match kind {
        ColorType::Grayscale => (1, false),
        ColorType::GrayscaleAlpha => (2, true),
        // EXPAND leaves no palette.
        ColorType::Rgb | ColorType::Indexed => (3, false),
        ColorType::Rgba => (4, true),
    };
    let mut color = Vec::with_capacity(pixels);
    let mut pixel = Vec::with_capacity(channels);
    for code in codes {
        pixel.push(code);
        if pixel.len() == channels {
            let alpha = if has_alpha {
                unit(pixel[channels - 1])
            } else {
                1.0
            };
            let at = |i: usize| {
                let i = if channels < 3 { 0 } else { i };
                (linear[usize::from(pixel[i])] * alpha) as f32
            };
            color.push([at(0), at(1), at(2), alpha as f32]);
            pixel.clear();
        }
    }
    color
}

/// Our own keys; texts that cannot be unpacked are somebody else's.
fn metadata(info: &png::Info<'_>) -> Vec<(String, String)> {
    let international = info
        .utf8_text
        .iter()
        .map(|chunk| (&chunk.keyword, chunk.get_text().ok()));
    let latin = info
        .uncompressed_latin1_text
        .iter()
        .map(|chunk| (&chunk.keyword, Some(chunk.text.clone())));
    international
        .chain(latin)
        .filter_map(|(keyword, text)| Some((keyword.strip_prefix(KEY_PREFIX)?.to_owned(), text?)))
        .collect()
}
