// The scalar at a point: of the cubic that passes through the voxels with central differences as its slopes (Catmull and
// Rom 1974). It keeps detail, is exact for polynomials of degree 2 along each axis, and may overshoot the data's range at
// edges. Voxels beside the grid repeat those at its edge. 64 voxels, loaded with full precision.
#import "lib/volume.wgsl"

fn reconstruct_scalar(position: vec3f) -> f32 {
    let place = position * volume.dims - 0.5;
    let low = floor(place);
    let part = place - low;
    let x = catmull_rom_weights(part.x);
    let y = catmull_rom_weights(part.y);
    let z = catmull_rom_weights(part.z);
    let first = vec3i(low) - 1;
    var sum = 0.0;
    for (var k = 0; k < 4; k++) {
        var plane = 0.0;
        for (var j = 0; j < 4; j++) {
            let at = first + vec3i(0, j, k);
            let line = vec4f(
                volume_voxel(at),
                volume_voxel(at + vec3i(1, 0, 0)),
                volume_voxel(at + vec3i(2, 0, 0)),
                volume_voxel(at + vec3i(3, 0, 0)),
            );
            plane += y[j] * dot(x, line);
        }
        sum += z[k] * plane;
    }
    return sum;
}

// Of the four voxels around a place, 0 to 1 between the two in the middle.
fn catmull_rom_weights(t: f32) -> vec4f {
    let s = 1.0 - t;
    return 0.5 * vec4f(
        -t * s * s,
        2.0 - t * t * (5.0 - 3.0 * t),
        2.0 - s * s * (5.0 - 3.0 * s),
        -s * t * t,
    );
}
