//! The ways in which programs save a file.

use std::fs::{self, File};
use std::io::Write;
use std::thread::sleep;
use std::time::{Duration, SystemTime};

use crate::case::{By, LONG, everywhere, everywhere_with};

const PAUSE: Duration = Duration::from_millis(30);

#[test]
fn written_in_place() {
    everywhere(|case| {
        fs::write(&case.path, "second").unwrap();
        assert_eq!(case.changed().unwrap(), "second");
        case.is_quiet();
    });
}

#[test]
fn written_in_place_with_the_same_length() {
    everywhere(|case| {
        for content in ["fiRst", "fIRst", "FIRST"] {
            fs::write(&case.path, content).unwrap();
            assert_eq!(case.changed().unwrap(), content);
        }
        case.is_quiet();
    });
}

#[test]
fn truncated_and_written_later() {
    everywhere(|case| {
        let mut file = File::create(&case.path).unwrap();
        let told = case.watch.wait(Some(PAUSE)).unwrap();
        assert_eq!(told, None, "an empty file is no news yet");
        file.write_all(b"second").unwrap();
        drop(file);
        assert_eq!(case.changed().unwrap(), "second");
        case.is_quiet();
    });
}

#[test]
fn renamed_over() {
    everywhere(|case| {
        for content in ["second", "third"] {
            let temporary = case.path.with_file_name("file.temporary");
            fs::write(&temporary, content).unwrap();
            fs::rename(&temporary, &case.path).unwrap();
            assert_eq!(case.changed().unwrap(), content);
        }
        // Where the path was a link, it is the file itself by now, and still watched.
        fs::write(&case.path, "fourth").unwrap();
        assert_eq!(case.changed().unwrap(), "fourth");
        case.is_quiet();
    });
}

#[test]
fn renamed_over_behind_the_link() {
    everywhere(|case| {
        let temporary = case.root.join("temporary");
        fs::write(&temporary, "second").unwrap();
        fs::rename(&temporary, &case.target).unwrap();
        assert_eq!(case.changed().unwrap(), "second");
        fs::write(&case.target, "third").unwrap();
        assert_eq!(case.changed().unwrap(), "third");
        case.is_quiet();
    });
}

#[test]
fn renamed_away_and_written_anew() {
    everywhere(|case| {
        fs::rename(&case.path, case.path.with_file_name("file~")).unwrap();
        assert_eq!(case.watch.wait(Some(PAUSE)).unwrap(), None);
        fs::write(&case.path, "second").unwrap();
        assert_eq!(case.changed().unwrap(), "second");
        case.is_quiet();
    });
}

#[test]
fn deleted_and_created_later() {
    everywhere(|case| {
        fs::remove_file(&case.path).unwrap();
        assert_eq!(case.watch.wait(Some(PAUSE)).unwrap(), None);
        fs::write(&case.path, "second").unwrap();
        assert_eq!(case.changed().unwrap(), "second");
        fs::write(&case.path, "third").unwrap();
        assert_eq!(case.changed().unwrap(), "third");
        case.is_quiet();
    });
}

#[test]
fn deleted_and_created_the_same() {
    everywhere(|case| {
        fs::remove_file(&case.path).unwrap();
        sleep(PAUSE);
        fs::write(&case.path, "first").unwrap();
        case.is_quiet();
    });
}

#[test]
fn a_burst_of_saves_ends_with_the_last() {
    everywhere(|case| {
        let path = case.path.clone();
        std::thread::scope(|scope| {
            scope.spawn(|| {
                for index in 0..=50 {
                    fs::write(&path, format!("save {index}")).unwrap();
                    sleep(Duration::from_millis(2));
                }
            });
            case.becomes("save 50");
        });
        case.is_quiet();
    });
}

#[test]
fn a_save_without_a_change_is_not_told() {
    everywhere(|case| {
        fs::write(&case.path, "first").unwrap();
        case.is_quiet();
        let temporary = case.path.with_file_name("temporary");
        fs::write(&temporary, "first").unwrap();
        fs::rename(&temporary, &case.path).unwrap();
        case.is_quiet();
        fs::write(&case.path, "second").unwrap();
        assert_eq!(case.changed().unwrap(), "second");
    });
}

#[test]
fn a_touch_and_an_access_are_not_told() {
    everywhere(|case| {
        let file = File::options().append(true).open(&case.path).unwrap();
        let later = SystemTime::now() + Duration::from_secs(60);
        file.set_modified(later).unwrap();
        drop(file);
        fs::read(&case.path).unwrap();
        case.is_quiet();
        fs::write(&case.path, "second").unwrap();
        assert_eq!(case.changed().unwrap(), "second");
    });
}

#[cfg(unix)]
#[test]
fn a_change_of_permissions_is_not_told() {
    use std::os::unix::fs::PermissionsExt;
    everywhere(|case| {
        fs::set_permissions(&case.path, fs::Permissions::from_mode(0o600)).unwrap();
        case.is_quiet();
    });
}

#[test]
fn removed_for_good_is_told_once_and_only_after_the_grace() {
    everywhere(|case| {
        // This grace lasts longer than the wait.
        fs::remove_file(&case.path).unwrap();
        case.is_quiet();
    });
    let short = |by: By| volgraph_watch::WatchOptions {
        grace: Duration::from_millis(50),
        ..by.options()
    };
    everywhere_with(short, |case| {
        fs::remove_file(&case.path).unwrap();
        assert_eq!(case.changed(), None);
        case.is_quiet();
        fs::write(&case.path, "back").unwrap();
        case.becomes("back");
        case.is_quiet();
    });
    // The same for a caller that does not say what it found.
    everywhere_with(short, |case| {
        fs::remove_file(&case.path).unwrap();
        assert!(case.watch.wait(Some(LONG)).unwrap().is_some());
        case.is_quiet();
        fs::write(&case.path, "first").unwrap();
        assert!(case.watch.wait(Some(LONG)).unwrap().is_some());
    });
}

#[test]
fn emptied_for_good_is_told_once_after_the_grace() {
    let short = |by: By| volgraph_watch::WatchOptions {
        grace: Duration::from_millis(50),
        ..by.options()
    };
    everywhere_with(short, |case| {
        File::create(&case.path).unwrap();
        assert_eq!(case.changed().unwrap(), "");
        case.is_quiet();
        fs::write(&case.path, "filled").unwrap();
        assert_eq!(case.changed().unwrap(), "filled");
    });
}
