//! Changes of the way that leads to a file: folders and links.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::thread::sleep;
use std::time::Duration;

use volgraph_watch::{Seen, WatchOptions};

use crate::case::{By, everywhere, everywhere_with};

#[test]
fn a_missing_file_appears() {
    everywhere(|case| {
        fs::remove_file(&case.path).unwrap();
        assert_eq!(case.reload(), None);
        case.is_quiet();
        fs::write(&case.path, "second").unwrap();
        assert_eq!(case.changed().unwrap(), "second");
    });
}

#[test]
fn a_file_appears_in_a_folder_that_did_not_exist() {
    everywhere(|case| {
        let folder = case.path.with_file_name("not/yet");
        case.path = folder.join("there");
        assert_eq!(case.reload(), None);
        case.is_quiet();
        // All at once, and again in steps.
        for (index, pause) in [0, 20].map(Duration::from_millis).into_iter().enumerate() {
            fs::create_dir(folder.parent().unwrap()).unwrap();
            sleep(pause);
            fs::create_dir(&folder).unwrap();
            sleep(pause);
            let content = format!("content {index}");
            fs::write(&case.path, &content).unwrap();
            assert_eq!(case.changed().unwrap(), content);
            fs::write(&case.path, "another").unwrap();
            assert_eq!(case.changed().unwrap(), "another");
            fs::remove_dir_all(folder.parent().unwrap()).unwrap();
            assert_eq!(case.reload(), None);
        }
    });
}

#[test]
fn a_folder_is_renamed_away_and_back() {
    everywhere(|case| {
        let (work, away) = (case.root.join("work"), case.root.join("away"));
        fs::rename(&work, &away).unwrap();
        sleep(Duration::from_millis(10));
        fs::rename(&away, &work).unwrap();
        case.is_quiet();
        fs::write(&case.target, "second").unwrap();
        assert_eq!(case.changed().unwrap(), "second");
        // Away for longer than the events take to settle, and changed there.
        fs::rename(&work, &away).unwrap();
        case.is_quiet();
        fs::write(away.join("file"), "third").unwrap();
        case.is_quiet();
        fs::rename(&away, &work).unwrap();
        assert_eq!(case.changed().unwrap(), "third");
        fs::write(&case.target, "fourth").unwrap();
        assert_eq!(case.changed().unwrap(), "fourth");
    });
}

#[test]
fn a_folder_renamed_away_is_told_after_the_grace() {
    let short = |by: By| WatchOptions {
        grace: Duration::from_millis(50),
        ..by.options()
    };
    everywhere_with(short, |case| {
        fs::rename(case.root.join("work"), case.root.join("away")).unwrap();
        assert_eq!(case.changed(), None);
        // Its old inode does not count any more.
        fs::write(case.root.join("away/file"), "elsewhere").unwrap();
        case.is_quiet();
        fs::rename(case.root.join("away"), case.root.join("work")).unwrap();
        assert_eq!(case.changed().unwrap(), "elsewhere");
    });
}

#[test]
fn a_folder_is_replaced_by_another_of_the_same_name() {
    everywhere(|case| {
        let (work, other) = (case.root.join("work"), case.root.join("other"));
        fs::create_dir(&other).unwrap();
        fs::write(other.join("file"), "second").unwrap();
        fs::rename(&work, case.root.join("old")).unwrap();
        fs::rename(&other, &work).unwrap();
        assert_eq!(case.changed().unwrap(), "second");
        fs::write(case.root.join("old/file"), "of no account").unwrap();
        case.is_quiet();
        fs::write(&case.target, "third").unwrap();
        assert_eq!(case.changed().unwrap(), "third");
        // By one with the same content: no news, and still watched.
        fs::remove_dir_all(&work).unwrap();
        fs::create_dir(&work).unwrap();
        fs::write(&case.target, "third").unwrap();
        case.is_quiet();
        fs::write(&case.target, "fourth").unwrap();
        assert_eq!(case.changed().unwrap(), "fourth");
    });
}

#[cfg(unix)]
#[test]
fn a_folder_far_above_is_replaced() {
    everywhere(|case| {
        let deep = case.root.join("a/b/c");
        fs::create_dir_all(&deep).unwrap();
        fs::write(deep.join("file"), "first").unwrap();
        case.path = deep.join("file");
        case.reload();
        case.is_quiet();
        fs::create_dir_all(case.root.join("new/b/c")).unwrap();
        fs::write(case.root.join("new/b/c/file"), "second").unwrap();
        fs::rename(case.root.join("a"), case.root.join("old")).unwrap();
        fs::rename(case.root.join("new"), case.root.join("a")).unwrap();
        assert_eq!(case.changed().unwrap(), "second");
        fs::write(deep.join("file"), "third").unwrap();
        assert_eq!(case.changed().unwrap(), "third");
    });
}

#[cfg(unix)]
#[test]
fn a_link_is_pointed_elsewhere() {
    use std::os::unix::fs::symlink;

    use crate::case::Place;
    everywhere(|case| {
        let (link, second, third) = match case.place {
            Place::Plain => return,
            Place::LinkedFile => (case.path.clone(), "far/second/file", "far/third/file"),
            Place::LinkedFolder => (case.root.join("linked"), "far/second", "far/third"),
        };
        for content in ["second", "third"] {
            let folder = case.root.join("far").join(content);
            fs::create_dir_all(&folder).unwrap();
            fs::write(folder.join("file"), content).unwrap();
        }
        // In one step, as `ln -sfn` does not but careful programs do.
        symlink(case.root.join(second), case.root.join("temporary")).unwrap();
        fs::rename(case.root.join("temporary"), &link).unwrap();
        assert_eq!(case.changed().unwrap(), "second");
        fs::write(&case.target, "of no account").unwrap();
        case.is_quiet();
        fs::remove_file(&link).unwrap();
        sleep(Duration::from_millis(10));
        symlink(case.root.join(third), &link).unwrap();
        assert_eq!(case.changed().unwrap(), "third");
        fs::write(case.root.join("far/third/file"), "fourth").unwrap();
        assert_eq!(case.changed().unwrap(), "fourth");
    });
}

#[cfg(unix)]
#[test]
fn a_file_becomes_a_link() {
    everywhere(|case| {
        fs::create_dir(case.root.join("far")).unwrap();
        let far = case.root.join("far/file");
        fs::write(&far, "second").unwrap();
        fs::remove_file(&case.target).unwrap();
        std::os::unix::fs::symlink(&far, &case.target).unwrap();
        assert_eq!(case.changed().unwrap(), "second");
        fs::write(&far, "third").unwrap();
        assert_eq!(case.changed().unwrap(), "third");
    });
}

/// Nothing is told, so nothing is registered anew, and yet the file lies elsewhere now.
#[cfg(unix)]
#[test]
fn a_file_becomes_a_link_to_the_same() {
    everywhere(|case| {
        fs::create_dir(case.root.join("far")).unwrap();
        let far = case.root.join("far/file");
        fs::write(&far, "first").unwrap();
        fs::remove_file(&case.target).unwrap();
        std::os::unix::fs::symlink(&far, &case.target).unwrap();
        case.is_quiet();
        fs::write(&far, "second").unwrap();
        assert_eq!(case.changed().unwrap(), "second");
    });
}

#[test]
fn another_file_in_a_watched_folder_is_not_told() {
    everywhere(|case| {
        let other = case.target.with_file_name("other");
        fs::write(&other, "1").unwrap();
        fs::write(&other, "2").unwrap();
        fs::rename(&other, case.target.with_file_name("another")).unwrap();
        case.is_quiet();
    });
}

#[test]
fn a_file_that_is_no_longer_watched_is_not_told() {
    everywhere(|case| {
        let other = case.root.join("other");
        fs::write(&other, "1").unwrap();
        let files = BTreeMap::from([(other.clone(), Seen::bytes(b"1"))]);
        case.watch.watch(files, BTreeSet::new());
        fs::write(&case.path, "second").unwrap();
        case.is_quiet();
        fs::write(&other, "2").unwrap();
        let told = case.watch.wait(Some(crate::case::LONG)).unwrap();
        assert_eq!(told, Some(BTreeSet::from([other])));
    });
}
