//! NIfTI-1 and NIfTI-2: one file (`.nii`), or a header with its data beside it (`.hdr`, `.img`), each plain or
//! gzipped. Source: <https://nifti.nimh.nih.gov/nifti-1> and <https://nifti.nimh.nih.gov/nifti-2>.
//!
//! `header` brings both versions to one set of numbers (version 1 by the crate `nifti`, which does not know version
//! 2); `placement` makes the grid of them as nibabel does and turns it from RAS to LPS. Here the axes are sorted (the
//! fourth is time, the fifth components, colours are components too), the units and the meaning are named, and a
//! [`Stored`] with slope and intercept is the way to the voxels. Extensions lie between header and voxels and are
//! passed over by the offset of the voxels. What nibabel mends while it reads is mended here, with a warning.

mod header;
mod meaning;
mod placement;

use std::io::{self, Read as _};
use std::path::Path;

use flate2::bufread::MultiGzDecoder;
use volgraph_volume::{ScalarType, Trouble, VolumeError};

use crate::axes::Axes;
use crate::contents::{Components, Contents, Opened};
use crate::format::Head;
use crate::input::{Input, stem};
use crate::load::LoadOptions;
use crate::piece::{Encoding, Piece};
use crate::rescale::Rescale;
use crate::stream::{Job, Stored};
use header::{Header, LONGEST};

/// Most time steps whose times are listed; a forged header could ask for 2^32.
const MOST_TIMES: u32 = 1 << 16;

/// Whether a file with this head is NIfTI, or Analyze 7.5, which is refused with its name.
pub(crate) fn is_nifti(head: &Head) -> bool {
    header::version(&head.bytes).is_some() || header::version(&head.unpacked).is_some()
}

/// The NIfTI header beside a file of voxels (`.img`, `.img.gz`), where there is one.
pub(crate) fn header_of<'a>(input: &Input<'a>, head: &Head) -> Option<Input<'a>> {
    if !(head.ends_with(".img") || head.ends_with(".img.gz")) || input.is_memory() {
        return None;
    }
    let beside = beside(&head.name, "hdr");
    let mut headers = beside
        .iter()
        .filter_map(|name| Input::file(&input.path.with_file_name(name)).ok());
    headers.find(|header| Head::of(header).is_ok_and(|head| is_nifti(&head)))
}

/// Names of the other file of a pair: that which is packed alike, then the other one.
fn beside(name: &str, ending: &str) -> [String; 2] {
    let (base, packed) = match name
        .len()
        .checked_sub(3)
        .and_then(|at| name.split_at_checked(at))
    {
        Some((base, gz)) if gz.eq_ignore_ascii_case(".gz") => (base, true),
        _ => (name, false),
    };
    let (base, old) = base.rsplit_once('.').unwrap_or((base, ""));
    let upper = !old.is_empty() && old.chars().all(|letter| letter.is_ascii_uppercase());
    let ending = if upper {
        ending.to_ascii_uppercase()
    } else {
        ending.to_owned()
    };
    let (plain, gz) = (format!("{base}.{ending}"), format!("{base}.{ending}.gz"));
    if packed { [gz, plain] } else { [plain, gz] }
}

/// Opens a file, or the header of a pair.
pub(crate) fn open<'a>(
    input: &Input<'a>,
    _options: &LoadOptions,
) -> Result<Opened<'a>, VolumeError> {
    let (bytes, packed) = head(input)?;
    let mut header = Header::parse(&bytes)?;
    let (stored, channels) = stored_type(header.datatype)?;
    let from = header.voxels_at()?;
    let layout = Layout::of(&header, channels)?;
    let data = data_input(input, &header)?;
    let data_packed = if header.attached {
        packed
    } else {
        is_gzip(&data)?
    };
    let count = layout.axes.count()?;
    let grid = placement::grid(&mut header, layout.axes.dims())?;
    let rescale = rescale(&header, stored, channels)?;
    let what = layout.axes.describe(stored);
    let mut contents = Contents::new(
        format!("NIfTI-{}", header.version),
        stem(&input.path),
        layout.axes.clone(),
        rescale.map_or(stored, |rescale| rescale.scalar_type),
        grid,
    );
    meaning::tell(&header, &mut contents);
    contents.times = times(&header, layout.axes.steps());
    if layout.colors {
        contents.components = Components::Colors;
    }
    contents.warnings = header.warnings;
    contents.data_files = vec![input.path.clone()];
    if !header.attached {
        contents.data_files.push(data.path.clone());
    }
    let piece = Piece {
        input: data,
        start: if data_packed { 0 } else { from },
        line_skip: 0,
        byte_skip: if data_packed {
            i64::try_from(from).unwrap_or(i64::MAX)
        } else {
            0
        },
        encoding: if data_packed {
            Encoding::Gzip
        } else {
            Encoding::Raw
        },
        line_end: false,
        encoded_len: None,
    };
    let stored = Stored {
        job: Job {
            pieces: vec![piece],
            scalar_type: stored,
            big_endian: header.big_endian,
            count,
            what,
        },
        axes: layout.axes,
        rescale,
    };
    Ok(Opened {
        contents,
        data: Box::new(stored),
    })
}

/// The first bytes, unpacked, and whether they were packed.
fn head(input: &Input<'_>) -> Result<(Vec<u8>, bool), VolumeError> {
    let mut bytes = Vec::new();
    let packed = is_gzip(input)?;
    let reader = input.open(0)?;
    let read = if packed {
        MultiGzDecoder::new(reader)
            .take(LONGEST)
            .read_to_end(&mut bytes)
    } else {
        reader.take(LONGEST).read_to_end(&mut bytes)
    };
    match read {
        Err(error) if !packed => Err(input.unreadable(&error)),
        // A stream that is cut off has told what it had; the header sees whether that is enough.
        Err(error) if error.kind() != io::ErrorKind::UnexpectedEof => {
            Err(VolumeError::DataCorrupt(Trouble::new(
                format!("the gzip stream cannot be decoded: {error}"),
                "fetch the file again",
            )))
        }
        _ => Ok((bytes, packed)),
    }
}

fn is_gzip(input: &Input<'_>) -> Result<bool, VolumeError> {
    Ok(input.head(2)? == b"\x1f\x8b")
}

/// The file with the voxels.
fn data_input<'a>(input: &Input<'a>, header: &Header) -> Result<Input<'a>, VolumeError> {
    if header.attached {
        return Ok(input.clone());
    }
    let name = input.path.file_name().unwrap_or_default().to_string_lossy();
    let [first, second] = beside(&name, "img");
    input.data_file(&first).or_else(|error| {
        let there = Path::new(&input.path).with_file_name(&second).is_file();
        if there {
            input.data_file(&second)
        } else {
            Err(error)
        }
    })
}

/// The type of the stored values, and how many of them a colour has (1 for what is no colour).
fn stored_type(code: i16) -> Result<(ScalarType, u64), VolumeError> {
    let refused = |what: &str, remedy: &str| {
        VolumeError::Unsupported(Trouble::new(
            format!("voxels are {what} (datatype {code})"),
            remedy,
        ))
    };
    let complex = "save the magnitude, or real and imaginary part, as a file each";
    Ok(match code {
        2 => (ScalarType::U8, 1),
        4 => (ScalarType::I16, 1),
        8 => (ScalarType::I32, 1),
        16 => (ScalarType::F32, 1),
        64 => (ScalarType::F64, 1),
        128 => (ScalarType::U8, 3),
        256 => (ScalarType::I8, 1),
        512 => (ScalarType::U16, 1),
        768 => (ScalarType::U32, 1),
        1024 => (ScalarType::I64, 1),
        1280 => (ScalarType::U64, 1),
        2304 => (ScalarType::U8, 4),
        1 => return Err(refused("single bits", "save them as uint8")),
        32 | 1792 | 2048 => return Err(refused("complex numbers", complex)),
        1536 => return Err(refused("float128", "save them as float64")),
        _ => {
            return Err(VolumeError::UnknownType(Trouble::new(
                format!("the datatype {code} is none of NIfTI's"),
                "fetch the file again, or correct the datatype in its header",
            )));
        }
    })
}

/// Slope and intercept; colours have none.
fn rescale(
    header: &Header,
    stored: ScalarType,
    channels: u64,
) -> Result<Option<Rescale>, VolumeError> {
    let none = header.slope == 0.0 || !header.slope.is_finite();
    if channels > 1 || none {
        return Ok(None);
    }
    if !header.intercept.is_finite() {
        return Err(VolumeError::BadValue(Trouble::new(
            format!(
                "the slope scl_slope is {} and the intercept scl_inter is {}",
                header.slope, header.intercept
            ),
            "set scl_inter to a finite number, or scl_slope to 0 for values as they are stored",
        )));
    }
    let rescale = Rescale::new(stored, None, header.slope, header.intercept);
    Ok((!rescale.is_identity()).then_some(rescale))
}

/// The axes of a file, sorted by what they are.
struct Layout {
    axes: Axes,
    colors: bool,
}

impl Layout {
    fn of(header: &Header, channels: u64) -> Result<Self, VolumeError> {
        let mut sizes = header.sizes()?;
        while sizes.len() > 3 && sizes.last() == Some(&1) {
            sizes.pop();
        }
        if let Some(axis) = (5..sizes.len()).find(|&axis| sizes[axis] > 1) {
            return Err(VolumeError::Unsupported(Trouble::new(
                format!(
                    "axis {} has {} samples; space, time and components are the first five",
                    axis + 1,
                    sizes[axis]
                ),
                "cut the file to five axes",
            )));
        }
        let spatial = sizes.len().min(3);
        let has_time = sizes.len() > 3;
        let first = usize::from(channels > 1);
        let colors = first == 1 && sizes.get(4).is_none_or(|&more| more == 1);
        if first == 1 {
            sizes.insert(0, channels);
        }
        let mut axes = Axes::new(sizes, (first..first + spatial).collect())?;
        if has_time {
            axes = axes.with_time(first + 3)?;
        }
        Ok(Self { axes, colors })
    }
}

/// The time of each step, where the header says it.
fn times(header: &Header, steps: u32) -> Vec<f64> {
    let step = header.pixdim[4];
    let told = step.is_finite() && step > 0.0;
    if !told || !(2..=MOST_TIMES).contains(&steps) {
        return Vec::new();
    }
    let start = if header.toffset.is_finite() {
        header.toffset
    } else {
        0.0
    };
    (0..steps)
        .map(|index| start + f64::from(index) * step)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_other_file_of_a_pair_is_packed_alike_first() {
        assert_eq!(beside("a.b.hdr", "img"), ["a.b.img", "a.b.img.gz"]);
        assert_eq!(beside("a.hdr.gz", "img"), ["a.img.gz", "a.img"]);
        assert_eq!(beside("A.IMG", "hdr"), ["A.HDR", "A.HDR.gz"]);
        assert_eq!(beside("a", "img"), ["a.img", "a.img.gz"]);
    }
}
