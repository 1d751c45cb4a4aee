// What a point makes of light: what the transfer function says of each scalar of a segment, integrated together with
// colour and extinction, from a table (Röttger et al. 2003). For `classify: preintegrated_2d`; matt and shiny layers
// thinner than a step keep their own light. Where the transfer function does not say, the parameters do.
#import "lib/lit_tables.wgsl"
#import "lib/material_params.wgsl"

fn material_segment(classified: Classified, segment: Segment, ray: Ray) -> Material {
    let part = lit_tables_part(classified, segment, lit_tables.material.z);
    let ambient = lit_tables_segment(segment, 0u);
    let diffuse = lit_tables_segment(segment, 1u);
    // The mean sharpness of the highlights in the segment, by their strength.
    let shininess = select(params.shininess, diffuse.w / max(ambient.w, 1.0e-12), ambient.w > 1.0e-12);
    return Material(part * ambient.xyz, part * diffuse.xyz, part * ambient.w, shininess);
}

// How much of it is seen in the light at the back end.
fn material_back(material: Material, classified: Classified, segment: Segment) -> MaterialBack {
    let back = lit_tables_part(classified, segment, lit_tables.moments.z) * lit_tables_material_moments(segment);
    return MaterialBack(min(back.xyz, material.diffuse), min(back.w, material.specular));
}

// Of an opaque surface of a linear colour, where the field has the given scalar.
fn material_surface(color: vec3f, scalar: f32) -> Material {
    let made = lit_tables_material(scalar);
    return Material(color * made.x, color * made.y, made.z, made.w);
}
