//! Alone in its process: after it, nothing can be saved any more.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::Path;
use std::time::{Duration, Instant};

use volgraph_picture::{Picture, SaveOptions, abandon_unfinished};

fn unfinished(folder: &Path) -> usize {
    let entries = std::fs::read_dir(folder).unwrap().flatten();
    entries
        .filter(|entry| entry.path().extension().is_some_and(|it| it == "part"))
        .count()
}

#[test]
fn what_is_half_written_is_removed() {
    let scratch = tempfile::tempdir().unwrap();
    let file = scratch.path().join("large.exr");
    let noise = |i: u32| (i.wrapping_mul(2_654_435_761) >> 8) as f32;
    let color = (0..1024 * 512u32).map(|i| [noise(i), noise(i + 7), noise(i + 9), 1.0]);
    let picture = Picture::from_color(1024, 512, color.collect()).unwrap();
    std::thread::spawn(
        move || {
            while picture.save(&file, SaveOptions::default()).is_ok() {}
        },
    );
    let start = Instant::now();
    while unfinished(scratch.path()) == 0 {
        assert!(
            start.elapsed() < Duration::from_secs(60),
            "nothing is written"
        );
    }
    abandon_unfinished();
    assert_eq!(unfinished(scratch.path()), 0);
    std::thread::sleep(Duration::from_millis(50));
    assert_eq!(unfinished(scratch.path()), 0, "it goes on");
}
