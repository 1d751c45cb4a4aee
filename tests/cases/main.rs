//! All cases, one binary; only `live` has a process of its own, whose memory it measures.

#![expect(clippy::unwrap_used, reason = "a case fails by panicking")]

mod accuracy;
mod agreement;
mod closed_forms;
mod exhaustion;
mod hazards;
mod lost_devices;
mod memory_of_work;
mod plans;
mod rebuilds;
mod segments;
