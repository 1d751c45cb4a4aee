// Which part of the ray is visible: what lies on the inner side of all of up to eight planes, or all but that.
#import "lib/clip.wgsl"
#import "lib/space.wgsl"

struct Params {
    /// How many of the planes cut. @default 1 @range 0 8
    planes: u32,
    /// The first plane: its world normal, which points to the inner side, and how far along it the plane lies from where
    /// positions count (see `space`). A normal of zeros cuts nothing. @default 1 0 0 0
    plane_1: vec4f,
    /// The second plane, likewise. @default 0 1 0 0
    plane_2: vec4f,
    /// The third plane, likewise. @default 0 0 1 0
    plane_3: vec4f,
    /// The fourth plane, likewise. @default 0 0 0 0
    plane_4: vec4f,
    /// The fifth plane, likewise. @default 0 0 0 0
    plane_5: vec4f,
    /// The sixth plane, likewise. @default 0 0 0 0
    plane_6: vec4f,
    /// The seventh plane, likewise. @default 0 0 0 0
    plane_7: vec4f,
    /// The eighth plane, likewise. @default 0 0 0 0
    plane_8: vec4f,
}

const PLANES_MAX: u32 = 8u;

// A stretch of a ray on the inner side of all planes, and the normals of the planes at its ends; zeros for none.
struct PlanesInside {
    stretch: vec2f,
    entered: vec3f,
    left: vec3f,
}

fn planes_given(index: u32) -> vec4f {
    switch index {
        case 0u: { return params.plane_1; }
        case 1u: { return params.plane_2; }
        case 2u: { return params.plane_3; }
        case 3u: { return params.plane_4; }
        case 4u: { return params.plane_5; }
        case 5u: { return params.plane_6; }
        case 6u: { return params.plane_7; }
        default: { return params.plane_8; }
    }
}

fn planes_inside(ray: Ray) -> PlanesInside {
    var inside = PlanesInside(vec2f(0.0, ray.far - ray.near), vec3f(0.0), vec3f(0.0));
    let entry = ray_world(ray, 0.0);
    for (var index = 0u; index < min(params.planes, PLANES_MAX); index++) {
        let given = planes_given(index);
        let magnitude = length(given.xyz);
        if magnitude < 1.0e-20 {
            continue;
        }
        let normal = given.xyz / magnitude;
        let height = dot(normal, entry - space_point(normal * given.w));
        let slope = dot(normal, ray.direction);
        if abs(slope) < 1.0e-12 {
            if height < 0.0 {
                inside.stretch.y = -1.0;
            }
            continue;
        }
        let crossing = -height / slope;
        if slope > 0.0 && crossing > inside.stretch.x {
            inside.stretch.x = crossing;
            inside.entered = normal;
        } else if slope < 0.0 && crossing < inside.stretch.y {
            inside.stretch.y = crossing;
            inside.left = normal;
        }
    }
    return inside;
}

// World distances from the ray's entry: where the first visible part starts and ends; the same twice for none.
fn clip_next(ray: Ray) -> vec2f {
    return clip_part(ray, planes_inside(ray).stretch);
}

// World normal, towards the eye, of the cut at a distance from the ray's entry where a visible part starts.
fn clip_normal(ray: Ray, distance: f32) -> vec3f {
    let inside = planes_inside(ray);
    return clip_facing(select(inside.entered, inside.left, clip_keeps_outside()), ray);
}
