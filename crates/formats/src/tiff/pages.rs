//! The pages of a TIFF file: their directories are walked through once, and each page is decoded on its own.

use tiff::ColorType;
use tiff::decoder::{ChunkType, Decoder, Limits};
use tiff::tags::{SampleFormat, Tag};
use volgraph_volume::{ScalarType, Trouble, VolumeError, Voxels};

use super::entries::{Entries, number};
use super::look::{Look, broken, look};
use super::patched::{Patched, Source};
use crate::input::Input;
use crate::slices::values_of;
use crate::stack::Shape;

/// Most pages of a file.
const MOST_PAGES: usize = 1_000_000;
/// Photometric interpretations by their numbers.
const WHITE_IS_ZERO: u64 = 0;
const PALETTE: u64 = 3;

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

#[derive(Clone, Debug)]
struct Page {
    /// Where its directory lies.
    directory: u64,
    look: Look,
    /// Where the number of its photometric interpretation lies, if it is to be read as "zero is black".
    as_black_is_zero: Option<u64>,
}

/// Byte order and the bytes of an offset.
fn head_of(input: &Input<'_>) -> Result<(bool, bool), VolumeError> {
    let head = input.head(4)?;
    let big_endian = head.starts_with(b"MM");
    let big_tiff = head.contains(&43);
    Ok((big_endian, big_tiff))
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
