//! Raw voxels: no header, x fastest, described by the file's name `name_XxYxZ_type.raw` or by the options.
//!
//! The voxels are little-endian unless the name ends in `_be` or the options say so. A gzip stream is known by
//! its content, unless the file is exactly as long as the plain voxels would be.

use glam::DVec3;
use volgraph_report::{did_you_mean, list_names};
use volgraph_volume::{Grid, ScalarType, Trouble, VolumeError};

use crate::axes::Axes;
use crate::contents::{Contents, Opened};
use crate::input::Input;
use crate::load::LoadOptions;
use crate::piece::{Encoding, Piece};
use crate::stream::{Job, Stored};

/// What the name of a raw file tells.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RawName {
    /// The part before the dimensions.
    pub name: String,
    /// Dimensions, x fastest; may hold zeros, which are refused later.
    pub dims: [u32; 3],
    /// Type of the voxels.
    pub scalar_type: ScalarType,
    /// Byte order, where the name ends in `_be` or `_le`.
    pub big_endian: Option<bool>,
}

const SHAPE: &str = "name it name_XxYxZ_type.raw or name_XxYxZ_type.raw.gz, such as engine_256x256x128_uint8.raw, \
                     or give dimensions and type as options";

/// Reads `name_XxYxZ_type.raw`, with `_le` or `_be` behind the type where wanted and `.gz` at the end where
/// the file is compressed. Folders before the name do not matter.
///
/// # Errors
/// [`VolumeError::RawName`] where the shape is another, [`VolumeError::UnknownType`] where the type is none.
pub fn parse_raw_name(file_name: &str) -> Result<RawName, VolumeError> {
    let no_shape = |cause: String| VolumeError::RawName(Trouble::new(cause, SHAPE));
    let base = file_name.rsplit(['/', '\\']).next().unwrap_or(file_name);
    let stem = strip_endings(base);
    let (stem, big_endian) = match stem.rsplit_once('_') {
        Some((rest, order)) if order.eq_ignore_ascii_case("be") => (rest, Some(true)),
        Some((rest, order)) if order.eq_ignore_ascii_case("le") => (rest, Some(false)),
        _ => (stem, None),
    };
    let missing = || {
        no_shape(format!(
            "the name {base:?} does not tell dimensions and type"
        ))
    };
    let (rest, type_name) = stem.rsplit_once('_').ok_or_else(missing)?;
    let (name, dims) = rest.rsplit_once('_').unwrap_or(("", rest));
    let numbers: Vec<&str> = dims.split(['x', 'X']).collect();
    let [x, y, z] = numbers.as_slice() else {
        return Err(missing());
    };
    let number = |digits: &str| {
        let plain = !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit());
        plain.then(|| digits.parse::<u32>())
    };
    let (Some(x), Some(y), Some(z)) = (number(x), number(y), number(z)) else {
        return Err(missing());
    };
    let (Ok(x), Ok(y), Ok(z)) = (x, y, z) else {
        return Err(no_shape(format!(
            "the dimensions {dims:?} in the name {base:?} are too large"
        )));
    };
    let scalar_type = ScalarType::parse(type_name).ok_or_else(|| unknown_type(type_name))?;
    Ok(RawName {
        name: if name.is_empty() { "volume" } else { name }.to_owned(),
        dims: [x, y, z],
        scalar_type,
        big_endian,
    })
}

/// "No such voxel type", with the nearest one.
pub(crate) fn unknown_type(name: &str) -> VolumeError {
    let known = || ScalarType::ALL.iter().map(|ty| ty.name());
    let name: String = name.chars().take(40).collect();
    VolumeError::UnknownType(Trouble::new(
        format!("there is no voxel type {name:?}"),
        did_you_mean(&name, known()).unwrap_or_else(|| list_names(known())),
    ))
}

fn strip_endings(name: &str) -> &str {
    let strip = |name: &str, ending: &str| -> Option<usize> {
        let at = name.len().checked_sub(ending.len())?;
        let tail = name.get(at..)?;
        tail.eq_ignore_ascii_case(ending).then_some(at)
    };
    let name = strip(name, ".gz").map_or(name, |at| &name[..at]);
    [".raw", ".bin", ".dat"]
        .iter()
        .find_map(|ending| strip(name, ending))
        .map_or(name, |at| &name[..at])
}

/// Whether a file of this name is taken as raw voxels.
pub(crate) fn names_raw(name: &str) -> bool {
    strip_endings(name).len() + ".gz".len() < name.len()
        || !matches!(parse_raw_name(name), Err(VolumeError::RawName(_)))
}

pub(crate) fn open<'a>(
    input: &Input<'a>,
    name: &str,
    looks_like: &str,
    options: &LoadOptions,
) -> Result<Opened<'a>, VolumeError> {
    let parsed = parse_raw_name(name);
    let said = parsed.as_ref().ok();
    let dims = options.dims.or(said.map(|raw| raw.dims));
    let scalar_type = options.scalar_type.or(said.map(|raw| raw.scalar_type));
    let (Some(dims), Some(scalar_type)) = (dims, scalar_type) else {
        return Err(parsed.err().unwrap_or_else(|| unknown_type("")));
    };
    if options.big_endian && said.and_then(|raw| raw.big_endian) == Some(false) {
        return Err(VolumeError::Option(Trouble::new(
            "the options say big-endian, the name says `_le`",
            "leave the option out, or rename the file",
        )));
    }
    let grid = Grid::axis_aligned(dims, DVec3::ONE, DVec3::ZERO);
    grid.check()?;
    let axes = Axes::new(dims.map(u64::from).to_vec(), vec![0, 1, 2])?;
    let count = axes.count()?;
    let what = axes.describe(scalar_type);
    let bytes = u128::from(count) * scalar_type.size() as u128;
    let packed = looks_like == "a gzip stream" && u128::from(input.len) != bytes;
    let job = Job {
        pieces: vec![Piece {
            input: input.clone(),
            start: 0,
            line_skip: 0,
            byte_skip: 0,
            encoding: if packed {
                Encoding::Gzip
            } else {
                Encoding::Raw
            },
            line_end: false,
            encoded_len: None,
        }],
        scalar_type,
        big_endian: options.big_endian || said.and_then(|raw| raw.big_endian).unwrap_or(false),
        count,
        // What the file looks like helps only where it looks like something else.
        what: if packed || looks_like.starts_with("bytes") {
            what
        } else {
            format!("{what} (the file looks like {looks_like})")
        },
    };
    let name = said.map_or_else(|| crate::input::stem(&input.path), |raw| raw.name.clone());
    Ok(Opened {
        contents: Contents::new("raw", name, axes.clone(), scalar_type, grid),
        data: Box::new(Stored {
            job,
            axes,
            rescale: None,
        }),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_dimensions_type_and_byte_order() {
        let raw = parse_raw_name("a/b\\my_head_128x64X112_uint16.raw.gz").unwrap();
        assert_eq!(
            raw,
            RawName {
                name: "my_head".into(),
                dims: [128, 64, 112],
                scalar_type: ScalarType::U16,
                big_endian: None
            }
        );
        assert_eq!(
            parse_raw_name("x_1x2x3_float_BE.RAW").unwrap().big_endian,
            Some(true)
        );
        assert_eq!(parse_raw_name("1x2x3_int8_le.bin").unwrap().name, "volume");
    }

    #[test]
    fn other_names_are_refused() {
        for (name, code) in [
            ("", "volume-raw-name"),
            ("engine.raw", "volume-raw-name"),
            ("engine_256x256_uint8.raw", "volume-raw-name"),
            ("engine_256x256x128x2_uint8.raw", "volume-raw-name"),
            ("engine_256x-1x128_uint8.raw", "volume-raw-name"),
            ("engine_256x+1x128_uint8.raw", "volume-raw-name"),
            ("engine_256x99999999999x128_uint8.raw", "volume-raw-name"),
            ("engine_256x256x128_uint9.raw", "volume-unknown-type"),
        ] {
            assert_eq!(parse_raw_name(name).unwrap_err().code(), code, "{name}");
        }
        let error = parse_raw_name("e_2x2x2_unit8.raw").unwrap_err();
        assert_eq!(error.trouble().remedy, "did you mean `uint8`?");
        assert!(names_raw("notes.raw") && names_raw("e_2x2x2_uint8") && names_raw("A.RAW.GZ"));
        assert!(!names_raw("notes.txt") && !names_raw("archive.gz"));
    }
}
