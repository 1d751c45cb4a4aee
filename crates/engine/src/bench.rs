//! How fast techniques draw, beside the limit of the device.
//!
//! The way of the data: a [`Subject`] is a volume with its transfer function and camera; a [`Technique`] is a ready graph
//! with settings, and [`Technique::scene`] draws the subject by it. [`limit_of`] makes of a scene the one that takes its
//! samples and does nothing else, and [`empty_of`] the one that takes a single one of each ray: what a frame costs anyway.
//! [`run_table`] times all of them in turn over a [`Rotation`] and gives a [`Table`] of frame times, rates and ratios.
//! [`growth`] times frames as the work grows, and [`fit`] says by which power. Nothing here prints or writes files.

mod fit;
mod growth;
mod limit;
mod memory;
mod peer_points;
mod peers;
mod rotation;
mod stand;
mod subject;
mod table;
mod technique;

pub use fit::{PowerFit, fit};
pub use growth::{Growth, GrowthAxis, GrowthOptions, GrowthPoint, growth};
pub use limit::{empty_of, limit_of};
pub use memory::{Memory, device_bytes, peak_resident_bytes};
pub use peer_points::{CHART_JOBS, PeerPoint};
pub use peers::{PEER_JOBS, PEER_VOLUMES, PeerJob, PeerRound, PeerRow, PeerWork, peer_times};
pub use rotation::Rotation;
pub use stand::{BenchStand, Entry};
pub use subject::Subject;
pub use table::{FrameTime, Row, Table, TableOptions, run_table};
pub use technique::{STAGES, TECHNIQUES, Technique, own_technique};
