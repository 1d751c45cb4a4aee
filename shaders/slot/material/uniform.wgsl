// What a point makes of light: the same everywhere.
#import "lib/lit_tables.wgsl"
#import "lib/material_params.wgsl"

fn material_segment(classified: Classified, segment: Segment, ray: Ray) -> Material {
    let opacity = 1.0 - classified.transmittance;
    let color = classified.color;
    return Material(color * params.ambient, color * params.diffuse, params.specular * opacity, params.shininess);
}

// How much of it is seen in the light at the back end.
fn material_back(material: Material, classified: Classified, segment: Segment) -> MaterialBack {
    let part = lit_tables_part(classified, segment, lit_tables.moments.z);
    let back = part * lit_tables_emission_moments(segment);
    // However segments are classified, no more is seen in that light than there is.
    return MaterialBack(min(back.xyz * params.diffuse, material.diffuse), min(back.w * params.specular, material.specular));
}

// Of an opaque surface of a linear colour, where the field has the given scalar.
fn material_surface(color: vec3f, scalar: f32) -> Material {
    return Material(color * params.ambient, color * params.diffuse, params.specular, params.shininess);
}
