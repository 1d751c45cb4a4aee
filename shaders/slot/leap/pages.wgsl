// Where is the next segment that may be seen, and how long is it? A page table tells of which bricks nothing is seen, and
// which are read from a coarser level: their segments are as much longer as their voxels.
#import "lib/brick_leap.wgsl"
#import "lib/pages.wgsl"

// So many segments are walked at least between two looks.
const LEAP_PAGES_LEAST: u32 = 2u;

// Segments of as many steps at most: two to the power of this.
const LEAP_PAGES_LEVEL: u32 = 6u;

fn leap_from(ray: Ray, index: u32) -> Leap {
    let length = ray.far - ray.near;
    var at = index;
    for (var turn = 0u; turn < BRICK_LEAP_TURNS; turn++) {
        if f32(at) * step_world() >= length {
            break;
        }
        let place = brick_leap_place(ray, at);
        let brick = bricks_at(place);
        let page = pages_at(brick);
        let whole = select(page.level, 0u, page.is_unseen && !page.is_all_unseen);
        let low = (brick >> vec3u(whole)) << vec3u(whole);
        let next = brick_leap_through(ray, at, place, low, low + vec3i(1i << whole));
        if !page.is_unseen {
            let leap = brick_leap_to(index, at, next, LEAP_PAGES_LEAST);
            let room = max(next, leap.index) - leap.index;
            let longest = 1u << firstLeadingBit(max(room / LEAP_PAGES_LEAST, 1u));
            let stride = min(1u << min(page.level, LEAP_PAGES_LEVEL), longest);
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
    return brick_leap_to(index, at, at, LEAP_PAGES_LEAST);
}
