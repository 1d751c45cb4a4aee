//! The way to a path, as the kernel walks it: name after name, through every link.
//!
//! Walking gives real entries, that is a folder without links on its own way and a name in it. Entries on the
//! way (folders and links) decide where the path leads; the entry at its end holds the content. Each entry's
//! folder is to be watched, except the root for the sake of a plain folder: those are hardly ever renamed, and
//! the recheck sees it. A way that breaks off ends at the missing entry, whose folder tells when it appears.

use std::collections::{BTreeMap, BTreeSet, HashMap, VecDeque};
use std::ffi::OsString;
use std::fs;
use std::path::{Component, Path, PathBuf};

use crate::subject::{Subject, absolute};

/// As many links as Linux follows.
const MOST_LINKS: usize = 40;

/// What an event on an entry means.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct Role {
    /// The subjects whose content this entry holds, by index.
    pub(crate) ends: Vec<usize>,
    /// It decides where some path leads.
    pub(crate) on_the_way: bool,
}

/// All entries that matter, and the folders that tell of them.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct Map {
    pub(crate) entries: HashMap<PathBuf, Role>,
    /// Folders of which every entry counts, with their subjects.
    pub(crate) listed: HashMap<PathBuf, Vec<usize>>,
    /// The folders to watch, with the subjects they serve.
    pub(crate) folders: BTreeMap<PathBuf, BTreeSet<usize>>,
}

impl Map {
    pub(crate) fn of(subjects: &[Subject]) -> Self {
        let mut map = Self::default();
        let mut known = HashMap::new();
        for (index, subject) in subjects.iter().enumerate() {
            map.walk(&subject.path, subject.is_folder(), index, &mut known);
        }
        map
    }

    fn walk(
        &mut self,
        path: &Path,
        is_folder: bool,
        index: usize,
        known: &mut HashMap<PathBuf, Kind>,
    ) {
        let (mut real, mut rest) = split(&absolute(path));
        let mut links = 0;
        while let Some(name) = rest.pop_front() {
            if name == ".." {
                real.pop();
                continue;
            }
            let entry = real.join(&name);
            let kind = known
                .entry(entry.clone())
                .or_insert_with(|| Kind::of(&entry));
            let is_last = rest.is_empty();
            // macOS tells of everything below a watched folder, and its own links in the root (`/tmp`) stay.
            let stays = match kind {
                Kind::Folder => true,
                Kind::Link(_) => cfg!(target_os = "macos"),
                Kind::Other => false,
            };
            if !(stays && real.parent().is_none()) {
                self.folders.entry(real.clone()).or_default().insert(index);
            }
            match kind {
                Kind::Link(target) => {
                    self.on_the_way(entry);
                    links += 1;
                    if links > MOST_LINKS {
                        return;
                    }
                    let (start, names) = split(target);
                    if !start.as_os_str().is_empty() {
                        real = start;
                    }
                    for name in names.into_iter().rev() {
                        rest.push_front(name);
                    }
                }
                Kind::Folder if is_last && is_folder => {
                    self.on_the_way(entry.clone());
                    self.list(entry, index);
                    return;
                }
                Kind::Folder if !is_last => {
                    self.on_the_way(entry.clone());
                    real = entry;
                }
                Kind::Folder | Kind::Other if is_last && !is_folder => {
                    self.entries.entry(key(entry)).or_default().ends.push(index);
                    return;
                }
                Kind::Folder | Kind::Other => {
                    self.on_the_way(entry);
                    return;
                }
            }
        }
        // The path names the root, or ended in `..`.
        if is_folder {
            self.list(real, index);
        }
    }

    fn on_the_way(&mut self, entry: PathBuf) {
        self.entries.entry(key(entry)).or_default().on_the_way = true;
    }

    fn list(&mut self, folder: PathBuf, index: usize) {
        let subjects = self.folders.entry(folder.clone()).or_default();
        subjects.insert(index);
        self.listed.entry(key(folder)).or_default().push(index);
    }
}

enum Kind {
    Folder,
    Link(PathBuf),
    /// A file, nothing, or what may not be looked at.
    Other,
}

impl Kind {
    fn of(entry: &Path) -> Self {
        match fs::symlink_metadata(entry) {
            Ok(metadata) if metadata.is_dir() => Self::Folder,
            Ok(metadata) if metadata.is_symlink() => {
                fs::read_link(entry).map_or(Self::Other, Self::Link)
            }
            _ => Self::Other,
        }
    }
}

/// Where a path starts (the root, with a drive where there are such; nothing for a relative path), and its names.
fn split(path: &Path) -> (PathBuf, VecDeque<OsString>) {
    let mut start = PathBuf::new();
    let mut names = VecDeque::new();
    for component in path.components() {
        match component {
            Component::Prefix(_) | Component::RootDir => start.push(component),
            Component::CurDir => {}
            Component::ParentDir | Component::Normal(_) => {
                names.push_back(component.as_os_str().to_owned());
            }
        }
    }
    (start, names)
}

/// An entry's path for comparing it with that of an event. Where file systems mostly fold case, so does this: one
/// event too many costs a comparison, one too few loses a change.
#[cfg(any(windows, target_os = "macos"))]
pub(crate) fn key(path: PathBuf) -> PathBuf {
    match path.to_str() {
        Some(text) => text.to_lowercase().into(),
        None => path,
    }
}

#[cfg(not(any(windows, target_os = "macos")))]
pub(crate) fn key(path: PathBuf) -> PathBuf {
    path
}

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::fs::symlink;

    use super::*;
    use crate::Seen;

    fn map_of(path: &Path) -> Map {
        Map::of(&[Subject::file(path.to_owned(), Seen::Absent, false)])
    }

    fn ends(map: &Map) -> Vec<&PathBuf> {
        let ends = map.entries.iter().filter(|(_, role)| !role.ends.is_empty());
        ends.map(|(entry, _)| entry).collect()
    }

    #[test]
    fn a_path_leads_through_links_and_back_up() {
        let temporary = tempfile::tempdir().unwrap();
        let root = temporary.path().canonicalize().unwrap();
        for folder in ["real/deep", "links"] {
            fs::create_dir_all(root.join(folder)).unwrap();
        }
        fs::write(root.join("real/file"), "1").unwrap();
        // `..` after a link leads to the parent of what it points to, not of the link.
        symlink("../real/deep", root.join("links/folder")).unwrap();
        symlink(root.join("links/folder/../file"), root.join("links/file")).unwrap();
        let map = map_of(&root.join("links/file"));
        assert_eq!(ends(&map), [&root.join("real/file")]);
        for way in ["links", "links/file", "links/folder", "real", "real/deep"] {
            assert!(map.entries[&root.join(way)].on_the_way, "{way}");
        }
        for folder in [".", "links", "real"] {
            let folder: PathBuf = root.join(folder).components().collect();
            assert!(map.folders.contains_key(&folder), "{}", folder.display());
        }
        assert!(!map.folders.contains_key(Path::new("/")));
        assert!(!map.folders.contains_key(&root.join("real/deep")));
    }

    #[test]
    fn a_broken_way_is_watched_where_it_breaks() {
        let temporary = tempfile::tempdir().unwrap();
        let root = temporary.path().canonicalize().unwrap();
        let map = map_of(&root.join("not/yet/there"));
        assert!(ends(&map).is_empty());
        assert!(map.entries[&root.join("not")].on_the_way);
        assert!(map.folders.contains_key(&root));
        let map = map_of(Path::new("/volgraph-not-there/file"));
        assert!(map.folders.contains_key(Path::new("/")));
    }

    #[test]
    fn a_circle_of_links_ends() {
        let temporary = tempfile::tempdir().unwrap();
        let root = temporary.path().canonicalize().unwrap();
        symlink("b", root.join("a")).unwrap();
        symlink("a", root.join("b")).unwrap();
        let map = map_of(&root.join("a"));
        assert!(ends(&map).is_empty());
        assert!(map.entries[&root.join("a")].on_the_way);
        assert!(map.entries[&root.join("b")].on_the_way);
    }
}
