// What is found where a walk looks at a brick.

struct BrickLook {
    // Whether anything of it may be seen.
    is_seen: bool,
    // The box of bricks around that is alike in that, from one corner up to the other.
    low: vec3i,
    high: vec3i,
    // A segment may be two to the power of this times as long as a step.
    power: u32,
}
