// Where is the next segment that may be seen? It is the next one.
#import "lib/leap.wgsl"
#import "lib/ray.wgsl"

fn leap_from(ray: Ray, index: u32, look: u32) -> Leap {
    return Leap(index, 65535u, 1u);
}
