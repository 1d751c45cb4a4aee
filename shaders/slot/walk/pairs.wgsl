// How is a part of a ray walked along? Two whole steps at a turn, in a loop with one way out, and what is left of the part
// behind it. For techniques that bend no rays and that may be handed more than they asked for: once that they have seen
// enough they say so of every segment (`@walks pairs` in their file). In here a segment is a step long, which is known
// when the shader is built. Software drivers keep what each pixel of a vector does apart from one way out of a loop to
// the next, and from one side of a branch to the other: without these a walk takes two thirds of the time.
#import slot "error_layer"
#import slot "leap"
#import slot "technique"
#import "lib/walked.wgsl"

fn walk_part(state: ptr<function, TechniqueState>, ray: ptr<function, Ray>, error: ptr<function, ErrorLayer>) -> Walked {
    let length = (*ray).far - (*ray).near;
    let step = step_world();
    let whole = min(u32(length / step), WALK_MAX_SEGMENTS);
    var samples = 1u;
    var is_done = false;
    var index = 0u;
    var front = sample_along(*ray, 0.0);
    // A look at what is ahead is worth it where there are two steps at least.
    for (var looks = 0u; looks <= whole && index + 1u < whole && !is_done; looks++) {
        let leap = leap_from(*ray, index);
        if leap.index != index {
            index = leap.index;
            front = sample_along(*ray, min(f32(index) * step, length));
            samples++;
        }
        let last = min(index + leap.segments, whole);
        for (; index + 1u < last && !is_done; index += 2u) {
            let middle = sample_along(*ray, f32(index + 1u) * step);
            let back = sample_along(*ray, f32(index + 2u) * step);
            technique_segment(state, ray, segment_step(front, middle, f32(index) * step, step));
            is_done = technique_segment(state, ray, segment_step(middle, back, f32(index + 1u) * step, step));
            front = back;
            samples += 2u;
        }
    }
    // One step may be left, and what is less than a step.
    var start = min(f32(index) * step, length);
    for (var turn = 0u; turn < WALK_MAX_SEGMENTS && start < length && !is_done; turn++) {
        let end = traverse_segment_end(*ray, index);
        let back = sample_along(*ray, end);
        is_done = technique_segment(state, ray, segment_between(front, back, start, end - start));
        front = back;
        start = end;
        index++;
        samples++;
    }
    return Walked(is_done, samples);
}
