// Where the tables of a transfer function start and end.

struct Transfer {
    // Texture coordinate of a scalar's entry: scalar * entry_scale + entry_bias.
    entry_scale: f32,
    entry_bias: f32,
    entries: f32,
    // Entry of the pre-integrated table: (scalar - low) * preintegration_per_scalar, up to the last one.
    low: f32,
    preintegration_per_scalar: f32,
    preintegration_last: f32,
    // Entry of the table of refractive indices: (scalar - low) * refraction_per_scalar, up to the last one.
    refraction_per_scalar: f32,
    refraction_last: f32,
    // The scalars between which the index changes.
    refraction_from: f32,
    refraction_to: f32,
    // Tables hold extinction per reference length; this makes it powers of two per world unit, for exp2.
    halvings_per_world: f32,
    // World length of the segments that the pre-integrated table is made for.
    preintegration_length: f32,
    // The same of the pre-integrated table of half segments.
    half_per_scalar: f32,
    half_last: f32,
    half_length: f32,
    // Entry of the table of integrals: (scalar - low) * integral_per_scalar, up to the last one.
    integral_per_scalar: f32,
    integral_last: f32,
    // Between these are all of its colours.
    color_least: vec3f,
    color_most: vec3f,
}
