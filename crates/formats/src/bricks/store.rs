//! The way to bricks: opening a volume with its pyramid, and reading.

use std::fmt;
use std::path::{Path, PathBuf};

use volgraph_volume::{About, ScalarType, Trouble, VolumeError, Voxels, drawn, for_scalar_type};

use super::build::level_of;
use super::cache::ChunkCache;
use super::field::Field;
use super::levels::{BrickLevel, levels};
use super::side::{FILE, Packed, Side};
use super::source::{Source, pyramid_path};
use super::survey::number;
use super::{BrickInfo, BrickStatistics};
use crate::load::LoadOptions;
use crate::reader::VolumeReader;

/// How a [`BrickStore`] is opened.
#[derive(Clone, Debug)]
pub struct StoreOptions {
    /// What is read of the source, as when the pyramid was built; placement may be another.
    pub load: LoadOptions,
    /// Where the pyramid is, if not at [`pyramid_path`].
    pub pyramid: Option<PathBuf>,
    /// Most bytes of unpacked chunks that are kept for neighbours; 256 MiB by default.
    pub cache_bytes: u64,
    /// Whether level 0 of a plain file is memory-mapped, which is many times faster for single bricks than reading at
    /// positions. True by default; see [`BrickStore::open`] for files that may shrink.
    pub mapped: bool,
}

impl Default for StoreOptions {
    fn default() -> Self {
        Self {
            load: LoadOptions::default(),
            pyramid: None,
            cache_bytes: 256 << 20,
            mapped: true,
        }
    }
}

/// A volume as levels of bricks, read on demand. It may be shared among threads and read from several at once.
///
/// A brick has `edge` voxels along each axis, and an apron of one more on every side: `edge + 2` in all, x fastest.
/// Voxel `(i, j, k)` of brick `b` is sample `b * edge + (i, j, k) - 1` of its level, clamped to the level's samples, so
/// that trilinear filtering within a brick gives what it gives within the whole level. All bricks have that size; those
/// at the end of an axis repeat its last sample.
///
/// Each level has `n.div_ceil(2)` samples along an axis where the one before has `n`, and all share one box (see
/// [`BrickLevel::grid`]). Where all sizes are even, brick `b` of a level has the bricks `2 b` and `2 b + 1` of the one
/// before below it; where a size is odd, boxes of bricks meet only about there, and a place is looked up by its index.
pub struct BrickStore {
    name: String,
    about: About,
    scalar_type: ScalarType,
    edge: u32,
    levels: Vec<BrickLevel>,
    fields: Vec<Field>,
    bricks: Vec<Vec<Packed>>,
    statistics: BrickStatistics,
    path: PathBuf,
    pyramid: PathBuf,
    digest: [u8; 32],
}

impl fmt::Debug for BrickStore {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("BrickStore")
            .field("path", &self.path)
            .field("pyramid", &self.pyramid)
            .finish_non_exhaustive()
    }
}

impl BrickStore {
    /// Opens a volume whose pyramid was built, or the pyramid itself. The source must be the one that it was built of:
    /// length, time of change and a digest of samples are compared. A pyramid with a copy of level 0 needs no source.
    ///
    /// **Mapped files.** Level 0 of a plain file is memory-mapped unless [`StoreOptions::mapped`] is false. Every read
    /// looks at the file's length first, and a file that was cut off is an error. But should it be cut off *while* a
    /// brick is copied, or its disk fail then, the system ends the process (SIGBUS on Unix). For files on drives that
    /// may go away, open them unmapped.
    ///
    /// # Errors
    /// [`VolumeError::DataFile`] where the pyramid is not there; [`VolumeError::DataCorrupt`] where it was damaged, or
    /// was built of another source; what may be wrong with the source otherwise. All name the file and the remedy.
    pub fn open(path: &Path, options: &StoreOptions) -> Result<Self, VolumeError> {
        let own = path.join(FILE).is_file();
        let pyramid = match &options.pyramid {
            _ if own => path.to_path_buf(),
            Some(pyramid) => pyramid.clone(),
            None => pyramid_path(path),
        };
        if !own && !path.exists() {
            return Err(VolumeError::Unreadable(Trouble::new(
                "is not there",
                "give the path of a volume, or of its pyramid",
            ))
            .in_file(path));
        }
        if !pyramid.join(FILE).is_file() {
            return Err(VolumeError::DataFile(Trouble::new(
                format!(
                    "has no pyramid of levels: {} is not there",
                    pyramid.display()
                ),
                "build its pyramid first (`volgraph pyramid`)",
            ))
            .in_file(path));
        }
        let side = Side::read(&pyramid)?;
        let source = if own {
            side.source_path(&pyramid)
        } else {
            path.to_path_buf()
        };
        Self::of_side(side, &source, &pyramid, options).map_err(|error| error.in_file(&pyramid))
    }

    fn of_side(
        side: Side,
        path: &Path,
        pyramid: &Path,
        options: &StoreOptions,
    ) -> Result<Self, VolumeError> {
        let digest = *blake3::hash(&side.to_bytes()).as_bytes();
        let cache = ChunkCache::new(usize::try_from(options.cache_bytes).unwrap_or(usize::MAX));
        let (name, about, levels, mut fields) = if side.first == 0 && !path.exists() {
            let reader = VolumeReader::open(pyramid, &LoadOptions::default())?;
            let contents = &reader.opened().contents;
            let levels = levels(reader.grid(), side.edge);
            (
                contents.name.clone(),
                contents.about.clone(),
                levels,
                Vec::new(),
            )
        } else {
            let source = Source::open(path, &options.load, side.edge, options.mapped, &cache)?;
            if source.tie != side.tie {
                return Err(stale(path));
            }
            (source.name, source.about, source.levels, source.fields)
        };
        fields.truncate(side.first as usize);
        let broken = |cause: String| {
            VolumeError::DataCorrupt(Trouble::new(cause, "build the pyramid again"))
        };
        if levels[0].grid.dims != side.dims {
            return Err(stale(path));
        }
        if fields.len() != side.first as usize {
            return Err(broken(format!(
                "levels below {} are not in the source",
                side.first
            )));
        }
        for number in side.first..u32::try_from(levels.len()).unwrap_or(u32::MAX) {
            fields.push(level_of(pyramid, number, &cache)?);
        }
        for (number, (field, level)) in fields.iter().zip(&levels).enumerate() {
            if field.dims != level.grid.dims || field.scalar_type != side.scalar_type {
                return Err(broken(format!(
                    "level {number} has {:?} voxels of {}, not {:?} of {}",
                    field.dims, field.scalar_type, level.grid.dims, side.scalar_type
                )));
            }
        }
        Ok(Self {
            name,
            about,
            scalar_type: side.scalar_type,
            edge: side.edge,
            levels,
            fields,
            bricks: side.bricks,
            statistics: side.statistics,
            path: path.to_path_buf(),
            pyramid: pyramid.to_path_buf(),
            digest,
        })
    }

    /// A short name of the volume.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What its file says beside grid and voxels.
    #[must_use]
    pub fn about(&self) -> &About {
        &self.about
    }

    /// The type of the voxels on all levels.
    #[must_use]
    pub fn scalar_type(&self) -> ScalarType {
        self.scalar_type
    }

    /// The levels, finest first; the last one fits a single brick.
    #[must_use]
    pub fn levels(&self) -> &[BrickLevel] {
        &self.levels
    }

    /// Voxels along each edge of a brick without its apron.
    #[must_use]
    pub fn edge(&self) -> u32 {
        self.edge
    }

    /// Bytes of a brick with its apron.
    #[must_use]
    pub fn brick_bytes(&self) -> usize {
        (self.edge as usize + 2).pow(3) * self.scalar_type.size()
    }

    /// What all voxels of level 0 are like.
    #[must_use]
    pub fn statistics(&self) -> &BrickStatistics {
        &self.statistics
    }

    /// The source's path and the pyramid's.
    #[must_use]
    pub fn paths(&self) -> [&Path; 2] {
        [&self.path, &self.pyramid]
    }

    /// What is drawn for a voxel's value: itself where it is finite; the smallest finite value for one that is not a
    /// number, the nearest finite one for an infinite one; 0 where no voxel is finite. Bricks have the values as they are.
    #[must_use]
    pub fn drawn(&self, value: f64) -> f64 {
        drawn(value, self.statistics.range())
    }

    /// Changes whenever the volume or its levels do.
    #[must_use]
    pub fn digest(&self) -> [u8; 32] {
        self.digest
    }

    /// What is known of a brick; `None` where there is no such level or brick.
    #[must_use]
    pub fn brick_info(&self, level: usize, brick: [u32; 3]) -> Option<BrickInfo> {
        let bricks = self.levels.get(level)?.bricks;
        if (0..3).any(|i| brick[i] >= bricks[i]) {
            return None;
        }
        let packed = self.bricks.get(level)?.get(number(bricks, brick))?;
        Some(packed.info())
    }

    /// A brick with its apron, `(edge + 2)^3` voxels, x fastest.
    ///
    /// # Errors
    /// [`VolumeError::Option`] where there is no such level or brick; what may be wrong with the file otherwise.
    pub fn read_brick(&self, level: usize, brick: [u32; 3]) -> Result<Voxels, VolumeError> {
        let count = (self.edge as usize + 2).pow(3);
        for_scalar_type!(self.scalar_type, T => {
            let mut values: Vec<T> = vec![bytemuck::Zeroable::zeroed(); count];
            self.read_brick_into(level, brick, bytemuck::cast_slice_mut(&mut values))?;
            Ok(values.into())
        })
    }

    /// As [`BrickStore::read_brick`], into a slice of just [`BrickStore::brick_bytes`], in the machine's byte order.
    ///
    /// # Errors
    /// As [`BrickStore::read_brick`]; [`VolumeError::Option`] where the slice has another length.
    pub fn read_brick_into(
        &self,
        level: usize,
        brick: [u32; 3],
        out: &mut [u8],
    ) -> Result<(), VolumeError> {
        let refuse = |cause: String, remedy: &str| {
            Err(VolumeError::Option(Trouble::new(cause, remedy)).in_file(&self.path))
        };
        let (Some(known), Some(field)) = (self.levels.get(level), self.fields.get(level)) else {
            let count = self.levels.len();
            return refuse(
                format!("there is no level {level} of {count}"),
                "name one that is there",
            );
        };
        if (0..3).any(|i| brick[i] >= known.bricks[i]) {
            let bricks = known.bricks;
            return refuse(
                format!("there is no brick {brick:?} of {bricks:?} on level {level}"),
                "name one that is there",
            );
        }
        if out.len() != self.brick_bytes() {
            return refuse(
                format!(
                    "a slice of {} bytes for a brick of {}",
                    out.len(),
                    self.brick_bytes()
                ),
                "give one of `brick_bytes`",
            );
        }
        let (dims, whole) = (known.grid.dims, self.edge + 2);
        let low = brick.map(|b| (b * self.edge).saturating_sub(1));
        let high = [0, 1, 2]
            .map(|i| (u64::from(brick[i] + 1) * u64::from(self.edge) + 1).min(dims[i].into()));
        let size = [0, 1, 2].map(|i| high[i] as u32 - low[i]);
        let read = if size == [whole; 3] {
            field.read_into(low, size, out)
        } else {
            field.read(low, size).map(|voxels| {
                // The brick's first voxel is one before its core.
                let lead = brick.map(|b| u32::from(b == 0));
                clamped(
                    voxels.as_bytes(),
                    size,
                    lead,
                    whole,
                    self.scalar_type.size(),
                    out,
                );
            })
        };
        read.map_err(|error| {
            error.in_file(if level == 0 {
                &self.path
            } else {
                &self.pyramid
            })
        })
    }

    /// The voxels of any box of a level, x fastest.
    ///
    /// # Errors
    /// [`VolumeError::Option`] where the level or the box is not there; what may be wrong with the file otherwise.
    pub fn read_region(
        &self,
        level: usize,
        origin: [u32; 3],
        size: [u32; 3],
    ) -> Result<Voxels, VolumeError> {
        let field = self.fields.get(level).filter(|field| {
            let end = |i: usize| u64::from(origin[i]) + u64::from(size[i]);
            (0..3).all(|i| size[i] > 0 && end(i) <= u64::from(field.dims[i]))
        });
        let Some(field) = field else {
            return Err(VolumeError::Option(Trouble::new(
                format!("there is no box from {origin:?} of {size:?} voxels on level {level}"),
                "ask for at least one voxel along each axis, inside of a level that is there",
            ))
            .in_file(&self.path));
        };
        field
            .read(origin, size)
            .map_err(|error| error.in_file(&self.path))
    }
}

/// A cube of `whole` voxels along each edge out of a smaller box: `lead` voxels before it and those behind it repeat its
/// first and last ones.
fn clamped(from: &[u8], size: [u32; 3], lead: [u32; 3], whole: u32, each: usize, out: &mut [u8]) {
    let at = |i: u32, axis: usize| i.saturating_sub(lead[axis]).min(size[axis] - 1) as usize;
    let [nx, ny, _] = size.map(|n| n as usize);
    let mut rows = out.chunks_exact_mut(whole as usize * each);
    for z in 0..whole {
        for y in 0..whole {
            let Some(row) = rows.next() else { return };
            let start = (at(z, 2) * ny + at(y, 1)) * nx * each;
            let source = &from[start..start + nx * each];
            for (x, out) in (0..whole).zip(row.chunks_exact_mut(each)) {
                let x = at(x, 0) * each;
                out.copy_from_slice(&source[x..x + each]);
            }
        }
    }
}

fn stale(path: &Path) -> VolumeError {
    VolumeError::DataCorrupt(Trouble::new(
        format!(
            "the pyramid was built of another state of {}, or of another choice of it",
            path.display()
        ),
        "build the pyramid again",
    ))
}

impl Side {
    /// Where the source should be.
    fn source_path(&self, pyramid: &Path) -> PathBuf {
        let parent = pyramid.parent().unwrap_or(Path::new(""));
        parent.join(&self.source)
    }
}
