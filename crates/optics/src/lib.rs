//! Optics: what a scalar looks like.
//!
//! The way of the data: a RON text ([`mod@file`] has the grammar) becomes a [`TransferFunction`], which gives linear
//! RGB and extinction for any scalar in float64; from it come the [`PostTable`] (one scalar in) and the
//! [`PreintegratedTable`] (the scalars at a segment's two ends in; with its length in too, the [`PreintegratedTable3d`]),
//! all in the `vec4<f32>` layout that a shader's texture or buffer takes; and the [`IntegralTable`], whose differences are
//! means between two scalars. What a scalar makes of light ([`Material`]) has such tables of its own
//! ([`PreintegratedMaterial`]), and so has the place in a segment that its light comes from
//! ([`PreintegratedMoments`]).
//!
//! The optical model is emission and absorption: along a ray of length parameter `t`,
//! `C = ∫ c(s(t)) τ(s(t)) exp(-∫₀ᵗ τ) dt` (Max, "Optical models for direct volume rendering", 1995), with the
//! colour `c` in linear RGB and the extinction `τ` per reference length. An authored opacity `α` is what one
//! reference length of the material hides: `τ = -ln(1 - α)`, and at most [`MAX_EXTINCTION_FROM_OPACITY`].

mod color;
mod color_map;
mod control_points;
mod curve;
pub mod file;
mod material;
mod post;
mod preintegrated;
mod transfer;

pub use color_map::color_map_names;
pub use control_points::ControlPoint;
pub use material::Material;
pub use post::PostTable;
pub use preintegrated::{
    IntegralTable, PreintegratedMaterial, PreintegratedMoments, PreintegratedTable,
    PreintegratedTable3d, PreintegrationPiece, PreintegrationPieces,
};
pub use transfer::{
    Domain, MAX_EXTINCTION_FROM_OPACITY, ReferenceLength, Smooth, SmoothMaterial, TransferFunction,
    extinction_from_opacity, opacity_from_extinction, union,
};

/// What can be wrong with a request for a table.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum OpticsError {
    /// A table of this many entries a side would be too coarse to be right, or too large to hold.
    #[error("a {table} table of {asked} entries a side is refused; ask for {min} to {max}")]
    TableSize {
        /// Which table.
        table: &'static str,
        /// The number asked for.
        asked: u32,
        /// The smallest allowed.
        min: u32,
        /// The largest allowed.
        max: u32,
    },
    /// A table of this many layers, one for each of several lengths.
    #[error("a pre-integrated table of {asked} layers is refused; ask for {min} to {max}")]
    Layers {
        /// The number asked for.
        asked: u32,
        /// The smallest allowed.
        min: u32,
        /// The largest allowed.
        max: u32,
    },
    /// The length of a segment is not a finite number above 0.
    #[error("a segment of {0} reference lengths is refused; ask for a finite length above 0")]
    SegmentLength(f64),
}
