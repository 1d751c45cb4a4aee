//! The pages of a TIFF file: their directories are walked through once, and each page is decoded on its own.

use tiff::ColorType;
use tiff::decoder::{ChunkType, Decoder, Limits};
use tiff::tags::{CompressionMethod, SampleFormat, Tag};
use volgraph_volume::{ScalarType, Trouble, VolumeError, Voxels};

use super::patched::Patched;
use crate::input::{BufReadSeek, Input};
use crate::slices::{Codec, plausible, values_of};
use crate::stack::Shape;

/// Most pages of a file.
const MOST_PAGES: usize = 1_000_000;
/// Photometric interpretations by their numbers.
const WHITE_IS_ZERO: u64 = 0;
const PALETTE: u64 = 3;

type Source<'a> = Patched<Box<dyn BufReadSeek + 'a>>;

/// A file whose directories were read.
pub(super) struct Pages<'a> {
    pub input: Input<'a>,
    /// Pages that are like the first one.
    pages: Vec<Page>,
    /// Pages that lie one behind the other in ImageJ's manner: offset of the first, and how many.
    raw: Option<(u64, usize)>,
    pub big_endian: bool,
    /// What the first page says of itself.
    pub description: Option<String>,
    /// Pixels per unit along x and y.
    pub resolution: [Option<f64>; 2],
    /// 1 for none, 2 for inches, 3 for centimetres.
    pub resolution_unit: u64,
    pub warnings: Vec<String>,
}

/// What must be the same for all slices.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Look {
    shape: Shape,
    bits: u8,
    color: ColorType,
    format: SampleFormat,
}

#[derive(Clone, Debug)]
struct Page {
    /// Where its directory lies.
    directory: u64,
    look: Look,
    /// Where the number of its photometric interpretation lies, if it is to be read as "zero is black".
    as_black_is_zero: Option<u64>,
}

fn broken(error: &tiff::TiffError) -> VolumeError {
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

/// Byte order and the bytes of an offset.
fn head_of(input: &Input<'_>) -> Result<(bool, bool), VolumeError> {
    let head = input.head(4)?;
    let big_endian = head.starts_with(b"MM");
    let big_tiff = head.contains(&43);
    Ok((big_endian, big_tiff))
}

fn number(bytes: &[u8], big_endian: bool) -> u64 {
    let fold = |value: u64, byte: &u8| value << 8 | u64::from(*byte);
    if big_endian {
        bytes.iter().fold(0, fold)
    } else {
        bytes.iter().rev().fold(0, fold)
    }
}

impl<'a> Pages<'a> {
    pub fn of(input: &Input<'a>) -> Result<Self, VolumeError> {
        let (big_endian, big_tiff) = head_of(input)?;
        let mut file = Self {
            input: input.clone(),
            pages: Vec::new(),
            raw: None,
            big_endian,
            description: None,
            resolution: [None; 2],
            resolution_unit: 2,
            warnings: Vec::new(),
        };
        let (mut others, mut chunks) = (0_usize, 0_u64);
        let mut directory = {
            let at = if big_tiff { 8 } else { 4 };
            number(&input.bytes_at(at, at)?, big_endian)
        };
        let mut seen = std::collections::HashSet::new();
        let mut directories = 0_u64;
        while directory != 0 {
            if !seen.insert(directory) || seen.len() > MOST_PAGES {
                return Err(VolumeError::DataCorrupt(Trouble::new(
                    "the directories of the pages go round in a circle, or are more than a million",
                    "fetch the file again, or save it anew",
                )));
            }
            let entries = Entries::read(input, directory, big_endian, big_tiff)?;
            directories += entries.size;
            if directories > input.len {
                return Err(VolumeError::DataCorrupt(Trouble::new(
                    "the directories of the pages overlap",
                    "fetch the file again, or save it anew",
                )));
            }
            let page = file.page(&entries, &mut chunks)?;
            match (file.pages.first(), page) {
                (None, Some(page)) => {
                    file.note_first(&page, &entries)?;
                    file.pages.push(page);
                }
                (Some(first), Some(page)) if first.look == page.look => file.pages.push(page),
                _ => others += 1,
            }
            directory = entries.next;
        }
        let Some(first) = file.pages.first() else {
            return Err(VolumeError::DataCorrupt(Trouble::new(
                "the file has no page of full size",
                "save it anew with at least one page",
            )));
        };
        if others > 0 {
            let (pages, are) = if others == 1 {
                ("page", "is")
            } else {
                ("pages", "are")
            };
            let shape = first.look.shape.describe();
            file.warnings.push(format!(
                "{others} {pages} of another size or type than {shape} (thumbnails?) {are} passed over"
            ));
        }
        Ok(file)
    }

    /// The page of a directory; `None` for a smaller copy of another page.
    fn page(&self, entries: &Entries, chunks: &mut u64) -> Result<Option<Page>, VolumeError> {
        if entries
            .value(Tag::NewSubfileType)
            .is_some_and(|kind| kind & 1 != 0)
        {
            return Ok(None);
        }
        let photometric = entries.value(Tag::PhotometricInterpretation);
        let as_stored = matches!(photometric, Some(WHITE_IS_ZERO | PALETTE));
        let mut page = Page {
            directory: entries.at,
            look: Look {
                shape: Shape {
                    width: 0,
                    height: 0,
                    channels: 1,
                    scalar_type: ScalarType::U8,
                },
                bits: 8,
                color: ColorType::Gray(8),
                format: SampleFormat::Uint,
            },
            as_black_is_zero: entries
                .offset(Tag::PhotometricInterpretation)
                .filter(|_| as_stored),
        };
        let mut decoder = self.decoder(&page)?;
        // Each strip or tile is a byte at least: forged directories that share endless lists are not all read.
        let count = match decoder.get_chunk_type() {
            ChunkType::Strip => decoder.strip_count(),
            ChunkType::Tile => decoder.tile_count(),
        };
        *chunks += u64::from(count.map_err(|error| broken(&error))?);
        if *chunks > self.input.len {
            return Err(VolumeError::DataCorrupt(Trouble::new(
                format!(
                    "the pages have more strips than the file has bytes ({})",
                    self.input.len
                ),
                "fetch the file again, or save it anew",
            )));
        }
        page.look = look(&mut decoder)?;
        Ok(Some(page))
    }

    fn note_first(&mut self, page: &Page, entries: &Entries) -> Result<(), VolumeError> {
        match entries.value(Tag::PhotometricInterpretation) {
            Some(WHITE_IS_ZERO) => self.warnings.push(
                "the pages say that zero is white; the values are taken as they are stored".into(),
            ),
            Some(PALETTE) => self.warnings.push(
                "the pages have a palette of colours; the values are the numbers in it".into(),
            ),
            _ => {}
        }
        let mut decoder = self.decoder(page)?;
        let text = decoder.find_tag(Tag::ImageDescription).ok().flatten();
        self.description = text.and_then(|value| match value {
            tiff::decoder::ifd::Value::Ascii(text) => Some(text),
            other => {
                let bytes = other.into_u8_vec().ok()?;
                Some(String::from_utf8_lossy(&bytes).into_owned())
            }
        });
        for (resolution, tag) in self
            .resolution
            .iter_mut()
            .zip([Tag::XResolution, Tag::YResolution])
        {
            let value = decoder.find_tag(tag).ok().flatten();
            *resolution = value
                .and_then(|value| match value {
                    tiff::decoder::ifd::Value::Rational(a, b) => Some(f64::from(a) / f64::from(b)),
                    other => other.into_f64().ok(),
                })
                .filter(|value| value.is_finite() && *value > 0.0);
        }
        self.resolution_unit = entries.value(Tag::ResolutionUnit).unwrap_or(2);
        Ok(())
    }

    /// A decoder whose first directory is that of the page.
    fn decoder(&self, page: &Page) -> Result<Decoder<Source<'a>>, VolumeError> {
        let (big_endian, big_tiff) = head_of(&self.input)?;
        let in_order = |value: u64, size: usize| {
            let bytes = value.to_be_bytes()[8 - size..].to_vec();
            if big_endian {
                bytes
            } else {
                bytes.into_iter().rev().collect()
            }
        };
        let mut patches = vec![if big_tiff {
            (8, in_order(page.directory, 8))
        } else {
            (4, in_order(page.directory, 4))
        }];
        if let Some(at) = page.as_black_is_zero {
            patches.push((at, in_order(1, 2)));
        }
        let source = Patched {
            reader: self.input.open_seek()?,
            at: 0,
            patches,
        };
        let mut limits = Limits::default();
        limits.ifd_value_size = usize::try_from(self.input.len).unwrap_or(usize::MAX);
        let decoder = Decoder::new(source).map_err(|error| broken(&error))?;
        Ok(decoder.with_limits(limits))
    }

    pub fn shape(&self) -> Shape {
        self.pages[0].look.shape
    }

    /// Whether the values of a pixel are gray and alpha, red, green, blue and alpha.
    pub fn is_color(&self) -> bool {
        use ColorType::{GrayA, RGB, RGBA, YCbCr};
        matches!(
            self.pages[0].look.color,
            RGB(_) | RGBA(_) | YCbCr(_) | GrayA(_)
        )
    }

    pub fn count(&self) -> usize {
        self.raw.map_or(self.pages.len(), |(_, count)| count)
    }

    /// Takes `count` pages that lie behind the first one without directories, as ImageJ writes them where a file is
    /// larger than 4 GiB; `false` where they do not.
    pub fn lie_behind_the_first(&mut self, count: usize) -> Result<bool, VolumeError> {
        let [page] = self.pages.as_slice() else {
            return Ok(false);
        };
        let mut decoder = self.decoder(page)?;
        let number = |decoder: &mut Decoder<Source<'a>>, tag| {
            let values = decoder.find_tag_unsigned_vec::<u64>(tag).ok().flatten();
            values.and_then(|values| values.first().copied())
        };
        let compression = number(&mut decoder, Tag::Compression).unwrap_or(1);
        let Some(at) = number(&mut decoder, Tag::StripOffsets) else {
            return Ok(false);
        };
        let bytes = page.look.shape.bytes().saturating_mul(count as u64);
        if compression != 1 || page.look.bits < 8 || at.saturating_add(bytes) > self.input.len {
            return Ok(false);
        }
        self.raw = Some((at, count));
        Ok(true)
    }

    /// The values of a page, components fastest.
    pub fn decode(&self, index: usize) -> Result<Voxels, VolumeError> {
        if let Some((at, _)) = self.raw {
            let shape = self.shape();
            let bytes = self
                .input
                .bytes_at(at + index as u64 * shape.bytes(), shape.bytes())?;
            return Ok(values_of(&bytes, shape.scalar_type, self.big_endian));
        }
        let page = &self.pages[index];
        let mut decoder = self.decoder(page)?;
        let look = look(&mut decoder)?;
        let layout = decoder
            .image_buffer_layout()
            .map_err(|error| broken(&error))?;
        let mut bytes = vec![0; layout.complete_len];
        decoder
            .read_image_bytes(&mut bytes)
            .map_err(|error| broken(&error))?;
        Ok(look.values(&bytes, layout.planes))
    }
}

/// Size and type of the decoder's page, held against the bytes that it is made of.
fn look(decoder: &mut Decoder<Source<'_>>) -> Result<Look, VolumeError> {
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
    let len = decoder.inner().reader.seek(std::io::SeekFrom::End(0));
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
    fn values(&self, bytes: &[u8], planes: usize) -> Voxels {
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

/// A directory as it lies in the file: only what the decoder does not tell.
struct Entries {
    at: u64,
    /// Bytes that it takes.
    size: u64,
    /// Tag, offset of the entry's value and the first two or four bytes of it as a number.
    found: Vec<(u64, u64, u64)>,
    next: u64,
}

impl Entries {
    fn read(
        input: &Input<'_>,
        at: u64,
        big_endian: bool,
        big_tiff: bool,
    ) -> Result<Self, VolumeError> {
        let (count_size, entry_size, next_size) = if big_tiff { (8, 20, 8) } else { (2, 12, 4) };
        let count = number(&input.bytes_at(at, count_size)?, big_endian);
        let first = at.saturating_add(count_size);
        let size = count.saturating_mul(entry_size);
        let bytes = input.bytes_at(first, size.saturating_add(next_size))?;
        let (entries, next) = bytes.split_at(size as usize);
        let wanted = [
            Tag::NewSubfileType,
            Tag::PhotometricInterpretation,
            Tag::ResolutionUnit,
        ];
        let wanted = wanted.map(|tag| u64::from(tag.to_u16()));
        let found = (0_u64..)
            .zip(entries.chunks_exact(entry_size as usize))
            .filter_map(|(i, entry)| {
                let tag = number(&entry[..2], big_endian);
                let value_at = if big_tiff { 12 } else { 8 };
                // Type 3 has two bytes, type 4 four.
                let size = if number(&entry[2..4], big_endian) == 3 {
                    2
                } else {
                    4
                };
                let value = number(&entry[value_at..value_at + size], big_endian);
                let offset = first + i * entry_size + value_at as u64;
                wanted.contains(&tag).then_some((tag, offset, value))
            });
        Ok(Self {
            at,
            size,
            found: found.collect(),
            next: number(next, big_endian),
        })
    }

    fn entry(&self, tag: Tag) -> Option<(u64, u64)> {
        let tag = u64::from(tag.to_u16());
        let entry = self.found.iter().find(|(found, ..)| *found == tag);
        entry.map(|&(_, offset, value)| (offset, value))
    }

    fn value(&self, tag: Tag) -> Option<u64> {
        self.entry(tag).map(|(_, value)| value)
    }

    fn offset(&self, tag: Tag) -> Option<u64> {
        self.entry(tag).map(|(offset, _)| offset)
    }
}
