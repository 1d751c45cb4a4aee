//! What several cases look through.

use glam::DVec3;
use volgraph_reference::Rays;

/// Parallel rays along z through the middle of a voxel's face, beside each other.
pub fn rays_along_z(size: [u32; 2]) -> Rays {
    Rays {
        eye: DVec3::new(0.5, 0.5, -9.0),
        right: DVec3::X,
        up: DVec3::Y,
        forward: DVec3::Z,
        half_extent: [0.4; 2],
        is_orthographic: true,
        size,
    }
}
