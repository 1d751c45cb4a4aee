//! Turns plans into wgpu calls: the one crate that touches a GPU.
//!
//! The way of the data: [`Gpu::open`] chooses an adapter and makes a device; its [`Gpu::limits`] and
//! [`Gpu::capabilities`] shape the plan. A [`Runner`] takes a plan: [`Runner::prepare`] builds every pipeline
//! and allocation inside error scopes into an [`Installation`], beside the one that works; [`Runner::frame`] compares
//! fingerprints with what each allocation holds, records and submits the nodes that must run, and [`Runner::read`]
//! brings an output back. What is held already is shared by the rules of [`pool`]. A node with several variants (fragment,
//! compute) is measured once on a small view, and the faster one stays; where there is a place to [`Keep`] it, for later
//! runs of the program too.

mod adapter;
mod bindings;
mod device;
mod display;
mod error;
mod guard;
mod kept;
mod pipelines;
pub mod pool;
mod readback;
mod runner;
mod timing;

pub use adapter::{AdapterChoice, AdapterSummary, list_adapters};
pub use device::{Gpu, SharedDevice};
pub use display::Shown;
pub use error::GpuError;
pub use kept::Keep;
pub use readback::{TexelValues, Texels};
pub use runner::{Building, FrameReport, Installation, NodeReport, Runner};
