// How much the trilinear field may change along a ray: its slope along an axis is a mean of differences of voxels beside
// each other, of which the largest is known.
#import "lib/volume.wgsl"

struct Steepness {
    // The largest difference of two voxels beside each other along each axis, in the units of scalars.
    per_voxel: vec3f,
    // The largest error of a sample.
    error: f32,
}

@group(1) @binding(35) var<uniform> steepness: Steepness;

// By how much the field changes within a segment at most, in whatever order it rises and falls.
fn steepness_within(ray: Ray, segment: Segment) -> f32 {
    return dot(steepness.per_voxel, abs(ray.slope * volume.dims)) * segment.length;
}
