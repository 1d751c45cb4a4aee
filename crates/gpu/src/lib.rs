//! Turns plans into wgpu calls: the one crate that touches a GPU.
//!
//! The way of the data: [`Gpu::open`] chooses an adapter and makes a device; its [`Gpu::limits`] and
//! [`Gpu::capabilities`] shape the plan. A [`Runner`] takes a plan: [`Runner::install`] builds every pipeline
//! inside an error scope and only then swaps, [`Runner::frame`] compares fingerprints with what each allocation
//! holds, records and submits the nodes that must run, and [`Runner::read`] brings an output back. Memory comes
//! from a [`pool`], which reports counts and bytes. A node with several variants (fragment, compute) is measured once
//! on a small view, and the faster one stays.

mod adapter;
mod bindings;
mod device;
mod error;
mod pipelines;
pub mod pool;
mod readback;
mod runner;
mod timing;

pub use adapter::{AdapterChoice, AdapterSummary, list_adapters};
pub use device::Gpu;
pub use error::GpuError;
pub use readback::Texels;
pub use runner::{FrameReport, NodeReport, Runner};
