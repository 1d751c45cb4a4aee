//! Pictures: linear f32 in memory, PNG and EXR on disk, with metadata.
//!
//! The way of the data: a renderer fills a [`Picture`] (linear, premultiplied, top row first).
//! [`Picture::save`] encodes it in memory by the path's extension, writes that beside the target and renames
//! it, so that nobody ever sees half a file, and says in a [`SaveReport`] what the format could not hold.
//! [`Picture::load`] looks at a file's first bytes, judges the size that its header states, and decodes. A [`FilmFile`]
//! takes picture after picture into one animated PNG or GIF, likewise whole or not there.
//!
//! | | PNG | EXR |
//! | --- | --- | --- |
//! | colour | sRGB, not premultiplied; without alpha where all is opaque | linear, premultiplied, f32 |
//! | depth, opacity | not kept | channels `Z` and `opacity.Y` |
//! | other layers | not kept | channels `NAME.Y`, or `NAME.X`, `NAME.Y`, `NAME.Z` and `NAME.A` |
//! | metadata | `iTXt` chunks `volgraph:KEY` | text attributes `volgraph:KEY` |

mod error;
mod exr_file;
mod files;
mod film_file;
mod png_file;
pub mod srgb;

use std::io::{BufRead, Cursor, Seek};
use std::path::Path;

pub use error::PictureError;
pub use files::abandon_unfinished;
pub use film_file::{FilmFile, FilmFormat};

/// Prefix of the metadata's keys on disk.
const KEY_PREFIX: &str = "volgraph:";

/// Most pixels of a picture that is saved or loaded: 2²⁸, a colour buffer of 4 GiB.
pub const MAX_PIXELS: u64 = 1 << 28;

/// Most pixels along one side of a picture that is saved or loaded.
pub const MAX_SIDE: u32 = 1 << 16;

/// A picture in memory. All buffers have `width × height` values, row by row, top row first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Linear RGB (Rec. 709 primaries), premultiplied by the fourth value, the alpha of 0 to 1.
    pub color: Vec<[f32; 4]>,
    /// Depth of what is seen, in the units of the one who drew it.
    pub depth: Option<Vec<f32>>,
    /// Opacity in f32, beside what alpha the colour carries (over a background that alpha is 1).
    pub opacity: Option<Vec<f32>>,
    /// What else is known of each pixel, each name once.
    pub layers: Vec<Layer>,
    /// Keys and values, kept in both formats. A key is 1 to 64 ASCII letters, digits, `-`, `_`, `.` or `:`, each
    /// key once; a value is any text. Loading sorts them by key.
    pub metadata: Vec<(String, String)>,
}

/// One number, or one vector, for each pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// 1 to 64 ASCII letters, digits, `-` or `_`; not `depth` or `opacity`, nor the name of a colour's channel.
    pub name: String,
    /// The numbers.
    pub values: LayerValues,
}

/// The numbers of a layer, `width × height`, row by row, top row first.
#[derive(Clone, Debug, PartialEq)]
pub enum LayerValues {
    /// One number for each pixel.
    Scalar(Vec<f32>),
    /// Three numbers for each pixel, and a fourth that is 1 where there is a vector, else 0.
    Vector(Vec<[f32; 4]>),
}

impl LayerValues {
    /// The pixels that there are values for.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Scalar(values) => values.len(),
            Self::Vector(values) => values.len(),
        }
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Bits of each PNG component.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum PngBits {
    /// 256 codes: for screens.
    #[default]
    Eight,
    /// 65 536 codes: for comparing.
    Sixteen,
}

/// How to save.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct SaveOptions {
    /// Bits of each PNG component; EXR is always f32.
    pub png_bits: PngBits,
    /// The picture will soon be replaced: it is compressed lightly, and nobody waits until the disk has it. It still
    /// appears as a whole.
    pub is_live: bool,
}

impl SaveOptions {
    /// The same with so many bits for each PNG component.
    #[must_use]
    pub fn with_png_bits(mut self, bits: PngBits) -> Self {
        self.png_bits = bits;
        self
    }

    /// The same for a picture that will soon be replaced.
    #[must_use]
    pub fn live(mut self) -> Self {
        self.is_live = true;
        self
    }
}

/// What the file does not hold as it was.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[must_use = "values that are not numbers, or do not fit the format, should be told to someone"]
pub struct SaveReport {
    /// Pixels with a colour component or alpha that is not a number. PNG has 0 in its place, EXR keeps it.
    pub nan_pixels: u64,
    /// Pixels with a component that PNG cannot hold and that was clamped: below 0, brighter than white, or light
    /// without alpha. Always 0 for EXR.
    pub clipped_pixels: u64,
}

/// The formats, by extension or by first bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Png,
    Exr,
}

impl Picture {
    /// A picture of colour alone.
    ///
    /// # Errors
    /// [`PictureError::Shape`] where the buffer is not of `width × height`, [`PictureError::Size`].
    pub fn from_color(width: u32, height: u32, color: Vec<[f32; 4]>) -> Result<Self, PictureError> {
        let picture = Self {
            width,
            height,
            color,
            ..Self::default()
        };
        picture.check()?;
        Ok(picture)
    }

    /// The layer of a name.
    #[must_use]
    pub fn layer(&self, name: &str) -> Option<&LayerValues> {
        let layer = self.layers.iter().find(|layer| layer.name == name)?;
        Some(&layer.values)
    }

    /// The colour at column `x` and row `y` (from the top); `None` outside.
    #[must_use]
    pub fn pixel(&self, x: u32, y: u32) -> Option<[f32; 4]> {
        let at = y as usize * self.width as usize + x as usize;
        self.color.get(at).filter(|_| x < self.width).copied()
    }

    /// Checks sizes and metadata keys, as saving does.
    ///
    /// # Errors
    /// [`PictureError::Size`], [`PictureError::Shape`], [`PictureError::Metadata`].
    pub fn check(&self) -> Result<(), PictureError> {
        let pixels = check_size(self.width, self.height)?;
        let buffers = [
            ("colour", Some(self.color.len())),
            ("depth", self.depth.as_ref().map(Vec::len)),
            ("opacity", self.opacity.as_ref().map(Vec::len)),
        ];
        for (buffer, len) in buffers {
            if let Some(len) = len.filter(|len| *len != pixels) {
                return Err(PictureError::Shape {
                    buffer,
                    len,
                    width: self.width,
                    height: self.height,
                });
            }
        }
        for (i, layer) in self.layers.iter().enumerate() {
            let name = &layer.name;
            let is_plain = |b: u8| b.is_ascii_alphanumeric() || b"-_".contains(&b);
            let is_taken = ["depth", "opacity"].contains(&name.as_str())
                || self.layers[..i].iter().any(|other| other.name == *name);
            if is_taken || name.is_empty() || name.len() > 64 || !name.bytes().all(is_plain) {
                return Err(PictureError::Layer { name: name.clone() });
            }
            if layer.values.len() != pixels {
                return Err(PictureError::Shape {
                    buffer: "layer",
                    len: layer.values.len(),
                    width: self.width,
                    height: self.height,
                });
            }
        }
        for (i, (key, _)) in self.metadata.iter().enumerate() {
            let is_key = |b: u8| b.is_ascii_alphanumeric() || b"-_.:".contains(&b);
            let cause = if key.is_empty() || key.len() > 64 || !key.bytes().all(is_key) {
                "a key is 1 to 64 ASCII letters, digits, `-`, `_`, `.` or `:`"
            } else if self.metadata[..i].iter().any(|(other, _)| other == key) {
                "it is given twice"
            } else {
                continue;
            };
            return Err(PictureError::Metadata {
                key: key.clone(),
                cause,
            });
        }
        Ok(())
    }

    /// Saves as PNG or EXR, by the extension of `path`. The file is whole or not there: it is written under
    /// another name in the same folder and renamed at the end.
    ///
    /// # Errors
    /// [`PictureError::Extension`], [`PictureError::Io`], [`PictureError::Encode`], and those of
    /// [`check`](Self::check).
    pub fn save(&self, path: &Path, options: SaveOptions) -> Result<SaveReport, PictureError> {
        let format = files::format_of(path)?;
        self.check()?;
        let (bytes, report) = match format {
            Format::Png => png_file::encode(self, options),
            Format::Exr => exr_file::encode(self),
        }
        .map_err(|cause| PictureError::Encode {
            path: path.to_path_buf(),
            cause,
        })?;
        files::write_whole(path, &bytes, !options.is_live).map_err(|source| PictureError::Io {
            path: path.to_path_buf(),
            source,
        })?;
        Ok(report)
    }

    /// Loads a PNG or EXR file, by its content.
    ///
    /// PNG: gray, RGB or palette, with or without alpha, 1 to 16 bits, taken as sRGB and made linear and
    /// premultiplied. EXR: the first flat layer's `R`, `G`, `B` (or `Y`), `A`, `Z`, `opacity.Y` in f16 or f32,
    /// taken as they are.
    ///
    /// # Errors
    /// [`PictureError::Io`], [`PictureError::NotAPicture`], [`PictureError::Decode`]; and
    /// [`PictureError::Size`] or [`PictureError::Decode`] for a size that is beyond the limits or that the file
    /// is far too short for, before a buffer of that size is made.
    pub fn load(path: &Path) -> Result<Self, PictureError> {
        let (format, reader, file_len) = files::open(path)?;
        decode(path, format, reader, file_len)
    }

    /// The same of a file's content that is in memory; `path` is its name for errors.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn from_bytes(path: &Path, bytes: &[u8]) -> Result<Self, PictureError> {
        let format = files::format_of_content(path, bytes)?;
        decode(path, format, Cursor::new(bytes), bytes.len() as u64)
    }
}

fn decode(
    path: &Path,
    format: Format,
    reader: impl BufRead + Seek,
    file_len: u64,
) -> Result<Picture, PictureError> {
    let decoded = match format {
        Format::Png => png_file::decode(reader, file_len),
        Format::Exr => exr_file::decode(reader, file_len),
    };
    let mut picture = decoded.map_err(|cause| PictureError::Decode {
        path: path.to_path_buf(),
        cause,
    })?;
    picture.metadata.sort();
    Ok(picture)
}

/// The number of pixels, where it is within the limits.
fn check_size(width: u32, height: u32) -> Result<usize, PictureError> {
    let pixels = u64::from(width) * u64::from(height);
    if pixels == 0 || pixels > MAX_PIXELS || width.max(height) > MAX_SIDE {
        return Err(PictureError::Size { width, height });
    }
    usize::try_from(pixels).map_err(|_| PictureError::Size { width, height })
}
