//! Something watched: a file or a folder, how it looked last, and what differs of it.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::Seen;
use crate::listing::{Differences, Listing};
use crate::record::{Record, Verdict};
use crate::stamp::Look;

#[derive(Debug)]
pub(crate) struct Subject {
    /// As the caller gave it.
    pub(crate) path: PathBuf,
    kind: Kind,
    /// What differs, and is not told yet.
    pub(crate) found: Option<Found>,
}

#[derive(Debug)]
enum Kind {
    File {
        record: Box<Record>,
        looked: Option<Look>,
        /// What the record is to become when the difference is told.
        next: Option<Seen>,
    },
    Folder {
        told: Listing,
        looked: Listing,
    },
}

/// A difference that waits to be told.
#[derive(Debug)]
pub(crate) struct Found {
    pub(crate) differences: Differences,
    /// When something complete was found first.
    pub(crate) complete_since: Option<Instant>,
    /// The last event of it.
    pub(crate) last_event: Instant,
}

impl Found {
    /// How long what is missing may take to come back; `None` when nothing is missing, or it may take for ever.
    pub(crate) fn missing_until(&self, grace: Duration) -> Option<Instant> {
        if self.differences.missing.is_empty() {
            return None;
        }
        self.last_event.checked_add(grace)
    }
}

impl Subject {
    pub(crate) fn file(path: PathBuf, seen: Seen, named: bool) -> Self {
        let kind = Kind::File {
            record: Box::new(Record::new(seen, named)),
            looked: None,
            next: None,
        };
        Self {
            path,
            kind,
            found: None,
        }
    }

    pub(crate) fn folder(path: PathBuf) -> Self {
        let told = Listing::of(&path);
        let looked = told.clone();
        Self {
            path,
            kind: Kind::Folder { told, looked },
            found: None,
        }
    }

    pub(crate) fn is_folder(&self) -> bool {
        matches!(self.kind, Kind::Folder { .. })
    }

    /// An event that may be of its content has named it.
    pub(crate) fn name(&mut self) {
        if let Kind::File { record, .. } = &mut self.kind {
            record.named = true;
        }
    }

    /// Whether an event has named it since it was last found unchanged.
    pub(crate) fn is_named(&self) -> bool {
        matches!(&self.kind, Kind::File { record, .. } if record.named)
    }

    /// Whether it looks different from the last look.
    pub(crate) fn stirred(&mut self) -> bool {
        match &mut self.kind {
            Kind::File { looked, .. } => {
                let now = Look::of(&self.path);
                let differs = now != *looked;
                *looked = now;
                differs
            }
            Kind::Folder { looked, .. } => {
                let now = Listing::of(&self.path);
                let differs = now != *looked;
                *looked = now;
                differs
            }
        }
    }

    /// Whether its last look leaves open if it has changed.
    pub(crate) fn must_read(&self) -> bool {
        match &self.kind {
            Kind::File { record, looked, .. } => {
                looked.as_ref().is_some_and(|look| record.must_read(look))
            }
            Kind::Folder { .. } => false,
        }
    }

    /// Compares, and notes what differs. `trusting` believes a look that stands, as there was no event of it.
    pub(crate) fn examine(&mut self, trusting: bool, last_event: Instant) {
        let differences = self.compare(trusting);
        let before = self.found.take();
        if differences.is_none() {
            return;
        }
        let last_event = match &before {
            Some(found) if trusting => found.last_event,
            _ => last_event,
        };
        let before = before.and_then(|found| found.complete_since);
        let complete_since = if differences.complete.is_empty() {
            None
        } else {
            Some(before.unwrap_or_else(Instant::now))
        };
        self.found = Some(Found {
            differences,
            complete_since,
            last_event,
        });
    }

    fn compare(&mut self, trusting: bool) -> Differences {
        let mut differences = Differences::default();
        match &mut self.kind {
            Kind::File {
                record,
                looked,
                next,
            } => {
                *looked = Look::of(&self.path);
                match record.examine(&self.path, looked.as_ref(), trusting) {
                    Verdict::Same => *next = None,
                    Verdict::Changed(seen) => {
                        *next = Some(seen);
                        differences.complete.insert(self.path.clone());
                    }
                    Verdict::Missing(seen) => {
                        *next = Some(seen);
                        differences.missing.insert(self.path.clone());
                    }
                }
            }
            Kind::Folder { told, looked } => {
                *looked = Listing::of(&self.path);
                differences = told.differences(looked, &self.path);
            }
        }
        differences
    }

    /// What has been missing for the time of grace stays away, and this is complete news. It may have come back
    /// without an event, so it is looked for once more.
    pub(crate) fn give_up_missing(&mut self, now: Instant, grace: Duration) {
        let until = |found: &Option<Found>| found.as_ref().and_then(|it| it.missing_until(grace));
        if until(&self.found).is_none_or(|until| now < until) {
            return;
        }
        if let Some(found) = &self.found {
            self.examine(false, found.last_event);
        }
        if let Some(found) = &mut self.found {
            found
                .differences
                .complete
                .append(&mut found.differences.missing);
            found.complete_since.get_or_insert(now);
        }
    }

    /// Hands over what is complete, and takes it as what is seen from now on.
    pub(crate) fn tell(&mut self) -> BTreeSet<PathBuf> {
        let Some(found) = &mut self.found else {
            return BTreeSet::new();
        };
        let told = std::mem::take(&mut found.differences.complete);
        found.complete_since = None;
        if found.differences.is_none() {
            self.found = None;
        }
        if !told.is_empty() {
            self.accept(&told);
        }
        told
    }

    fn accept(&mut self, paths: &BTreeSet<PathBuf>) {
        match &mut self.kind {
            Kind::File { record, next, .. } => {
                if let Some(seen) = next.take() {
                    record.accept(seen);
                }
            }
            Kind::Folder { told, looked } => told.accept(looked, &self.path, paths),
        }
    }
}

/// The path from the file system's root on; as given where there is no current folder to start from. The empty path,
/// a bare name's folder, is the current folder.
pub(crate) fn absolute(path: &Path) -> PathBuf {
    if path.as_os_str().is_empty() {
        return std::env::current_dir().unwrap_or_default();
    }
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
}
