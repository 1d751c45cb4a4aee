//! How changes come to be known, for people to read.

use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;
use std::time::Duration;

/// How a [`FileWatch`](crate::FileWatch) comes to know of changes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Backend {
    /// The platform's watcher; where there is none, the reason, and everything is polled.
    pub events: Result<&'static str, String>,
    /// Folders that are polled beside the events, with the reason.
    pub polled: BTreeMap<PathBuf, String>,
    /// The polling interval.
    pub interval: Duration,
}

impl fmt::Display for Backend {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let interval = self.interval;
        match &self.events {
            Ok(name) => write!(f, "events from {name}")?,
            Err(reason) => write!(f, "polling every {interval:?}: {reason}")?,
        }
        for (folder, reason) in &self.polled {
            let folder = folder.display();
            write!(f, "; polling every {interval:?} below `{folder}`: {reason}")?;
        }
        Ok(())
    }
}
