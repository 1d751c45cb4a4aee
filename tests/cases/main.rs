//! All cases, one binary.

mod agreement;
mod closed_forms;
mod memory_of_work;
mod plans;
