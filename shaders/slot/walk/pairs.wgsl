// How is a part of a ray walked along? Two whole steps at a turn, in a loop with one way out, and what is left of the part
// behind it. For techniques that bend no rays and that may be handed more than they asked for: once that they have seen
// enough they say so of every segment (`@walks pairs` in their file). In here a segment is a step long, which is known
// when the shader is built. Software drivers keep what each pixel of a vector does apart from one way out of a loop to
// the next, and from one side of a branch to the other: without these a walk takes two thirds of the time.
//
// Where the technique does not see all segments, and what it makes of those that it sees is far more than a look at them
// (`heed`), a loop of its own looks for the next two of which one is seen; another goes through them until two are not.
#import slot "error_layer"
#import slot "heed"
#import slot "leap"
#import slot "technique"
#import "lib/walked.wgsl"

// Two steps side by side.
struct Pair {
    near: Segment,
    far: Segment,
}

fn pair_at(ray: Ray, front: Sample, index: u32, step: f32) -> Pair {
    let middle = sample_along(ray, f32(index + 1u) * step);
    let back = sample_along(ray, f32(index + 2u) * step);
    let near = segment_step(front, middle, f32(index) * step, step);
    return Pair(near, segment_step(middle, back, f32(index + 1u) * step, step));
}

fn pair_is_heeded(ray: Ray, pair: Pair) -> bool {
    let is_near = heed_segment(ray, pair.near);
    return heed_segment(ray, pair.far) || is_near;
}

fn walk_part(state: ptr<function, TechniqueState>, ray: ptr<function, Ray>, error: ptr<function, ErrorLayer>) -> Walked {
    let length = (*ray).far - (*ray).near;
    let step = step_world();
    let whole = min(u32(length / step), WALK_MAX_SEGMENTS);
    var samples = 1u;
    var is_done = false;
    var leap = leap_from(*ray, 0u, 0u);
    var index = leap.index;
    var front = sample_along(*ray, min(f32(index) * step, length));
    // What lies ahead is looked at behind what is walked: so no turn finds out that there is nothing.
    for (var looks = 0u; looks <= whole && index + 1u < whole && !is_done; looks++) {
        let last = min(index + leap.segments, whole);
        for (; !heed_is_choosy() && index + 1u < last && !is_done; index += 2u) {
            let pair = pair_at(*ray, front, index, step);
            technique_segment(state, ray, pair.near);
            is_done = technique_segment(state, ray, pair.far);
            front = pair.far.back;
            samples += 2u;
        }
        for (var hunt = 0u; heed_is_choosy() && hunt <= whole && index + 1u < last && !is_done; hunt++) {
            var is_heeded = false;
            for (; index + 1u < last && !is_heeded; ) {
                let pair = pair_at(*ray, front, index, step);
                is_heeded = pair_is_heeded(*ray, pair);
                if !is_heeded {
                    front = pair.far.back;
                    index += 2u;
                }
                samples += 2u;
            }
            for (; index + 1u < last && is_heeded && !is_done; index += 2u) {
                let pair = pair_at(*ray, front, index, step);
                is_heeded = pair_is_heeded(*ray, pair);
                technique_segment(state, ray, pair.near);
                is_done = technique_segment(state, ray, pair.far);
                front = pair.far.back;
                samples += 2u;
            }
        }
        leap = leap_from(*ray, index, looks + 1u);
        // What is left of a part belongs to the walk that comes to it.
        if last < whole && leap.index != index {
            index = leap.index;
            front = sample_along(*ray, min(f32(index) * step, length));
            samples++;
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
