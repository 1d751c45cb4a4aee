// Where is the next segment that may be seen, and how long may it be? A look at a brick tells how many steps a segment
// may take here, and how far around that holds; the ray goes through what is not seen in one leap.
#import "lib/brick_leap.wgsl"
#import "lib/bricks.wgsl"
#import "lib/nearest_sampler.wgsl"

@group(1) @binding(34) var stride_map: texture_2d<f32>;

// A run of longer segments has so many at least: a look costs as much as some of them. Even.
const LEAP_STRIDES_LEAST: u32 = 4u;

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
        let power = (number >> 8u) & 15u;
        if power < 15u {
            let leap = brick_leap_to(index, at, next);
            let fits = (next - leap.index) / LEAP_STRIDES_LEAST;
            if power == 0u || next < leap.index || fits < 2u {
                return leap;
            }
            let stride = min(1u << power, 1u << firstLeadingBit(fits));
            return Leap(leap.index, ((next - leap.index) / stride) & ~1u, stride);
        }
        if next == at {
            break;
        }
        at = next;
    }
    return brick_leap_to(index, at, at);
}
