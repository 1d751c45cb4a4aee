// A stretch of a ray that runs through one label.
#import "lib/ray.wgsl"

// Stands for no label: what a node does wherever no label is walked through.
const STRETCH_NO_LABEL: u32 = 256u;

struct Stretch {
    // World distance from the ray's entry to where the label changes, at most to where the ray ends.
    end: f32,
    label: u32,
    // World normal, towards the eye, of the boundary at its end; zeros where the ray ends there.
    normal: vec3f,
}
