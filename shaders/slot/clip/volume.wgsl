// Which part of the ray is visible: that where another volume, at `clip_volume`, is above an isovalue, or below it.
// That has no closed form along a ray: the clip volume is looked at in steps of its own, and where its side changes
// between two, the crossing is interpolated (Röttger et al. 2003, section 2) and refined. Two crossings in one of its
// steps may be lost. Around its box the clip volume goes on with its nearest value.
#import "lib/clip.wgsl"
#import slot "clip_volume_filter"

struct Params {
    /// The clip volume's value on the clip surface; inside is where it is above. @default 0.5
    clip_isovalue: f32,
    /// The unit of `clip_isovalue`: `range`, 0 to 1 over the values that the clip volume has; `normalised`, over the range
    /// of the stored type (of floats: of the data); or `data`. @default range @choices range normalised data
    clip_isovalue_unit: u32,
    /// Where the clip volume is: at its own place in the `world`, or laid over the volume's `box`, axis by axis.
    /// @default world @choices world box
    clip_volume_place: u32,
    /// Length of the steps in which the clip volume is looked at, in voxels of its own along the axis of which the ray
    /// crosses most. @default 1.0 @range 0.01 64.0 @unit voxel
    clip_step: f32,
}

@group(1) @binding(12) var<uniform> clip_placement: Volume;

// A ray in texture coordinates of the clip volume: its entry, and the change per world unit.
struct ClipVolumeLine {
    entry: vec3f,
    slope: vec3f,
}

// Turns of a walk; longer ones are refused before (software drivers end every loop after as many).
const CLIP_VOLUME_TURNS: u32 = 65535u;
// Steps that a visible part is looked at ahead: a ray that ends early does not look at the rest.
const CLIP_VOLUME_AHEAD: f32 = 16.0;
// Samples that refine a crossing: where the field bends at a voxel's face close by, the first ones help little.
const CLIP_VOLUME_REFINEMENTS: u32 = 8u;

// Texture coordinates of the clip volume per texture coordinate of the volume, where it is laid over its box.
fn clip_volume_scale() -> vec3f {
    return (clip_placement.box_high - clip_placement.box_low) / (volume.box_high - volume.box_low);
}

fn clip_volume_line(ray: Ray) -> ClipVolumeLine {
    if params.clip_volume_place == 1u {
        let scale = clip_volume_scale();
        return ClipVolumeLine(clip_placement.box_low + (ray.entry - volume.box_low) * scale, ray.slope * scale);
    }
    let entry = clip_placement.texture_from_world * vec4f(ray_world(ray, 0.0), 1.0);
    return ClipVolumeLine(entry.xyz, (clip_placement.texture_from_world * vec4f(ray.direction, 0.0)).xyz);
}

// How far a position is above the isovalue, in data units.
fn clip_volume_above(position: vec3f) -> f32 {
    let value = clip_volume_filter(position) * clip_placement.value_scale + clip_placement.value_offset;
    return value - volume_scalar(clip_placement, params.clip_isovalue, params.clip_isovalue_unit);
}

// The same along a line, with the sign that what is visible is not below 0.
fn clip_volume_side(line: ClipVolumeLine, distance: f32) -> f32 {
    let above = clip_volume_above(line.entry + distance * line.slope);
    return select(above, -above, clip_keeps_outside());
}

// The crossing between two distances with different sides: the rule of false position; the end that stays for a
// second time counts half (the Illinois rule), so that both close in.
fn clip_volume_crossing(line: ClipVolumeLine, distances: vec2f, sides: vec2f) -> f32 {
    var ends = distances;
    var values = sides;
    var kept = 0;
    for (var turn = 0u; turn < CLIP_VOLUME_REFINEMENTS; turn++) {
        let at = mix(ends.x, ends.y, values.x / (values.x - values.y));
        let side = clip_volume_side(line, at);
        if (side >= 0.0) == (values.x >= 0.0) {
            ends.x = at;
            values = vec2f(side, select(values.y, 0.5 * values.y, kept == 1));
            kept = 1;
        } else {
            ends.y = at;
            values = vec2f(select(values.x, 0.5 * values.x, kept == 2), side);
            kept = 2;
        }
    }
    // Where a side is exactly 0 on both ends, either is the crossing.
    let span = values.x - values.y;
    return mix(ends.x, ends.y, select(values.x / span, 0.0, span == 0.0));
}

// Visible segments by the side of their fronts, whole steps from the entry.
fn clip_volume_naive(ray: Ray, line: ClipVolumeLine) -> vec2f {
    let length = ray.far - ray.near;
    let step = step_world();
    var start = -1.0;
    for (var turn = 0u; f32(turn) * step < length && turn < CLIP_VOLUME_TURNS; turn++) {
        let front = f32(turn) * step;
        let is_visible = clip_volume_side(line, front) >= 0.0;
        if start >= 0.0 && (!is_visible || front - start >= CLIP_VOLUME_AHEAD * step) {
            return vec2f(start, front);
        }
        if is_visible && start < 0.0 {
            start = front;
        }
    }
    return select(vec2f(0.0), vec2f(start, length), start >= 0.0);
}

// World distances from the ray's entry: where the first visible part starts and ends; the same twice for none. A part
// that ends in sight goes on in the next, with no cut between.
fn clip_next(ray: Ray) -> vec2f {
    let line = clip_volume_line(ray);
    if clip_is_naive() {
        return clip_volume_naive(ray, line);
    }
    let length = ray.far - ray.near;
    let voxels = abs(line.slope) * clip_placement.dims;
    let march = params.clip_step / max(max(max(voxels.x, voxels.y), voxels.z), 1.0e-20);
    // Whole steps, so that a part which goes on has no shorter segment; less the rounding that would begin another one.
    let ahead = max(ceil(CLIP_VOLUME_AHEAD * march / step_world()), 1.0) * step_world() - volume_least();
    var from_distance = 0.0;
    var front = clip_volume_side(line, 0.0);
    var start = select(-1.0, 0.0, front >= 0.0);
    for (var turn = 1u; from_distance < length && turn <= CLIP_VOLUME_TURNS; turn++) {
        let to_distance = min(f32(turn) * march, length);
        let back = clip_volume_side(line, to_distance);
        if (front >= 0.0) != (back >= 0.0) {
            let crossing = clip_volume_crossing(line, vec2f(from_distance, to_distance), vec2f(front, back));
            if back >= 0.0 {
                start = crossing;
            } else {
                // What is left of a part that has been shown already is no part.
                if crossing - start > volume_least() {
                    return vec2f(start, crossing);
                }
                start = -1.0;
            }
        }
        if start >= 0.0 && to_distance - start >= ahead {
            return vec2f(start, start + ahead);
        }
        from_distance = to_distance;
        front = back;
    }
    return select(vec2f(0.0), vec2f(start, length), start >= 0.0);
}

// World normal, towards the eye, of the cut at a distance from the ray's entry where a visible part starts: along the
// clip volume's gradient, by central differences of one voxel to each side.
fn clip_normal(ray: Ray, distance: f32) -> vec3f {
    let line = clip_volume_line(ray);
    let at = line.entry + distance * line.slope;
    let h = 1.0 / clip_placement.dims;
    let gradient = clip_placement.dims * vec3f(
        clip_volume_above(at + vec3f(h.x, 0.0, 0.0)) - clip_volume_above(at - vec3f(h.x, 0.0, 0.0)),
        clip_volume_above(at + vec3f(0.0, h.y, 0.0)) - clip_volume_above(at - vec3f(0.0, h.y, 0.0)),
        clip_volume_above(at + vec3f(0.0, 0.0, h.z)) - clip_volume_above(at - vec3f(0.0, 0.0, h.z)),
    );
    // Gradients are covectors: by the transpose of what takes world positions to texture coordinates.
    if params.clip_volume_place == 1u {
        return clip_facing((transpose(volume.texture_from_world) * vec4f(gradient * clip_volume_scale(), 0.0)).xyz, ray);
    }
    return clip_facing((transpose(clip_placement.texture_from_world) * vec4f(gradient, 0.0)).xyz, ray);
}
