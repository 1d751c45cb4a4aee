//! Where level 0 comes from: a run of a file, or a Zarr image, which may have coarser levels that serve as they are.
//!
//! The header is read by the format's own reader; the voxels stay where they are. A [`Tie`] says which file that was, so
//! that what was built of it is not shown with another one.

use std::fs::{File, Metadata};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::UNIX_EPOCH;

use volgraph_volume::{About, Component, Picked, ScalarType, Step, Trouble, VolumeError};

use super::cache::ChunkCache;
use super::field::{Field, read_at};
use super::levels::{self, BrickLevel};
use crate::load::{Limits, LoadOptions};
use crate::pick;
use crate::reader::VolumeReader;
use crate::stream::FileRun;
use crate::zarr::{self, Pyramid};

/// Blocks of a file that its digest is of, and their bytes.
const SAMPLES: u64 = 64;
const SAMPLE: u64 = 4096;

/// Chunks of an image that its digest is of.
const SAMPLED_CHUNKS: u32 = 8;

/// A volume whose header was read.
pub(super) struct Source {
    pub name: String,
    pub about: About,
    pub scalar_type: ScalarType,
    pub levels: Vec<BrickLevel>,
    /// Level 0, and those behind it that are there already.
    pub fields: Vec<Field>,
    pub tie: Tie,
}

/// What tells that a source is the one that a pyramid was built of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Tie {
    /// Bytes of the file that holds the voxels, or of an array's metadata.
    pub len: u64,
    /// When that was changed last, in nanoseconds since 1970.
    pub modified: u64,
    /// Of samples of the voxels and of what was chosen of them.
    pub digest: String,
}

impl Source {
    pub fn open(
        path: &Path,
        options: &LoadOptions,
        edge: u32,
        mapped: bool,
        cache: &Arc<ChunkCache>,
    ) -> Result<Self, VolumeError> {
        let options = &LoadOptions {
            level: None,
            progress: None,
            ..options.clone()
        };
        let reader = VolumeReader::open(path, options)?;
        let opened = || {
            let contents = &reader.opened().contents;
            let component = pick::component(contents, options)?;
            if let Some(other @ (Component::Color | Component::Magnitude)) = component {
                return Err(VolumeError::Component(Trouble::new(
                    format!("bricks have one stored value per voxel, not {other}"),
                    "name one with the option `component`, by its number",
                )));
            }
            let (index, count) = (options.time.unwrap_or(0), reader.step_count());
            if index >= count {
                return Err(VolumeError::Option(Trouble::new(
                    format!("there is no time step {index} of {count}"),
                    format!("name one of 0 to {}", count - 1),
                )));
            }
            let levels = levels::levels(reader.grid(), edge);
            let values = contents.axes.component_count();
            let about = About {
                picked: component.filter(|_| values > 1).map(|component| Picked {
                    component,
                    count: values,
                }),
                step: (count > 1).then(|| Step {
                    index,
                    count,
                    time: contents.times.get(index as usize).copied(),
                    unit: contents.time_unit.clone(),
                }),
                ..contents.about.clone()
            };
            let chosen = format!("{index} {component:?}");
            let is_image = contents.about.format.contains("Zarr");
            let (fields, tie) = if is_image {
                let pyramid = Arc::new(Pyramid::open(path, options)?);
                let fields = own_levels(&pyramid, &levels, cache);
                let file = contents.data_files.first().map_or(path, PathBuf::as_path);
                let tie = tie_of_image(file, &pyramid, &chosen)?;
                (fields, tie)
            } else {
                let limits = Limits::new(None, None);
                let run = reader.opened().data.run(index, &limits)?;
                let voxels = reader.grid().voxel_count();
                let run = run.filter(|run| run.count == voxels).ok_or_else(no_run)?;
                let tie = tie_of_file(&run, &chosen)?;
                (vec![Field::of_run(run, reader.grid().dims, mapped)?], tie)
            };
            let Some(scalar_type) = fields.first().map(|field| field.scalar_type) else {
                return Err(no_run());
            };
            Ok(Self {
                name: contents.name.clone(),
                about,
                scalar_type,
                levels,
                fields,
                tie,
            })
        };
        opened().map_err(|error: VolumeError| error.in_file(path))
    }
}

fn no_run() -> VolumeError {
    VolumeError::Unsupported(Trouble::new(
        "its voxels are not plain ones in one run of one file, of which bricks could be read",
        "convert it first: `volgraph convert IN OUT.zarr`",
    ))
}

/// Level 0, and the ones behind it as long as each halves the one before and lies where it should.
fn own_levels(
    pyramid: &Arc<Pyramid>,
    levels: &[BrickLevel],
    cache: &Arc<ChunkCache>,
) -> Vec<Field> {
    let mut fields: Vec<Field> = Vec::new();
    let Some(finest) = pyramid.levels().next().copied() else {
        return fields;
    };
    for ((number, there), wanted) in (0_u32..).zip(pyramid.levels()).zip(levels) {
        let place = levels::coarse(&finest.grid, wanted.grid.dims).world_from_index;
        let near = there
            .grid
            .world_from_index
            .abs_diff_eq(place, 1e-6 * there.grid.min_spacing());
        let fits = there.grid.dims == wanted.grid.dims
            && there.scalar_type == finest.scalar_type
            && (number == 0 || near);
        match Field::of_zarr(Arc::clone(pyramid), number as usize, number, cache) {
            Some(field) if fits => fields.push(field),
            _ => break,
        }
    }
    fields
}

fn tie_of_file(run: &FileRun, chosen: &str) -> Result<Tie, VolumeError> {
    let unreadable = |error: &std::io::Error| unreadable(&run.file, error);
    let file = File::open(&run.file).map_err(|error| unreadable(&error))?;
    let metadata = file.metadata().map_err(|error| unreadable(&error))?;
    let bytes = run.count * run.scalar_type.size() as u64;
    let mut hasher = blake3::Hasher::new();
    hasher.update(
        format!(
            "{chosen} {} {} {:?}",
            run.offset, run.big_endian, run.rescale
        )
        .as_bytes(),
    );
    let mut block = vec![0; SAMPLE.min(bytes) as usize];
    let last = bytes - block.len() as u64;
    for sample in 0..SAMPLES {
        let at = u128::from(last) * u128::from(sample) / u128::from(SAMPLES - 1);
        read_at(&file, &mut block, run.offset + at as u64).map_err(|error| unreadable(&error))?;
        hasher.update(&block);
    }
    Ok(Tie {
        len: metadata.len(),
        modified: modified(&metadata),
        digest: hasher.finalize().to_hex().to_string(),
    })
}

fn tie_of_image(file: &Path, pyramid: &Pyramid, chosen: &str) -> Result<Tie, VolumeError> {
    let metadata = file.metadata().map_err(|error| unreadable(file, &error))?;
    let text = pyramid.metadata()?;
    let mut hasher = blake3::Hasher::new();
    hasher.update(chosen.as_bytes()).update(&text);
    if let Some(level) = pyramid.levels().next().copied() {
        let (dims, chunk) = (level.grid.dims, level.chunk);
        let most = [0, 1, 2].map(|i| (dims[i] - 1) / chunk[i]);
        for sample in 0..SAMPLED_CHUNKS {
            // Along the diagonal.
            let at = most.map(|n| u64::from(n) * u64::from(sample) / u64::from(SAMPLED_CHUNKS - 1));
            let at = [0, 1, 2].map(|i| at[i] as u32 * chunk[i]);
            let size = [0, 1, 2].map(|i| chunk[i].min(dims[i] - at[i]).min(32));
            hasher.update(pyramid.read_region(0, at, size)?.as_bytes());
        }
    }
    Ok(Tie {
        len: metadata.len(),
        modified: modified(&metadata),
        digest: hasher.finalize().to_hex().to_string(),
    })
}

fn modified(metadata: &Metadata) -> u64 {
    let time = metadata.modified().ok();
    let since = time.and_then(|time| time.duration_since(UNIX_EPOCH).ok());
    since.map_or(0, |since| {
        u64::try_from(since.as_nanos()).unwrap_or(u64::MAX)
    })
}

fn unreadable(file: &Path, error: &std::io::Error) -> VolumeError {
    VolumeError::Unreadable(Trouble::new(
        format!("cannot be read: {error}"),
        "check the file, its permissions and the disk",
    ))
    .in_file(file)
}

/// Where the pyramid of a volume lies unless it is told otherwise: `NAME.pyramid.zarr` beside it, NAME with its
/// ending (`head.nrrd.pyramid.zarr`).
#[must_use]
pub fn pyramid_path(source: &Path) -> PathBuf {
    let source = zarr::folder(source).unwrap_or_else(|| source.to_path_buf());
    let mut name = source.file_name().unwrap_or_default().to_os_string();
    name.push(".pyramid.zarr");
    source.with_file_name(name)
}
