// The frame: the lens (projection and picture size, the same for all poses) and the pose of the camera.

struct Lens {
    // Width and height of the whole picture in pixels.
    size: vec2f,
    // What is drawn may be a window of it: its first pixel, and its width and height, which textures have.
    corner: vec2f,
    extent: vec2f,
    // From clip coordinates of the whole picture to those of the window.
    clip_scale: vec2f,
    clip_shift: vec2f,
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

// From a pixel position of what is drawn (pixel centres at .5, y down) to the view plane: -1..1 over the height of the
// whole picture, y up; x likewise, so that squares stay square.
fn frame_view_plane(pixel: vec2f) -> vec2f {
    let centred = (pixel + lens.corner) * 2.0 - lens.size;
    return vec2f(centred.x, -centred.y) / lens.size.y;
}

// Clip coordinates of a world point. Depth is constant: there is no depth buffer, and nothing is cut at a far plane.
fn frame_clip_from_world(world: vec3f) -> vec4f {
    let from_anchor = world - camera.anchor;
    let x = dot(from_anchor, camera.right) / lens.half_extent.x;
    let y = dot(from_anchor, camera.up) / lens.half_extent.y;
    let w = select(camera.skipped + dot(from_anchor, camera.forward), 1.0, lens.is_orthographic != 0u);
    let in_window = vec2f(x, y) * lens.clip_scale + w * lens.clip_shift;
    return vec4f(in_window, 0.5 * w, w);
}
