// What the volume is made of: one thing.
#import "lib/stretch.wgsl"

// The stretch of one label at the ray's entry, up to a world distance from it at most.
fn labels_next(ray: Ray, end: f32) -> Stretch {
    return Stretch(end, 0u, vec3f(0.0));
}

// Whether a label is drawn.
fn labels_is_visible(label: u32) -> bool {
    return true;
}

// Makes the parameters and the transfer function those of a label, or the node's own for STRETCH_NO_LABEL.
fn labels_select(label: u32) {
}

// The label that was selected last.
fn labels_selected() -> u32 {
    return STRETCH_NO_LABEL;
}

// The label at a position in texture coordinates.
fn labels_at(position: vec3f) -> u32 {
    return 0u;
}
