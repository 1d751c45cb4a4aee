// The gradient at a point: from the volume of gradients that the `gradient` node makes once.
#import "lib/volume.wgsl"
#import "lib/gradient_texture.wgsl"
#import slot "gradient_storage"

// World-space gradient, data units per world unit.
fn gradient_at(position: vec3f) -> vec3f {
    let stored = textureSampleLevel(gradient_volume, linear_sampler, position, 0.0);
    let per_index = gradient_decode(stored) * volume.value_range;
    return volume.world_from_index_gradient * per_index;
}
