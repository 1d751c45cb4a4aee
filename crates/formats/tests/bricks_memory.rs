//! A pyramid of a volume of 64 MiB is built in 8 MiB: counted by the allocator, alone in its process.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::io::{BufWriter, Write as _};
use std::sync::atomic::{AtomicUsize, Ordering};

use volgraph_formats::bricks::{BrickStore, BuildOptions, StoreOptions, build, pyramid_path};

static NOW: AtomicUsize = AtomicUsize::new(0);
static MOST: AtomicUsize = AtomicUsize::new(0);

struct Counting;

// SAFETY: the system's allocator does all the work; two numbers are kept beside it.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let now = NOW.fetch_add(layout.size(), Ordering::Relaxed) + layout.size();
        MOST.fetch_max(now, Ordering::Relaxed);
        // SAFETY: as the caller promises.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        NOW.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: as the caller promises.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

fn value(x: u32, y: u32, z: u32) -> u8 {
    (((x * x) >> 9) + ((y ^ z) >> 2) + x % 3) as u8
}

#[test]
fn memory_stays_below_the_limit() {
    const LIMIT: u64 = 8 << 20;
    let folder = tempfile::tempdir().unwrap();
    let source = folder.path().join("big_512x512x256_uint8.raw");
    let mut file = BufWriter::new(std::fs::File::create(&source).unwrap());
    for z in 0..256 {
        for y in 0..512 {
            let row: Vec<u8> = (0..512).map(|x| value(x, y, z)).collect();
            file.write_all(&row).unwrap();
        }
    }
    file.into_inner().unwrap();
    let options = BuildOptions {
        max_memory: LIMIT,
        ..BuildOptions::default()
    };
    let before = NOW.load(Ordering::Relaxed);
    MOST.store(before, Ordering::Relaxed);
    build(&source, &pyramid_path(&source), &options).unwrap();
    let most = MOST.load(Ordering::Relaxed) - before;
    assert!(most as u64 <= LIMIT, "{most} bytes");
    // It was no empty walk.
    assert!(most > 1 << 19, "{most} bytes");
    let store = BrickStore::open(&source, &StoreOptions::default()).unwrap();
    assert_eq!(store.levels().len(), 5);
    let brick = store.read_brick(0, [3, 5, 2]).unwrap();
    assert_eq!(brick.get(0), f64::from(value(95, 159, 63)));
    assert_eq!(store.statistics().finite_count, 1 << 26);
}
