//! How a build keeps to its bound on memory: how many threads work, and how large a box each may take.

use rayon::{ThreadPool, ThreadPoolBuilder};
use volgraph_volume::{Trouble, VolumeError};

use super::build::BuildOptions;
use super::side::{self, BINS};
use super::source::Source;
use crate::write::Compression;

/// Refuses options that make no sense.
pub(super) fn check_options(options: &BuildOptions) -> Result<(), VolumeError> {
    let few = |n: u32| (1..=64).contains(&n);
    if !few(options.chunk_bricks) || !options.shard_chunks.is_none_or(few) {
        return Err(VolumeError::Option(Trouble::new(
            "chunks of no bricks or shards of no chunks, or of more than 64 along an edge",
            "give 1 to 64 of them",
        )));
    }
    match options.compression {
        Compression::Gzip(10..) => Some("deflate has levels of 0 to 9"),
        Compression::Zstd(level) if !(1..=22).contains(&level) => {
            Some("Zstandard has levels of 1 to 22")
        }
        _ => None,
    }
    .map_or(Ok(()), |cause| {
        Err(VolumeError::Option(Trouble::new(
            cause,
            "give one of these",
        )))
    })
}

/// How much is done at once.
pub(super) struct Plan {
    pub pool: ThreadPool,
    /// Bytes that one thread may have.
    pub each: u64,
    /// Voxels along the edge of what is written at once.
    pub unit: u32,
    /// Bytes that will be reported.
    pub total: u64,
}

impl Plan {
    pub fn new(source: &Source, options: &BuildOptions) -> Result<Self, VolumeError> {
        let size = source.scalar_type.size() as u64;
        let unit = options.edge * options.chunk_bricks * options.shard_chunks.unwrap_or(1);
        let half = options.max_memory / 2;
        let dims = source.levels[0].grid.dims;
        // Ranges and errors of every brick, packed and summed up.
        let tables = side::counts(dims, options.edge)
            .into_iter()
            .fold(0_u64, u64::saturating_add)
            .saturating_mul(48)
            + (BINS as u64) * 8;
        let written = tile_bytes(unit, unit, size, dims);
        let surveyed = block_bytes(options.edge, 1, size, dims);
        let least = written.max(surveyed);
        if tables > options.max_memory / 4 || least > half {
            let need = (4 * tables).max(2 * least).div_ceil(1 << 20);
            return Err(VolumeError::TooLarge(Trouble::new(
                format!("a pyramid of {dims:?} voxels needs {need} MiB of memory to be built"),
                "allow more memory (max_memory), or smaller chunks and shards",
            )));
        }
        let threads = rayon::current_num_threads()
            .min((half / least.max(1)) as usize)
            .max(1);
        let pool = ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.map_err(|error| {
            VolumeError::TooLarge(Trouble::new(
                format!("no threads can be started: {error}"),
                "free memory, and start it again",
            ))
        })?;
        let bytes = |level: usize| source.levels[level].grid.voxel_count().saturating_mul(size);
        let count = source.levels.len();
        let own = first_built(source, options);
        let alone = if own > 1 || count == 1 { bytes(0) } else { 0 };
        let copied = if options.copy_level_0 { bytes(0) } else { 0 };
        let halved = (own..count).map(|number| bytes(number - 1));
        let parts = halved.chain((0..count).map(bytes)).chain([alone, copied]);
        Ok(Self {
            pool,
            each: half / threads as u64,
            unit,
            total: parts.fold(0, u64::saturating_add),
        })
    }
}

/// The first level that is built: a copy has all of them in one place.
pub(super) fn first_built(source: &Source, options: &BuildOptions) -> usize {
    if options.copy_level_0 {
        1
    } else {
        source.fields.len()
    }
}

/// Bytes of a box of `width` voxels along x and `unit` along y and z that is made of a finer level.
pub(super) fn tile_bytes(width: u32, unit: u32, size: u64, dims: [u32; 3]) -> u64 {
    let [width, unit] = [width, unit].map(u64::from);
    let fine = product([2 * width + 2, 2 * unit + 2, 2 * unit + 2], dims);
    let coarse = product([width, unit, unit], dims);
    // The voxels as they are read, and once more where they are rescaled or unpacked; the result, a chunk of it as
    // bytes, and packed.
    fine.saturating_mul(2 * size)
        .saturating_add(coarse.saturating_mul(3 * size))
        .saturating_add(width * 8)
}

/// Bytes of a block of `count` bricks along x and two along y and z, compared with the levels.
pub(super) fn block_bytes(edge: u32, count: u32, size: u64, dims: [u32; 3]) -> u64 {
    let [edge, count] = [edge, count].map(u64::from);
    let fine = product([count * edge + 2, 2 * edge + 2, 2 * edge + 2], dims);
    let coarse = product([count * edge / 2 + 3, edge + 3, edge + 3], dims);
    fine.saturating_mul(2 * size)
        .saturating_add(coarse.saturating_mul(8 + size))
        .saturating_add((BINS as u64) * 8)
}

/// Voxels of a box that is no larger than the level.
fn product(sizes: [u64; 3], dims: [u32; 3]) -> u64 {
    let inside = sizes.iter().zip(dims).map(|(&n, dim)| n.min(dim.into()));
    inside.fold(1, u64::saturating_mul)
}

/// The largest count up to `most` that fits; 1 where none does.
pub(super) fn longest(most: u32, fits: impl Fn(u32) -> bool) -> u32 {
    let (mut low, mut high) = (1, most.max(1));
    while low < high {
        let middle = low + (high - low).div_ceil(2);
        if fits(middle) {
            low = middle;
        } else {
            high = middle - 1;
        }
    }
    low
}
