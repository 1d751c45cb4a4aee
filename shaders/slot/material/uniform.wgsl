// What a point makes of light: the same everywhere.
#import "lib/material.wgsl"

struct Params {
    /// Share of the colour that needs no light. @default 0.3 @range 0 1
    ambient: f32,
    /// Share of the colour that the light gives. @default 0.7 @range 0 1
    diffuse: f32,
    /// Strength of the highlight. @default 0.25 @range 0 1
    specular: f32,
}

fn material_segment(classified: Classified, segment: Segment, ray: Ray) -> Material {
    let opacity = 1.0 - classified.transmittance;
    return Material(classified.color * params.ambient, classified.color * params.diffuse, params.specular * opacity);
}

// Of an opaque surface of a linear colour, where the field has the given scalar.
fn material_surface(color: vec3f, scalar: f32) -> Material {
    return Material(color * params.ambient, color * params.diffuse, params.specular);
}
