// Which parts of rays may see anything (beams: Laine and Karras 2010): one ray through the middle of a tile of pixels looks
// at bricks ahead for all rays of the tile. Bricks around it are empty for all of them where they hold whatever is as far
// away as the tile's corners.
#import "lib/active_blocks.wgsl"
#import "lib/bricks.wgsl"
#import "lib/ray.wgsl"
#import "lib/spans.wgsl"
#import "lib/spans_beside.wgsl"
#import "lib/step.wgsl"
#import "lib/volume.wgsl"
#import slot "look"

struct ActiveBlocks {
    workgroups: vec3u,
    count: atomic<u32>,
    blocks: array<u32>,
}

@group(3) @binding(26) var spans_out: texture_storage_2d<rgba32float, write>;
@group(3) @binding(27) var spans: texture_2d<f32>;
@group(3) @binding(28) var<storage, read_write> active_blocks_out: ActiveBlocks;

// Whatever bricks say, a scout comes to its end.
const SCOUT_TURNS: u32 = 16384u;
// Bricks that places are rounded by, and much more.
const SCOUT_ROUNDING: f32 = 0.02;
// Bricks that no ray is away from the volume.
const SCOUT_OUTSIDE: f32 = 1.0e9;
// Steps that are walked sooner than leapt over.
const SCOUT_GAP: f32 = 6.0;

struct Scouted {
    tile: vec2f,
    // How many spans there are, and the last one of them while it waits for another to share a texel with.
    count: u32,
    held: vec2f,
}

fn scout_add(before: Scouted, span: vec2f) -> Scouted {
    var scouted = before;
    if scouted.count % 2u == 1u {
        textureStore(spans_out, vec2u(spans_texel(scouted.tile, scouted.count / 2u)), vec4f(scouted.held, span));
    }
    scouted.held = span;
    scouted.count += 1u;
    return scouted;
}

@compute @workgroup_size(8, 8, 1)
fn scout_compute(@builtin(global_invocation_id) id: vec3u) {
    let tile = vec2f(id.xy);
    if any(tile >= spans_tiles()) {
        return;
    }
    let ray = ray_through((tile + 0.5) * spans_pixels());
    // In bricks, of a box that is larger by as much as rays are apart; distances are rounded by more where they are long.
    let origin = bricks_place((volume.texture_from_world * vec4f(ray.origin, 1.0)).xyz);
    let given = (volume.texture_from_world * vec4f(ray.direction, 0.0)).xyz * bricks.per_texture;
    let slope = select(given, vec3f(1.0e-20), abs(given) < vec3f(1.0e-20));
    let rounding = SCOUT_ROUNDING + 1.0e-6 * (abs(origin) + spans_farthest(ray) * abs(slope));
    let beside = spans_beside(ray) + rounding;
    let a = (bricks_place(volume.box_low) - beside - origin) / slope;
    let b = (bricks_place(volume.box_high) + beside - origin) / slope;
    let first = min(a, b);
    let last = max(a, b);
    let near = max(max(max(first.x, first.y), first.z), 0.0);
    let far = min(min(last.x, last.y), last.z);
    let least = 0.5 * min(min(rounding.x, rounding.y), rounding.z) / max(max(abs(slope.x), abs(slope.y)), abs(slope.z));
    let gap = SCOUT_GAP * step_world();

    var scouted = Scouted(tile, 0u, SPANS_NONE);
    var span = SPANS_NONE;
    var distance = near;
    for (var turn = 0u; turn < SCOUT_TURNS && distance < far; turn++) {
        let place = origin + distance * slope;
        let brick = bricks_at(place);
        let look = look_at(brick);
        // The outer bricks go on outside of the volume.
        let is_first = look.low <= vec3i(0);
        let is_last = look.high >= bricks.dims;
        let low = select(vec3f(look.low) + beside, vec3f(-SCOUT_OUTSIDE), is_first);
        let high = select(vec3f(look.high) - beside, vec3f(SCOUT_OUTSIDE), is_last);
        let is_empty = !look.is_seen && all(place >= low) && all(place <= high);
        // What is seen all around is; beside what is not, a brick is looked at by itself.
        let own_low = select(vec3f(brick), vec3f(-SCOUT_OUTSIDE), brick <= vec3i(0));
        let own_high = select(vec3f(brick + 1), vec3f(SCOUT_OUTSIDE), brick + 1 >= bricks.dims);
        let seen_low = select(vec3f(look.low), vec3f(-SCOUT_OUTSIDE), is_first);
        let seen_high = select(vec3f(look.high), vec3f(SCOUT_OUTSIDE), is_last);
        let box_low = select(select(own_low, seen_low, look.is_seen), low, is_empty);
        let box_high = select(select(own_high, seen_high, look.is_seen), high, is_empty);
        let exits = max((box_low - place) / slope, (box_high - place) / slope);
        let start = distance;
        distance += max(min(min(exits.x, exits.y), exits.z), least);
        if is_empty {
            continue;
        }
        if span.y >= 0.0 && start - span.y < gap {
            span.y = distance;
            continue;
        }
        if span.y >= 0.0 {
            scouted = scout_add(scouted, span);
        }
        span = vec2f(start, distance);
        if scouted.count + 1u >= 2u * SPANS_TEXELS {
            // The last one goes on to the end.
            break;
        }
    }
    // Whatever stopped the scout, what it has not seen may be seen.
    if distance < far {
        span = vec2f(select(distance, span.x, span.y >= 0.0), far);
    }
    if span.y >= 0.0 {
        scouted = scout_add(scouted, span);
    }
    for (var turn = 0u; turn < 2u * SPANS_TEXELS && scouted.count < 2u * SPANS_TEXELS; turn++) {
        scouted = scout_add(scouted, SPANS_NONE);
    }
}

// The list of blocks of pixels that have a span. Neighbours in the picture are near each other in it: see the same of the volume.
@compute @workgroup_size(1)
fn scout_reset() {
    atomicStore(&active_blocks_out.count, 0u);
}

@compute @workgroup_size(8, 8, 1)
fn scout_list(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let block = 8u * group.xy + active_blocks_turn(lane);
    let first = vec2f(ACTIVE_BLOCKS_SIDE * block);
    if any(first >= lens.extent) {
        return;
    }
    // The tiles of its pixels.
    let last = min(first + f32(ACTIVE_BLOCKS_SIDE), lens.extent) - 0.5;
    let end = spans_tile(last);
    var is_active = !spans_are_known();
    for (var y = spans_tile(first + 0.5).y; y <= end.y && !is_active; y += 1.0) {
        for (var x = spans_tile(first + 0.5).x; x <= end.x && !is_active; x += 1.0) {
            is_active = textureLoad(spans, vec2i(spans_texel(vec2f(x, y), 0u)), 0).y >= 0.0;
        }
    }
    if is_active {
        let number = atomicAdd(&active_blocks_out.count, 1u);
        active_blocks_out.blocks[number] = active_blocks_packed(block);
    }
}

@compute @workgroup_size(1)
fn scout_settle() {
    let groups = active_blocks_groups(atomicLoad(&active_blocks_out.count));
    // As few too many as can be: processors hand them out in equal parts.
    let rows = max((groups + ACTIVE_BLOCKS_ROW - 1u) / ACTIVE_BLOCKS_ROW, 1u);
    active_blocks_out.workgroups = vec3u((groups + rows - 1u) / rows, rows, 1u);
}
