// How the 64 invocations of a workgroup lie side by side: as four squares of four pixels a side, so that those that run
// together see much the same.

// The square of an invocation, from 0 to 3.
fn lane_square(lane: u32) -> u32 {
    return lane / 16u;
}

// The pixel within its square.
fn lane_pixel(lane: u32) -> vec2u {
    return vec2u(lane & 3u, (lane >> 2u) & 3u);
}
