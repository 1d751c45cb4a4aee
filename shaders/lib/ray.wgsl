// Rays, samples and segments: what the walk hands to the slots.
#import "lib/frame.wgsl"

struct Ray {
    // The pixel position that it starts from, where it starts from one.
    pixel: vec2f,
    // World position of the eye (or of the pixel on the eye's plane), and the unit direction. From an eye that is very far
    // away, the place that is `skipped` world units before it.
    origin: vec3f,
    direction: vec3f,
    skipped: f32,
    // World distances from the origin where the ray enters and leaves the volume's box; empty where far <= near.
    near: f32,
    far: f32,
    // Texture coordinates of the entry, and their change per world unit along the ray.
    entry: vec3f,
    slope: vec3f,
    // World normal, towards the eye, of the cut that the ray enters through; zeros where it enters through no cut.
    cut_normal: vec3f,
    // Whether the ray only goes on where the part before it ended: there is no face at its entry.
    is_continued: bool,
    // What the part of the volume is that the ray runs through, by the `labels`; 0 where there are none.
    label: u32,
    // World distance from the origin where the cut, or the face of the box, is that ends what is visible here.
    visible_end: f32,
    // How often the ray has changed its direction.
    bends: u32,
}

// The scalar, in data units, at a position in texture coordinates.
struct Sample {
    position: vec3f,
    scalar: f32,
}

struct Segment {
    front: Sample,
    back: Sample,
    // World distance from the ray's entry to the segment's front, and the segment's length in world units.
    start: f32,
    length: f32,
    // The scalar at its middle, for whoever has it already.
    middle: f32,
    has_middle: bool,
    // Whether it is a step long, as the tables of segments are; where the walk knows when the shader is built.
    is_step: bool,
}

struct RayResult {
    // Linear premultiplied colour; alpha is the opacity of what the ray met.
    color: vec4f,
    // World distance from the ray's origin to what it shows.
    depth: f32,
}

// Stands for an infinite depth: WGSL has no infinity of its own.
const RAY_NO_DEPTH: f32 = 3.0e38;

fn ray_nothing() -> RayResult {
    return RayResult(vec4f(0.0), RAY_NO_DEPTH);
}

// The ray through a pixel position (pixel centres at .5, y down); its box is not known yet.
fn ray_through(pixel: vec2f) -> Ray {
    let plane = frame_view_plane(pixel) * lens.half_extent.y;
    let aside = plane.x * camera.right + plane.y * camera.up;
    var ray: Ray;
    ray.pixel = pixel;
    if lens.is_orthographic != 0u {
        ray.origin = camera.anchor + aside;
        ray.direction = camera.forward;
        ray.skipped = camera.skipped;
    } else {
        let towards = camera.forward + aside;
        ray.origin = camera.anchor + camera.skipped * aside;
        ray.direction = normalize(towards);
        ray.skipped = camera.skipped * length(towards);
    }
    return ray;
}

// Texture coordinates at a world distance from the ray's entry. Never accumulated: the error stays one rounding.
fn ray_position(ray: Ray, distance: f32) -> vec3f {
    return ray.entry + distance * ray.slope;
}

// The world position at a world distance from the ray's entry.
fn ray_world(ray: Ray, distance: f32) -> vec3f {
    return ray.origin + (ray.near + distance) * ray.direction;
}

// The part of a ray between two world distances from its entry. Distances from the origin stay what they are.
fn ray_between(ray: Ray, start: f32, end: f32) -> Ray {
    var part = ray;
    part.entry = ray_position(ray, start);
    part.near = ray.near + start;
    part.far = ray.near + end;
    part.cut_normal = vec3f(0.0);
    part.is_continued = false;
    return part;
}

fn segment_between(front: Sample, back: Sample, start: f32, length: f32) -> Segment {
    return Segment(front, back, start, length, 0.0, false, false);
}

// A segment that is a step long.
fn segment_step(front: Sample, back: Sample, start: f32, step: f32) -> Segment {
    return Segment(front, back, start, step, 0.0, false, true);
}

// The middle of a segment in texture coordinates.
fn segment_centre(ray: Ray, segment: Segment) -> vec3f {
    return ray_position(ray, segment.start + 0.5 * segment.length);
}
