// The 2D pre-integrated table, as the processor makes it: an entry is a window of d cells between neighbouring entries,
// which are composited. An invocation makes 32 neighbouring windows of one d, for both directions: what is in all of them
// is composited once, what is before it in some is kept, what is behind it grows. In float32; opacities and transmittances
// are never multiplied up over many cells, where a rounding that is always the same would become an error.

// Keep `WINDOWS` in the node's file equal.
const PREINTEGRATION_WINDOWS: u32 = 32u;
const PREINTEGRATION_ROW: u32 = 2048u;
// Pieces of a cell at most; of all its knots and halves.
const PREINTEGRATION_PIECES: u32 = 60000u;

struct Preintegration {
    // Entries a side of a table, tables in a row of the texture, and tables.
    size: u32,
    columns: u32,
    tables: u32,
    // Whether entries have transmittances in place of depths.
    has_transmittances: u32,
}

@group(2) @binding(0) var<uniform> preintegration: Preintegration;
@group(2) @binding(1) var preintegration_pieces: texture_2d<f32>;
@group(2) @binding(2) var table_out: texture_storage_2d<rgba32float, write>;

// What a stretch of scalars shows towards its low and its high end.
struct PreintegrationStretch {
    rising: vec3f,
    falling: vec3f,
    depth: f32,
    opacity: f32,
}

fn preintegration_empty() -> PreintegrationStretch {
    return PreintegrationStretch(vec3f(0.0), vec3f(0.0), 0.0, 0.0);
}

// A stretch and behind it, at higher scalars, the next.
fn preintegration_then(low: PreintegrationStretch, high: PreintegrationStretch) -> PreintegrationStretch {
    return PreintegrationStretch(
        low.rising + exp(-low.depth) * high.rising,
        low.falling + (high.falling - high.opacity * low.falling),
        low.depth + high.depth,
        low.opacity + (high.opacity - high.opacity * low.opacity),
    );
}

// The same where the low one is short and the high one is long.
fn preintegration_before(low: PreintegrationStretch, high: PreintegrationStretch) -> PreintegrationStretch {
    return PreintegrationStretch(
        high.rising + (low.rising - low.opacity * high.rising),
        high.falling + exp(-high.depth) * low.falling,
        low.depth + high.depth,
        high.opacity + (low.opacity - low.opacity * high.opacity),
    );
}

fn preintegration_texel(index: u32) -> vec4f {
    return textureLoad(preintegration_pieces, vec2u(index % PREINTEGRATION_ROW, index / PREINTEGRATION_ROW), 0);
}

// Opacity of a piece of a depth, and how much more its near half is seen, and its ends than its middle.
fn preintegration_seen(t: f32) -> vec3f {
    if t < 0.5 {
        // The closed forms cancel here.
        let opacity = 1.0 / 120.0 + t * (-1.0 / 720.0 + t * (1.0 / 5040.0 - t / 40320.0));
        let skew = -1.0 / 80.0 + t * (1.0 / 360.0 + t * (-1.0 / 2016.0 + t / 13440.0));
        let bow = 1.0 / 2520.0 + t * (-1.0 / 12096.0 + t / 72576.0);
        return vec3f(
            t * (1.0 + t * (-0.5 + t * (1.0 / 6.0 + t * (-1.0 / 24.0 + t * opacity)))),
            t * t * (-1.0 / 12.0 + t * (1.0 / 24.0 + t * skew)),
            t * t * t * (1.0 / 360.0 + t * (-1.0 / 720.0 + t * bow)),
        );
    }
    let transmittance = exp(-t);
    let opacity = 1.0 - transmittance;
    let first = opacity / t - transmittance;
    let second = 2.0 * first / t - transmittance;
    return vec3f(opacity, first - 0.5 * opacity, second - first + opacity / 6.0);
}

// A cell of a table that is a share of a segment; of no extent behind the last one.
fn preintegration_cell(table: u32, cell: u32, share: f32) -> PreintegrationStretch {
    var stretch = preintegration_empty();
    if cell + 1u >= preintegration.size {
        return stretch;
    }
    let entry = 2u * (table * preintegration.size + cell) + 1u;
    let pieces = 2u * preintegration.tables * preintegration.size;
    let end = u32(preintegration_texel(entry + 2u).x);
    var index = u32(preintegration_texel(entry).x);
    for (var turn = 0u; index < end && turn < PREINTEGRATION_PIECES; turn++) {
        let first = pieces + 4u * index;
        let head = preintegration_texel(first);
        if share > head.y {
            // Its halves instead.
            index++;
            continue;
        }
        index = u32(head.z);
        let depth = head.x * share;
        let seen = preintegration_seen(depth);
        let even = preintegration_texel(first + 1u).xyz * seen.x + preintegration_texel(first + 3u).xyz * seen.z;
        let odd = preintegration_texel(first + 2u).xyz * seen.y;
        stretch = preintegration_then(stretch, PreintegrationStretch(even + odd, even - odd, depth, seen.x));
    }
    return stretch;
}

// The fourth number of an entry: its depth, or the share of light that passes through it; of great depths still a number
// that `transfer_depth` finds them by.
fn preintegration_fourth(depth: f32) -> f32 {
    if preintegration.has_transmittances == 0u {
        return depth;
    }
    return exp(-select(depth, 64.0 + log(max(depth, 64.0) / 64.0), depth > 64.0));
}

fn preintegration_write(table: u32, low: u32, cells: u32, stretch: PreintegrationStretch) {
    let high = low + cells;
    if high >= preintegration.size {
        return;
    }
    let tile = vec2u(table % preintegration.columns, table / preintegration.columns) * preintegration.size;
    let fourth = preintegration_fourth(stretch.depth);
    textureStore(table_out, tile + vec2u(low, high), vec4f(stretch.rising, fourth));
    textureStore(table_out, tile + vec2u(high, low), vec4f(stretch.falling, fourth));
}

@compute @workgroup_size(8, 1, 1)
fn preintegration_compute(@builtin(global_invocation_id) id: vec3u) {
    let table = id.z;
    let cells = id.y;
    let start = id.x * PREINTEGRATION_WINDOWS;
    if start + cells >= preintegration.size || table >= preintegration.tables {
        return;
    }
    let share = 1.0 / f32(max(cells, 1u));
    if cells < PREINTEGRATION_WINDOWS {
        for (var low = start; low < start + PREINTEGRATION_WINDOWS; low++) {
            var window = preintegration_empty();
            if cells == 0u {
                // One scalar all along.
                let entry = preintegration_texel(2u * (table * preintegration.size + min(low, preintegration.size - 1u)));
                let opacity = preintegration_seen(entry.w).x;
                window = PreintegrationStretch(entry.xyz * opacity, entry.xyz * opacity, entry.w, opacity);
            }
            for (var cell = low; cell < low + cells; cell++) {
                window = preintegration_then(window, preintegration_cell(table, cell, share));
            }
            preintegration_write(table, low, cells, window);
        }
        return;
    }
    // The cells that are in all windows, some at a time: a long sum of short terms would gather roundings.
    var shared_cells = preintegration_empty();
    for (var first = start + PREINTEGRATION_WINDOWS - 1u; first < start + cells; first += PREINTEGRATION_WINDOWS) {
        var some = preintegration_empty();
        for (var cell = first; cell < min(first + PREINTEGRATION_WINDOWS, start + cells); cell++) {
            some = preintegration_then(some, preintegration_cell(table, cell, share));
        }
        shared_cells = preintegration_then(shared_cells, some);
    }
    // With those before them, from the last window to the first.
    var tails: array<PreintegrationStretch, PREINTEGRATION_WINDOWS>;
    tails[PREINTEGRATION_WINDOWS - 1u] = shared_cells;
    for (var before = 1u; before < PREINTEGRATION_WINDOWS; before++) {
        let at = PREINTEGRATION_WINDOWS - 1u - before;
        shared_cells = preintegration_before(preintegration_cell(table, start + at, share), shared_cells);
        tails[at] = shared_cells;
    }
    // And with those behind them.
    var head = preintegration_empty();
    for (var at = 0u; at < PREINTEGRATION_WINDOWS; at++) {
        preintegration_write(table, start + at, cells, preintegration_then(tails[at], head));
        head = preintegration_then(head, preintegration_cell(table, start + cells + at, share));
    }
}
