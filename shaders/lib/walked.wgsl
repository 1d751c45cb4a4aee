// What a walk along a part of a ray comes to, and what every walk needs.
#import "lib/sample.wgsl"
#import slot "traverse"

// Whatever a `traverse` slot says, a walk ends. Software drivers end every loop after as many turns.
const WALK_MAX_SEGMENTS: u32 = 65535u;

struct Walked {
    // Whether the technique has seen enough of the ray.
    is_done: bool,
    // Samples of the volume that the walk took.
    samples: u32,
}
