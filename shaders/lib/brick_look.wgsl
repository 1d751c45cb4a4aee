// What is found where a walk looks at a brick.

struct BrickLook {
    // Whether anything of it may be seen.
    is_seen: bool,
    // Less than so many bricks away to each side, all bricks are alike in that; at least 1.
    away: i32,
}
