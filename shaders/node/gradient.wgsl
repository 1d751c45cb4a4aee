// A volume of gradients, one per voxel, made once.
#import "lib/volume.wgsl"
#import slot "gradient_method"
#import slot "gradient_storage"

@compute @workgroup_size(8, 8, 1)
fn gradient_compute(@builtin(global_invocation_id) id: vec3u) {
    if any(id >= vec3u(volume.dims)) {
        return;
    }
    let per_index = gradient_estimate(vec3i(id)) / max(volume.value_range, 1.0e-30);
    textureStore(gradient_out, id, gradient_encode(per_index, volumes_load(vec3i(id))));
}
