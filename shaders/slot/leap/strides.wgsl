// Where is the next segment that may be seen, and how long may it be? A look at a brick tells how many steps a segment
// may take here, and how far around that holds; the ray goes through what is not seen in one leap.
#import "lib/brick_leap.wgsl"
#import "lib/bricks.wgsl"
#import "lib/nearest_sampler.wgsl"

@group(1) @binding(34) var stride_map: texture_2d<f32>;

// So many segments are walked at least between two looks, long ones as well: fewer samples are what it is for.
const LEAP_STRIDES_LEAST: u32 = 2u;

fn leap_from(ray: Ray, index: u32) -> Leap {
    let length = ray.far - ray.near;
    var at = index;
    for (var turn = 0u; turn < BRICK_LEAP_TURNS; turn++) {
        if f32(at) * step_world() >= length {
            break;
        }
        let place = brick_leap_place(ray, at);
        let brick = bricks_at(place);
        let number = u32(textureSampleLevel(stride_map, nearest_sampler, bricks_in_map(brick), 0.0).x);
        let radius = i32(1u << ((number >> 12u) & 7u)) - 1;
        let next = brick_leap_through(ray, at, place, brick - radius, brick + radius + 1);
        let power = (number >> 8u) & 7u;
        if power < 7u {
            let leap = brick_leap_to(index, at, next, LEAP_STRIDES_LEAST);
            let room = max(next, leap.index) - leap.index;
            let stride = min(1u << power, 1u << firstLeadingBit(max(room / LEAP_STRIDES_LEAST, 1u)));
            if stride == 1u {
                return leap;
            }
            return Leap(leap.index, (room / stride) & ~1u, stride);
        }
        if next == at {
            break;
        }
        at = next;
    }
    return brick_leap_to(index, at, at, LEAP_STRIDES_LEAST);
}
