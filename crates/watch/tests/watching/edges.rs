//! Registration, timeouts, stamps, several files at once, and what events do not tell.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

use volgraph_watch::{FileWatch, Seen, Stamp, WatchError, WatchOptions};

use crate::case::{By, Case, LONG, SHORT, everywhere, everywhere_with, read};

#[test]
fn a_change_between_reading_and_watching_is_told() {
    everywhere(|case| {
        let files = BTreeMap::from([(case.path.clone(), read(&case.path).0)]);
        fs::write(&case.path, "second").unwrap();
        // Whatever it may have told of this is taken away.
        case.reload();
        assert_eq!(
            case.watch.wait(Some(Duration::from_millis(30))).unwrap(),
            None
        );
        case.watch.watch(files, BTreeSet::new());
        assert_eq!(case.changed().unwrap(), "second");
        case.is_quiet();
    });
}

#[test]
fn a_change_while_nobody_waits_is_told() {
    everywhere(|case| {
        fs::write(&case.path, "second").unwrap();
        std::thread::sleep(Duration::from_millis(50));
        assert_eq!(case.changed().unwrap(), "second");
    });
}

#[test]
fn short_waits_lose_nothing() {
    everywhere(|case| {
        fs::write(&case.path, "second").unwrap();
        let start = Instant::now();
        while case.watch.wait(Some(Duration::ZERO)).unwrap().is_none() {
            assert!(start.elapsed() < LONG, "the change was not told");
        }
        assert_eq!(case.reload().unwrap(), "second");
    });
}

#[test]
fn extreme_options_and_timeouts_do_no_harm() {
    let extreme = |by: By| WatchOptions {
        settle: Duration::ZERO,
        longest_settle: Duration::MAX,
        grace: Duration::MAX,
        poll: (by == By::Polling).then_some(Duration::ZERO),
        recheck: Some(Duration::MAX),
    };
    everywhere_with(extreme, |case| {
        fs::write(&case.path, "second").unwrap();
        assert!(case.watch.wait(Some(Duration::MAX)).unwrap().is_some());
    });
}

#[test]
fn waiting_for_nothing_is_refused() {
    let mut watch = FileWatch::new(WatchOptions::default());
    assert!(matches!(watch.wait(None), Err(WatchError::NothingWatched)));
    assert_eq!(watch.wait(Some(Duration::ZERO)).unwrap(), None);
}

#[test]
fn odd_paths_are_watched_without_harm() {
    let mut watch = FileWatch::new(WatchOptions::default());
    let odd = [
        "",
        "/",
        ".",
        "..",
        "/..",
        "a/../../b",
        "/dev/null",
        "\0",
        "/proc/self/mem/x",
    ];
    let files = odd.map(|path| (PathBuf::from(path), Seen::Absent));
    let folders = ["", "/", "\0", "/dev/null"].map(PathBuf::from);
    watch.watch(files.into(), folders.into());
    assert_eq!(watch.wait(Some(Duration::from_millis(50))).unwrap(), None);
    let too_long = PathBuf::from("/tmp").join("x".repeat(5000));
    watch.watch(BTreeMap::from([(too_long, Seen::Absent)]), BTreeSet::new());
    assert_eq!(watch.wait(Some(Duration::from_millis(50))).unwrap(), None);
}

#[cfg(unix)]
#[test]
fn a_pipe_in_place_of_a_file_is_not_waited_for() {
    let short = |by: By| WatchOptions {
        grace: Duration::from_millis(50),
        ..by.options()
    };
    everywhere_with(short, |case| {
        fs::remove_file(&case.target).unwrap();
        let made = std::process::Command::new("mkfifo")
            .arg(&case.target)
            .status();
        if !made.is_ok_and(|status| status.success()) {
            return;
        }
        // It holds nothing that could be read.
        assert!(case.watch.wait(Some(LONG)).unwrap().is_some());
        let files = BTreeMap::from([(case.path.clone(), Seen::Absent)]);
        case.watch.watch(files, BTreeSet::new());
        case.is_quiet();
    });
}

fn stamped(path: &Path) -> BTreeMap<PathBuf, Seen> {
    BTreeMap::from([(path.to_owned(), Seen::Stamp(Stamp::of(path).unwrap()))])
}

#[test]
fn what_nobody_is_sure_of_is_told_whatever_it_is_now() {
    everywhere(|case| {
        age(&case.path);
        let unsure = BTreeMap::from([(case.path.clone(), Seen::Unsure)]);
        case.watch.watch(unsure, BTreeSet::new());
        case.changed();
        case.is_quiet();
    });
    let short = |by: By| WatchOptions {
        grace: Duration::from_millis(50),
        ..by.options()
    };
    everywhere_with(short, |case| {
        fs::remove_file(&case.target).unwrap();
        let unsure = BTreeMap::from([(case.path.clone(), Seen::Unsure)]);
        case.watch.watch(unsure, BTreeSet::new());
        assert_eq!(case.changed(), None);
        case.is_quiet();
    });
}

#[test]
fn a_file_with_a_stamp_is_told_when_its_stamp_differs() {
    everywhere(|case| {
        age(&case.path);
        case.watch.watch(stamped(&case.path), BTreeSet::new());
        case.is_quiet();
        fs::write(&case.path, "longer than the first").unwrap();
        assert!(case.watch.wait(Some(LONG)).unwrap().is_some());
        // As nobody says what was read, what was told is what is seen.
        drain(case);
        fs::write(&case.path, "shorter").unwrap();
        assert!(case.watch.wait(Some(LONG)).unwrap().is_some());
    });
}

/// Waits until nothing is told any more. The end of a write may be told once more of a young file with a stamp.
fn drain(case: &mut Case) {
    let mut times = 0;
    while case.watch.wait(Some(SHORT)).unwrap().is_some() {
        times += 1;
        assert!(times < 5, "it is told again and again");
    }
}

fn age(path: &Path) {
    set_modified(path, SystemTime::now() - Duration::from_secs(3600));
}

fn set_modified(path: &Path, time: SystemTime) {
    let file = File::options().append(true).open(path).unwrap();
    file.set_modified(time).unwrap();
}

/// Puts other content under an equal stamp, and gives one event for it.
fn write_unseen(case: &Case) {
    let stamp = Stamp::of(&case.path).unwrap();
    let modified = fs::metadata(&case.path).unwrap().modified().unwrap();
    let len = usize::try_from(stamp.len()).unwrap();
    // Through another link, as there must be no event before the time is set back.
    let link = case.root.join("another link");
    fs::hard_link(&case.target, &link).unwrap();
    let mut file = File::options().write(true).open(&link).unwrap();
    file.write_all(&vec![b'x'; len]).unwrap();
    file.set_modified(modified).unwrap();
    drop(file);
    fs::remove_file(&link).unwrap();
    assert_eq!(Stamp::of(&case.path).unwrap(), stamp);
    drop(File::options().append(true).open(&case.path).unwrap());
}

#[test]
fn an_event_on_a_racily_clean_file_is_told() {
    everywhere(|case| {
        if case.by == By::Polling {
            return;
        }
        // A time in the future stays young.
        set_modified(&case.path, SystemTime::now() + Duration::from_secs(3600));
        case.watch.watch(stamped(&case.path), BTreeSet::new());
        drain(case);
        write_unseen(case);
        assert!(case.watch.wait(Some(LONG)).unwrap().is_some());
        // The stamp of an old file proves that nothing has changed: nobody sets times back.
        age(&case.path);
        case.watch.watch(stamped(&case.path), BTreeSet::new());
        drain(case);
        write_unseen(case);
        case.is_quiet();
    });
}

#[test]
fn content_under_an_equal_stamp_is_told_where_it_is_read() {
    everywhere(|case| {
        age(&case.path);
        case.reload();
        case.is_quiet();
        write_unseen(case);
        assert_eq!(case.changed().unwrap(), "xxxxx");
    });
}

/// Two files, the first gone or empty, the second changed.
#[test]
fn what_settles_together_is_told_together() {
    everywhere(|case| {
        let other = case.root.join("other");
        fs::write(&other, "1").unwrap();
        let files = [&case.path, &other].map(|path| (path.clone(), read(path).0));
        case.watch.watch(files.clone().into(), BTreeSet::new());
        case.is_quiet();
        let mut file = File::create(&case.path).unwrap();
        fs::write(&other, "2").unwrap();
        assert_eq!(
            case.watch.wait(Some(Duration::from_millis(50))).unwrap(),
            None
        );
        file.write_all(b"second").unwrap();
        drop(file);
        let both = BTreeSet::from([case.path.clone(), other]);
        assert_eq!(case.watch.wait(Some(LONG)).unwrap(), Some(both));
    });
}

#[test]
fn what_is_complete_waits_for_the_missing_no_longer_than_the_grace() {
    let short = |by: By| WatchOptions {
        grace: Duration::from_millis(100),
        ..by.options()
    };
    everywhere_with(short, |case| {
        let other = case.root.join("other");
        fs::write(&other, "1").unwrap();
        let files = [&case.path, &other].map(|path| (path.clone(), read(path).0));
        case.watch.watch(files.into(), BTreeSet::new());
        case.is_quiet();
        let path = case.path.clone();
        let done = std::sync::atomic::AtomicBool::new(false);
        let told = std::thread::scope(|scope| {
            // Its events never end, and it is always empty.
            scope.spawn(|| {
                while !done.load(std::sync::atomic::Ordering::Relaxed) {
                    File::create(&path).unwrap();
                    std::thread::sleep(Duration::from_millis(20));
                }
            });
            fs::write(&other, "2").unwrap();
            // Where the machine pauses, the empty file is told by itself first.
            let mut told = BTreeSet::new();
            let start = Instant::now();
            while !told.contains(&other) && start.elapsed() < LONG {
                told = case.watch.wait(Some(LONG)).unwrap().unwrap_or_default();
            }
            done.store(true, std::sync::atomic::Ordering::Relaxed);
            told
        });
        assert!(told.contains(&other));
    });
}

/// A write through another hard link gives no event in the watched folder.
#[cfg(unix)]
#[test]
fn what_events_do_not_tell_the_recheck_sees() {
    for recheck in [None, Some(Duration::from_millis(20))] {
        let options = |by: By| WatchOptions {
            recheck,
            ..by.options()
        };
        everywhere_with(options, |case| {
            fs::create_dir(case.root.join("hard")).unwrap();
            let link = case.root.join("hard/link");
            fs::hard_link(&case.target, &link).unwrap();
            case.is_quiet();
            fs::write(&link, "second").unwrap();
            if recheck.is_none() && case.by == By::Events {
                case.is_quiet();
            } else {
                assert_eq!(case.changed().unwrap(), "second");
            }
        });
    }
}

#[test]
fn a_relative_path_is_told_as_it_was_given() {
    let here = std::env::current_dir().unwrap();
    let folder = tempfile::tempdir_in(&here).unwrap();
    let path = folder.path().strip_prefix(&here).unwrap().join("file");
    fs::write(&path, "1").unwrap();
    let mut watch = FileWatch::new(By::Events.options());
    watch.watch(
        BTreeMap::from([(path.clone(), Seen::bytes(b"1"))]),
        BTreeSet::new(),
    );
    fs::write(&path, "2").unwrap();
    let told = watch.wait(Some(LONG)).unwrap();
    assert_eq!(told, Some(BTreeSet::from([path])));
}

#[test]
fn the_backend_says_why_it_polls() {
    let watch = FileWatch::new(By::Polling.options());
    assert_eq!(
        watch.backend().to_string(),
        "polling every 5ms: as asked for"
    );
    let watch = FileWatch::new(By::Events.options());
    assert!(watch.backend().events.is_ok());
    assert!(watch.backend().polled.is_empty());
}

#[test]
fn it_can_move_to_another_thread() {
    fn is_send<T: Send>() {}
    is_send::<FileWatch>();
}
