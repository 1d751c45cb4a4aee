// A stretch of a ray that runs through one label.
#import "lib/ray.wgsl"

struct Stretch {
    // World distance from the ray's entry to where the label changes, at most to where the ray ends.
    end: f32,
    label: u32,
    // World normal, towards the eye, of the boundary at its end; zeros where the ray ends there.
    normal: vec3f,
}
