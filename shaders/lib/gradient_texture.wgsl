// The volume of gradients that the `gradient` node makes, as the slot `gradient_storage` says.

@group(1) @binding(4) var gradient_volume: texture_3d<f32>;
