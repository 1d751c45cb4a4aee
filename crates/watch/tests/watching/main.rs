//! Edits of files and folders, each told or not told by the platform's watcher and by polling.

#![expect(
    clippy::unwrap_used,
    reason = "helpers fail a test by panicking, as tests do"
)]

mod case;
mod edges;
mod folders;
mod saving;
mod ways;
