//! Tells, by content, when files that a picture depends on have changed.
//!
//! The way of the data: [`FileWatch::watch`] takes paths with what was [`Seen`] of each. `route` walks to every
//! path as the kernel does and so finds the folders to watch: the path's own, those of the links on the way, and
//! their ancestors. `platform` watches these folders, and tells which ones need polling. `inbox` keeps the
//! events that name something on a route and drops the rest. [`FileWatch::wait`] lets events settle, walks again
//! where the way itself has changed, and then compares (`record` for files, `listing` for folders). Only a
//! difference of content ends the waiting. Events make it fast; a comparison at every registration, and a slow
//! look every two seconds, make it sure.

mod backend;
mod inbox;
mod listing;
mod network;
mod platform;
mod record;
mod route;
mod stamp;
mod subject;
#[cfg(test)]
mod tests;
mod wait;
mod watch;

use std::time::Duration;

pub use backend::Backend;
pub use stamp::{Seen, Stamp};
pub use watch::FileWatch;

/// How patient a [`FileWatch`] is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WatchOptions {
    /// How long it must be quiet after an event before files are compared. 3 ms.
    pub settle: Duration,
    /// In a burst of events, how long after the first one files are compared all the same. 50 ms.
    pub longest_settle: Duration,
    /// How long a file that is gone or empty may take to come back before this is told, as editors truncate and
    /// then write, or delete and then create. 100 ms.
    pub grace: Duration,
    /// Polls everything at this interval and uses no events. By default there are events, and what they may not
    /// reach is polled every [`WatchOptions::POLL`].
    pub poll: Option<Duration>,
    /// How often everything is looked at where events should tell, for what they cannot: a write through another
    /// hard link, a file system mounted or taken away. The looks are cheap, as a stamp that stands is trusted.
    /// Every 2 s; `None` relies on events alone.
    pub recheck: Option<Duration>,
}

impl WatchOptions {
    /// The polling interval where none is set.
    pub const POLL: Duration = Duration::from_millis(500);
}

impl Default for WatchOptions {
    fn default() -> Self {
        Self {
            settle: Duration::from_millis(3),
            longest_settle: Duration::from_millis(50),
            grace: Duration::from_millis(100),
            poll: None,
            recheck: Some(Duration::from_secs(2)),
        }
    }
}

/// Why waiting ended without an answer.
#[derive(Debug, thiserror::Error)]
pub enum WatchError {
    /// Nothing is watched and no timeout is set, so waiting would never end.
    #[error(
        "nothing is watched, so nothing can change; watch a file or a folder before waiting for it"
    )]
    NothingWatched,
}
