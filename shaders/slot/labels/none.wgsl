// What the volume is made of: one thing.
#import "lib/stretch.wgsl"

// The stretch of one label at the ray's entry, up to a world distance from it at most.
fn labels_next(ray: Ray, end: f32) -> Stretch {
    return Stretch(end, 0u, vec3f(0.0));
}

// Makes the parameters those of a label.
fn labels_select(label: u32) {
}

// The label at a position in texture coordinates.
fn labels_at(position: vec3f) -> u32 {
    return 0u;
}
