// The gradient at a voxel: central differences of its six neighbours.
#import "lib/volume.wgsl"

// Data units per voxel along the index axes.
fn gradient_estimate(index: vec3i) -> vec3f {
    return 0.5 * vec3f(
        volume_voxel(index + vec3i(1, 0, 0)) - volume_voxel(index - vec3i(1, 0, 0)),
        volume_voxel(index + vec3i(0, 1, 0)) - volume_voxel(index - vec3i(0, 1, 0)),
        volume_voxel(index + vec3i(0, 0, 1)) - volume_voxel(index - vec3i(0, 0, 1)),
    );
}
