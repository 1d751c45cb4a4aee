//! All cases, one binary.

#![expect(clippy::unwrap_used, reason = "a case fails by panicking")]

mod accuracy;
mod agreement;
mod closed_forms;
mod exhaustion;
mod hazards;
mod live;
mod memory_of_work;
mod plans;
