// The scalar at a point: between trilinear and nearest, as sharp as is asked for.
//
// A reconstruction gives the scalar in data units at a position in texture coordinates, 0 to 1 over the volume.
#import "lib/volume.wgsl"

struct Params {
    /// 0 is trilinear, 1 nearly a step from voxel to voxel. @default 0.5 @range 0 1
    sharpness: f32,
}

// Voxel centres lie at half-integer places; between two of them the share of the farther one is bent to an S.
fn reconstruct_scalar(position: vec3f) -> f32 {
    let place = position * volume.dims - 0.5;
    let low = floor(place);
    let part = place - low;
    let bent = smoothstep(vec3f(0.0), vec3f(1.0), part);
    let sharp = smoothstep(vec3f(0.0), vec3f(1.0), bent);
    return volume_linear((low + mix(part, sharp, params.sharpness) + 0.5) / volume.dims);
}
