// The gradient at a voxel: the 3D Sobel operator (weights 1 2 1 across, differences along), smoother on noise.
#import "lib/volume.wgsl"

// Data units per voxel along the index axes.
fn gradient_estimate(index: vec3i) -> vec3f {
    var sum = vec3f(0.0);
    for (var z = -1; z <= 1; z++) {
        for (var y = -1; y <= 1; y++) {
            for (var x = -1; x <= 1; x++) {
                let offset = vec3i(x, y, z);
                let smoothing = vec3f(2.0) - abs(vec3f(offset));
                let across = vec3f(smoothing.y * smoothing.z, smoothing.x * smoothing.z, smoothing.x * smoothing.y);
                sum += volume_voxel(index + offset) * vec3f(offset) * across;
            }
        }
    }
    // The weights of one side add up to 16, and the two sides are two voxels apart.
    return sum / 32.0;
}
