//! The live window as people meet it, without a window: widgets by their names, a real drawing thread on a folder.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod desk;
mod diagnostics;
mod drawing;
mod graph;
mod menus;
mod parameters;
mod ray;
mod slices;
mod slots;
mod time;
mod transfer;
mod view;
