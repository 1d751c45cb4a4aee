//! NIfTI, VTI, NumPy and HDF5 files with something broken in them: a volume or an error that says something, never a panic.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use common::expected::{options, unpack};
use common::table;
use volgraph_formats::{LoadOptions, load};

/// Most bytes that reading a broken file of some hundred bytes may allocate at once: the first step of a growing
/// vector is 4 MiB, the dictionary of LZMA has up to 64, and more tests may run beside.
const MOST_BYTES: usize = 128 << 20;

/// The system's allocator, with the sum and its highest.
struct Counting;

static NOW: AtomicUsize = AtomicUsize::new(0);
static HIGHEST: AtomicUsize = AtomicUsize::new(0);

// SAFETY: all is done by the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let now = NOW.fetch_add(layout.size(), Ordering::Relaxed) + layout.size();
        HIGHEST.fetch_max(now, Ordering::Relaxed);
        // SAFETY: as the caller promises.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        NOW.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: as the caller promises.
        unsafe { System.dealloc(at, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Changes per file.
const MUTANTS: u64 = 40;

/// A small generator, the same everywhere (SplitMix64).
struct Dice(u64);

impl Dice {
    fn roll(&mut self, sides: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % sides.max(1) as u64) as usize
    }
}

const NASTY: [&[u8]; 12] = [
    b"0",
    b"-1",
    b"18446744073709551615",
    b"4294967295",
    b"-2147483648 2147483647",
    b"nan",
    b"1e999",
    b"\"",
    b"<",
    b"(",
    b"'",
    b"99999999999999999999",
];

/// One to three changes: bits, numbers of a binary header, numbers in text, a cut, a piece twice.
fn mutate(bytes: &mut Vec<u8>, dice: &mut Dice) {
    // Where headers are, most of the time.
    let head = if dice.roll(3) == 0 {
        bytes.len()
    } else {
        bytes.len().min(700)
    };
    match dice.roll(6) {
        0 => {
            let at = dice.roll(head);
            bytes[at] ^= 1 << dice.roll(8);
        }
        1 => {
            let (at, width) = (dice.roll(head), [1, 2, 4, 8][dice.roll(4)]);
            let value = [0x00, 0xff, 0x7f, 0x80, 0x01][dice.roll(5)];
            let end = (at + width).min(bytes.len());
            bytes[at..end].fill(value);
        }
        2 => bytes.truncate(dice.roll(bytes.len())),
        3 => {
            let at = dice.roll(head);
            let end = (at + dice.roll(60)).min(bytes.len());
            let piece = bytes[at..end].to_vec();
            bytes.splice(at..at, piece);
        }
        _ => {
            let starts: Vec<usize> = (1..head)
                .filter(|&at| bytes[at].is_ascii_digit() && !bytes[at - 1].is_ascii_digit())
                .collect();
            let Some(&at) = starts.get(dice.roll(starts.len())) else {
                return;
            };
            let digits = bytes[at..]
                .iter()
                .take_while(|byte| byte.is_ascii_digit())
                .count();
            bytes.splice(
                at..at + digits,
                NASTY[dice.roll(NASTY.len())].iter().copied(),
            );
        }
    }
}

/// Reads mutants of every small file of a table; gives how many were read and how many refused.
fn mutants(text: &str, seed: u64) -> (usize, usize) {
    let rows = table(text);
    let mut dice = Dice(seed);
    let (mut read, mut refused) = (0, 0);
    for row in rows.iter().filter(|row| !row["bytes"].is_empty()) {
        let folder = tempfile::tempdir().unwrap();
        let path = unpack(row, folder.path());
        let files: Vec<_> = std::fs::read_dir(folder.path())
            .unwrap()
            .map(|file| file.unwrap().path())
            .collect();
        let whole: Vec<Vec<u8>> = files
            .iter()
            .map(|file| std::fs::read(file).unwrap())
            .collect();
        for _ in 0..MUTANTS {
            let which = dice.roll(files.len());
            let mut bytes = whole[which].clone();
            for _ in 0..=dice.roll(3) {
                if !bytes.is_empty() {
                    mutate(&mut bytes, &mut dice);
                }
            }
            std::fs::write(&files[which], &bytes).unwrap();
            let options = LoadOptions {
                max_bytes: Some(1 << 40),
                ..options(row)
            };
            match load(&path, &options) {
                Ok(volume) => {
                    read += 1;
                    assert_eq!(volume.voxels().len() as u64, volume.grid().voxel_count());
                    assert!(volume.grid().check().is_ok());
                    let (lo, hi) = volume.grid().box_index();
                    let _ = (
                        volume.trilinear(lo),
                        volume.trilinear(hi),
                        volume.statistics().min,
                    );
                }
                Err(error) => {
                    refused += 1;
                    let text = error.to_string();
                    let stem = path.file_stem().unwrap().to_string_lossy();
                    let stem = stem.trim_end_matches(".nii");
                    assert!(text.contains(stem) && text.len() < 900, "{text}");
                    assert!(!error.trouble().remedy.is_empty(), "{text}");
                    assert!(!error.trouble().cause.ends_with('.'), "{text}");
                }
            }
            std::fs::write(&files[which], &whole[which]).unwrap();
        }
    }
    let highest = HIGHEST.load(Ordering::Relaxed);
    assert!(highest < MOST_BYTES, "{highest} bytes were allocated");
    assert!(
        read > 100 && refused > 100,
        "{read} read, {refused} refused"
    );
    (read, refused)
}

#[test]
fn broken_nifti_is_refused_or_read() {
    mutants(include_str!("expected_nifti.tsv"), 1);
}

#[test]
fn broken_vti_is_refused_or_read() {
    mutants(include_str!("expected_vti.tsv"), 2);
}

#[test]
fn broken_npy_is_refused_or_read() {
    mutants(include_str!("expected_npy.tsv"), 3);
}

#[test]
fn broken_hdf5_is_refused_or_read() {
    mutants(include_str!("expected_hdf5.tsv"), 4);
}

/// A file of 1 GiB by its own word: the header of one compressed block and what it holds.
fn promise(compressor: &str, header: &[u32], data: &[u8]) -> Vec<u8> {
    let text = format!(
        "<VTKFile type=\"ImageData\" header_type=\"UInt32\" byte_order=\"LittleEndian\" compressor=\"{compressor}\">\
         <ImageData WholeExtent=\"0 1023 0 1023 0 1023\"><Piece Extent=\"0 1023 0 1023 0 1023\"><PointData>\
         <DataArray type=\"UInt8\" Name=\"a\" format=\"appended\" offset=\"0\"/></PointData></Piece></ImageData>\
         <AppendedData encoding=\"raw\">_"
    );
    let words: Vec<u8> = header.iter().flat_map(|word| word.to_le_bytes()).collect();
    [text.as_bytes(), &words, data].concat()
}

#[test]
fn promises_of_a_header_allocate_nothing() {
    let zeros = |len: usize| vec![0_u8; len];
    let one = [1, 1 << 30, 0, 32];
    let mut npy = b"\x93NUMPY\x01\0\x76\0{'descr': '|u1', 'fortran_order': False, 'shape': (1024, 1024, 1024), }".to_vec();
    npy.resize(128, b' ');
    for (name, bytes) in [
        ("lz4.vti", promise("vtkLZ4DataCompressor", &one, &zeros(32))),
        (
            "zlib.vti",
            promise(
                "vtkZLibDataCompressor",
                &one,
                &common::zlib(&zeros(5000))[..],
            ),
        ),
        (
            "lzma.vti",
            promise("vtkLZMADataCompressor", &one, &zeros(32)),
        ),
        ("plain.vti", promise("", &[1 << 30], &zeros(32))),
        (
            "blocks.vti",
            promise("vtkLZ4DataCompressor", &[1 << 30, 1, 0], &zeros(32)),
        ),
        ("long.npy", npy),
    ] {
        let error =
            volgraph_formats::from_bytes(name, &bytes, &LoadOptions::default()).unwrap_err();
        let code = error.code();
        assert!(
            matches!(code, "volume-data-too-short" | "volume-data-corrupt"),
            "{error}"
        );
    }
    let highest = HIGHEST.load(Ordering::Relaxed);
    assert!(highest < MOST_BYTES, "{highest} bytes were allocated");
}
