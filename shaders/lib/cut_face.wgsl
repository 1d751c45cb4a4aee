// The faces of a solid where a cut, or a face of the volume's box, goes through it.
#import "lib/crossing.wgsl"
#import "lib/isovalue.wgsl"

struct Params {
    /// What is seen where a cut, or a face of the volume's box, lies in the solid: its face, or the hollow inside. An eye
    /// inside of the solid sees its hollow side. @default drawn @choices drawn open
    cut_faces: u32,
}

// What a walk has come through.
struct CutFace {
    // World distance from the origin where the last part ended, and whether it ended in the solid.
    end: f32,
    is_solid: bool,
}

fn cut_face_begin() -> CutFace {
    return CutFace(-1.0, false);
}

// Whether the segment starts at a face of the solid that the ray meets from outside.
fn cut_face_is_met(before: CutFace, ray: Ray, segment: Segment) -> bool {
    // The uniform comes last: conditions that begin with one crash fragment shaders of Mesa 22.3's lavapipe.
    let is_start = segment.start == 0.0 && ray.near > 0.0 && !ray.is_continued && params.cut_faces == 0u;
    // A part that goes on where the last one ended, as where a label changes, is no face inside of the solid.
    let goes_on = before.is_solid && ray.near <= before.end + volume_least();
    return is_start && !goes_on && crossing_starts_above(ray, segment, isovalue_level()) != (params.solid == 1u);
}

// After a segment.
fn cut_face_after(ray: Ray, segment: Segment) -> CutFace {
    return CutFace(ray.far, isovalue_is_solid(segment.back.scalar));
}
