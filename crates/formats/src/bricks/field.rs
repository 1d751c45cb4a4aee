//! Boxes of voxels of one level: out of a run of a file, or out of the chunks of a Zarr array.
//!
//! A run is memory-mapped where bricks are read at random (a brick has a thousand short rows, and a system call for each
//! costs tens of times the copy), and read by position where it is streamed, so that a build is safe from files that
//! shrink and its memory is what it asks for. Chunks go through a [`ChunkCache`], for a brick and its apron touch up
//! to 27 of them.

use std::fs::File;
use std::io;
use std::sync::Arc;

use memmap2::{Mmap, MmapOptions};
use volgraph_volume::{
    Element, ScalarType, Trouble, VolumeError, Voxels, for_scalar_type, for_voxels,
};

use super::cache::ChunkCache;
use crate::stream::FileRun;
use crate::zarr::Pyramid;

/// Most bytes between two rows that are read along with them.
const SPAN: usize = 1 << 11;

/// A level's voxels.
pub(super) struct Field {
    pub dims: [u32; 3],
    pub scalar_type: ScalarType,
    way: Way,
}

enum Way {
    Run {
        run: FileRun,
        file: File,
        map: Option<Mmap>,
    },
    Zarr {
        pyramid: Arc<Pyramid>,
        /// Its level there.
        level: usize,
        chunk: [u32; 3],
        /// Its name in the cache.
        id: u32,
        cache: Arc<ChunkCache>,
    },
}

impl Field {
    /// The voxels of a run; `mapped` for reading at random.
    pub fn of_run(run: FileRun, dims: [u32; 3], mapped: bool) -> Result<Self, VolumeError> {
        let len = run.count * run.scalar_type.size() as u64;
        let open = || -> io::Result<(File, Option<Mmap>)> {
            let file = File::open(&run.file)?;
            if !mapped {
                return Ok((file, None));
            }
            let len = usize::try_from(len).map_err(io::Error::other)?;
            // SAFETY: the map is only read, and only after `whole` has seen that the file still has all of it. Who cuts
            // the file off in between, or writes to it, is told in the documentation of `BrickStore::open`.
            let map = unsafe { MmapOptions::new().offset(run.offset).len(len).map(&file)? };
            Ok((file, Some(map)))
        };
        let (file, map) = open().map_err(|error| unreadable(&run, &error))?;
        whole(&run, &file)?;
        let scalar_type = run
            .rescale
            .map_or(run.scalar_type, |rescale| rescale.scalar_type);
        Ok(Self {
            dims,
            scalar_type,
            way: Way::Run { run, file, map },
        })
    }

    /// A level of a Zarr image.
    pub fn of_zarr(
        pyramid: Arc<Pyramid>,
        level: usize,
        id: u32,
        cache: &Arc<ChunkCache>,
    ) -> Option<Self> {
        let known = *pyramid.levels().nth(level)?;
        Some(Self {
            dims: known.grid.dims,
            scalar_type: known.scalar_type,
            way: Way::Zarr {
                pyramid,
                level,
                chunk: known.chunk,
                id,
                cache: Arc::clone(cache),
            },
        })
    }

    /// The voxels of a box that lies inside, x fastest.
    pub fn read(&self, origin: [u32; 3], size: [u32; 3]) -> Result<Voxels, VolumeError> {
        let count: usize = size.iter().map(|&n| n as usize).product();
        for_scalar_type!(self.scalar_type, T => {
            let mut values: Vec<T> = Vec::new();
            if values.try_reserve_exact(count).is_err() {
                return Err(VolumeError::TooLarge(Trouble::new(
                    format!("memory does not hold a box of {size:?} voxels"),
                    "free memory, or read smaller boxes",
                )));
            }
            values.resize(count, bytemuck::Zeroable::zeroed());
            self.read_into(origin, size, bytemuck::cast_slice_mut(&mut values))?;
            Ok(T::wrap(values))
        })
    }

    /// As [`Field::read`], into bytes of just that size.
    pub fn read_into(
        &self,
        origin: [u32; 3],
        size: [u32; 3],
        out: &mut [u8],
    ) -> Result<(), VolumeError> {
        match &self.way {
            Way::Run { run, file, map } => {
                whole(run, file)?;
                let each = run.scalar_type.size();
                let rows = Rows {
                    dims: self.dims,
                    origin,
                    size,
                    each,
                };
                let Some(rescale) = run.rescale.filter(|rescale| !rescale.is_identity()) else {
                    return rows.read(run, file, map.as_ref(), out);
                };
                let count = rows.count();
                let stored = for_scalar_type!(run.scalar_type, T => {
                    let mut values: Vec<T> = vec![bytemuck::Zeroable::zeroed(); count];
                    rows.read(run, file, map.as_ref(), bytemuck::cast_slice_mut(&mut values))?;
                    T::wrap(values)
                });
                let scaled = rescale.apply(stored);
                for_voxels!(&scaled, values => out.copy_from_slice(bytemuck::cast_slice(values)));
                Ok(())
            }
            Way::Zarr {
                pyramid,
                level,
                chunk,
                id,
                cache,
            } => {
                let each = self.scalar_type.size();
                let bytes = chunk.iter().map(|&n| n as usize).product::<usize>() * each;
                if !cache.takes(bytes) {
                    let voxels = pyramid.read_region(*level, origin, size)?;
                    out.copy_from_slice(voxels.as_bytes());
                    return Ok(());
                }
                let cells = [0, 1, 2]
                    .map(|i| origin[i] / chunk[i]..(origin[i] + size[i]).div_ceil(chunk[i]));
                let [xs, ys, zs] = cells;
                for z in zs {
                    for y in ys.clone() {
                        for x in xs.clone() {
                            let low = [x * chunk[0], y * chunk[1], z * chunk[2]];
                            let part = [0, 1, 2].map(|i| chunk[i].min(self.dims[i] - low[i]));
                            let voxels = cache
                                .get((*id, [x, y, z]), || pyramid.read_region(*level, low, part))?;
                            copy(voxels.as_bytes(), low, part, out, origin, size, each);
                        }
                    }
                }
                Ok(())
            }
        }
    }
}

/// Copies what two boxes share.
fn copy(
    from: &[u8],
    from_origin: [u32; 3],
    from_size: [u32; 3],
    to: &mut [u8],
    to_origin: [u32; 3],
    to_size: [u32; 3],
    each: usize,
) {
    let low = [0, 1, 2].map(|i| from_origin[i].max(to_origin[i]));
    let high = [0, 1, 2].map(|i| (from_origin[i] + from_size[i]).min(to_origin[i] + to_size[i]));
    let at = |origin: [u32; 3], size: [u32; 3], y: u32, z: u32| {
        let [x, y, z] = [low[0] - origin[0], y - origin[1], z - origin[2]].map(|n| n as usize);
        ((z * size[1] as usize + y) * size[0] as usize + x) * each
    };
    let width = (high[0] - low[0]) as usize * each;
    for z in low[2]..high[2] {
        for y in low[1]..high[1] {
            let source = at(from_origin, from_size, y, z);
            let target = at(to_origin, to_size, y, z);
            to[target..target + width].copy_from_slice(&from[source..source + width]);
        }
    }
}

/// The rows of a box of a run.
struct Rows {
    dims: [u32; 3],
    origin: [u32; 3],
    size: [u32; 3],
    each: usize,
}

impl Rows {
    fn count(&self) -> usize {
        self.size.iter().map(|&n| n as usize).product()
    }

    fn read(
        &self,
        run: &FileRun,
        file: &File,
        map: Option<&Mmap>,
        out: &mut [u8],
    ) -> Result<(), VolumeError> {
        let [nx, ny, _] = self.dims.map(u64::from);
        let [x, y, z] = self.origin.map(u64::from);
        let [width, height, _] = self.size.map(|n| n as usize);
        let row = width * self.each;
        let pitch = nx as usize * self.each;
        if row == 0 || height == 0 {
            return Ok(());
        }
        let mut span = Vec::new();
        for (k, plane) in (0..).zip(out.chunks_exact_mut(row * height)) {
            let at = (((z + k) * ny + y) * nx + x) * self.each as u64;
            if let Some(map) = map {
                // The map has all elements of the grid.
                let at = at as usize;
                for (j, out) in plane.chunks_exact_mut(row).enumerate() {
                    let at = at + j * pitch;
                    out.copy_from_slice(&map[at..at + row]);
                }
                continue;
            }
            let read = |bytes: &mut [u8], at: u64| {
                read_at(file, bytes, run.offset + at).map_err(|error| unreadable(run, &error))
            };
            if pitch == row {
                read(plane, at)?;
            } else if pitch - row <= SPAN {
                span.resize(pitch * (height - 1) + row, 0);
                read(&mut span, at)?;
                for (out, span) in plane.chunks_exact_mut(row).zip(span.chunks(pitch)) {
                    out.copy_from_slice(&span[..row]);
                }
            } else {
                for (j, out) in (0..).zip(plane.chunks_exact_mut(row)) {
                    read(out, at + j * pitch as u64)?;
                }
            }
        }
        if run.big_endian != cfg!(target_endian = "big") && self.each > 1 {
            out.chunks_exact_mut(self.each).for_each(<[u8]>::reverse);
        }
        Ok(())
    }
}

/// Refuses a file that has become shorter since it was opened.
fn whole(run: &FileRun, file: &File) -> Result<(), VolumeError> {
    let len = file
        .metadata()
        .map_err(|error| unreadable(run, &error))?
        .len();
    let need = run.offset + run.count * run.scalar_type.size() as u64;
    if len >= need {
        return Ok(());
    }
    Err(VolumeError::DataTooShort(Trouble::new(
        format!("has {len} bytes, and its voxels need {need}: it was cut off since it was opened"),
        "fetch the file again, and build its pyramid again",
    ))
    .in_file(&run.file))
}

fn unreadable(run: &FileRun, error: &io::Error) -> VolumeError {
    VolumeError::Unreadable(Trouble::new(
        format!("cannot be read: {error}"),
        "check the file, its permissions and the disk",
    ))
    .in_file(&run.file)
}

/// Fills the bytes from a position on, whatever other threads read.
#[cfg(unix)]
pub(crate) fn read_at(file: &File, bytes: &mut [u8], at: u64) -> io::Result<()> {
    std::os::unix::fs::FileExt::read_exact_at(file, bytes, at)
}

/// Fills the bytes from a position on, whatever other threads read.
#[cfg(windows)]
pub(crate) fn read_at(file: &File, mut bytes: &mut [u8], mut at: u64) -> io::Result<()> {
    use std::os::windows::fs::FileExt as _;
    while !bytes.is_empty() {
        match file.seek_read(bytes, at) {
            Ok(0) => return Err(io::ErrorKind::UnexpectedEof.into()),
            Ok(got) => {
                bytes = &mut bytes[got..];
                at += got as u64;
            }
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(())
}
