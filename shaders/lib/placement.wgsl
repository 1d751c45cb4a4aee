// Where a volume is, and how its texels become scalars in data units.

struct Volume {
    // Texture coordinates (0..1 over whole voxels) from world positions.
    texture_from_world: mat4x4f,
    // World gradients from gradients per voxel along the index axes.
    world_from_index_gradient: mat3x3f,
    // Voxels along each axis.
    dims: vec3f,
    // The box in texture coordinates: 0..1, or voxel centre to voxel centre for a node-centred grid.
    box_low: vec3f,
    box_high: vec3f,
    // World position of the box's middle, and half of its smallest side.
    centre: vec3f,
    half_side: f32,
    // World distance from the middle to a corner.
    radius: f32,
    // Where the world's own origin is: shaders count from the middle of all volumes.
    world_origin: vec3f,
    // World length of the smallest spacing.
    voxel: f32,
    // scalar = texel * value_scale + value_offset: data units, from the smallest value for data far from 0
    value_scale: f32,
    value_offset: f32,
    // The data value that is 0 in shaders.
    value_reference: f32,
    // The smallest scalar of the data, and the largest minus that.
    value_low: f32,
    value_range: f32,
    // What 0 of a normalised scalar stands for, and what 1 is more than that, in the units of scalars: the range of
    // the stored type; of the data where it is stored in floats.
    normalised_low: f32,
    normalised_span: f32,
}
