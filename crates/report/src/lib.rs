//! What volgraph tells people about their files: findings, each with a place, a cause and a remedy.
//!
//! The way of the data: a reader meets a file ([`ron_text::Document`] for RON, the linker for WGSL), turns
//! everything wrong in it into a [`Finding`], collects them in [`Findings`] and goes on, so that one run shows
//! all of them. The command line prints them sorted by place with [`excerpt::render`]; tests look at the
//! [`Finding::code`], which is stable, and at the [`Place`]. Nothing here prints.

pub mod excerpt;
mod finding;
mod place;
pub mod ron_text;
mod suggest;

pub use finding::{Finding, Findings, Severity};
pub use place::{Place, line_column};
pub use suggest::{did_you_mean, list_names, near_names};
