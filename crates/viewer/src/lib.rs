//! The live window: a volgraph session in egui, on one device with it.
//!
//! The way of the data: a [`Worker`] owns the session on a thread of its own, follows the files as `volgraph watch` does,
//! and tells the interface what there is to see ([`Told`]); so a slow frame never holds up a menu. The interface
//! ([`Viewer`]) asks by [`Request`]s: cameras, parameters, sizes. While the camera moves the worker draws as coarsely as
//! the time for a frame allows, and refines when it stands still; what stands still is the picture that `volgraph
//! render` gives. Panels are functions of what was told, and change nothing but by requests, so they are tested without
//! a window. [`open`] brings both into a window that draws with the session's own device.

mod blit;
mod export;
mod handles;
mod histogram;
mod looked;
mod measure;
mod navigate;
mod panels;
mod settings;
mod transfer;
mod view;
mod viewer;
mod window;
mod worker;
mod write_back;

pub use blit::Shot;
pub use looked::{Looked, LookedPlane};
pub use measure::Measured;
pub use navigate::{Axis, Navigation};
pub use settings::{Pane, Settings};
pub use transfer::TransferEdit;
pub use viewer::Viewer;
pub use window::{measure, open};
pub use worker::{ErrorMap, Note, Request, Told, Turntable, Worker, WorkerOptions};
