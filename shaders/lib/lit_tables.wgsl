// Tables for lit segments: where they start and end, and lookups.
#import "lib/classified.wgsl"
#import "lib/transfer.wgsl"
#import slot "table_filter"

struct LitTables {
    // Texture coordinate of a scalar's entry in the material's table: scalar * entry_scale + entry_bias.
    entry_scale: f32,
    entry_bias: f32,
    // Entry of a table over segments: (scalar - low) * x, up to y. The segments that it is made for are z long.
    low: f32,
    material: vec3f,
    moments: vec3f,
}

@group(2) @binding(20) var<uniform> lit_tables: LitTables;
@group(2) @binding(21) var material_table: texture_2d<f32>;
@group(2) @binding(22) var material_preintegration_table: texture_2d<f32>;
@group(2) @binding(23) var material_moments_table: texture_2d<f32>;
@group(2) @binding(24) var emission_moments_table: texture_2d<f32>;

// Ambient, diffuse, specular and shininess at a scalar.
fn lit_tables_material(scalar: f32) -> vec4f {
    // Clamped here: see `transfer_coordinate`.
    let place = clamp(scalar * lit_tables.entry_scale + lit_tables.entry_bias, 0.0, 1.0);
    return textureSampleLevel(material_table, nearest_sampler, vec2f(place, 0.5), 0.0);
}

// Ambient colour and highlight of a segment (0), or its diffuse colour and the highlight times its shininess (1).
fn lit_tables_segment(segment: Segment, table: u32) -> vec4f {
    let ends = vec2f(segment.front.scalar, segment.back.scalar);
    let place = (ends - lit_tables.low) * lit_tables.material.x;
    let last = lit_tables.material.y;
    return between_entries(material_preintegration_table, place, last, vec2i(0, i32(table) * (i32(last) + 1)));
}

// The share of the back end's light in a segment's diffuse colour and in its highlight.
fn lit_tables_material_moments(segment: Segment) -> vec4f {
    let ends = vec2f(segment.front.scalar, segment.back.scalar);
    return between_entries(material_moments_table, (ends - lit_tables.low) * lit_tables.moments.x, lit_tables.moments.y, vec2i(0));
}

// The share of the back end in what a segment emits, and in its opacity.
fn lit_tables_emission_moments(segment: Segment) -> vec4f {
    let ends = vec2f(segment.front.scalar, segment.back.scalar);
    return between_entries(emission_moments_table, (ends - lit_tables.low) * lit_tables.moments.x, lit_tables.moments.y, vec2i(0));
}

// What a segment makes of light, of what a whole one of a table's length makes: both are seen through their own depth.
// Its depth is known by the transmittance that classification found.
fn lit_tables_part(classified: Classified, segment: Segment, table_length: f32) -> f32 {
    let part = segment.length / table_length;
    if abs(part - 1.0) < 1.0e-4 {
        return 1.0;
    }
    let whole_opacity = 1.0 - pow(max(classified.transmittance, 1.0e-30), 1.0 / part);
    let opacity = 1.0 - classified.transmittance;
    return select(part, opacity / max(whole_opacity, 1.0e-4), whole_opacity > 1.0e-4);
}
