//! Ground truth: what a picture of a volume should be, in float64 and to a stated tolerance.
//!
//! The way of the data: a [`Scene`] is plain values: rays, a [`Field`], [`Matter`], what is asked of each ray.
//! [`render`] walks each ray through the cells of the field ([`field`]), in which a trilinear scalar is a cubic of the
//! distance; each cubic is split where it turns and where it meets a knot of the transfer function ([`pieces`]), so
//! that what is left is smooth, and there adaptive collocation integrates emission and absorption ([`integral`]).
//! Nothing is sampled: the result depends on no step. Every pixel carries the bound of its own error.
//!
//! Distances along rays are world units from the ray's origin; scalars are data units.

pub mod background;
pub mod field;
pub mod integral;
pub mod matter;
pub mod pieces;
pub mod rays;
mod render;
pub mod scene;
mod volume_rendering;

pub use background::Background;
pub use field::Field;
pub use matter::Matter;
pub use rays::{Ray, Rays};
pub use render::{Progress, ReferenceError, Rendered, Silent, render};
pub use scene::{Scene, Technique};

/// The absolute tolerance of colours that is asked for where nothing else is said.
pub const DEFAULT_TOLERANCE: f64 = 1e-8;
