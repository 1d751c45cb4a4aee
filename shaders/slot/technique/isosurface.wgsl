// The first isosurface that the ray meets, opaque and lit.
#import "lib/crossing.wgsl"
#import "lib/isovalue.wgsl"
#import "lib/surface.wgsl"
#import slot "light"

struct Params {
    /// Linear colour of the isosurface. @default 0.8 0.75 0.65 @range 0 1 @color
    surface_color: vec3f,
    /// What is seen where a cut, or a face of the volume's box, lies in the solid: its face, or the hollow inside.
    /// @default drawn @choices drawn open
    cut_faces: u32,
}

struct TechniqueState {
    color: vec4f,
    depth: f32,
}

fn technique_begin(ray: Ray) -> TechniqueState {
    return TechniqueState(vec4f(0.0), RAY_NO_DEPTH);
}

fn technique_segment(state: ptr<function, TechniqueState>, ray: ptr<function, Ray>, segment: Segment) -> bool {
    var distance = CROSSING_NONE;
    var normal = vec3f(0.0);
    // The eye itself may be inside of the solid; then there is no face.
    let is_face = segment.start == 0.0 && (*ray).near > 0.0 && !(*ray).is_continued;
    if is_face && params.cut_faces == 0u && isovalue_is_solid(segment.front.scalar) {
        distance = 0.0;
        normal = surface_entry_normal(*ray);
    } else {
        distance = crossing_next(*ray, segment, isovalue_level(), -1.0);
        if distance == CROSSING_NONE {
            return false;
        }
        normal = surface_gradient_normal(*ray, distance);
    }
    let point = SurfacePoint(ray_world(*ray, distance), ray_position(*ray, distance), normal, isovalue_level());
    *state = TechniqueState(vec4f(light_surface(params.surface_color, point, *ray), 1.0), (*ray).near + distance);
    return true;
}

fn technique_finish(state: TechniqueState, ray: Ray) -> RayResult {
    return RayResult(state.color, state.depth);
}
