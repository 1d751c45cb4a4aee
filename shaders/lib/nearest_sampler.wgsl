// Reads the nearest texel; beyond a texture's edges those at its edges. A load would be checked against the texture's size
// each time.

@group(2) @binding(5) var nearest_sampler: sampler;
