//! Zarr in zip archives by zarr-python (`make_zarr_zip.py`), and others that are broken or unusual.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

use std::io::{Cursor, Write as _};
use std::path::{Path, PathBuf};

use common::{numbers, table, unhex};
use volgraph_formats::bricks::{BrickStore, BuildOptions, StoreOptions, build, pyramid_path};
use volgraph_formats::zarr::Pyramid;
use volgraph_formats::{LoadOptions, from_bytes, is_volume, load};
use volgraph_volume::Volume;
use zip::write::{SimpleFileOptions, ZipWriter};
use zip::{CompressionMethod, ZipArchive};

const FILES: &str = include_str!("zarr_zip.tsv");

/// The archive of a case, in a folder of its own.
fn one(case: &str) -> (tempfile::TempDir, PathBuf, Vec<u8>) {
    let folder = tempfile::tempdir().unwrap();
    let rows = table(FILES);
    let row = rows.iter().find(|row| row["case"] == case).unwrap();
    let path = folder.path().join(case);
    let bytes = unhex(row["hex"]);
    std::fs::write(&path, &bytes).unwrap();
    (folder, path, bytes)
}

fn cases() -> Vec<&'static str> {
    table(FILES).iter().map(|row| row["case"]).collect()
}

fn weighted(volume: &Volume) -> f64 {
    let (mut sum, mut i) = (0.0, 0_u32);
    volume.voxels().for_each(|value| {
        sum += value * f64::from(i % 1009);
        i += 1;
    });
    sum / f64::from(i)
}

#[test]
fn archives_read_as_zarr_python_reads_them_and_as_their_folders() {
    for row in table(FILES) {
        let case = row["case"];
        let (folder, path, bytes) = one(case);
        assert!(is_volume(&path), "{case}");
        let volume = load(&path, &LoadOptions::default()).unwrap();
        let grid = volume.grid();
        assert_eq!(grid.dims.to_vec(), numbers::<u32>(row["dims"]), "{case}");
        assert_eq!(volume.voxels().scalar_type().name(), row["type"], "{case}");
        let statistics = volume.statistics();
        assert_eq!(statistics.min, row["min"].parse::<f64>().unwrap(), "{case}");
        assert_eq!(statistics.max, row["max"].parse::<f64>().unwrap(), "{case}");
        let want: f64 = row["weighted"].parse().unwrap();
        assert!((weighted(&volume) - want).abs() < 1e-9, "{case}");
        assert_eq!(volume.source_files(), std::slice::from_ref(&path), "{case}");

        // The same in a folder, and in memory.
        let unpacked = folder.path().join("unpacked");
        ZipArchive::new(Cursor::new(&bytes))
            .unwrap()
            .extract(&unpacked)
            .unwrap();
        let below = unpacked.join("cells.zarr");
        let unpacked = if below.is_dir() { below } else { unpacked };
        let same = load(&unpacked, &LoadOptions::default()).unwrap();
        assert_eq!(volume.voxels(), same.voxels(), "{case}");
        assert_eq!(
            (grid, volume.about()),
            (same.grid(), same.about()),
            "{case}"
        );
        let same = from_bytes(case, &bytes, &LoadOptions::default()).unwrap();
        assert_eq!(volume.voxels(), same.voxels(), "{case}");

        let whole = Pyramid::open(&path, &LoadOptions::default()).unwrap();
        let region = whole.read_region(0, [1, 2, 1], [3, 2, 4]).unwrap();
        let folder = Pyramid::open(&unpacked, &LoadOptions::default()).unwrap();
        assert_eq!(region, folder.read_region(0, [1, 2, 1], [3, 2, 4]).unwrap());
    }
}

#[test]
fn levels_of_an_archive_are_read_alone() {
    for case in ["image.ozx", "below.zip"] {
        let (_folder, path, _) = one(case);
        let options = LoadOptions {
            level: Some(1),
            ..LoadOptions::default()
        };
        let volume = load(&path, &options).unwrap();
        assert_eq!(volume.grid().dims, [5, 4, 3]);
        assert_eq!(volume.grid().spacing().x, 2.0);
        assert_eq!(volume.about().length_unit.as_deref(), Some("µm"));
        assert_eq!(volume.about().format, "OME-Zarr 0.5");
    }
}

#[test]
fn bricks_come_out_of_an_archive_as_out_of_a_folder() {
    let (folder, path, bytes) = one("image.ozx");
    let unpacked = folder.path().join("unpacked.zarr");
    let archive = ZipArchive::new(Cursor::new(&bytes));
    archive.unwrap().extract(&unpacked).unwrap();
    let levels = [&path, &unpacked].map(|source| {
        let options = BuildOptions {
            edge: 8,
            ..BuildOptions::default()
        };
        build(source, &pyramid_path(source), &options).unwrap();
        let store = BrickStore::open(source, &StoreOptions::default()).unwrap();
        let levels = store.levels().iter().enumerate();
        let all = levels.map(|(number, level)| store.read_region(number, [0; 3], level.grid.dims));
        all.collect::<Result<Vec<_>, _>>().unwrap()
    });
    assert_eq!(levels[0], levels[1]);
    assert!(levels[0].len() > 1);
}

/// Entries with their bytes, as an archive.
fn archive(entries: &[(String, Vec<u8>)], options: SimpleFileOptions) -> Vec<u8> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in entries {
        writer.start_file(name, options).unwrap();
        writer.write_all(bytes).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

fn entries(bytes: &[u8]) -> Vec<(String, Vec<u8>)> {
    let mut archive = ZipArchive::new(Cursor::new(bytes)).unwrap();
    (0..archive.len())
        .map(|i| {
            let mut entry = archive.by_index(i).unwrap();
            let mut bytes = Vec::new();
            std::io::Read::read_to_end(&mut entry, &mut bytes).unwrap();
            (entry.name().to_owned(), bytes)
        })
        .collect()
}

#[test]
fn wide_numbers_and_many_entries_are_read() {
    let (_folder, path, bytes) = one("shards.zarr.zip");
    let want = load(&path, &LoadOptions::default()).unwrap();
    let stored = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    let mut entries = entries(&bytes);
    let wide = archive(&entries, stored.large_file(true));
    let read = from_bytes("a.zarr.zip", &wide, &LoadOptions::default()).unwrap();
    assert_eq!(read.voxels(), want.voxels());
    // More than 65 535: the end of the directory has 64 bits.
    entries.extend((0..70_000).map(|i| (format!("notes/{i}"), Vec::new())));
    let many = archive(&entries, stored);
    let read = from_bytes("a.zarr.zip", &many, &LoadOptions::default()).unwrap();
    assert_eq!(read.voxels(), want.voxels());
}

fn code(name: &str, bytes: &[u8]) -> &'static str {
    let error = from_bytes(name, bytes, &LoadOptions::default()).unwrap_err();
    assert!(!error.trouble().remedy.is_empty(), "{error}");
    error.code()
}

#[test]
fn what_is_no_zarr_or_cannot_be_read_is_told() {
    let (_folder, _, bytes) = one("plain.zarr.zip");
    let good = entries(&bytes);
    let stored = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    let other = archive(&[("a.txt".to_owned(), b"text".to_vec())], stored);
    assert_eq!(code("a.zip", &other), "volume-unsupported");
    assert_eq!(code("a.ozx", b"text"), "volume-wrong-content");
    let two: Vec<_> = ["a", "b"]
        .iter()
        .flat_map(|below| {
            let inside =
                |(name, bytes): &(String, Vec<u8>)| (format!("{below}/{name}"), bytes.clone());
            good.iter().map(inside).collect::<Vec<_>>()
        })
        .collect();
    assert_eq!(code("a.zip", &archive(&two, stored)), "volume-unsupported");
    let half = &bytes[..bytes.len() / 2];
    assert_eq!(code("a.zarr.zip", half), "volume-data-too-short");
    // A voxel that is another one.
    let chunk = good
        .iter()
        .find(|(name, _)| name.starts_with("c/"))
        .unwrap();
    let at = bytes
        .windows(chunk.1.len())
        .position(|part| part == chunk.1);
    let mut other = bytes.clone();
    other[at.unwrap()] ^= 1;
    assert_eq!(code("a.zarr.zip", &other), "volume-data-corrupt");
    // A chunk of zeros that is much longer than chunks are.
    let deflated = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
    let mut bomb = good.clone();
    let chunk = bomb.iter_mut().find(|(name, _)| name.starts_with("c/"));
    chunk.unwrap().1 = vec![0; 64 << 20];
    assert_eq!(
        code("a.zarr.zip", &archive(&bomb, deflated)),
        "volume-data-corrupt"
    );
}

struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % n.max(1) as u64) as usize
    }
}

#[test]
fn mutants_are_read_or_refused_and_never_panic() {
    let mut random = Random(88_172_645_463_325_252);
    let (mut read, mut refused) = (0, 0);
    for case in cases() {
        let (_folder, _, good) = one(case);
        for _ in 0..200 {
            let mut bytes = good.clone();
            for _ in 0..=random.below(3) {
                // Where the directory is, most of the time.
                let from = if random.below(3) == 0 {
                    0
                } else {
                    bytes.len() / 2
                };
                let at = from + random.below(bytes.len() - from);
                match random.below(4) {
                    0 => bytes[at] ^= 1 << random.below(8),
                    1 => {
                        let end = (at + [1, 2, 4, 8][random.below(4)]).min(bytes.len());
                        bytes[at..end].fill([0, 0xff, 0x7f, 0x80, 1][random.below(5)]);
                    }
                    2 if random.below(8) == 0 => bytes.truncate(at.max(1)),
                    _ => bytes[at] = random.below(256) as u8,
                }
            }
            let name = Path::new(case).file_name().unwrap().to_str().unwrap();
            match from_bytes(name, &bytes, &LoadOptions::default()) {
                Ok(volume) => {
                    read += 1;
                    assert_eq!(volume.voxels().len() as u64, volume.grid().voxel_count());
                }
                Err(error) => {
                    refused += 1;
                    assert!(!error.trouble().remedy.is_empty(), "{error}");
                    assert!(error.to_string().len() < 900, "{error}");
                }
            }
        }
    }
    assert!(
        read > 100 && refused > 100,
        "{read} read, {refused} refused"
    );
}
