// How much of a light reaches a point: as `transmittance` says, from a grid that the `light_volume` node makes once.
// Trilinear between the grid's points; soft where it is coarse. Of the volume alone: isosurfaces cast no shadow here.
#import "lib/light_grid.wgsl"
#import "lib/lights.wgsl"
#import "lib/shadow_step.wgsl"
#import "lib/volume.wgsl"

@group(3) @binding(22) var light_volume: texture_2d<f32>;

// The four lights in a slice. Bilinear from the middle of texel to middle: the next slice has no weight but that of a
// coordinate's rounding, 2.5e-4 in the largest atlas and below the half floats' own.
fn shadow_slice(slice: u32, place: vec2f) -> vec4f {
    let texel = vec2f(light_grid_corner(slice)) + place + 0.5;
    return textureSampleLevel(light_volume, linear_sampler, texel / vec2f(textureDimensions(light_volume)), 0.0);
}

// The share of a light, by its number, that reaches a world position. `normal` is the unit world normal of the surface
// that the position is on, zeros inside of a volume.
fn shadow_transmittance(world: vec3f, normal: vec3f, light: Light, index: u32) -> vec3f {
    let position = (volume.texture_from_world * vec4f(world, 1.0)).xyz;
    let share = clamp((position - volume.box_low) / (volume.box_high - volume.box_low), vec3f(0.0), vec3f(1.0));
    let place = share * vec3f(light_grid.dims - 1u);
    let slice = min(u32(place.z), light_grid.dims.z - 2u);
    let reaches = mix(shadow_slice(slice, place.xy), shadow_slice(slice + 1u, place.xy), place.z - f32(slice));
    return vec3f(reaches[index]);
}
