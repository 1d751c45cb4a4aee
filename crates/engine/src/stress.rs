//! The known breaking points of volume rendering, each with the methods that break there and those that hold.
//!
//! The way of the data: a [`Case`] is plain values: scenes at the points of a sweep ([`Point`]), the [`Method`]s that draw
//! them, each with a bound and what is expected of it, and where the [`Truth`] comes from. A [`Stand`] has one device and
//! one session; it draws every method at every point and judges the pixels ([`judge`]): values that are no numbers,
//! holes, specks, errors above the bound. What came of it is a [`CaseReport`]. [`cases`] are all that are known.

mod case;
mod cases;
pub mod judge;
mod report;
mod scene_text;
mod stand;
mod truth;

pub use case::{Bound, Case, Expect, Method, Point, Quantity, Truth};
pub use cases::{cases, kind_of_classify};
pub use judge::{Measured, Pixels};
pub use report::{CaseReport, MethodReport, Verdict};
pub use scene_text::{SceneText, VolumeText};
pub use stand::Stand;
