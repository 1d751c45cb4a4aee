//! HDF5, and what is kept in it: ITK's images, NetCDF-4, arrays of h5py and MATLAB.
//!
//! The crate `hdf5-reader` knows the container: groups, types, chunks, filters. [`parts`] finds the arrays and takes
//! the one that is asked for; [`meaning`] says which axes are space, time and components; [`place`] where the grid
//! lies; [`voxels`] reads one time step in slabs. Axes are in C order: the last one is x, unless names say otherwise.
//! An array whose bytes lie in one run is left there to be mapped ([`layout`]).
//!
//! What the file says of sizes is held against its length here before anything is read: streams of deflate grow at
//! most a thousandfold. [`guarded`] tells a panic of the crate as a broken file.
//! Source: <https://support.hdfgroup.org/documentation/hdf5/latest/_f_m_t3.html>.

mod attributes;
mod element;
mod lzf;
mod meaning;
mod parts;
mod place;
mod voxels;

use std::panic::{AssertUnwindSafe, catch_unwind};

use hdf5_reader::messages::HdfMessage;
use hdf5_reader::messages::layout::DataLayout;
use hdf5_reader::{Dataset, FilterRegistry, Hdf5File, OpenOptions};
use volgraph_volume::{Trouble, Values, VolumeError};

use crate::axes::Axes;
use crate::choice::cut;
use crate::contents::{Contents, Opened};
use crate::input::{Input, stem};
use crate::load::LoadOptions;
use crate::rescale::Rescale;
use attributes::Attributes;
use element::Stored;
use meaning::Meaning;
use parts::Parts;
use voxels::Source;

/// What every file has at 0, or behind a user block of 512, 1024, 2048... bytes.
const SIGNATURE: &[u8] = b"\x89HDF\r\n\x1a\n";

/// Bytes of voxels that may be nothing but the fill value.
const FREE_BYTES: u64 = 1 << 25;

/// Bytes of voxels for each byte of the file: arrays of labels are deflated twice, or have few chunks that are there.
const MOST_FILL: u64 = 4096;

/// Bytes that one of a stream may become: deflate's most is 1032.
const MOST_RATIO: u64 = 1040;

/// Bytes that a chunk may have however short the file is, and however long.
const CHUNK_BYTES: (u64, u64) = (1 << 24, 1 << 31);

/// Most bytes of one object's header.
const HEADER_BYTES: usize = 1 << 22;

/// Whether a file begins so; the head is long enough for user blocks of up to 1024 bytes.
pub(crate) fn is_hdf5(head: &[u8]) -> bool {
    [0, 512, 1024].into_iter().any(|at| {
        head.get(at..)
            .is_some_and(|rest| rest.starts_with(SIGNATURE))
    })
}

/// Opens the array that the options name.
pub(crate) fn open<'a>(
    input: &Input<'a>,
    options: &LoadOptions,
) -> Result<Opened<'a>, VolumeError> {
    guarded(|| {
        let file = file(input)?;
        let name = options.part.as_deref();
        let parts = Parts::of(&file, name)?;
        let part = parts.find(name)?;
        let dataset = parts.dataset(part)?;
        let root = file.root_group().and_then(|root| root.attributes());
        let is_netcdf = root.is_ok_and(|list| list.iter().any(|one| one.name == "_NCProperties"));
        let format = match (place::is_itk(part), is_netcdf) {
            (true, _) => "HDF5 (ITK)",
            (false, true) => "NetCDF-4",
            (false, false) => "HDF5",
        };
        opened(input, &file, &parts, &part.path, dataset, format)
    })
}

/// What is opened, with bounds of the file's length on what its words can allocate.
fn file(input: &Input<'_>) -> Result<Hdf5File, VolumeError> {
    let mut filters = FilterRegistry::new();
    filters.register(lzf::FILTER, Box::new(lzf::undo));
    let chunk = input.len.saturating_mul(MOST_RATIO);
    let chunk = chunk.clamp(CHUNK_BYTES.0, CHUNK_BYTES.1);
    let options = OpenOptions::default()
        .with_filter_registry(filters)
        // Slabs are of whole chunks: none is needed twice.
        .with_chunk_cache_bytes(0)
        .with_max_chunk_bytes(usize::try_from(chunk).unwrap_or(usize::MAX))
        .with_max_object_header_bytes(HEADER_BYTES);
    let file = if input.is_memory() {
        let bytes = input.bytes_at(0, input.len)?;
        Hdf5File::from_vec_with_options(bytes, options)
    } else {
        Hdf5File::open_with_options(&input.path, options)
    };
    file.map_err(|error| told(&error))
}

fn opened(
    input: &Input<'_>,
    file: &Hdf5File,
    parts: &Parts,
    path: &str,
    dataset: &Dataset,
    format: &str,
) -> Result<Opened<'static>, VolumeError> {
    let element = element::of(dataset)?;
    let run = layout(input, file, dataset)?.filter(|_| !element.is_half);
    let attributes = Attributes::of(dataset.attributes());
    let mut warnings = Vec::new();
    let scales = parts.scales(dataset, &attributes);
    let itk = place::Itk::of(parts, path)?;
    let meaning = match &itk {
        Some(itk) => Meaning::of_itk(dataset.ndim(), itk.rank())?,
        None => Meaning::of(dataset.shape(), &meaning::names(&attributes, &scales))?,
    };
    let axes = meaning.axes(dataset.shape())?;
    check_there(input, dataset, &axes, &element)?;
    let placed = match &itk {
        Some(itk) => itk.placed(&meaning, axes.dims())?,
        None => place::placed(&meaning, axes.dims(), &attributes, &scales, &mut warnings)?,
    };
    let number = |name: &str| attributes.number(name);
    let rescale = Rescale::new(
        element.scalar_type,
        None,
        number("scale_factor").unwrap_or(1.0),
        number("add_offset").unwrap_or(0.0),
    );
    // NetCDF's marks of cells without a value.
    let missing = ["_FillValue", "missing_value"].into_iter();
    let missing = missing.filter_map(|name| attributes.numbers(name));
    let missing: Vec<f64> = missing
        .flatten()
        .map(|mark| element.nearest(mark))
        .collect();
    let missing = if rescale.scalar_type.is_float() {
        missing
    } else {
        if let Some(mark) = missing.first() {
            warnings.push(format!(
                "{mark} marks cells without a value: of integers it is drawn as the number that it is"
            ));
        }
        Vec::new()
    };

    let mut contents = Contents::new(
        format,
        stem(&input.path),
        axes.clone(),
        rescale.scalar_type,
        placed.grid,
    );
    contents.about.length_unit = placed.unit;
    contents.about.value_unit = attributes.text("units").filter(|unit| unit != "1");
    let name = ["long_name", "standard_name"].iter();
    if let Some(name) = name.filter_map(|name| attributes.text(name)).next() {
        contents.about.values = Values::Named(name);
    }
    contents.about.facts.push(("dataset".into(), cut(path)));
    if let Some(time) = meaning.time {
        (contents.times, contents.time_unit) = place::times(scales[time].as_ref(), axes.steps());
    }
    if element.is_byte() && (3..=4).contains(&axes.component_count()) {
        contents.components = crate::contents::Components::Colors;
    }
    contents.warnings = warnings;
    let run = run.filter(|_| missing.is_empty());
    let source = Source {
        dataset: dataset.clone(),
        element,
        axes,
        time: meaning.time,
        rescale,
        missing,
        run,
    };
    Ok(Opened {
        contents,
        data: Box::new(source),
    })
}

/// Holds the sizes against the file's length: metadata alone shall not fill the memory with the fill value.
fn check_there(
    input: &Input<'_>,
    dataset: &Dataset,
    axes: &Axes,
    element: &Stored,
) -> Result<(), VolumeError> {
    let count = axes.count()?;
    let bytes = count.saturating_mul(element.size as u64);
    let plain = dataset.chunks().is_none();
    let fits = if plain {
        bytes <= input.len || bytes <= FREE_BYTES
    } else {
        bytes <= input.len.saturating_mul(MOST_FILL).max(FREE_BYTES)
    };
    if fits {
        return Ok(());
    }
    let what = axes.describe(element.scalar_type);
    Err(VolumeError::DataTooShort(Trouble::new(
        format!(
            "{what} are {bytes} bytes, and a file of {} cannot hold them",
            input.len
        ),
        "fetch the file again",
    )))
}

/// Where the bytes of an array begin that lie in one run of the file, neither chunked nor filtered; refuses those that
/// lie in other files, which nobody has checked.
fn layout(
    input: &Input<'_>,
    file: &Hdf5File,
    dataset: &Dataset,
) -> Result<Option<voxels::PlainRun>, VolumeError> {
    let header = file.get_or_parse_header(dataset.address());
    let header = header.map_err(|error| told(&error))?;
    let (mut run, mut filtered) = (None, false);
    for message in &header.messages {
        match message {
            HdfMessage::ExternalFiles(_) => {
                return Err(VolumeError::Unsupported(Trouble::new(
                    "the values of the array lie in another file, as raw voxels",
                    "give that file with its dimensions and type (`--dims`, `--type`)",
                )));
            }
            HdfMessage::FilterPipeline(_) => filtered = true,
            HdfMessage::DataLayout(message) => {
                if let DataLayout::Contiguous { address, size } = message.layout {
                    run = Some((address, size));
                }
            }
            _ => {}
        }
    }
    let bytes = dataset.raw_byte_len().map_err(|error| told(&error))?;
    let offset = run
        .filter(|&(_, size)| size == bytes as u64 && !filtered && !input.is_memory())
        .and_then(|(address, size)| {
            let offset = address.checked_add(file.superblock().base_address)?;
            offset.checked_add(size).filter(|&end| end <= input.len)?;
            Some(offset)
        });
    Ok(offset.map(|offset| voxels::PlainRun {
        file: input.path.clone(),
        offset,
    }))
}

/// Calls the crate. It is careful: of two million forged files it panicked on two, where a product of sizes was too large
/// for arithmetic that is checked. Such a one is a broken file to be told, and no end of the program.
fn guarded<T>(call: impl FnOnce() -> Result<T, VolumeError>) -> Result<T, VolumeError> {
    catch_unwind(AssertUnwindSafe(call)).unwrap_or_else(|_| {
        Err(VolumeError::DataCorrupt(Trouble::new(
            "the structure of the HDF5 file is broken",
            "check the file with `h5dump -H`, or fetch it again",
        )))
    })
}

/// What the crate says, with what to do.
fn told(error: &hdf5_reader::error::Error) -> VolumeError {
    use hdf5_reader::error::Error as E;
    let mut cause = error;
    while let E::Context { source, .. } = cause {
        cause = source;
    }
    let text: String = cause
        .to_string()
        .chars()
        .filter(|letter| !letter.is_control())
        .take(300)
        .collect();
    let text = text.trim_end_matches('.').to_owned();
    match cause {
        E::Io(_) => VolumeError::Unreadable(Trouble::new(
            format!("cannot be read: {text}"),
            "check the file, its permissions and the disk",
        )),
        E::UnsupportedFilter(_) => VolumeError::Unsupported(Trouble::new(
            format!("the array is packed in a way that is not read here: {text}"),
            "pack it anew with `h5repack -f GZIP=4 OLD.h5 NEW.h5`",
        )),
        E::ResourceLimit(_) => VolumeError::TooLarge(Trouble::new(
            text,
            "check the file with `h5dump -H`, or write it again with smaller chunks",
        )),
        E::UnexpectedEof { .. } | E::OffsetOutOfBounds(_) => {
            VolumeError::DataTooShort(Trouble::new(text, "the file is cut off: fetch it again"))
        }
        E::UnsupportedEncoding(_)
        | E::UnsupportedLayoutClass(_)
        | E::UnsupportedLayoutVersion(_)
        | E::UnsupportedDatatypeClass(_)
        | E::UnsupportedSuperblockVersion(_)
        | E::UnsupportedChunkIndexType(_) => VolumeError::Unsupported(Trouble::new(
            text,
            "write the array anew: `h5py.File(NEW, 'w')['data'] = h5py.File(OLD)[NAME][...]`",
        )),
        _ => VolumeError::DataCorrupt(Trouble::new(
            format!("the HDF5 file is broken: {text}"),
            "check the file with `h5dump -H`, or fetch it again",
        )),
    }
}
