// Of each brick, whether it may be seen, and how many bricks away the next one is of the other kind: the largest of its
// distances along the axes (chessboard distance). Along x, then along y of what that gave, then along z.
//
// A number has two halves of 12 bits, so that one texture of floats does: a pass reads one half of all numbers, and
// writes the other half of its own. The result is in the upper half: 1 in its first bit for a brick that may be seen,
// the distance in the others.
//
// Before that, of bricks that are not seen only those are kept that are part of a cube of three that are not (an opening):
// leaps over less gain nothing, and looks for them cost the rays that go by. `near` finds the middles of such cubes, `open`
// what is around these; each goes along the three axes in turn, as distances do.
#import "lib/brick_ranges.wgsl"
#import "lib/bricks.wgsl"
#import slot "emptiness"

@group(3) @binding(24) var distance_map_out: texture_storage_2d<r32float, read_write>;

const DISTANCE_SEEN: u32 = 0x800u;

@compute @workgroup_size(8, 4, 4)
fn distance_map_begin(@builtin(global_invocation_id) id: vec3u) {
    let brick = vec3i(id);
    if all(brick < bricks.dims) {
        let range = brick_range(brick);
        let kind = select(0u, DISTANCE_SEEN, emptiness_is_seen(range.x, range.y));
        textureStore(distance_map_out, bricks_texel(brick), vec4f(f32(kind | bricks.farthest)));
    }
}

@compute @workgroup_size(8, 4, 4)
fn distance_map_near_x(@builtin(global_invocation_id) id: vec3u) {
    distance_map_along(vec3i(id), vec3i(1, 0, 0), 0u, 2u);
}

@compute @workgroup_size(8, 4, 4)
fn distance_map_near_y(@builtin(global_invocation_id) id: vec3u) {
    distance_map_along(vec3i(id), vec3i(0, 1, 0), 12u, 2u);
}

@compute @workgroup_size(8, 4, 4)
fn distance_map_near_z(@builtin(global_invocation_id) id: vec3u) {
    distance_map_along(vec3i(id), vec3i(0, 0, 1), 0u, 2u);
}

@compute @workgroup_size(8, 4, 4)
fn distance_map_open_x(@builtin(global_invocation_id) id: vec3u) {
    distance_map_kept(vec3i(id), vec3i(1, 0, 0), 12u);
}

@compute @workgroup_size(8, 4, 4)
fn distance_map_open_y(@builtin(global_invocation_id) id: vec3u) {
    distance_map_kept(vec3i(id), vec3i(0, 1, 0), 0u);
}

@compute @workgroup_size(8, 4, 4)
fn distance_map_open_z(@builtin(global_invocation_id) id: vec3u) {
    distance_map_kept(vec3i(id), vec3i(0, 0, 1), 12u);
}

@compute @workgroup_size(8, 4, 4)
fn distance_map_x(@builtin(global_invocation_id) id: vec3u) {
    distance_map_along(vec3i(id), vec3i(1, 0, 0), 0u, bricks.farthest);
}

@compute @workgroup_size(8, 4, 4)
fn distance_map_y(@builtin(global_invocation_id) id: vec3u) {
    distance_map_along(vec3i(id), vec3i(0, 1, 0), 12u, bricks.farthest);
}

@compute @workgroup_size(8, 4, 4)
fn distance_map_z(@builtin(global_invocation_id) id: vec3u) {
    distance_map_along(vec3i(id), vec3i(0, 0, 1), 0u, bricks.farthest);
}

// What is kept as not seen, along one more axis: bricks beside the middle of a cube that is not.
fn distance_map_kept(brick: vec3i, axis: vec3i, shift: u32) {
    if any(brick >= bricks.dims) {
        return;
    }
    let texel = bricks_texel(brick);
    let word = u32(textureLoad(distance_map_out, texel).x);
    let before = distance_map_half(max(brick - axis, vec3i(0)), shift);
    let after = distance_map_half(min(brick + axis, bricks.dims - vec3i(1)), shift);
    let is_kept = distance_map_is_middle((word >> shift) & 0xfffu) || distance_map_is_middle(before) || distance_map_is_middle(after);
    let kept = word & (0xfffu << shift);
    let half = select(DISTANCE_SEEN, 0u, is_kept) | bricks.farthest;
    textureStore(distance_map_out, texel, vec4f(f32(kept | (half << (12u - shift)))));
}

// Whether a brick is not seen, nor are those around it.
fn distance_map_is_middle(half: u32) -> bool {
    return half >= 2u && half < DISTANCE_SEEN;
}

// The distance in one more axis: of the bricks along it, the least of what is larger, the way there or the distance from
// there; `most` where that is as far or farther. `shift` is the half that is read.
fn distance_map_along(brick: vec3i, axis: vec3i, shift: u32, most: u32) {
    if any(brick >= bricks.dims) {
        return;
    }
    let texel = bricks_texel(brick);
    let word = u32(textureLoad(distance_map_out, texel).x);
    let own = (word >> shift) & 0xfffu;
    let kind = own & DISTANCE_SEEN;
    var least = i32(min(own & ~DISTANCE_SEEN, most));
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
    let half = distance_map_half(other, shift);
    let distance = max(away, i32(half & ~DISTANCE_SEEN));
    return select(away, distance, (half & DISTANCE_SEEN) == kind);
}

fn distance_map_half(brick: vec3i, shift: u32) -> u32 {
    return (u32(textureLoad(distance_map_out, bricks_texel(brick)).x) >> shift) & 0xfffu;
}
