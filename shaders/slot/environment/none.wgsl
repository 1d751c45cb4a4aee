// What a surface mirrors: nothing.
#import "lib/surface_point.wgsl"

// Linear colour that a surface mirrors towards the eye, beside what lights give it.
fn environment_reflection(point: SurfacePoint, ray: Ray) -> vec3f {
    return vec3f(0.0);
}
