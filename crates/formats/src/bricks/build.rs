//! A pyramid out of a source.
//!
//! Level 1 is made of level 0 in boxes of whole chunks, and on the way range and mean are taken; each further level is
//! made of the one before, read back from its chunks. With all levels there, level 0 passes a second time: it is
//! compared with what each coarser level shows in its place (`survey`), and counted into the histogram. Boxes run in
//! parallel, are read by position, and are as long along x as the bound on memory lets them be. All of it happens in a
//! temporary folder that gets its name at the end.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;
use volgraph_volume::edit::{Filter, Watch};
use volgraph_volume::{Element, ScalarType, Trouble, Values, VolumeError, brick_dims, for_voxels};

use super::DEFAULT_EDGE;
use super::cache::ChunkCache;
use super::chunks::Target;
use super::field::Field;
use super::halve::{Halving, Reduce};
use super::levels::first_in;
use super::plan::{Plan, check_options, first_built, longest, tile_bytes};
use super::side::{self, Side};
use super::source::Source;
use super::tally::Tally;
use crate::load::LoadOptions;
use crate::write::target::{TempFolder, check};
use crate::write::zarr::{group, pretty};
use crate::write::{Compression, WriteOptions};
use crate::zarr::Pyramid;

/// How a pyramid is built.
#[derive(Clone, Debug)]
pub struct BuildOptions {
    /// What is read of the source: dimensions and type of raw voxels, part, time step, component.
    pub load: LoadOptions,
    /// Voxels along each edge of a brick, without its apron: a power of two from 4 to 256; 32 by default.
    pub edge: u32,
    /// Bricks along each edge of a chunk; 1 by default.
    pub chunk_bricks: u32,
    /// Chunks along each edge of a shard, for file systems that dislike many files; each chunk is a file where `None`.
    pub shard_chunks: Option<u32>,
    /// How chunks are packed; Zstandard of level 1 by default.
    pub compression: Compression,
    /// Whether level 0 is copied as well, so that the pyramid does without its source.
    pub copy_level_0: bool,
    /// Most bytes of memory at once; 512 MiB by default. Fewer threads work where it is little.
    pub max_memory: u64,
    /// Whether a pyramid of that name is replaced.
    pub overwrite: bool,
    /// Tells of bytes that are done (level 0 counts twice), and stops.
    pub watch: Watch,
}

impl Default for BuildOptions {
    fn default() -> Self {
        Self {
            load: LoadOptions::default(),
            edge: DEFAULT_EDGE,
            chunk_bricks: 1,
            shard_chunks: None,
            compression: Compression::Zstd(1),
            copy_level_0: false,
            max_memory: 512 << 20,
            overwrite: false,
            watch: Watch::default(),
        }
    }
}

/// What was built.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Built {
    /// The folder of the pyramid.
    pub folder: PathBuf,
    /// All levels, those of the source included.
    pub levels: usize,
    /// How many of them lie in the folder; a Zarr source may have had the others.
    pub written: usize,
}

/// Builds the pyramid of a volume: its coarser levels as an OME-Zarr 0.5 folder at `out` (see
/// [`pyramid_path`](super::pyramid_path) for where it is looked for), with what is known of each brick in a file
/// `bricks.bin` inside. Level 0 is read twice (three times where it is copied), in pieces that fit
/// [`BuildOptions::max_memory`]. An error or an interrupt leaves nothing behind.
///
/// Labels become the most frequent one of the cells under a coarse one; all other values their mean.
///
/// # Errors
/// [`VolumeError::Unsupported`] where bricks of the source cannot be read where they lie (compressed, interleaved, in
/// several files); [`VolumeError::Write`] where `out` is there already or cannot be written; [`VolumeError::Option`]
/// for options that make no sense; [`VolumeError::TooLarge`] where the memory is too little;
/// [`VolumeError::Interrupted`]; what may be wrong with the source otherwise.
pub fn build(source: &Path, out: &Path, options: &BuildOptions) -> Result<Built, VolumeError> {
    side::check_edge(options.edge)?;
    check_options(options)?;
    let write = WriteOptions {
        overwrite: options.overwrite,
        watch: options.watch.clone(),
        ..WriteOptions::default()
    };
    apart(source, out)?;
    check(out, true, &write)?;
    options.watch.check()?;
    let cache = ChunkCache::new(usize::try_from(options.max_memory / 4).unwrap_or(usize::MAX));
    let opened = Source::open(source, &options.load, options.edge, false, &cache)?;
    let folder = TempFolder::beside(out).map_err(|error| error.in_file(out))?;
    let plan = Plan::new(&opened, options).map_err(|error| error.in_file(source))?;
    let build = Build {
        folder: &folder,
        options,
        cache,
        reduce: match opened.about.values {
            Values::Labels(_) => Reduce::Mode,
            _ => Reduce::Mean,
        },
        done: AtomicU64::new(0),
        plan,
    };
    let built = build.run(&opened, source, out);
    let (levels, written) = built.map_err(|error: VolumeError| error.in_file(out))?;
    let folder = folder.finish(&write).map_err(|error| error.in_file(out))?;
    Ok(Built {
        folder,
        levels,
        written,
    })
}

/// Refuses to write a pyramid over its source.
fn apart(source: &Path, out: &Path) -> Result<(), VolumeError> {
    if let (Ok(source), Ok(target)) = (source.canonicalize(), out.canonicalize())
        && source.starts_with(&target)
    {
        return Err(VolumeError::Write(Trouble::new(
            "the pyramid would take the place of its source",
            "give another name",
        ))
        .in_file(out));
    }
    Ok(())
}

/// A build that goes on.
pub(super) struct Build<'a> {
    folder: &'a TempFolder,
    pub(super) options: &'a BuildOptions,
    cache: Arc<ChunkCache>,
    reduce: Reduce,
    done: AtomicU64,
    pub(super) plan: Plan,
}

/// A box of a level: first index and size.
type Tile = ([u32; 3], [u32; 3]);

impl Build<'_> {
    fn run(&self, source: &Source, path: &Path, out: &Path) -> Result<(usize, usize), VolumeError> {
        let levels = &source.levels;
        let copied = self.options.copy_level_0;
        if copied {
            let target = self.target(source, 0)?;
            self.tiles(
                levels[0].grid.dims,
                source.scalar_type,
                |(origin, size)| {
                    target.put(&source.fields[0].read(origin, size)?, origin, size)?;
                    self.report(size, source.scalar_type);
                    Ok(())
                },
                |()| {},
            )?;
        }
        let own = first_built(source, self.options);
        let mut built: Vec<Field> = Vec::new();
        let mut tally = Tally::default();
        for number in own..levels.len() {
            let finer = match number {
                1 => &source.fields[0],
                _ => built.last().unwrap_or(&source.fields[own - 1]),
            };
            let target = self.target(source, number)?;
            let (fine, coarse) = (levels[number - 1].grid.dims, levels[number].grid.dims);
            self.tiles(
                coarse,
                source.scalar_type,
                |(origin, size)| {
                    let halving = Halving::new(fine, coarse, origin, size);
                    let voxels = finer.read(halving.origin, halving.size)?;
                    let part = [0, 1, 2].map(|i| {
                        let first = |at: u32| first_in(at, fine[i], coarse[i]) - halving.origin[i];
                        first(origin[i])..first(origin[i] + size[i])
                    });
                    let counted = (number == 1).then(|| Tally::of(&voxels, halving.size, &part));
                    let smaller = for_voxels!(&voxels, values => {
                        Element::wrap(halving.apply(values, self.reduce))
                    });
                    target.put(&smaller, origin, size)?;
                    self.report(
                        part.map(|range| range.end - range.start),
                        source.scalar_type,
                    );
                    Ok(counted.unwrap_or_default())
                },
                |part| tally.merge(&part),
            )?;
            built.push(self.reopen(number)?);
        }
        if own > 1 || levels.len() == 1 {
            self.tiles(
                levels[0].grid.dims,
                source.scalar_type,
                |(origin, size)| {
                    let voxels = source.fields[0].read(origin, size)?;
                    self.report(size, source.scalar_type);
                    Ok(Tally::of(&voxels, size, &size.map(|n| 0..n)))
                },
                |part| tally.merge(&part),
            )?;
        }
        let fields = source.fields[..own].iter().chain(&built).collect();
        let (statistics, bricks) = self.survey(source, fields, &tally)?;
        let first = if copied { 0 } else { own };
        let grids: Vec<_> = levels[first..].iter().map(|level| level.grid).collect();
        let filter = Filter::for_values(&source.about.values);
        let metadata = group(&source.name, &source.about, first, &grids, false, filter);
        if grids.is_empty() {
            // A group without an image: the source has all levels.
            let empty =
                serde_json::json!({"zarr_format": 3, "node_type": "group", "attributes": {}});
            self.folder.put("zarr.json", &pretty(&empty))?;
        } else {
            self.folder.put("zarr.json", &pretty(&metadata))?;
        }
        let side = Side {
            source: from_folder(path, out),
            tie: source.tie.clone(),
            dims: levels[0].grid.dims,
            scalar_type: source.scalar_type,
            edge: self.options.edge,
            first: u32::try_from(first).unwrap_or(u32::MAX),
            statistics,
            bricks,
        };
        self.folder.put(side::FILE, &side.to_bytes())?;
        Ok((levels.len(), grids.len()))
    }

    fn target(&self, source: &Source, number: usize) -> Result<Target<'_>, VolumeError> {
        Target::new(
            self.folder,
            number,
            source.levels[number].grid,
            source.scalar_type,
            self.options.edge * self.options.chunk_bricks,
            self.options.shard_chunks,
            self.options.compression,
        )
    }

    /// A level that was written.
    fn reopen(&self, number: usize) -> Result<Field, VolumeError> {
        let id = u32::try_from(number).unwrap_or(u32::MAX);
        level_of(self.folder.path(), id, &self.cache)
    }

    /// Runs through a level in boxes of whole units; what comes of them is taken in order.
    fn tiles<O: Send>(
        &self,
        dims: [u32; 3],
        scalar_type: ScalarType,
        work: impl Fn(Tile) -> Result<O, VolumeError> + Sync,
        take: impl FnMut(O),
    ) -> Result<(), VolumeError> {
        let (unit, size) = (self.plan.unit, scalar_type.size() as u64);
        let fits =
            |count: u32| tile_bytes(count * unit, unit, size, [u32::MAX; 3]) <= self.plan.each;
        let counts = brick_dims(dims, unit);
        let along = longest(counts[0], fits);
        let work = |at: [u32; 3]| {
            let origin = [at[0] * along, at[1], at[2]].map(|n| n * unit);
            let most = [along.saturating_mul(unit), unit, unit];
            let size = [0, 1, 2].map(|i| most[i].min(dims[i] - origin[i]));
            work((origin, size))
        };
        self.each(
            [counts[0].div_ceil(along), counts[1], counts[2]],
            work,
            take,
        )
    }

    /// Runs through a grid of boxes in batches.
    pub(super) fn each<O: Send>(
        &self,
        counts: [u32; 3],
        work: impl Fn([u32; 3]) -> Result<O, VolumeError> + Sync,
        mut take: impl FnMut(O),
    ) -> Result<(), VolumeError> {
        let [nx, ny, nz] = counts.map(u64::from);
        let total = nx * ny * nz;
        let batch = 8 * self.plan.pool.current_num_threads() as u64;
        #[expect(clippy::cast_possible_truncation, reason = "indices below u32 counts")]
        let at = |i: u64| [i % nx, i / nx % ny, i / (nx * ny)].map(|n| n as u32);
        let mut from = 0;
        while from < total {
            let end = total.min(from + batch);
            let outcomes: Vec<Result<O, VolumeError>> = self.plan.pool.install(|| {
                let range = (from..end).into_par_iter();
                range
                    .map(|i| {
                        self.options.watch.check()?;
                        work(at(i))
                    })
                    .collect()
            });
            for outcome in outcomes {
                take(outcome?);
            }
            from = end;
        }
        Ok(())
    }

    pub(super) fn report(&self, size: [u32; 3], scalar_type: ScalarType) {
        let voxels: u64 = size.iter().map(|&n| u64::from(n)).product();
        let bytes = voxels * scalar_type.size() as u64;
        let done = self.done.fetch_add(bytes, Ordering::Relaxed) + bytes;
        self.options
            .watch
            .report(done.min(self.plan.total), self.plan.total);
    }
}

/// A level that lies in a pyramid's folder; its number is its name in the cache.
pub(super) fn level_of(
    folder: &Path,
    number: u32,
    cache: &Arc<ChunkCache>,
) -> Result<Field, VolumeError> {
    let path = folder.join(number.to_string());
    let pyramid = Arc::new(Pyramid::open(&path, &LoadOptions::default())?);
    Field::of_zarr(pyramid, 0, number, cache).ok_or_else(|| {
        VolumeError::DataFile(Trouble::new("has no level", "build the pyramid again"))
            .in_file(&path)
    })
}

/// The source's path as it is found from the folder of the pyramid: its name where they lie side by side.
fn from_folder(source: &Path, out: &Path) -> String {
    let full = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
    let source = crate::zarr::folder(source).unwrap_or_else(|| source.to_path_buf());
    let (source, out) = (full(&source), full(out));
    let beside = out
        .parent()
        .and_then(|parent| source.strip_prefix(parent).ok());
    beside.unwrap_or(&source).to_string_lossy().into_owned()
}
