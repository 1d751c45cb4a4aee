//! Pictures in PNG and JPEG as slices of a volume; one alone is a volume of one slice.
//!
//! The headers of all pictures are read when they are opened, and all must have the same size and type. Gray values
//! of 8 and 16 bits stay as they are (fewer bits are stretched to 8); gray with alpha, red, green and blue, and
//! palettes become colours. A picture knows no millimetres that could be trusted: x grows to the right, y downwards
//! as the rows go, z along the slices in the natural order of their names, each by 1.

use glam::DVec3;
use jpeg_decoder::PixelFormat;
use volgraph_volume::{Grid, ScalarType, Trouble, VolumeError, Voxels};

use crate::axes::Axes;
use crate::contents::{Components, Contents, Opened};
use crate::input::{BufReadSeek, Input, stem};
use crate::load::LoadOptions;
use crate::slices::{Codec, Frames, Slices, guarded, plausible, values_of};

/// Whether a file with this head is a PNG picture.
pub(crate) fn is_png(head: &[u8]) -> bool {
    head.starts_with(b"\x89PNG\r\n\x1a\n")
}

/// Whether a file with this head is a JPEG picture.
pub(crate) fn is_jpeg(head: &[u8]) -> bool {
    head.starts_with(b"\xff\xd8\xff")
}

/// PNG pictures as slices.
pub(crate) fn open_png<'a>(
    inputs: &[Input<'a>],
    _: &LoadOptions,
) -> Result<Opened<'a>, VolumeError> {
    open(inputs, Kind::Png)
}

/// JPEG pictures as slices.
pub(crate) fn open_jpeg<'a>(
    inputs: &[Input<'a>],
    _: &LoadOptions,
) -> Result<Opened<'a>, VolumeError> {
    open(inputs, Kind::Jpeg)
}

#[derive(Clone, Copy)]
enum Kind {
    Png,
    Jpeg,
}

/// Size and type of a picture, as it is decoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shape {
    pub width: u32,
    pub height: u32,
    pub channels: u64,
    pub scalar_type: ScalarType,
}

impl Shape {
    /// Values of one picture.
    pub fn values(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height) * self.channels
    }

    pub fn bytes(&self) -> u64 {
        self.values().saturating_mul(self.scalar_type.size() as u64)
    }

    /// `512×512 uint8 with 3 channels`, for messages.
    pub fn describe(&self) -> String {
        let channels = match self.channels {
            1 => String::new(),
            n => format!(" with {n} channels"),
        };
        format!(
            "{}×{} {}{channels}",
            self.width, self.height, self.scalar_type
        )
    }
}

/// Refuses slices of different sizes or types, naming both files.
pub(crate) fn same_shape(
    shapes: &[Shape],
    path: impl Fn(usize) -> std::path::PathBuf,
) -> Result<Shape, VolumeError> {
    let first = shapes[0];
    let Some(other) = shapes.iter().position(|shape| *shape != first) else {
        return Ok(first);
    };
    Err(VolumeError::Unsupported(Trouble::new(
        format!(
            "this slice is {}, and {} is {}",
            shapes[other].describe(),
            path(0).file_name().unwrap_or_default().to_string_lossy(),
            first.describe()
        ),
        "name the slices of one volume with a pattern, as in `slices/a*.png`",
    ))
    .in_file(&path(other)))
}

fn open<'a>(inputs: &[Input<'a>], kind: Kind) -> Result<Opened<'a>, VolumeError> {
    let pictures = Pictures {
        inputs: inputs.to_vec(),
        kind,
    };
    let shapes: Vec<Shape> = inputs
        .iter()
        .map(|input| {
            guarded("picture's", || pictures.shape(input)).map_err(|e| e.in_file(&input.path))
        })
        .collect::<Result<_, _>>()?;
    let shape = same_shape(&shapes, |i| inputs[i].path.clone())?;
    let name = match kind {
        Kind::Png => "PNG",
        Kind::Jpeg => "JPEG",
    };
    let mut contents = contents_of(name, inputs, shape, DVec3::ONE)?;
    if matches!(kind, Kind::Jpeg) {
        let fact = ("compression".to_owned(), "JPEG, with losses".to_owned());
        contents.about.facts.push(fact);
    }
    let what = contents.axes.describe(shape.scalar_type);
    let data = Slices {
        frames: pictures,
        order: (0..inputs.len()).collect(),
        per_step: inputs.len(),
        values: shape.values(),
        scalar_type: shape.scalar_type,
        what,
    };
    Ok(Opened {
        contents,
        data: Box::new(data),
    })
}

/// What slices in files of their own have in common.
pub(crate) fn contents_of(
    format: &str,
    inputs: &[Input<'_>],
    shape: Shape,
    spacing: DVec3,
) -> Result<Contents, VolumeError> {
    let first = &inputs[0].path;
    let folder = first.parent().filter(|_| inputs.len() > 1);
    let name = folder.map_or_else(|| stem(first), stem);
    let slices = inputs.len() as u64;
    let (width, height) = (u64::from(shape.width), u64::from(shape.height));
    let axes = match shape.channels {
        1 => Axes::new(vec![width, height, slices], vec![0, 1, 2])?,
        n => Axes::new(vec![n, width, height, slices], vec![1, 2, 3])?,
    };
    let grid = Grid::axis_aligned(axes.dims(), spacing, DVec3::ZERO);
    let mut contents = Contents::new(format, name, axes, shape.scalar_type, grid);
    if (2..=4).contains(&shape.channels) {
        contents.components = Components::Colors;
    }
    if inputs.len() > 1 {
        contents.data_files = inputs.iter().map(|input| input.path.clone()).collect();
    }
    Ok(contents)
}

/// One file per slice.
struct Pictures<'a> {
    inputs: Vec<Input<'a>>,
    kind: Kind,
}

impl Frames for Pictures<'_> {
    fn decode(&self, frame: usize) -> Result<Voxels, VolumeError> {
        let input = &self.inputs[frame];
        let decode = || match self.kind {
            Kind::Png => decode_png(input),
            Kind::Jpeg => decode_jpeg(input),
        };
        guarded("picture's", decode).map_err(|error| error.in_file(&input.path))
    }
}

impl Pictures<'_> {
    fn shape(&self, input: &Input<'_>) -> Result<Shape, VolumeError> {
        let (shape, codec) = match self.kind {
            Kind::Png => (png_shape(&png_reader(input)?)?, Codec::Deflate),
            Kind::Jpeg => {
                let mut decoder = jpeg_decoder::Decoder::new(input.open_seek()?);
                decoder
                    .read_info()
                    .map_err(|error| corrupt("JPEG", &error))?;
                (jpeg_shape(&decoder)?, Codec::Jpeg)
            }
        };
        plausible(codec, input.len, shape.bytes())?;
        Ok(shape)
    }
}

fn corrupt(what: &str, error: &dyn std::error::Error) -> VolumeError {
    VolumeError::DataCorrupt(Trouble::new(
        format!("the {what} picture cannot be decoded: {error}"),
        "fetch the file again, or save it anew",
    ))
}

type Source<'a> = Box<dyn BufReadSeek + 'a>;

fn png_reader<'a>(input: &Input<'a>) -> Result<png::Reader<Source<'a>>, VolumeError> {
    // Text and colour profiles are of no use here; nothing else in the file may allocate more than the file's size.
    let bytes = usize::try_from(input.len)
        .unwrap_or(usize::MAX)
        .max(1 << 20);
    let limits = png::Limits { bytes };
    let mut decoder = png::Decoder::new_with_limits(input.open_seek()?, limits);
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    decoder.set_transformations(png::Transformations::EXPAND);
    decoder.read_info().map_err(|error| corrupt("PNG", &error))
}

fn png_shape(reader: &png::Reader<Source<'_>>) -> Result<Shape, VolumeError> {
    let (color, depth) = reader.output_color_type();
    let info = reader.info();
    let scalar_type = match depth {
        png::BitDepth::Eight => ScalarType::U8,
        png::BitDepth::Sixteen => ScalarType::U16,
        other => {
            return Err(VolumeError::Unsupported(Trouble::new(
                format!("pixels of {other:?} bits"),
                "save the picture with 8 or 16 bits",
            )));
        }
    };
    Ok(Shape {
        width: info.width,
        height: info.height,
        channels: color.samples() as u64,
        scalar_type,
    })
}

fn decode_png(input: &Input<'_>) -> Result<Voxels, VolumeError> {
    let mut reader = png_reader(input)?;
    let shape = png_shape(&reader)?;
    plausible(Codec::Deflate, input.len, shape.bytes())?;
    let size = reader.output_buffer_size().unwrap_or(usize::MAX);
    if size as u64 != shape.bytes() {
        return Err(VolumeError::DataCorrupt(Trouble::new(
            format!(
                "a picture of {} is decoded to {size} bytes",
                shape.describe()
            ),
            "save the picture anew",
        )));
    }
    let mut bytes = vec![0; size];
    reader
        .next_frame(&mut bytes)
        .map_err(|error| corrupt("PNG", &error))?;
    Ok(values_of(&bytes, shape.scalar_type, true))
}

fn jpeg_shape<R: std::io::Read>(decoder: &jpeg_decoder::Decoder<R>) -> Result<Shape, VolumeError> {
    let unsupported = |cause: String| {
        VolumeError::Unsupported(Trouble::new(cause, "save the picture as gray or RGB"))
    };
    let info = decoder
        .info()
        .ok_or_else(|| unsupported("a JPEG picture without a size".into()))?;
    let (channels, scalar_type) = match info.pixel_format {
        PixelFormat::L8 => (1, ScalarType::U8),
        PixelFormat::L16 => (1, ScalarType::U16),
        PixelFormat::RGB24 => (3, ScalarType::U8),
        PixelFormat::CMYK32 => return Err(unsupported("a JPEG picture in CMYK".into())),
    };
    Ok(Shape {
        width: info.width.into(),
        height: info.height.into(),
        channels,
        scalar_type,
    })
}

fn decode_jpeg(input: &Input<'_>) -> Result<Voxels, VolumeError> {
    let decoder = jpeg_decoder::Decoder::new(input.open_seek()?);
    decode_jpeg_stream(decoder, input.len)
}

/// Decodes a stream of `len` bytes; 16 bits come in the machine's byte order.
pub(crate) fn decode_jpeg_stream<R: std::io::Read>(
    mut decoder: jpeg_decoder::Decoder<R>,
    len: u64,
) -> Result<Voxels, VolumeError> {
    decoder
        .read_info()
        .map_err(|error| corrupt("JPEG", &error))?;
    let shape = jpeg_shape(&decoder)?;
    plausible(Codec::Jpeg, len, shape.bytes())?;
    let bytes = decoder.decode().map_err(|error| corrupt("JPEG", &error))?;
    Ok(values_of(
        &bytes,
        shape.scalar_type,
        cfg!(target_endian = "big"),
    ))
}
