//! The platform's thread ends with the watch. Alone in its program, as it counts threads.

#![cfg(target_os = "linux")]
#![expect(
    clippy::unwrap_used,
    reason = "helpers fail a test by panicking, as tests do"
)]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::thread::sleep;
use std::time::{Duration, Instant};

use volgraph_watch::{FileWatch, Seen, WatchOptions};

fn watchers() -> usize {
    let tasks = fs::read_dir("/proc/self/task").unwrap();
    let names = tasks.map(|task| fs::read_to_string(task.unwrap().path().join("comm")));
    names
        .filter(|name| name.as_ref().is_ok_and(|name| name.starts_with("notify")))
        .count()
}

#[test]
fn no_thread_outlives_the_watch() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("file");
    let mut watch = FileWatch::new(WatchOptions::default());
    watch.watch(BTreeMap::from([(path, Seen::Absent)]), BTreeSet::new());
    assert_eq!(watchers(), 1);
    drop(watch);
    // Its last code has run; the system may take a moment to clear it away.
    let start = Instant::now();
    while watchers() > 0 {
        assert!(start.elapsed() < Duration::from_secs(10));
        sleep(Duration::from_millis(1));
    }
}
