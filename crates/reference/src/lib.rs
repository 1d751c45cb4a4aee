//! Ground truth: what a picture of a volume should be, in float64 and to a stated tolerance.
//!
//! The way of the data: a [`Scene`] is plain values: rays, a [`Field`], what a [`Clip`] leaves of it, [`Labels`] that say
//! which [`Look`] is where, what is asked of each ray. [`render`] cuts each ray into parts, each visible and of one label,
//! and walks each part through the cells of the field, in which the scalar is a polynomial of the distance ([`curve`]).
//! Of that extremes, integrals and crossings are closed forms or roots. For emission and absorption it is split where it
//! turns, where it meets a knot of the transfer function ([`pieces`]) and where light jumps, so that what is left is
//! smooth, and there adaptive collocation integrates ([`integral`]). Nothing is sampled: the result depends on no step.
//! Every pixel carries the bound of its own error.
//!
//! Distances along rays are world units from the ray's origin; scalars are data units.

pub mod background;
pub mod clip;
pub mod curve;
pub mod field;
pub mod gradient;
pub mod integral;
pub mod labels;
mod lit;
pub mod look;
pub mod matter;
pub mod pieces;
pub mod polynomial;
mod profile;
mod projection;
pub mod rays;
mod render;
pub mod scene;
mod shadow;
mod sight;
mod surface;
mod volume_rendering;

pub use background::Background;
pub use clip::{Clip, Shape};
pub use curve::Kernel;
pub use field::{Field, interval};
pub use gradient::Gradients;
pub use labels::Labels;
pub use look::{Lamp, Layer, Look, Place, Tone, Window};
pub use matter::{Materials, Matter};
pub use profile::{Profile, ProfilePoint, profile};
pub use rays::{Ray, Rays};
pub use render::{Progress, ReferenceError, Rendered, Silent, render, render_pixels};
pub use scene::{Scene, Shadow, Technique};

/// The absolute tolerance of colours that is asked for where nothing else is said.
pub const DEFAULT_TOLERANCE: f64 = 1e-8;
