// How much light gets through the volume along a ray: what classification leaves of it, segment by segment.
#import "lib/shadow_ray.wgsl"
#import slot "classify"
#import slot "shadow_leap"

// A walk ends where less than this share gets through; what it returns is off by less.
const SHADOW_LEAST: f32 = 1.0 / 4096.0;

fn shadow_through(ray: Ray) -> f32 {
    var parts = parts_begin(ray);
    var part = ray;
    var through = 1.0;
    for (var number = 0u; through >= SHADOW_LEAST && number < PARTS_MAX; number++) {
        if !parts_next(&parts, &part) {
            break;
        }
        let length = part.far - part.near;
        var front = shadow_sample(part, 0.0);
        var start = 0.0;
        var index = 0u;
        // Looks are behind the segments that they are for, and not in between: see `walk/pairs.wgsl`.
        for (var looks = 0u; through >= SHADOW_LEAST && start < length && looks < SHADOW_MAX_SEGMENTS; looks++) {
            let last = index + shadow_leap_least();
            for (; through >= SHADOW_LEAST && start < length && index < last; index++) {
                let end = shadow_segment_end(part, index);
                let back = shadow_sample(part, end);
                through *= classify_segment(part, segment_between(front, back, start, end - start)).transmittance;
                front = back;
                start = end;
            }
            let next = shadow_leap_from(part, index, shadow_step_world());
            if next != index {
                index = next;
                start = min(f32(index) * shadow_step_world(), length);
                front = shadow_sample(part, start);
            }
        }
    }
    return through;
}
