// The gradient at a point: from the volume of gradients that the `gradient` node makes once.
#import "lib/volume.wgsl"
#import slot "gradient_storage"

@group(1) @binding(4) var gradient_volume: texture_3d<f32>;

// World-space gradient, data units per world unit.
fn gradient_at(position: vec3f) -> vec3f {
    let stored = textureSampleLevel(gradient_volume, linear_sampler, position, 0.0);
    let per_index = gradient_decode(stored) * volume.value_range;
    return volume.world_from_index_gradient * per_index;
}
