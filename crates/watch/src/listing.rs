//! A folder's direct entries, and which of them differ from before.
//!
//! A listing is taken when watching begins. An entry differs by being new, gone, or looked at differently: its
//! status counts too, as a permission may mend what a content could not. Of a folder inside only its being there
//! counts, since its own entries are not watched.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crate::stamp::{Identity, Look, identity};

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Entry {
    Folder(Option<Identity>),
    /// A file, a link that leads nowhere, or anything else.
    Other(Look),
}

impl Entry {
    fn of(path: &Path) -> Option<Self> {
        let taken = SystemTime::now();
        let metadata = fs::metadata(path)
            .or_else(|_| fs::symlink_metadata(path))
            .ok()?;
        Some(if metadata.is_dir() {
            Self::Folder(identity(&metadata))
        } else {
            Self::Other(Look::new(&metadata, taken))
        })
    }

    fn is_empty_file(&self) -> bool {
        matches!(self, Self::Other(look) if look.is_file && look.stamp.is_empty())
    }
}

/// The folder of a bare name is empty, and is the current one.
fn readable(folder: &Path) -> &Path {
    if folder.as_os_str().is_empty() {
        Path::new(".")
    } else {
        folder
    }
}

/// The entries of a folder; `None` where it cannot be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Listing(Option<BTreeMap<OsString, Entry>>);

impl Listing {
    pub(crate) fn of(folder: &Path) -> Self {
        let Ok(entries) = fs::read_dir(readable(folder)) else {
            return Self(None);
        };
        let names = entries.flatten().map(|entry| entry.file_name());
        Self(Some(
            names
                .filter_map(|name| {
                    let entry = Entry::of(&folder.join(&name))?;
                    Some((name, entry))
                })
                .collect(),
        ))
    }

    /// What differs now: the paths with something to see, and those that are gone or empty but were not.
    pub(crate) fn differences(&self, now: &Self, folder: &Path) -> Differences {
        let mut found = Differences::default();
        let (before, now) = match (&self.0, &now.0) {
            (None, None) => return found,
            (None, Some(_)) => {
                found.complete.insert(folder.to_owned());
                return found;
            }
            (Some(_), None) => {
                found.missing.insert(folder.to_owned());
                return found;
            }
            (Some(before), Some(now)) => (before, now),
        };
        for (name, entry) in now {
            if before.get(name) != Some(entry) {
                let place = if entry.is_empty_file() {
                    &mut found.missing
                } else {
                    &mut found.complete
                };
                place.insert(folder.join(name));
            }
        }
        let gone = before.keys().filter(|name| !now.contains_key(*name));
        found.missing.extend(gone.map(|name| folder.join(name)));
        found
    }

    /// Takes over what `now` says of the paths that were told.
    pub(crate) fn accept(&mut self, now: &Self, folder: &Path, told: &BTreeSet<PathBuf>) {
        let (Some(before), Some(now)) = (&mut self.0, &now.0) else {
            self.clone_from(now);
            return;
        };
        let names = told
            .iter()
            .filter(|path| path.parent() == Some(folder))
            .filter_map(|path| path.file_name());
        for name in names {
            match now.get(name) {
                Some(entry) => before.insert(name.to_owned(), entry.clone()),
                None => before.remove(name),
            };
        }
    }
}

/// Paths that differ.
#[derive(Debug, Default)]
pub(crate) struct Differences {
    pub(crate) complete: BTreeSet<PathBuf>,
    /// Gone or empty, and given time to come back.
    pub(crate) missing: BTreeSet<PathBuf>,
}

impl Differences {
    pub(crate) fn is_none(&self) -> bool {
        self.complete.is_empty() && self.missing.is_empty()
    }
}
