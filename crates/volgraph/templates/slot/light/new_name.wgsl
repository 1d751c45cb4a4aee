// How a point is lit: surfaces that face the eye keep their colour, and turn bright where they turn away from it.
//
// A light gives the premultiplied colour that a classified segment sends to the eye.
#import "lib/classified.wgsl"
#import "lib/surface_point.wgsl"
#import "lib/volume.wgsl"
#import slot "gradient"

struct Params {
    /// Strength of the rim. @default 0.8 @range 0 10
    rim: f32,
    /// Sharpness of the rim. @default 2 @range 0.1 32
    sharpness: f32,
}

// How much brighter a point is. The gradient is in data units per world unit; its direction is the normal of the
// surface, and where it has no length there is no surface.
fn new_name_rim(position: vec3f, ray: Ray) -> f32 {
    let gradient = gradient_at(position);
    let magnitude = length(gradient);
    let facing = abs(dot(gradient, ray.direction)) / max(magnitude, 1.0e-20);
    let rim = params.rim * pow(1.0 - min(facing, 1.0), params.sharpness);
    // Flat is what changes by less than one part in 10^4 of the data's range per voxel.
    let is_flat = magnitude * volume.voxel < 1.0e-4 * volume.value_range;
    return 1.0 + select(rim, 0.0, is_flat);
}

// Of a segment of a volume: its linear premultiplied colour towards the eye.
fn light_segment(classified: Classified, segment: Segment, ray: Ray) -> vec3f {
    return classified.color * new_name_rim(segment_centre(ray, segment), ray);
}

// Of an opaque surface, for techniques that draw one: its linear colour towards the eye.
fn light_surface(color: vec3f, point: SurfacePoint, ray: Ray) -> vec3f {
    return color * new_name_rim(point.position, ray);
}
