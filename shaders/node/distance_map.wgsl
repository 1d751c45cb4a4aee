// Of each brick, whether it may be seen, and how many bricks away the next one is of the other kind: the largest of its
// distances along the axes (chessboard distance). Along x, then along y of what that gave, then along z.
//
// A number has two halves of 12 bits, so that one texture of floats does: a pass reads one half of all numbers, and
// writes the other half of its own. The result is in the upper half: 1 in its first bit for a brick that may be seen,
// the distance in the others.
//
// All of it is done twice. Of bricks that are not seen, only those count in the end that are part of a cube of three that are
// not (an opening): leaps over less gain nothing, and looks for them cost the rays that go by.
#import "lib/brick_ranges.wgsl"
#import "lib/bricks.wgsl"
#import slot "emptiness"

@group(3) @binding(24) var distance_map_out: texture_storage_2d<r32float, read_write>;

// Farther than any brick.
const DISTANCE_NONE: u32 = 0x7ffu;
const DISTANCE_SEEN: u32 = 0x800u;

@compute @workgroup_size(4, 4, 4)
fn distance_map_begin(@builtin(global_invocation_id) id: vec3u) {
    let brick = vec3i(id);
    if all(brick < bricks.dims) {
        let range = brick_range(brick);
        let kind = select(0u, DISTANCE_SEEN, emptiness_is_seen(range.x, range.y));
        textureStore(distance_map_out, bricks_texel(brick), vec4f(f32(kind | DISTANCE_NONE)));
    }
}

@compute @workgroup_size(4, 4, 4)
fn distance_map_x(@builtin(global_invocation_id) id: vec3u) {
    distance_map_along(vec3i(id), vec3i(1, 0, 0), 0u);
}

@compute @workgroup_size(4, 4, 4)
fn distance_map_y(@builtin(global_invocation_id) id: vec3u) {
    distance_map_along(vec3i(id), vec3i(0, 1, 0), 12u);
}

@compute @workgroup_size(4, 4, 4)
fn distance_map_z(@builtin(global_invocation_id) id: vec3u) {
    distance_map_along(vec3i(id), vec3i(0, 0, 1), 0u);
}

// The kinds of the second turn.
@compute @workgroup_size(4, 4, 4)
fn distance_map_open(@builtin(global_invocation_id) id: vec3u) {
    let brick = vec3i(id);
    if any(brick >= bricks.dims) {
        return;
    }
    let low = max(brick - vec3i(1), vec3i(0));
    let high = min(brick + vec3i(1), bricks.dims - vec3i(1));
    var kind = DISTANCE_SEEN;
    for (var z = low.z; z <= high.z; z++) {
        for (var y = low.y; y <= high.y; y++) {
            for (var x = low.x; x <= high.x; x++) {
                let half = u32(textureLoad(distance_map_out, bricks_texel(vec3i(x, y, z))).x) >> 12u;
                if (half & DISTANCE_SEEN) == 0u && (half & DISTANCE_NONE) >= 2u {
                    kind = 0u;
                }
            }
        }
    }
    let texel = bricks_texel(brick);
    let kept = u32(textureLoad(distance_map_out, texel).x) & 0xfff000u;
    textureStore(distance_map_out, texel, vec4f(f32(kept | kind | DISTANCE_NONE)));
}

// The distance in one more axis: of the bricks along it, the least of what is larger, the way there or the distance from
// there. `shift` is the half that is read.
fn distance_map_along(brick: vec3i, axis: vec3i, shift: u32) {
    if any(brick >= bricks.dims) {
        return;
    }
    let texel = bricks_texel(brick);
    let word = u32(textureLoad(distance_map_out, texel).x);
    let own = (word >> shift) & 0xfffu;
    let kind = own & DISTANCE_SEEN;
    var least = i32(own & DISTANCE_NONE);
    for (var away = 1; away < least; away++) {
        let before = brick - away * axis;
        let after = brick + away * axis;
        let has_before = all(before >= vec3i(0));
        let has_after = all(after < bricks.dims);
        if !(has_before || has_after) {
            break;
        }
        if has_before {
            least = min(least, distance_map_from(before, away, shift, kind));
        }
        if has_after {
            least = min(least, distance_map_from(after, away, shift, kind));
        }
    }
    let kept = word & (0xfffu << shift);
    textureStore(distance_map_out, texel, vec4f(f32(kept | ((kind | u32(least)) << (12u - shift)))));
}

// The distance by way of another brick.
fn distance_map_from(other: vec3i, away: i32, shift: u32, kind: u32) -> i32 {
    let half = (u32(textureLoad(distance_map_out, bricks_texel(other)).x) >> shift) & 0xfffu;
    let distance = max(away, i32(half & DISTANCE_NONE));
    return select(away, distance, (half & DISTANCE_SEEN) == kind);
}
