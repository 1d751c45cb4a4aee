//! Volumes that are folders: Zarr, and pyramids of bricks.

use std::path::Path;
use std::sync::LazyLock;

use volgraph_formats::bricks::{BrickStore, BuildOptions, StoreOptions, build};
use volgraph_formats::zarr::Pyramid;
use volgraph_formats::{Compression, is_volume, load};
use volgraph_volume::{Trouble, VolumeError};

use crate::folder::Folder;
use crate::volumes::{options, sound};

/// The files of a Zarr folder, each behind a line `//// PATH`; the first byte chooses as for other volumes. It is read
/// whole, and as levels of which regions are read.
pub fn zarr(data: &[u8]) {
    let Some((first, files)) = data.split_first() else {
        return;
    };
    let options = options(*first);
    let folder = Folder::of(files);
    let _ = is_volume(folder.path());
    sound(load(folder.path(), &options));
    let pyramid = match Pyramid::open(folder.path(), &options) {
        Ok(pyramid) => pyramid,
        Err(error) => return told(&error),
    };
    for (number, level) in pyramid.levels().enumerate().take(4) {
        let size = [0, 1, 2].map(|i| level.chunk[i].clamp(1, 8).min(level.grid.dims[i]));
        let last = [0, 1, 2].map(|i| level.grid.dims[i] - size[i]);
        for origin in [[0; 3], last] {
            match pyramid.read_region(number, origin, size) {
                Ok(voxels) => {
                    assert_eq!(voxels.len() as u32, size.iter().product::<u32>());
                    assert_eq!(voxels.scalar_type(), level.scalar_type);
                }
                Err(error) => told(&error),
            }
        }
    }
}

/// Dimensions of the pyramid whose table of bricks is made, and the edge of its bricks.
const DIMS: [u32; 3] = [9, 6, 5];
const EDGE: u32 = 4;

/// The table of bricks of a small pyramid. The first byte says how it is made: odd, and the rest is its bytes, to
/// which only the checksum is added; even, and the second byte is the number of bricks, then come a line with the
/// header, 64 bytes of statistics and what all bricks' entries repeat.
pub fn bricks(data: &[u8]) {
    match open_bricks(data) {
        Some((Ok(store), _folder)) => use_bricks(&store),
        Some((Err(error), _)) => told(&error),
        None => (),
    }
}

/// The pyramid with the table of an input, and where it lies; `None` where the input is too short.
pub(crate) fn open_bricks(data: &[u8]) -> Option<(Result<BrickStore, VolumeError>, Folder)> {
    let mut table = table(data)?;
    table.extend(crc32c::crc32c(&table).to_le_bytes());
    let folder = Folder::new();
    for (name, bytes) in FILES.iter() {
        folder.write(name, bytes);
    }
    folder.write("bricks.bin", &table);
    let store = BrickStore::open(folder.path(), &StoreOptions::default());
    Some((store, folder))
}

fn use_bricks(store: &BrickStore) {
    for (number, level) in store.levels().iter().enumerate() {
        let last = level.bricks.map(|count| count - 1);
        for brick in [[0; 3], last] {
            let info = store
                .brick_info(number, brick)
                .expect("a brick that is there");
            assert!(info.min <= info.max && info.rms_error >= 0.0 && info.max_error >= 0.0);
            if let Err(error) = store.read_brick(number, brick) {
                told(&error);
            }
        }
        assert!(store.brick_info(number, level.bricks).is_none());
    }
    let _ = (store.statistics(), store.drawn(f64::NAN));
}

/// The bytes of a table of bricks without its checksum.
fn table(data: &[u8]) -> Option<Vec<u8>> {
    let (first, rest) = data.split_first()?;
    if first & 1 == 1 {
        return Some(rest.to_vec());
    }
    let (count, rest) = rest.split_first()?;
    let end = rest.iter().position(|byte| *byte == b'\n')?;
    let (header, numbers) = (&rest[..end], &rest[end + 1..]);
    let (statistics, entries) = numbers.split_at_checked(64)?;
    let mut table = b"volgraph-bricks\0\x01\0\0\0".to_vec();
    table.extend((header.len() as u32).to_le_bytes());
    table.extend(header);
    table.extend(statistics);
    table.extend([0; 4096 * 8]);
    let wanted = usize::from(*count) * 16;
    table.extend(entries.iter().cycle().take(wanted));
    Some(table)
}

/// The files of the pyramid but for its table.
static FILES: LazyLock<Vec<(String, Vec<u8>)>> = LazyLock::new(|| {
    let folder = Folder::new();
    let [x, y, z] = DIMS;
    let voxels: Vec<u8> = (0..(x * y * z)).map(|i| (i * 7) as u8).collect();
    folder.write("a_9x6x5_uint8.raw", &voxels);
    let options = BuildOptions {
        edge: EDGE,
        copy_level_0: true,
        compression: Compression::None,
        ..BuildOptions::default()
    };
    let out = folder.path().join("pyramid");
    build(&folder.path().join("a_9x6x5_uint8.raw"), &out, &options).expect("a small pyramid");
    let mut files = Vec::new();
    collect(&out, "", &mut files);
    files.retain(|(name, _)| name != "bricks.bin");
    files
});

fn collect(folder: &Path, name: &str, files: &mut Vec<(String, Vec<u8>)>) {
    for entry in std::fs::read_dir(folder).expect("a folder of the pyramid") {
        let path = entry.expect("a file of the pyramid").path();
        let own = path.file_name().unwrap_or_default().to_string_lossy();
        let name = format!("{name}{own}");
        if path.is_dir() {
            collect(&path, &format!("{name}/"), files);
        } else {
            files.push((name, std::fs::read(&path).expect("a file of the pyramid")));
        }
    }
}

fn told(error: &VolumeError) {
    let Trouble { cause, remedy, .. } = error.trouble();
    assert!(!cause.is_empty() && !remedy.is_empty(), "{error}");
}
