//! The arguments of `volgraph info`, `volgraph convert` and `volgraph distance-field`: volumes and how they are read and written.

use std::path::PathBuf;

use clap::{Args as ClapArgs, ValueEnum};
use volgraph_formats::{Compression, LoadOptions};
use volgraph_mesh::{Sign, Up};
use volgraph_volume::edit::Filter;
use volgraph_volume::{Component, ScalarType};

use super::words::{parse_dims, parse_type};

/// A volume and how it is read.
#[derive(ClapArgs, Debug)]
pub struct VolumeArgs {
    /// The volume: a file, a folder (of slices, of a file per time step, of Zarr) or a pattern of names (`slices/*.tif`).
    pub volume: PathBuf,
    /// Dimensions of a raw file whose name does not say.
    #[arg(long, value_name = "XxYxZ", value_parser = parse_dims)]
    pub dims: Option<[u32; 3]>,
    /// Scalar type of a raw file whose name does not say, such as uint8.
    #[arg(long = "type", value_name = "TYPE", value_parser = parse_type)]
    pub scalar_type: Option<ScalarType>,
    /// A raw file has its highest byte first.
    #[arg(long)]
    pub big_endian: bool,
    /// Which of several values per voxel: its number from 0, `magnitude` or `color`.
    #[arg(long, value_name = "NUMBER | magnitude | color")]
    pub component: Option<Component>,
    /// Which time step, from 0.
    #[arg(long, value_name = "STEP")]
    pub time: Option<u32>,
    /// Which volume of several, by a part of its name: a series of a folder, an array of a group.
    #[arg(long, value_name = "NAME")]
    pub part: Option<String>,
    /// Which level of a multi-resolution file; 0 is the finest.
    #[arg(long)]
    pub level: Option<u32>,
}

impl VolumeArgs {
    /// The same as options.
    pub fn options(&self) -> LoadOptions {
        LoadOptions {
            dims: self.dims,
            scalar_type: self.scalar_type,
            big_endian: self.big_endian,
            component: self.component,
            time: self.time,
            part: self.part.clone(),
            level: self.level,
            ..LoadOptions::default()
        }
    }
}

/// `volgraph info`.
#[derive(ClapArgs, Debug)]
pub struct InfoArgs {
    /// The volume.
    #[command(flatten)]
    pub volume: VolumeArgs,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// How a volume is written.
#[derive(ClapArgs, Debug)]
pub struct WriteArgs {
    /// How voxels are packed: none, gzip or zstd (OME-Zarr alone), with a level where wanted, as in gzip:9.
    #[arg(long, value_name = "none | gzip[:LEVEL] | zstd[:LEVEL]", value_parser = parse_compression)]
    pub compress: Option<Compression>,
    /// Voxels of a chunk (OME-Zarr).
    #[arg(long, value_name = "XxYxZ", default_value = "64x64x64", value_parser = parse_dims)]
    pub chunk: ChunkSize,
    /// Levels of resolution (OME-Zarr), each half as fine as the one before: a number, or `all` until one fits a chunk.
    #[arg(long, value_name = "N | all", default_value = "1", value_parser = parse_levels)]
    pub levels: u32,
    /// Replace a file that is there.
    #[arg(long)]
    pub force: bool,
    /// Print what was done as JSON.
    #[arg(long)]
    pub json: bool,
}

/// Voxels along x, y and z.
pub type ChunkSize = [u32; 3];

/// `volgraph convert`.
#[derive(ClapArgs, Debug)]
pub struct ConvertArgs {
    /// The volume.
    #[command(flatten)]
    pub volume: VolumeArgs,
    /// The file, by its ending: .nrrd, .nhdr, .mha, .mhd, .nii, .nii.gz, .raw, .raw.gz (the name tells dimensions and type:
    /// name_XxYxZ_type.raw), .npy, or .zarr for a folder of OME-Zarr.
    pub output: PathBuf,
    /// Cut a box out, from the first voxel to behind the last one along x, y and z; it stays where it is in the world.
    #[arg(long, value_name = "X,Y,Z..X,Y,Z", value_parser = parse_crop)]
    pub crop: Option<Crop>,
    /// Resample to these dimensions over the same box.
    #[arg(long, value_name = "XxYxZ", value_parser = parse_dims, conflicts_with = "spacing")]
    pub resample: Option<[u32; 3]>,
    /// Resample to these distances between voxels; one number for all axes.
    #[arg(long, value_name = "LENGTH | X,Y,Z", value_parser = parse_spacing)]
    pub spacing: Option<Spacing>,
    /// How it is resampled: linear (means where there get fewer voxels), nearest, or mode (the commonest label); by default
    /// mode where the file says that it holds labels, and linear elsewhere.
    #[arg(long, value_name = "FILTER")]
    pub filter: Option<FilterName>,
    /// Write voxels of this type; whole numbers are rounded and clamped, and how many were is told.
    #[arg(long = "as", value_name = "TYPE", value_parser = parse_type)]
    pub to: Option<ScalarType>,
    /// Spread the values between these two over all of the type of --as.
    #[arg(long, value_name = "LOW..HIGH", requires = "to", allow_hyphen_values = true, value_parser = parse_window)]
    pub window: Option<Window>,
    /// How it is written.
    #[command(flatten)]
    pub write: WriteArgs,
}

/// `volgraph pyramid`.
#[derive(ClapArgs, Debug)]
pub struct PyramidArgs {
    /// The volume: raw voxels, or uncompressed NRRD, MetaImage, NIfTI, NumPy or HDF5 with one value per voxel, or Zarr.
    #[command(flatten)]
    pub volume: VolumeArgs,
    /// The folder of the pyramid; by default NAME.pyramid.zarr beside the volume, where it is looked for.
    #[arg(short, long, value_name = "FOLDER")]
    pub output: Option<PathBuf>,
    /// Most memory in MiB.
    #[arg(long, value_name = "MIB", default_value = "512", value_parser = clap::value_parser!(u64).range(1..=1 << 20))]
    pub memory: u64,
    /// Voxels along each edge of a brick: a power of two.
    #[arg(long, value_name = "N", default_value = "32")]
    pub edge: u32,
    /// Chunks along each edge of a shard, for file systems that dislike many files.
    #[arg(long, value_name = "N")]
    pub shard: Option<u32>,
    /// Copy the finest level as well, so that the pyramid does without its source.
    #[arg(long)]
    pub copy: bool,
    /// Replace a pyramid that is there.
    #[arg(long)]
    pub force: bool,
    /// Print what was built as JSON.
    #[arg(long)]
    pub json: bool,
}

/// `volgraph distance-field`.
#[derive(ClapArgs, Debug)]
pub struct DistanceFieldArgs {
    /// The mesh: PLY, OBJ or STL, gzip or not.
    pub mesh: PathBuf,
    /// The volume, as `volgraph convert` writes it.
    pub output: PathBuf,
    /// Voxels along the longest axis, margin included.
    #[arg(long, value_name = "N", default_value = "128", value_parser = clap::value_parser!(u32).range(2..=65536))]
    pub longest: u32,
    /// Exactly these dimensions.
    #[arg(long, value_name = "XxYxZ", value_parser = parse_dims, conflicts_with_all = ["longest", "voxel"])]
    pub dims: Option<[u32; 3]>,
    /// The edge of a voxel, in the mesh's unit.
    #[arg(long, value_name = "LENGTH", conflicts_with = "longest")]
    pub voxel: Option<f64>,
    /// Voxels between the mesh and each face of the volume.
    #[arg(long, value_name = "N", default_value = "3")]
    pub margin: u32,
    /// Clamp distances beyond so many voxels, which is faster.
    #[arg(long, value_name = "VOXELS")]
    pub band: Option<f64>,
    /// How inside and outside are told apart: pseudonormal is exact for closed meshes, winding fair for open and broken ones,
    /// auto chooses by the mesh's report, unsigned makes all distances positive.
    #[arg(
        long,
        value_name = "auto | pseudonormal | winding | unsigned",
        default_value = "auto"
    )]
    pub sign: Sign,
    /// The sign of distances inside: positive, so that the solid is where the field is high, as techniques and clips of
    /// volgraph take it; or negative, as most programs write distance fields.
    #[arg(long, value_enum, default_value = "positive")]
    pub inside: InsideName,
    /// Which axis of the mesh points up; y is turned so that it stands upright.
    #[arg(long, value_name = "y | z", default_value = "z")]
    pub up: Up,
    /// How it is written.
    #[command(flatten)]
    pub write: WriteArgs,
}

/// The sign of distances inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum InsideName {
    /// Above 0.
    Positive,
    /// Below 0.
    Negative,
}

/// Ways to resample.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum FilterName {
    /// Linear; means where there get fewer voxels.
    Linear,
    /// The nearest voxel.
    Nearest,
    /// The commonest value.
    Mode,
}

impl From<FilterName> for Filter {
    fn from(name: FilterName) -> Self {
        match name {
            FilterName::Linear => Self::Linear,
            FilterName::Nearest => Self::Nearest,
            FilterName::Mode => Self::Mode,
        }
    }
}

/// First voxel and dimensions of a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crop {
    /// The first voxel.
    pub low: [u32; 3],
    /// Voxels along each axis.
    pub dims: [u32; 3],
}

pub(super) fn parse_crop(text: &str) -> Result<Crop, String> {
    let corner = |text: &str| -> Option<[u32; 3]> {
        let numbers: Option<Vec<u32>> = text.split(',').map(|n| n.trim().parse().ok()).collect();
        numbers?.try_into().ok()
    };
    let ends = text
        .split_once("..")
        .and_then(|(low, high)| Some((corner(low)?, corner(high)?)));
    let (low, high) = ends.ok_or("write it as X,Y,Z..X,Y,Z, such as 0,0,10..256,256,90")?;
    let mut dims = [0; 3];
    for axis in 0..3 {
        dims[axis] = high[axis]
            .checked_sub(low[axis])
            .filter(|n| *n > 0)
            .ok_or("each end must be behind its beginning")?;
    }
    Ok(Crop { low, dims })
}

/// Distances between voxels along x, y and z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spacing(pub [f64; 3]);

fn parse_spacing(text: &str) -> Result<Spacing, String> {
    let numbers: Option<Vec<f64>> = text
        .split(',')
        .map(|n| {
            n.trim()
                .parse()
                .ok()
                .filter(|n: &f64| n.is_finite() && *n > 0.0)
        })
        .collect();
    match numbers.as_deref() {
        Some([all]) => Ok(Spacing([*all; 3])),
        Some([x, y, z]) => Ok(Spacing([*x, *y, *z])),
        _ => Err("give one length above 0, or three with commas".to_owned()),
    }
}

/// Two values, the lower first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window(pub f64, pub f64);

fn parse_window(text: &str) -> Result<Window, String> {
    let ends = text
        .split_once("..")
        .and_then(|(low, high)| Some((low.parse::<f64>().ok()?, high.parse::<f64>().ok()?)));
    match ends {
        Some((low, high)) if low.is_finite() && high.is_finite() && low < high => {
            Ok(Window(low, high))
        }
        _ => Err("write it as LOW..HIGH, such as -200..800".to_owned()),
    }
}

fn parse_compression(text: &str) -> Result<Compression, String> {
    let (name, level) = match text.split_once(':') {
        Some((name, level)) => (name, Some(level)),
        None => (text, None),
    };
    let wrong = || "write none, gzip, gzip:0 to gzip:9, zstd, or zstd:1 to zstd:22".to_owned();
    let number = |default: u32| level.map_or(Ok(default), |it| it.parse().map_err(|_| wrong()));
    match name {
        "none" if level.is_none() => Ok(Compression::None),
        "gzip" => number(6).map(Compression::Gzip),
        "zstd" => i32::try_from(number(3)?)
            .map(Compression::Zstd)
            .map_err(|_| wrong()),
        _ => Err(wrong()),
    }
}

fn parse_levels(text: &str) -> Result<u32, String> {
    match (text, text.parse()) {
        ("all", _) => Ok(volgraph_formats::WriteOptions::ALL_LEVELS),
        (_, Ok(levels)) if levels > 0 => Ok(levels),
        _ => Err("give a number of at least 1, or `all`".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_mean_what_they_say() {
        let crop = parse_crop("1,2,3..4,6,9").unwrap();
        assert_eq!((crop.low, crop.dims), ([1, 2, 3], [3, 4, 6]));
        assert!(parse_crop("1,2,3..4,2,9").is_err() && parse_crop("1,2..4,2,9").is_err());
        assert_eq!(parse_spacing("0.5").unwrap(), Spacing([0.5; 3]));
        assert_eq!(parse_spacing("1,2, 3").unwrap(), Spacing([1.0, 2.0, 3.0]));
        assert!(parse_spacing("0").is_err() && parse_spacing("1,2").is_err());
        assert_eq!(parse_window("-200..800").unwrap(), Window(-200.0, 800.0));
        assert!(parse_window("5..5").is_err() && parse_window("a..b").is_err());
        assert_eq!(parse_compression("gzip:9").unwrap(), Compression::Gzip(9));
        assert!(parse_compression("none:1").is_err() && parse_compression("lz4").is_err());
        assert_eq!(parse_levels("3").unwrap(), 3);
        assert!(parse_levels("0").is_err());
    }
}
