// Of each brick, how many steps a segment may take, and how far around that holds. First each brick for itself; then, for
// radii of 1, 3, 7 and 15 bricks, the least around it, along x, y and z: that of a radius is the least of three of the
// radius before. As far as it is the brick's own, its radius grows.
//
// A number has fields of four bits, so that one texture of floats does: in turn a pass reads one of the first two of all
// numbers, and writes the other one of its own. Their last bit says that something around is not seen: what is seen ends
// there, for the ray to leap. Then the brick's own power of two (7: nothing is seen), how often its radius has grown, and
// how many radii have been tried.
#import "lib/absorbing.wgsl"
#import "lib/brick_details.wgsl"
#import "lib/brick_ranges.wgsl"
#import "lib/bricks.wgsl"
#import "lib/importance.wgsl"

@group(3) @binding(25) var stride_map_out: texture_storage_2d<r32float, read_write>;

const STRIDE_UNSEEN: u32 = 7u;
const STRIDE_BESIDE_UNSEEN: u32 = 8u;
// Segments of more steps would hardly save anything more.
const STRIDE_MOST: f32 = 5.0;

@compute @workgroup_size(4, 4, 4)
fn stride_map_begin(@builtin(global_invocation_id) id: vec3u) {
    let brick = vec3i(id);
    if any(brick >= bricks.dims) {
        return;
    }
    let range = brick_range(brick);
    var stride = STRIDE_UNSEEN;
    if absorbing_between(range.x, range.y) {
        let steps = importance_steps(range.x, range.y, brick_detail(brick));
        stride = u32(clamp(floor(log2(steps)), 0.0, STRIDE_MOST));
    }
    let field = stride | select(0u, STRIDE_BESIDE_UNSEEN, stride == STRIDE_UNSEEN);
    textureStore(stride_map_out, bricks_texel(brick), vec4f(f32(field | (field << 4u) | (stride << 8u))));
}

@compute @workgroup_size(4, 4, 4)
fn stride_map_x(@builtin(global_invocation_id) id: vec3u) {
    stride_map_along(vec3i(id), vec3i(1, 0, 0), 0u);
}

@compute @workgroup_size(4, 4, 4)
fn stride_map_y(@builtin(global_invocation_id) id: vec3u) {
    stride_map_along(vec3i(id), vec3i(0, 1, 0), 1u);
}

@compute @workgroup_size(4, 4, 4)
fn stride_map_z(@builtin(global_invocation_id) id: vec3u) {
    stride_map_along(vec3i(id), vec3i(0, 0, 1), 2u);
}

// The least of a radius along one more axis, the `number`th of its level.
fn stride_map_along(brick: vec3i, axis: vec3i, number: u32) {
    if any(brick >= bricks.dims) {
        return;
    }
    let texel = bricks_texel(brick);
    let word = u32(textureLoad(stride_map_out, texel).x);
    let level = word >> 15u;
    let from_shift = ((level + number) & 1u) * 4u;
    let to_shift = 4u - from_shift;
    let field = (word >> from_shift) & 15u;
    var least = field & 7u;
    var beside = field & STRIDE_BESIDE_UNSEEN;
    let way = i32(1u << level) * axis;
    for (var side = 0; side < 2; side++) {
        let other = select(brick + way, brick - way, side == 0);
        if all(other >= vec3i(0)) && all(other < bricks.dims) {
            let there = u32(textureLoad(stride_map_out, bricks_texel(other)).x) >> from_shift;
            least = min(least, there & 7u);
            beside |= there & STRIDE_BESIDE_UNSEEN;
        }
    }
    var next = (word & ~(15u << to_shift)) | ((least | beside) << to_shift);
    if number == 2u {
        let own = (word >> 8u) & 7u;
        let grown = (word >> 12u) & 7u;
        // Only as far as all radii before.
        let is_alike = least >= own && (own == STRIDE_UNSEEN || beside == 0u);
        let grows = is_alike && grown == level;
        next = (next & 0xfffu) | ((grown + select(0u, 1u, grows)) << 12u) | ((level + 1u) << 15u);
    }
    textureStore(stride_map_out, texel, vec4f(f32(next)));
}
