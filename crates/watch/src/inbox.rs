//! Where the platform's thread leaves events, and [`FileWatch::wait`](crate::FileWatch::wait) finds them.
//!
//! Only events on entries of the [`Map`] are kept, one note for each entry, so that an inbox nobody empties stays
//! small however busy a folder such as `/tmp` is.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use notify::event::{AccessKind, AccessMode, ModifyKind};
use notify::{Event, EventKind};

use crate::route::{Map, key};

#[derive(Debug, Default)]
pub(crate) struct Inbox {
    state: Mutex<State>,
    news: Condvar,
}

#[derive(Debug, Default)]
struct State {
    map: Arc<Map>,
    mail: Mail,
}

/// What has happened since the inbox was emptied.
#[derive(Debug, Default)]
pub(crate) struct Mail {
    pub(crate) entries: BTreeMap<PathBuf, Note>,
    /// Events were lost: anything may have happened.
    pub(crate) lost: bool,
    /// The times of the first and the last event.
    pub(crate) span: Option<(Instant, Instant)>,
}

/// What has happened to one entry.
#[derive(Debug)]
pub(crate) struct Note {
    /// Its content may have changed, not its status alone.
    pub(crate) content: bool,
    /// It may be another file, folder or link than before.
    pub(crate) replaced: bool,
    /// It is a listed folder, and something in it has changed.
    pub(crate) inside: bool,
    pub(crate) last: Instant,
}

impl Inbox {
    /// Which entries matter from now on.
    pub(crate) fn filter(&self, map: Arc<Map>) {
        self.lock().map = map;
    }

    /// Takes what has come.
    pub(crate) fn empty(&self) -> Mail {
        std::mem::take(&mut self.lock().mail)
    }

    /// Waits until something has come, at most until then.
    pub(crate) fn wait(&self, until: Option<Instant>) {
        let mut state = self.lock();
        while state.mail.span.is_none() {
            state = match until {
                None => self
                    .news
                    .wait(state)
                    .unwrap_or_else(PoisonError::into_inner),
                Some(until) => {
                    let left = until.saturating_duration_since(Instant::now());
                    if left.is_zero() {
                        return;
                    }
                    self.news
                        .wait_timeout(state, left)
                        .unwrap_or_else(PoisonError::into_inner)
                        .0
                }
            };
        }
    }

    /// Takes an event from the platform's thread.
    pub(crate) fn receive(&self, event: notify::Result<Event>) {
        let Some(change) = event.map_or(Some(Change::Lost), Change::of) else {
            return;
        };
        let now = Instant::now();
        let mut state = self.lock();
        if state.note(change, now) {
            let first = state.mail.span.map_or(now, |(first, _)| first);
            state.mail.span = Some((first, now));
            self.news.notify_all();
        }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        // Every change to the state is whole in itself.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// An event, as far as it matters.
enum Change {
    Lost,
    Entries {
        paths: Vec<PathBuf>,
        content: bool,
        replaced: bool,
    },
}

impl Change {
    /// `None` for an access, which changes nothing. A close after writing is the end of a change.
    fn of(event: Event) -> Option<Self> {
        if event.need_rescan() {
            return Some(Self::Lost);
        }
        let (content, replaced) = match event.kind {
            EventKind::Access(AccessKind::Close(AccessMode::Write))
            | EventKind::Modify(ModifyKind::Data(_)) => (true, false),
            EventKind::Access(_) => return None,
            EventKind::Modify(ModifyKind::Metadata(_)) => (false, false),
            // Created, removed, renamed, or something that the platform cannot name.
            _ => (true, true),
        };
        Some(Self::Entries {
            paths: event.paths,
            content,
            replaced,
        })
    }
}

impl State {
    /// Whether the change matters.
    fn note(&mut self, change: Change, now: Instant) -> bool {
        let (paths, content, replaced) = match change {
            Change::Lost => {
                self.mail.lost = true;
                return true;
            }
            Change::Entries {
                paths,
                content,
                replaced,
            } => (paths, content, replaced),
        };
        let mut matters = false;
        for path in paths {
            let entry = key(path);
            let folder = entry
                .parent()
                .filter(|folder| self.map.listed.contains_key(*folder));
            if let Some(folder) = folder {
                self.mail.note(folder.to_owned(), now).inside = true;
                matters = true;
            }
            if self.map.entries.contains_key(&entry) {
                let note = self.mail.note(entry, now);
                note.content |= content;
                note.replaced |= replaced;
                matters = true;
            }
        }
        matters
    }
}

impl Mail {
    fn note(&mut self, entry: PathBuf, now: Instant) -> &mut Note {
        let note = self.entries.entry(entry).or_insert(Note {
            content: false,
            replaced: false,
            inside: false,
            last: now,
        });
        note.last = now;
        note
    }
}
