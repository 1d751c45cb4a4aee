// The refractive index of the transfer function, from its table.
#import "lib/transfer.wgsl"

@group(2) @binding(12) var refraction_table: texture_2d<f32>;

// Refractive index at a scalar, linear between the table's entries.
fn refraction_index(scalar: f32) -> f32 {
    let place = clamp((scalar - transfer.low) * transfer.refraction_per_scalar, 0.0, transfer.refraction_last);
    let low = min(floor(place), transfer.refraction_last - 1.0);
    let near = textureLoad(refraction_table, vec2i(i32(low), 0), 0).x;
    let far = textureLoad(refraction_table, vec2i(i32(low) + 1, 0), 0).x;
    // Exact where the two are equal, which `mix` need not be: then no ray bends.
    return near + (far - near) * (place - low);
}

// Change of the index per scalar, over the scalars up to `reach` to both sides. With half of the change over a step as
// the reach, the slopes of a ray's steps add up to the change of the index itself: no peak between two steps is lost.
fn refraction_slope(scalar: f32, reach: f32) -> f32 {
    // Below two entries the rounding of the entries shows.
    let used = max(reach, 2.0 / transfer.refraction_per_scalar);
    // Most of a volume bends nothing; then the table need not be read.
    if scalar + used < transfer.refraction_from || scalar - used > transfer.refraction_to {
        return 0.0;
    }
    return (refraction_index(scalar + used) - refraction_index(scalar - used)) / (2.0 * used);
}
