// How much of each light reaches the points of a grid: one walk for each point and light, written slice by slice.
#import "lib/light_grid.wgsl"
#import slot "light_places"
#import "lib/shadow_through.wgsl"
#import slot "eye_light"

@group(3) @binding(23) var light_out: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8, 1)
fn light_volume_compute(@builtin(global_invocation_id) id: vec3u) {
    let tile = id.xy / light_grid.dims.xy;
    let slice = tile.y * light_grid.columns + tile.x;
    if tile.x >= light_grid.columns || slice >= light_grid.dims.z {
        return;
    }
    let point = vec3u(id.xy - tile * light_grid.dims.xy, slice);
    let world = (light_grid.world_from_point * vec4f(vec3f(point), 1.0)).xyz;
    let eye = eye_light_towards(world);
    labels_select(STRETCH_NO_LABEL);
    var reaches = vec4f(1.0);
    for (var index = 0u; index < min(params.lights, 4u); index++) {
        let light = lights_at(index, world, eye.xyz);
        let reach = select(light.distance, eye.w, lights_is_at_eye(index));
        let through = shadow_through(shadow_ray(world, light.direction, reach));
        labels_select(STRETCH_NO_LABEL);
        reaches = select(reaches, vec4f(through), vec4u(0u, 1u, 2u, 3u) == vec4u(index));
    }
    textureStore(light_out, vec2i(id.xy), reaches);
}
