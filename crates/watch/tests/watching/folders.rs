//! Folders of which every entry counts.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use volgraph_watch::{FileWatch, WatchOptions};

use crate::case::{By, Case, LONG, everywhere, everywhere_with};

/// Watches the folder that holds the path, and nothing else.
fn watch_folder(case: &mut Case) -> PathBuf {
    let folder = case.path.parent().unwrap().to_owned();
    watch_this(case, &folder);
    folder
}

fn watch_this(case: &mut Case, folder: &Path) {
    let folders = BTreeSet::from([folder.to_owned()]);
    case.watch.watch(BTreeMap::new(), folders);
    case.is_quiet();
}

fn told(case: &mut Case, path: &Path) {
    let told = case.watch.wait(Some(LONG)).unwrap();
    assert_eq!(told, Some(BTreeSet::from([path.to_owned()])));
}

#[test]
fn a_new_entry_and_a_changed_one_are_told() {
    everywhere(|case| {
        let folder = watch_folder(case);
        fs::write(folder.join("new"), "1").unwrap();
        told(case, &folder.join("new"));
        case.is_quiet();
        fs::create_dir(folder.join("inside")).unwrap();
        told(case, &folder.join("inside"));
        // What lies deeper does not count.
        fs::write(folder.join("inside/file"), "1").unwrap();
        case.is_quiet();
        fs::write(folder.join("new"), "22").unwrap();
        told(case, &folder.join("new"));
    });
}

#[test]
fn a_change_of_permissions_counts() {
    everywhere(|case| {
        if case.place != crate::case::Place::Plain {
            return;
        }
        let folder = watch_folder(case);
        let mut permissions = fs::metadata(&case.target).unwrap().permissions();
        permissions.set_readonly(true);
        fs::set_permissions(&case.target, permissions).unwrap();
        if cfg!(unix) {
            told(case, &folder.join("file"));
        }
    });
}

#[test]
fn a_temporary_entry_is_not_told() {
    everywhere(|case| {
        let folder = watch_folder(case);
        // As vim does to see whether it may write here.
        fs::write(folder.join("4913"), "").unwrap();
        case.is_quiet();
        fs::remove_file(folder.join("4913")).unwrap();
        case.is_quiet();
    });
}

#[test]
fn a_removed_entry_is_told_after_the_grace() {
    let short = |by: By| WatchOptions {
        grace: Duration::from_millis(50),
        ..by.options()
    };
    everywhere_with(short, |case| {
        let folder = watch_folder(case);
        fs::remove_file(&case.path).unwrap();
        told(case, &case.path.clone());
        case.is_quiet();
        fs::remove_dir_all(case.root.join("work")).unwrap();
        if folder.exists() {
            // The folder of the link is still there.
            case.is_quiet();
        } else {
            told(case, &folder);
        }
        case.is_quiet();
    });
}

#[test]
fn a_folder_that_did_not_exist_appears() {
    everywhere(|case| {
        let folder = case.path.with_file_name("not/yet");
        watch_this(case, &folder);
        fs::create_dir_all(&folder).unwrap();
        told(case, &folder);
        fs::write(folder.join("file"), "1").unwrap();
        told(case, &folder.join("file"));
    });
}

#[test]
fn the_empty_path_is_the_current_folder() {
    let mut watch = FileWatch::new(WatchOptions::default());
    watch.watch(BTreeMap::new(), BTreeSet::from([PathBuf::new()]));
    let file = tempfile::NamedTempFile::new_in(".").unwrap();
    let name = PathBuf::from(file.path().file_name().unwrap());
    let start = Instant::now();
    // Other tests may use this folder as well.
    while !watch
        .wait(Some(LONG))
        .unwrap()
        .unwrap_or_default()
        .contains(&name)
    {
        assert!(start.elapsed() < LONG, "the new file was not told");
    }
}
