// Colour and opacity of a segment: the integral of the transfer function over a scalar that runs linearly from front to
// back, for segments of any length (Röttger, Kraus and Ertl 2000). Order 2 in the step, for any transfer function; the
// short last segment of a ray, and steps that change, are as right as whole ones. Costs twice the lookups there.
// @order 2
#import "lib/classified.wgsl"
#import "lib/transfer.wgsl"

struct Preintegration3d {
    // Entry of a scalar: (scalar - low) * entries_per_scalar, up to the last one.
    low: f32,
    entries_per_scalar: f32,
    last_entry: f32,
    // Layer of a length: its root, as a share of that of the longest, times the last layer.
    last_layer: f32,
    // World length of the longest segment that the table is made for. Longer ones are as deep as they are, with its
    // mean colour.
    longest: f32,
}

@group(2) @binding(40) var<uniform> preintegration_3d: Preintegration3d;
@group(2) @binding(41) var preintegration_3d_table: texture_3d<f32>;

// Bilinear in a layer: mean colour, and extinction per reference length.
fn preintegrated_3d_layer(low: vec2f, part: vec2f, layer: f32) -> vec4f {
    let at = vec3i(vec3f(low, layer));
    let right = vec3i(1, 0, 0);
    let up = vec3i(0, 1, 0);
    let near = mix(textureLoad(preintegration_3d_table, at, 0), textureLoad(preintegration_3d_table, at + right, 0), part.x);
    let far = mix(textureLoad(preintegration_3d_table, at + up, 0), textureLoad(preintegration_3d_table, at + up + right, 0), part.x);
    return mix(near, far, part.y);
}

// A segment within the table, from entry to entry, of a world length.
fn preintegrated_3d_between(inside: vec2f, length: f32) -> Classified {
    let table = preintegration_3d;
    let low = min(floor(inside), vec2f(table.last_entry - 1.0));
    let part = inside - low;
    let place = sqrt(clamp(length / table.longest, 0.0, 1.0)) * table.last_layer;
    let layer = min(floor(place), table.last_layer - 1.0);
    var entry = preintegrated_3d_layer(low, part, layer + 1.0);
    // Whole segments are at a layer, but for rounding.
    if place - layer < 0.9999 {
        entry = mix(preintegrated_3d_layer(low, part, layer), entry, place - layer);
    }
    let transmittance = exp2(-entry.w * (length * transfer.halvings_per_world));
    return Classified(entry.xyz * (1.0 - transmittance), transmittance);
}

fn classify_segment(ray: Ray, segment: Segment) -> Classified {
    let table = preintegration_3d;
    let ends = (vec2f(segment.front.scalar, segment.back.scalar) - table.low) * table.entries_per_scalar;
    let inside = clamp(ends, vec2f(0.0), vec2f(table.last_entry));
    if !transfer_reach_is_short() || all(inside == ends) {
        return preintegrated_3d_between(inside, segment.length);
    }
    let lengths = transfer_shares(ends, table.last_entry) * segment.length;
    let before = preintegrated_3d_between(inside.xx, lengths.x);
    let behind = preintegrated_3d_between(inside.yy, lengths.z);
    return classified_behind(classified_behind(before, preintegrated_3d_between(inside, lengths.y)), behind);
}
