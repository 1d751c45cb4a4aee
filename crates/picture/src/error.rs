//! What can go wrong between a picture and its file.

use std::io;
use std::path::PathBuf;

use crate::{MAX_PIXELS, MAX_SIDE};

/// Why a picture was not saved or loaded.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The file system refused.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The extension names no format that can be written.
    #[error("{}: the extension names no picture format; end the name with .png or .exr", path.display())]
    Extension {
        /// The file.
        path: PathBuf,
    },
    /// The first bytes are those of no known format.
    #[error("{}: this is neither a PNG nor an EXR file", path.display())]
    NotAPicture {
        /// The file.
        path: PathBuf,
    },
    /// The picture has no pixels, or too many.
    #[error(
        "a picture of {width} × {height} pixels is refused; a side has 1 to {MAX_SIDE} pixels, all at most {MAX_PIXELS}"
    )]
    Size {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// A buffer does not have `width × height` values.
    #[error("the {buffer} buffer has {len} values, which is not {width} × {height}")]
    Shape {
        /// Which buffer.
        buffer: &'static str,
        /// How many values it has.
        len: usize,
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// A layer's name cannot be written.
    #[error(
        "the layer name `{name}` is refused: it is 1 to 64 ASCII letters, digits, `-` or `_`, once, and not `depth` or `opacity`"
    )]
    Layer {
        /// The name.
        name: String,
    },
    /// A metadata key cannot be written.
    #[error("the metadata key `{key}` is refused: {cause}")]
    Metadata {
        /// The key.
        key: String,
        /// Why.
        cause: &'static str,
    },
    /// The encoder failed.
    #[error("{}: the picture cannot be encoded: {cause}", path.display())]
    Encode {
        /// The file.
        path: PathBuf,
        /// Why.
        cause: String,
    },
    /// The file is damaged, cut short, or uses what is not supported.
    #[error("{}: the picture cannot be read: {cause}", path.display())]
    Decode {
        /// The file.
        path: PathBuf,
        /// Why.
        cause: String,
    },
}
