//! Volumes into files.
//!
//! [`write`] picks the format by the name's ending (or [`WriteOptions::format`]), and its module writes header and
//! voxels into a temporary file or folder beside the target (`target`), block by block, watched by a
//! [`Watch`]. Only when all is there does it get its name; an error or an interrupt leaves nothing behind.
//! What a format cannot say (a placement, a centring, colours) is told in [`Written::warnings`]; voxels and the
//! placement that a format can say are written to the last digit.

mod metaimage;
mod nifti;
mod nrrd;
mod plain;
pub(crate) mod target;
pub(crate) mod zarr;

use std::path::{Path, PathBuf};

use volgraph_volume::edit::Watch;
use volgraph_volume::{Trouble, Volume, VolumeError};

/// Formats that are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileFormat {
    /// NRRD: `.nrrd`, or `.nhdr` with the voxels in a file beside it.
    Nrrd,
    /// MetaImage: `.mha`, or `.mhd` with the voxels in a file beside it.
    MetaImage,
    /// NIfTI-1, or NIfTI-2 where a dimension needs it: `.nii` and `.nii.gz`.
    Nifti,
    /// NIfTI-2, whose placement has all digits.
    Nifti2,
    /// Plain voxels that the name describes: `name_XxYxZ_type.raw` and `.raw.gz`.
    Raw,
    /// An array of NumPy: `.npy`.
    Npy,
    /// A folder of OME-Zarr 0.5 (Zarr v3): `.zarr`.
    Zarr,
}

impl FileFormat {
    /// All of them with their endings.
    pub const ALL: [(Self, &'static [&'static str]); 6] = [
        (Self::Nrrd, &[".nrrd", ".nhdr"]),
        (Self::MetaImage, &[".mha", ".mhd"]),
        (Self::Nifti, &[".nii", ".nii.gz"]),
        (Self::Raw, &[".raw", ".raw.gz"]),
        (Self::Npy, &[".npy"]),
        (Self::Zarr, &[".zarr"]),
    ];

    /// The format that a name's ending promises.
    #[must_use]
    pub fn of_name(path: &Path) -> Option<Self> {
        Self::ALL
            .iter()
            .find(|(_, endings)| endings.iter().any(|ending| ends_with(path, ending)))
            .map(|(format, _)| *format)
    }
}

/// How voxels are packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compression {
    /// Not at all.
    None,
    /// Deflate with a level of 0 to 9: gzip, and zlib in MetaImage.
    Gzip(u32),
    /// Zstandard with a level of 1 to 22; OME-Zarr alone has it.
    Zstd(i32),
}

/// How a volume is written. The default writes what the name's ending says and never over anything.
#[derive(Clone, Debug)]
pub struct WriteOptions {
    /// The format, where the name's ending does not say it.
    pub format: Option<FileFormat>,
    /// How voxels are packed; where `None`, gzip where the name ends in `.gz`, Zstandard in OME-Zarr, not at all
    /// elsewhere.
    pub compression: Option<Compression>,
    /// Voxels of a chunk along x, y and z (OME-Zarr).
    pub chunk: [u32; 3],
    /// Levels of resolution (OME-Zarr), each half as fine as the one before; fewer where a level fits one chunk.
    pub levels: u32,
    /// Whether a file or folder of that name is replaced.
    pub overwrite: bool,
    /// Tells of voxel bytes that are written, and stops.
    pub watch: Watch,
}

impl WriteOptions {
    /// For [`WriteOptions::levels`]: until a level fits one chunk.
    pub const ALL_LEVELS: u32 = u32::MAX;
}

impl Default for WriteOptions {
    fn default() -> Self {
        Self {
            format: None,
            compression: None,
            chunk: [64; 3],
            levels: 1,
            overwrite: false,
            watch: Watch::default(),
        }
    }
}

/// What was written.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Written {
    /// The file or folder that was named, and the data file beside it where there is one.
    pub files: Vec<PathBuf>,
    /// Bytes on disk.
    pub bytes: u64,
    /// What the format could not say.
    pub warnings: Vec<String>,
}

/// Writes a volume; where it has colours, they are written instead of the scalars if the format has colours.
///
/// # Errors
/// [`VolumeError::Write`] where the target is there already, cannot be written, or the format or its options do not
/// fit; [`VolumeError::RawName`] where a raw file's name does not tell its voxels; [`VolumeError::Interrupted`].
pub fn write(volume: &Volume, path: &Path, options: &WriteOptions) -> Result<Written, VolumeError> {
    let written = || {
        let format = options.format.or_else(|| FileFormat::of_name(path));
        let Some(format) = format else {
            let endings: Vec<&str> = FileFormat::ALL
                .iter()
                .flat_map(|(_, endings)| *endings)
                .copied()
                .collect();
            return Err(VolumeError::Write(Trouble::new(
                "the name's ending tells no format that is written",
                format!(
                    "end it in one of {}, or name the format",
                    endings.join(", ")
                ),
            )));
        };
        check_packing(format, options.compression)?;
        target::check(path, format == FileFormat::Zarr, options)?;
        options.watch.check()?;
        match format {
            FileFormat::Nrrd => nrrd::write(volume, path, options),
            FileFormat::MetaImage => metaimage::write(volume, path, options),
            FileFormat::Nifti => nifti::write(volume, path, options, false),
            FileFormat::Nifti2 => nifti::write(volume, path, options, true),
            FileFormat::Raw => plain::write_raw(volume, path, options),
            FileFormat::Npy => plain::write_npy(volume, path, options),
            FileFormat::Zarr => zarr::write(volume, path, options),
        }
    };
    written().map_err(|error: VolumeError| error.in_file(path))
}

fn check_packing(format: FileFormat, compression: Option<Compression>) -> Result<(), VolumeError> {
    let refuse = |cause: &str, remedy: &str| Err(VolumeError::Write(Trouble::new(cause, remedy)));
    match compression {
        Some(Compression::Gzip(level)) if level > 9 => {
            refuse("deflate has no level past 9", "give a level of 0 to 9")
        }
        Some(Compression::Zstd(level)) if !(1..=22).contains(&level) => {
            refuse("Zstandard has levels of 1 to 22", "give a level of 1 to 22")
        }
        Some(Compression::Zstd(_)) if format != FileFormat::Zarr => refuse(
            "this format has no Zstandard compression",
            "use gzip, or write OME-Zarr",
        ),
        Some(Compression::Gzip(_)) if format == FileFormat::Npy => {
            refuse("this format is not compressed", "leave the compression out")
        }
        _ => Ok(()),
    }
}

/// Whether a name ends so in any case.
fn ends_with(path: &Path, ending: &str) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    name.to_ascii_lowercase().ends_with(ending)
}

/// The level of deflate, where there is one.
fn deflate_level(path: &Path, options: &WriteOptions) -> Option<u32> {
    match options.compression {
        Some(Compression::Gzip(level)) => Some(level),
        Some(_) => None,
        None => ends_with(path, ".gz").then_some(6),
    }
}

/// The file beside a header that holds the voxels.
fn beside(path: &Path, ending: &str) -> PathBuf {
    path.with_extension(ending)
}

const NO_NODES: &str = "the format cannot say that samples lie on nodes: the box reads as half a voxel larger on each side";
const NO_COLORS: &str = "the format has no colours: the scalars were written";
const NO_PLACE: &str =
    "the format has no placement: spacing, origin and directions are not in the file";

/// Whether a placement says more than the default one.
fn placed(volume: &Volume) -> bool {
    volume.grid().world_from_index != glam::DAffine3::IDENTITY
}
