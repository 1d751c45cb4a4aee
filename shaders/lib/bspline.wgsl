// The cubic B-spline over the voxels, smooth up to its second derivative, from trilinear samples between voxels (Sigg and
// Hadwiger 2005, "Fast third-order texture filtering"). Voxels beside the grid repeat those at its edge.
#import "lib/volume.wgsl"

// Two linear samples along each axis that stand for four voxels.
struct Bspline {
    // Texture coordinates of the sample between the two lower voxels, and between the two higher ones.
    low: vec3f,
    high: vec3f,
    // Their weights.
    low_weight: vec3f,
    high_weight: vec3f,
}

// Texture coordinates of the voxel centre at or below a position, and the rest in voxels (0 to 1).
struct BsplinePlace {
    centre: vec3f,
    part: vec3f,
}

fn bspline_place(position: vec3f) -> BsplinePlace {
    let place = position * volume.dims - 0.5;
    let low = floor(place);
    return BsplinePlace(low + 0.5, place - low);
}

fn bspline_between(place: BsplinePlace, w0: vec3f, w1: vec3f, w2: vec3f, w3: vec3f) -> Bspline {
    let low_weight = w0 + w1;
    let high_weight = w2 + w3;
    // The weights of a pair have one sign, so each sample lies between its two voxels.
    let low = (place.centre - 1.0 + w1 / low_weight) / volume.dims;
    let high = (place.centre + 1.0 + w3 / high_weight) / volume.dims;
    return Bspline(low, high, low_weight, high_weight);
}

// For the value: the weights add up to 1.
fn bspline_value(place: BsplinePlace) -> Bspline {
    let t = place.part;
    let s = 1.0 - t;
    let w0 = s * s * s / 6.0;
    let w1 = (4.0 - 6.0 * t * t + 3.0 * t * t * t) / 6.0;
    let w2 = (4.0 - 6.0 * s * s + 3.0 * s * s * s) / 6.0;
    let w3 = t * t * t / 6.0;
    return bspline_between(place, w0, w1, w2, w3);
}

// For the derivative per voxel: the weights add up to 0.
fn bspline_derivative(place: BsplinePlace) -> Bspline {
    let t = place.part;
    let s = 1.0 - t;
    return bspline_between(place, -0.5 * s * s, 0.5 * t * (3.0 * t - 4.0), -0.5 * s * (3.0 * s - 4.0), 0.5 * t * t);
}

// The sum of eight samples, each axis with its own pair.
fn bspline_sum(x: Bspline, y: Bspline, z: Bspline) -> f32 {
    return z.low_weight.z * bspline_plane(x, y, z.low.z) + z.high_weight.z * bspline_plane(x, y, z.high.z);
}

fn bspline_plane(x: Bspline, y: Bspline, z: f32) -> f32 {
    return y.low_weight.y * bspline_line(x, y.low.y, z) + y.high_weight.y * bspline_line(x, y.high.y, z);
}

fn bspline_line(x: Bspline, y: f32, z: f32) -> f32 {
    let low = volume_linear(vec3f(x.low.x, y, z));
    let high = volume_linear(vec3f(x.high.x, y, z));
    return x.low_weight.x * low + x.high_weight.x * high;
}
