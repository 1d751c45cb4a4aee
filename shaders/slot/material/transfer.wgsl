// What a point makes of light: what the transfer function says of its scalar, in a segment of the mean of both ends.
// Where the transfer function does not say, the parameters do. Right where materials change slowly over a segment.
#import "lib/lit_tables.wgsl"
#import "lib/material_params.wgsl"

fn material_segment(classified: Classified, segment: Segment, ray: Ray) -> Material {
    let made = lit_tables_material(0.5 * (segment.front.scalar + segment.back.scalar));
    let opacity = 1.0 - classified.transmittance;
    return Material(classified.color * made.x, classified.color * made.y, made.z * opacity, made.w);
}

// How much of it is seen in the light at the back end.
fn material_back(material: Material, classified: Classified, segment: Segment) -> MaterialBack {
    let made = lit_tables_material(0.5 * (segment.front.scalar + segment.back.scalar));
    let back = lit_tables_part(classified, segment, lit_tables.moments.z) * lit_tables_emission_moments(segment);
    return MaterialBack(min(back.xyz * made.y, material.diffuse), min(back.w * made.z, material.specular));
}

// Of an opaque surface of a linear colour, where the field has the given scalar.
fn material_surface(color: vec3f, scalar: f32) -> Material {
    let made = lit_tables_material(scalar);
    return Material(color * made.x, color * made.y, made.z, made.w);
}
