// Direct volume rendering with an isosurface in it: a segment that the isosurface cuts is classified in pieces, each with
// its own length and the isovalue at the cut, so that the colour is right on both sides of the surface at any step.
// @skips isovalue_transfer
#import "lib/compositing.wgsl"
#import "lib/crossing.wgsl"
#import "lib/cut_face.wgsl"
#import "lib/isovalue.wgsl"
#import "lib/surface.wgsl"
#import slot "classify"
#import slot "light"

struct Params {
    /// Linear colour of the isosurface. @default 0.8 0.75 0.65 @range 0 1 @color
    surface_color: vec3f,
    /// Opacity of the isosurface; 0 leaves it out. @default 0.5 @range 0 1
    surface_opacity: f32,
}

struct TechniqueState {
    composite: Composite,
    face: CutFace,
}

fn technique_begin(ray: Ray) -> TechniqueState {
    return TechniqueState(compositing_begin(), cut_face_begin());
}

fn technique_segment(state: ptr<function, TechniqueState>, ray: ptr<function, Ray>, segment: Segment) -> bool {
    var composite = (*state).composite;
    if cut_face_is_met((*state).face, *ray, segment) {
        let normal = surface_entry_normal(*ray);
        composite = technique_surface(composite, *ray, 0.0, normal, segment.front.scalar);
    }
    (*state).face = cut_face_after(*ray, segment);
    let end = segment.start + segment.length;
    var front = segment.front;
    var start = segment.start;
    var after = -1.0;
    for (var index = 0u; index < CROSSING_MAX && !compositing_is_done(composite); index++) {
        after = crossing_next(*ray, segment, isovalue_level(), after);
        if after == CROSSING_NONE {
            break;
        }
        let cut = Sample(ray_position(*ray, after), isovalue_level());
        if after < end {
            composite = technique_piece(composite, *ray, segment_between(front, cut, start, after - start));
        } else {
            composite = technique_piece(composite, *ray, segment_between(front, segment.back, start, end - start));
        }
        let normal = surface_gradient_normal(*ray, after);
        composite = technique_surface(composite, *ray, after, normal, isovalue_level());
        front = cut;
        start = after;
    }
    if !compositing_is_done(composite) {
        composite = technique_piece(composite, *ray, segment_between(front, segment.back, start, end - start));
    }
    (*state).composite = composite;
    return compositing_is_done(composite);
}

// What a piece of a segment adds.
fn technique_piece(before: Composite, ray: Ray, piece: Segment) -> Composite {
    if piece.length <= 0.0 {
        return before;
    }
    let classified = classify_segment(ray, piece);
    if classified.transmittance >= 1.0 {
        return before;
    }
    return compositing_segment(before, ray, piece, light_segment(classified, piece, ray), classified.transmittance);
}

// What the surface adds, at a world distance from the ray's entry.
fn technique_surface(before: Composite, ray: Ray, distance: f32, normal: vec3f, scalar: f32) -> Composite {
    if params.surface_opacity == 0.0 {
        return before;
    }
    let point = SurfacePoint(ray_world(ray, distance), ray_position(ray, distance), normal, scalar);
    let color = light_surface(params.surface_color, point, ray);
    return compositing_surface(before, ray, distance, color, params.surface_opacity);
}

fn technique_finish(state: TechniqueState, ray: Ray) -> RayResult {
    return compositing_result(state.composite);
}
