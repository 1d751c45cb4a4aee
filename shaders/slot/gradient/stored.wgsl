// The gradient at a point: from the volume of gradients that the `gradient` node makes once.
#import "lib/gradient_texture.wgsl"
#import "lib/volume.wgsl"
#import slot "gradient_storage"

// World-space gradient, data units per world unit.
fn gradient_at(position: vec3f) -> vec3f {
    let stored = textureSampleLevel(gradient_volume, linear_sampler, position, 0.0);
    // What holds for all samples comes first.
    return (volume.world_from_index_gradient * volume.value_range) * gradient_decode(stored);
}
