//! EXR: all channels as they are, in one layer, so that common viewers open it.
//!
//! Out: `R`, `G`, `B`, `A` and, where the picture has them, `Z`, `opacity.Y` and its layers' channels, all f32, in scan lines packed
//! with ZIP, which loses nothing. In: the first flat layer; f16 and f32 channels.

use std::io::{BufRead, Cursor, Seek};
use std::panic::{AssertUnwindSafe, catch_unwind};

use exr::image::{AnyChannel, AnyChannels, Blocks, Encoding, FlatSamples, Image, Layer};
use exr::meta::attribute::{AttributeValue, LineOrder, Text};
use exr::meta::header::{Header, LayerAttributes};
use exr::prelude::{Compression, ReadChannels as _, ReadLayers as _, SmallVec, WritableImage as _};

use crate::files::check_ratio;
use crate::{KEY_PREFIX, Layer as PictureLayer, LayerValues, Picture, SaveReport, check_size};

const DEPTH: &str = "Z";
const OPACITY: &str = "opacity.Y";
/// Suffixes of a vector layer's channels.
const VECTOR: [&str; 4] = ["X", "Y", "Z", "A"];

type FlatImage = Image<Layer<AnyChannels<FlatSamples>>>;

pub(crate) fn encode(picture: &Picture) -> Result<(Vec<u8>, SaveReport), String> {
    let channel = |name: &str, values: Vec<f32>| AnyChannel::new(name, FlatSamples::F32(values));
    let mut channels: SmallVec<[AnyChannel<FlatSamples>; 4]> = ["R", "G", "B", "A"]
        .iter()
        .enumerate()
        .map(|(i, name)| channel(name, picture.color.iter().map(|color| color[i]).collect()))
        .collect();
    channels.extend(
        picture
            .depth
            .iter()
            .map(|depth| channel(DEPTH, depth.clone())),
    );
    channels.extend(
        picture
            .opacity
            .iter()
            .map(|opacity| channel(OPACITY, opacity.clone())),
    );

    for layer in &picture.layers {
        let named = |suffix: &str| format!("{}.{suffix}", layer.name);
        match &layer.values {
            LayerValues::Scalar(values) => channels.push(channel(&named("Y"), values.clone())),
            LayerValues::Vector(values) => {
                for (i, suffix) in VECTOR.iter().enumerate() {
                    let values = values.iter().map(|value| value[i]).collect();
                    channels.push(channel(&named(suffix), values));
                }
            }
        }
    }

    let mut attributes = LayerAttributes {
        software_name: Some(Text::from("volgraph")),
        ..Default::default()
    };
    for (key, value) in &picture.metadata {
        let key = Text::from(format!("{KEY_PREFIX}{key}").as_str());
        // EXR does not say how its texts are encoded; UTF-8 is what everyone writes.
        let value = Text::from_bytes_unchecked(value.as_bytes().into());
        attributes.other.insert(key, AttributeValue::Text(value));
    }
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let size = (picture.width as usize, picture.height as usize);
    let layer = Layer::new(size, attributes, encoding, AnyChannels::sort(channels));
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer)
        .write()
        .to_buffered(&mut bytes)
        .map_err(|error| error.to_string())?;
    let has_nan = |color: &&[f32; 4]| color.iter().any(|c| c.is_nan());
    let nan_pixels = picture.color.iter().filter(has_nan).count() as u64;
    Ok((
        bytes.into_inner(),
        SaveReport {
            nan_pixels,
            clipped_pixels: 0,
        },
    ))
}

pub(crate) fn decode(reader: impl BufRead + Seek, file_len: u64) -> Result<Picture, String> {
    // The decoder has places where a damaged file meets an `expect`; that must stay this file's error.
    catch_unwind(AssertUnwindSafe(|| read(reader, file_len)))
        .unwrap_or_else(|_| Err("it is damaged".to_owned()))
        .and_then(picture_of)
}

fn read(reader: impl BufRead + Seek, file_len: u64) -> Result<FlatImage, String> {
    let chunks = exr::block::read(reader, true).map_err(|error| error.to_string())?;
    for header in chunks.headers() {
        check_header(header, file_len)?;
    }
    exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .pedantic()
        .from_chunks(chunks)
        .map_err(|error| error.to_string())
}

fn check_header(header: &Header, file_len: u64) -> Result<(), String> {
    let side = |length: usize| u32::try_from(length).unwrap_or(u32::MAX);
    let pixels = check_size(
        side(header.layer_size.width()),
        side(header.layer_size.height()),
    )
    .map_err(|error| error.to_string())?;
    // The decoder gives each channel a full buffer of at most 4 bytes a sample, whatever its sampling.
    check_ratio(
        (pixels as u64).saturating_mul(4 * header.channels.list.len() as u64),
        file_len,
    )
}

fn picture_of(image: FlatImage) -> Result<Picture, String> {
    let Layer {
        mut channel_data,
        size,
        attributes,
        ..
    } = image.layer_data;
    let pixels = size.area();
    let names: Vec<String> = channel_data
        .list
        .iter()
        .map(|channel| channel.name.to_string())
        .collect();
    let mut take = |name: &str| -> Result<Option<Vec<f32>>, String> {
        let Some(at) = channel_data
            .list
            .iter()
            .position(|channel| channel.name.eq(name))
        else {
            return Ok(None);
        };
        let channel = channel_data.list.remove(at);
        let values = match channel.sample_data {
            FlatSamples::F32(values) => values,
            FlatSamples::F16(values) => values.into_iter().map(f32::from).collect(),
            FlatSamples::U32(_) => return Err(format!("its channel {name} holds whole numbers")),
        };
        if channel.sampling.area() != 1 || values.len() != pixels {
            return Err(format!("its channel {name} has fewer samples than pixels"));
        }
        Ok(Some(values))
    };
    let rgb = match (take("R")?, take("G")?, take("B")?, take("Y")?) {
        (Some(r), Some(g), Some(b), _) => [r, g, b],
        (None, None, None, Some(y)) => [y.clone(), y.clone(), y],
        _ => {
            return Err(format!(
                "it has neither R, G, B nor Y; its channels are {}",
                names.join(", ")
            ));
        }
    };
    let alpha = take("A")?;
    let color = (0..pixels)
        .map(|i| {
            [
                rgb[0][i],
                rgb[1][i],
                rgb[2][i],
                alpha.as_ref().map_or(1.0, |alpha| alpha[i]),
            ]
        })
        .collect();
    let metadata = attributes
        .other
        .iter()
        .chain(&image.attributes.other)
        .filter_map(|(key, value)| {
            let key = key.to_string().strip_prefix(KEY_PREFIX)?.to_owned();
            let AttributeValue::Text(value) = value else {
                return None;
            };
            Some((key, String::from_utf8_lossy(value.as_slice()).into_owned()))
        })
        .collect();
    let (depth, opacity) = (take(DEPTH)?, take(OPACITY)?);
    // Whole layers as they are written here; other channels of other software are left alone.
    let mut layers = Vec::new();
    for name in names.iter().filter_map(|name| name.strip_suffix(".Y")) {
        let is_vector = VECTOR
            .iter()
            .all(|suffix| names.contains(&format!("{name}.{suffix}")));
        let is_plain = |b: u8| b.is_ascii_alphanumeric() || b"-_".contains(&b);
        if name == "opacity" || name.is_empty() || name.len() > 64 || !name.bytes().all(is_plain) {
            continue;
        }
        let mut channels = Vec::new();
        for suffix in if is_vector { &VECTOR[..] } else { &["Y"] } {
            channels.extend(take(&format!("{name}.{suffix}"))?);
        }
        let values = match channels.as_slice() {
            [x, y, z, a] => {
                LayerValues::Vector((0..pixels).map(|i| [x[i], y[i], z[i], a[i]]).collect())
            }
            [y] => LayerValues::Scalar(y.clone()),
            _ => continue,
        };
        layers.push(PictureLayer {
            name: name.to_owned(),
            values,
        });
    }
    let side = |length: usize| u32::try_from(length).map_err(|_| "it is too large".to_owned());
    Ok(Picture {
        width: side(size.width())?,
        height: side(size.height())?,
        color,
        depth,
        opacity,
        layers,
        metadata,
    })
}
