//! The platform's watcher, and the folders it watches.
//!
//! [`Platform::follow`] brings the watched folders in line with the needed ones. A folder's watch follows its
//! inode, so a folder renamed away, or replaced, is watched anew. What cannot be watched, and what lies on a
//! network file system, is kept with the reason, for polling.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, TryRecvError};
use std::time::Duration;

use notify::{Config, RecommendedWatcher, RecursiveMode, Watcher, WatcherKind};

use crate::inbox::Inbox;
use crate::network;
use crate::route::{Map, key};
use crate::stamp::{Identity, identity_of};

/// How long dropping waits for the platform's thread. It ends within milliseconds of being asked.
const LONGEST_END: Duration = Duration::from_secs(1);

pub(crate) struct Platform {
    events: Result<Events, String>,
    watched: BTreeMap<PathBuf, Option<Identity>>,
    /// Folders to poll, and why.
    polled: BTreeMap<PathBuf, String>,
}

struct Events {
    watcher: Box<dyn Watcher + Send>,
    name: &'static str,
    /// Says when the thread that calls our handler has ended.
    ended: Receiver<()>,
}

/// Which folders to watch anew although they seem to be watched.
pub(crate) enum Again {
    Nothing,
    Below(BTreeSet<PathBuf>),
    Everything,
}

impl Again {
    fn holds(&self, folder: &Path) -> bool {
        match self {
            Self::Nothing => false,
            Self::Below(entries) => {
                let folder = key(folder.to_owned());
                folder.ancestors().any(|above| entries.contains(above))
            }
            Self::Everything => true,
        }
    }
}

impl Platform {
    /// The platform's watcher; without events where it cannot be made.
    pub(crate) fn new(inbox: &Arc<Inbox>) -> Self {
        Self::of(Events::new(inbox))
    }

    /// No events, for this reason.
    pub(crate) fn without_events(reason: impl Into<String>) -> Self {
        Self::of(Err(reason.into()))
    }

    /// This watcher, whose thread holds the sender's end.
    #[cfg(test)]
    pub(crate) fn with(
        watcher: Box<dyn Watcher + Send>,
        name: &'static str,
        ended: Receiver<()>,
    ) -> Self {
        Self::of(Ok(Events {
            watcher,
            name,
            ended,
        }))
    }

    fn of(events: Result<Events, String>) -> Self {
        Self {
            events,
            watched: BTreeMap::new(),
            polled: BTreeMap::new(),
        }
    }

    /// The watcher's name, or why there is none.
    pub(crate) fn events(&self) -> Result<&'static str, &str> {
        match &self.events {
            Ok(events) => Ok(events.name),
            Err(reason) => Err(reason),
        }
    }

    /// The folders to poll, with the reasons.
    pub(crate) fn polled(&self) -> &BTreeMap<PathBuf, String> {
        &self.polled
    }

    /// Watches these folders and no others. True when a folder is watched now that was not before, and so may
    /// have changed unseen.
    pub(crate) fn follow(&mut self, map: &Map, again: &Again) -> bool {
        self.give_up_when_ended();
        let Ok(events) = &mut self.events else {
            return false;
        };
        let needed = &map.folders;
        // First away with what is stale: one inode has one watch, whatever its name.
        self.watched.retain(|folder, identity| {
            let stands = needed.contains_key(folder)
                && !again.holds(folder)
                && *identity == identity_of(folder);
            if !stands {
                // It fails where the folder is gone and the watch with it.
                let _ = events.watcher.unwatch(folder);
            }
            stands
        });
        self.polled.clear();
        let mut added = false;
        for folder in needed.keys() {
            if let Some(name) = network::file_system(folder) {
                let reason = format!("on {name}, where other machines may write");
                self.polled.insert(folder.clone(), reason);
            }
            if self.watched.contains_key(folder) {
                continue;
            }
            let identity = identity_of(folder);
            if identity.is_some() && self.watched.values().any(|other| *other == identity) {
                let reason = "it is watched by another name".to_owned();
                self.polled.insert(folder.clone(), reason);
                continue;
            }
            match events.watcher.watch(folder, RecursiveMode::NonRecursive) {
                Ok(()) => {
                    self.watched.insert(folder.clone(), identity);
                    added = true;
                }
                Err(error) => {
                    let reason = format!("it cannot be watched: {}", describe(&error));
                    self.polled.insert(folder.clone(), reason);
                }
            }
        }
        added
    }

    /// A thread that has ended answers nothing, and its watcher would panic when asked.
    fn give_up_when_ended(&mut self) {
        let Ok(events) = &self.events else { return };
        if events.has_ended() {
            let reason = format!("the thread of {} has ended", events.name);
            let given_up = std::mem::replace(self, Self::without_events(reason));
            drop(given_up);
        }
    }
}

impl Events {
    fn new(inbox: &Arc<Inbox>) -> Result<Self, String> {
        let name = match RecommendedWatcher::kind() {
            WatcherKind::Inotify => "inotify",
            WatcherKind::Fsevent => "FSEvents",
            WatcherKind::ReadDirectoryChangesWatcher => "ReadDirectoryChangesW",
            WatcherKind::Kqueue => {
                return Err("kqueue tells nothing of a write into a file by its folder".to_owned());
            }
            _ => return Err("there is no watcher for this platform".to_owned()),
        };
        let (alive, ended) = mpsc::channel();
        let inbox = Arc::clone(inbox);
        let handler = move |event| {
            let _ = &alive;
            inbox.receive(event);
        };
        let watcher = RecommendedWatcher::new(handler, Config::default())
            .map_err(|error| format!("{name} cannot be used: {}", describe(&error)))?;
        Ok(Self {
            watcher: Box::new(watcher),
            name,
            ended,
        })
    }

    fn has_ended(&self) -> bool {
        self.ended.try_recv() == Err(TryRecvError::Disconnected)
    }
}

impl Drop for Platform {
    fn drop(&mut self) {
        let Ok(events) = std::mem::replace(&mut self.events, Err(String::new())) else {
            return;
        };
        if events.has_ended() {
            std::mem::forget(events.watcher);
        } else {
            drop(events.watcher);
            let _ = events.ended.recv_timeout(LONGEST_END);
        }
    }
}

/// The error in words. The paths are told beside it.
fn describe(error: &notify::Error) -> String {
    match &error.kind {
        notify::ErrorKind::MaxFilesWatch => {
            "the limit of watched folders is reached; raise fs.inotify.max_user_watches".to_owned()
        }
        notify::ErrorKind::Io(error) => error.to_string(),
        notify::ErrorKind::Generic(text) => text.clone(),
        notify::ErrorKind::PathNotFound => "it is gone".to_owned(),
        kind => format!("{kind:?}"),
    }
}
