// The sampler that goes on with the other edge.

@group(2) @binding(4) var repeat_sampler: sampler;
