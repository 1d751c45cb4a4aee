// How is a part of a ray walked along? Segment by segment, the technique asked after each: any technique, over segments
// of any lengths, with what layers want to know of each.
#import slot "error_layer"
#import slot "heed"
#import slot "leap"
#import slot "technique"
#import slot "trace_layer"
#import "lib/walked.wgsl"

fn walk_part(state: ptr<function, TechniqueState>, ray: ptr<function, Ray>, error: ptr<function, ErrorLayer>) -> Walked {
    let length = (*ray).far - (*ray).near;
    let bends = (*ray).bends;
    var samples = 0u;
    var is_done = false;
    var front: Sample;
    var start = 0.0;
    var index = 0u;
    // Software drivers run what is in no loop of its own for every pixel, needed or not. So a choosy technique looks
    // into segments out here, and the loops below end at those that it heeds.
    var looks = 0u;
    for (var hunt = 0u; hunt < WALK_MAX_SEGMENTS; hunt++) {
        var segment: Segment;
        var is_heeded = false;
        // A bent ray is another ray: its parts are looked for anew.
        for (; looks < WALK_MAX_SEGMENTS && !is_done && !is_heeded && (*ray).bends == bends; ) {
            let leap = leap_from(*ray, index, looks);
            if looks == 0u || leap.index != index {
                let before = start;
                index = leap.index;
                start = 0.0;
                if index > 0u {
                    start = traverse_segment_end(*ray, index - 1u);
                }
                trace_layer_leap(before, start);
                if start < length {
                    front = sample_along(*ray, start);
                    samples++;
                }
            }
            looks++;
            if start >= length {
                break;
            }
            for (var turn = 0u; turn < leap.segments && start < length; turn++) {
                let end = traverse_segment_end(*ray, index + leap.stride - 1u);
                let back = sample_along(*ray, end);
                samples++;
                segment = segment_between(front, back, start, end - start);
                error_layer_segment(error, *state, *ray, segment);
                front = back;
                start = end;
                index += leap.stride;
                if heed_is_choosy() {
                    is_heeded = heed_segment(*ray, segment);
                    if is_heeded {
                        break;
                    }
                    trace_layer_segment(*state, *ray, segment, false);
                } else {
                    is_done = technique_segment(state, ray, segment);
                    trace_layer_segment(*state, *ray, segment, is_done);
                    if is_done || (*ray).bends != bends {
                        break;
                    }
                }
            }
        }
        if !heed_is_choosy() || !is_heeded {
            break;
        }
        is_done = technique_segment(state, ray, segment);
        trace_layer_segment(*state, *ray, segment, is_done);
        if is_done {
            break;
        }
    }
    return Walked(is_done, samples);
}
