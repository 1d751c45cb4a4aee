// What rays see that leave the volume in any direction: the background on two planes across the view, one behind the
// volume and one as far in front of it. A ray that is not bent meets the plane behind at its own pixel's place, so there
// is no seam between straight rays and bent ones.
#import "lib/volume.wgsl"
#import slot "beyond"

struct Params {
    /// Where bent rays meet what is behind: on a plane across the view so far behind the volume's middle, and, where they
    /// go back towards the eye, on one so far in front of it. In radii of the volume's box. @default 2 @range 1 1000
    background_distance: f32,
}

// Linear premultiplied colour that a ray sees which leaves a world position, in the volume, in a unit direction.
fn beyond_color(world: vec3f, direction: vec3f) -> vec4f {
    return beyond_at(beyond_place(world, direction));
}

// Where that ray meets the planes, in the view plane: -1..1 over the height, y up. The plane in front shows what the
// plane behind shows at the same distance from the view's axis.
fn beyond_place(world: vec3f, direction: vec3f) -> vec2f {
    let middle = dot(volume.centre - camera.eye, camera.forward);
    let reach = params.background_distance * volume.radius;
    // The plane is not behind the eye, as long as any of the volume is before it.
    let behind_depth = max(middle + reach, 1.0e-3 * volume.radius);
    let along = dot(direction, camera.forward);
    let is_back = along < 0.0;
    let depth = select(behind_depth, middle - reach, is_back);
    // A ray along the planes meets them far away, but not at infinity.
    let speed = select(max(along, 1.0e-4), min(along, -1.0e-4), is_back);
    let from_eye = world - camera.eye;
    let met = from_eye + (depth - dot(from_eye, camera.forward)) / speed * direction;
    let scale = select(behind_depth, 1.0, lens.is_orthographic != 0u) * lens.half_extent.y;
    return vec2f(dot(met, camera.right), dot(met, camera.up)) / scale;
}
