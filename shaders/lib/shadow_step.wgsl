// The step of rays towards lights.

struct Params {
    /// Length of a segment of a ray towards a light, in voxels of the smallest spacing.
    /// @default 1.0 @range 0.05 64.0 @unit voxel
    shadow_step: f32,
}
