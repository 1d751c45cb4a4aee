//! Renderers for the processor that are fast: float32, eight rays at a time, all cores. No graphics library is needed.
//!
//! The way of the data: a [`VoxelGrid`] holds a volume's voxels as samples want them, [`Tables`] a transfer function over
//! its scalars, and a [`DistanceMap`] says of which bricks nothing is seen. All three stay while the camera moves.
//! [`Raycast::render`] walks the rays of a picture through them in packets of eight neighbours ([`lanes`]), tile by tile
//! on all cores ([`Projection`] and [`Isosurface`] go from cell to cell instead, where a [`RangeMap`] says that it matters);
//! no ray's colour depends on how many cores there are, on its neighbours, or on the machine's instructions.
//!
//! Conventions are those of `node/raycast.wgsl`: whole steps from the entry into the box, the last one shorter; the outer
//! half voxel is clamped. Distances along rays are world units; positions are index coordinates (voxel centres at whole
//! numbers); raw scalars are data values minus an offset of the grid.

mod ahead;
mod cells;
mod classify;
pub mod empty;
pub mod grid;
pub mod isosurface;
pub mod lanes;
mod packet;
pub mod projection;
pub mod ranges;
pub mod raycast;
mod scout;
pub mod shear_warp;
mod shine;
pub mod tables;
mod tiles;
mod walk;

pub use empty::DistanceMap;
pub use grid::VoxelGrid;
pub use isosurface::{Isosurface, Refinement};
pub use projection::{Extremum, Projection};
pub use ranges::RangeMap;
pub use raycast::Raycast;
pub use shear_warp::ShearWarp;
pub use tables::{Attenuation, Classify, Tables, Units};

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
pub enum SoftwareError {
    /// Places of voxels are 32-bit numbers.
    #[error(
        "a volume of {}×{}×{} voxels is too large for the software renderers, which number voxels in 31 bits: take a coarser or a smaller part of it",
        .dims[0], .dims[1], .dims[2]
    )]
    TooLarge {
        /// Voxels along each axis.
        dims: [u32; 3],
    },
}
