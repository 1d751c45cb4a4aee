// The frame: the lens (projection and picture size, the same for all poses) and the pose of the camera.

struct Lens {
    // Width and height in pixels.
    size: vec2f,
    // Half the width and height of the view: at distance 1 in perspective, in world units otherwise.
    half_extent: vec2f,
    // 1 where rays are parallel.
    is_orthographic: u32,
}

// World space, counted from the middle of all volumes, so that f32 has digits left for them far from the world's own
// origin; right, up and forward are orthonormal.
struct Camera {
    eye: vec3f,
    // Where the view's axis starts: the eye, or, where that is so far away that f32 has no digits left for both, a place
    // before the volumes; and the world distance to it from the eye.
    anchor: vec3f,
    skipped: f32,
    right: vec3f,
    up: vec3f,
    forward: vec3f,
}

@group(0) @binding(0) var<uniform> lens: Lens;
@group(0) @binding(1) var<uniform> camera: Camera;

// From a pixel position (pixel centres at .5, y down) to the view plane: -1..1 over the height, y up; x likewise,
// so that squares stay square.
fn frame_view_plane(pixel: vec2f) -> vec2f {
    let centred = pixel * 2.0 - lens.size;
    return vec2f(centred.x, -centred.y) / lens.size.y;
}

// Clip coordinates of a world point. Depth is constant: there is no depth buffer, and nothing is cut at a far plane.
fn frame_clip_from_world(world: vec3f) -> vec4f {
    let from_anchor = world - camera.anchor;
    let x = dot(from_anchor, camera.right) / lens.half_extent.x;
    let y = dot(from_anchor, camera.up) / lens.half_extent.y;
    let w = select(camera.skipped + dot(from_anchor, camera.forward), 1.0, lens.is_orthographic != 0u);
    return vec4f(x, y, 0.5 * w, w);
}
