// The cells that a ray runs through, and the cubic polynomial that the trilinear field is along the ray in each of them
// (Marmitt et al. 2004, "Fast and accurate ray-voxel intersection techniques for iso-surface ray tracing"). A cell is
// the cube between eight voxel centres. Voxels beside the grid repeat those at its edge, so that cells there are the
// clamped outer half voxel of the box.
#import "lib/volume.wgsl"

// A stretch of a ray inside of one cell.
struct Cell {
    // The voxel at the cell's low corner; -1 along an axis where the cell begins beside the grid.
    index: vec3i,
    // World distances from the ray's entry: where the stretch starts and ends, and where the walk does.
    start: f32,
    end: f32,
    limit: f32,
}

// The scalars at a cell's corners; x runs fastest, then y. `low` is the plane of the low z.
struct CellValues {
    low: vec4f,
    high: vec4f,
}

// More than a ray can meet in a grid of 2048 voxels to each side.
const CELL_MAX: u32 = 8192u;

// The first stretch of the walk over the cells between two world distances from the ray's entry.
fn cell_begin(ray: Ray, start: f32, limit: f32) -> Cell {
    let index = vec3i(floor(cell_from_voxel(ray, vec3i(0), start)));
    return Cell(index, start, clamp(cell_exit(ray, index).x, start, limit), limit);
}

// Moves on to the next cell; false where the walk has come to its end.
fn cell_next(ray: Ray, cell: ptr<function, Cell>) -> bool {
    let walked = *cell;
    if walked.end >= walked.limit {
        return false;
    }
    let axis = i32(cell_exit(ray, walked.index).y);
    let unit = vec3i(vec3(axis == 0, axis == 1, axis == 2));
    let index = walked.index + unit * vec3i(sign(ray.slope));
    // Where the ray meets an edge, rounding may put one face before the other: then the stretch between has no length.
    *cell = Cell(index, walked.end, clamp(cell_exit(ray, index).x, walked.end, walked.limit), walked.limit);
    return true;
}

// World distance from the ray's entry to where it leaves a cell, from the face's own place: nothing adds up. The axis of
// the face comes second.
fn cell_exit(ray: Ray, index: vec3i) -> vec2f {
    let slope = ray.slope * volume.dims;
    let face = vec3f(index) + max(sign(slope), vec3f(0.0)) + 0.5 - ray.entry * volume.dims;
    // A ray along a face never meets it.
    let is_along = abs(slope) < vec3f(1.0e-20);
    let exit = select(face / select(slope, vec3f(1.0), is_along), vec3f(3.0e38), is_along);
    if exit.x <= exit.y && exit.x <= exit.z {
        return vec2f(exit.x, 0.0);
    }
    return select(vec2f(exit.z, 2.0), vec2f(exit.y, 1.0), exit.y <= exit.z);
}

// Place on a ray counted in voxels from a voxel's centre.
fn cell_from_voxel(ray: Ray, index: vec3i, distance: f32) -> vec3f {
    return (ray.entry * volume.dims - 0.5 - vec3f(index)) + distance * (ray.slope * volume.dims);
}

// Place inside of a cell, 0 to 1 along each axis.
fn cell_place(ray: Ray, index: vec3i, distance: f32) -> vec3f {
    return clamp(cell_from_voxel(ray, index, distance), vec3f(0.0), vec3f(1.0));
}

// The scalars at the corners of a cell less a level: the digits of what lies near the level are kept.
fn cell_values(index: vec3i, level: f32) -> CellValues {
    let low = vec4f(
        volume_voxel(index),
        volume_voxel(index + vec3i(1, 0, 0)),
        volume_voxel(index + vec3i(0, 1, 0)),
        volume_voxel(index + vec3i(1, 1, 0)),
    );
    let high = vec4f(
        volume_voxel(index + vec3i(0, 0, 1)),
        volume_voxel(index + vec3i(1, 0, 1)),
        volume_voxel(index + vec3i(0, 1, 1)),
        volume_voxel(index + vec3i(1, 1, 1)),
    );
    return CellValues(low - level, high - level);
}

// The same for the cell that a ray comes to from a face of another one, whose corners are known: half of them are new.
fn cell_values_behind(known: CellValues, from_index: vec3i, index: vec3i, level: f32) -> CellValues {
    let way = index - from_index;
    let is_back = way.x + way.y + way.z < 0;
    // The far face, by its two other axes.
    let u = select(vec3i(1, 0, 0), vec3i(0, 1, 0), way.x != 0);
    let v = select(vec3i(0, 0, 1), vec3i(0, 1, 0), way.z != 0);
    let corner = index + max(way, vec3i(0));
    let face = vec4f(
        volume_voxel(corner),
        volume_voxel(corner + u),
        volume_voxel(corner + v),
        volume_voxel(corner + u + v),
    ) - level;
    if way.z != 0 {
        return CellValues(select(known.high, face, is_back), select(known.low, face, !is_back));
    }
    let low = known.low;
    let high = known.high;
    if way.x != 0 {
        let far = CellValues(vec4f(low.y, face.x, low.w, face.y), vec4f(high.y, face.z, high.w, face.w));
        let near = CellValues(vec4f(face.x, low.x, face.y, low.z), vec4f(face.z, high.x, face.w, high.z));
        return CellValues(select(far.low, near.low, is_back), select(far.high, near.high, is_back));
    }
    let far = CellValues(vec4f(low.zw, face.xy), vec4f(high.zw, face.zw));
    let near = CellValues(vec4f(face.xy, low.xy), vec4f(face.zw, high.xy));
    return CellValues(select(far.low, near.low, is_back), select(far.high, near.high, is_back));
}

// Trilinear between a cell's corners, at a place in it.
fn cell_scalar(values: CellValues, place: vec3f) -> f32 {
    let plane = mix(values.low, values.high, place.z);
    let line = mix(plane.xy, plane.zw, place.y);
    return mix(line.x, line.y, place.x);
}

// Gradient between a cell's corners, at a place in it, per voxel along the index axes.
fn cell_gradient(values: CellValues, place: vec3f) -> vec3f {
    let plane = mix(values.low, values.high, place.z);
    let line = mix(plane.xy, plane.zw, place.y);
    let along_y = plane.zw - plane.xy;
    let along_z = values.high - values.low;
    let along_z_line = mix(along_z.xy, along_z.zw, place.y);
    return vec3f(
        line.y - line.x,
        mix(along_y.x, along_y.y, place.x),
        mix(along_z_line.x, along_z_line.y, place.x),
    );
}

// The trilinear field along the stretch: x + y w + z w^2 + w w^3, where w runs from 0 at its start to 1 at its end.
fn cell_cubic(ray: Ray, cell: Cell, values: CellValues) -> vec4f {
    let place = cell_place(ray, cell.index, cell.start);
    let change = cell_place(ray, cell.index, cell.end) - place;
    // Four edges along z, linear in w; between them two lines along y, of degree 2; between those the cubic.
    let rise = values.high - values.low;
    let edge = values.low + rise * place.z;
    let edge_1 = rise * change.z;
    let across = edge.zw - edge.xy;
    let across_1 = edge_1.zw - edge_1.xy;
    let line = edge.xy + across * place.y;
    let line_1 = edge_1.xy + across_1 * place.y + across * change.y;
    let line_2 = across_1 * change.y;
    return vec4f(
        line.x + (line.y - line.x) * place.x,
        line_1.x + (line_1.y - line_1.x) * place.x + (line.y - line.x) * change.x,
        line_2.x + (line_2.y - line_2.x) * place.x + (line_1.y - line_1.x) * change.x,
        (line_2.y - line_2.x) * change.x,
    );
}

// A cubic at w between 0 and 1.
fn cell_cubic_at(cubic: vec4f, w: f32) -> f32 {
    return ((cubic.w * w + cubic.z) * w + cubic.y) * w + cubic.x;
}

fn cell_cubic_slope(cubic: vec4f, w: f32) -> f32 {
    return (3.0 * cubic.w * w + 2.0 * cubic.z) * w + cubic.y;
}

// The extremes of a cubic between 0 and 1, in order; 1 in the place of those that it has not.
fn cell_cubic_extremes(cubic: vec4f) -> vec2f {
    let a = 3.0 * cubic.w;
    let discriminant = cubic.z * cubic.z - a * cubic.y;
    if discriminant <= 0.0 {
        return vec2f(1.0);
    }
    // Of the two forms of each root the one that does not cancel.
    let root = sqrt(discriminant);
    let q = -cubic.z - select(root, -root, cubic.z < 0.0);
    let is_first = abs(cubic.y) < abs(q) && cubic.y * sign(q) > 0.0;
    let is_second = abs(q) < abs(a) && q * sign(a) > 0.0;
    let first = select(1.0, cubic.y / select(1.0, q, is_first), is_first);
    let second = select(1.0, q / select(1.0, a, is_second), is_second);
    return vec2f(min(first, second), max(first, second));
}

// Turns until a root is as good as its rounding, even where halving alone brings it nearer.
const CELL_ROOT_TURNS: u32 = 32u;

// The root of a cubic between two places where it changes its sign and has no extreme; `is_above` says that it is not
// negative at the first. Newton's steps, halving where they leave the bracket.
fn cell_cubic_root(cubic: vec4f, first: f32, second: f32, is_above: bool) -> f32 {
    var low = first;
    var high = second;
    let front = cell_cubic_at(cubic, low);
    let back = cell_cubic_at(cubic, high);
    var w = 0.5 * (low + high);
    if (front >= 0.0) != (back >= 0.0) {
        w = low + (high - low) * (front / (front - back));
    }
    for (var turn = 0u; turn < CELL_ROOT_TURNS; turn++) {
        let value = cell_cubic_at(cubic, w);
        if (value >= 0.0) == is_above {
            low = w;
        } else {
            high = w;
        }
        let slope = cell_cubic_slope(cubic, w);
        var next = w - value / select(slope, 1.0, slope == 0.0);
        if slope == 0.0 || !(next >= low && next <= high) {
            next = 0.5 * (low + high);
        }
        let moved = abs(next - w);
        w = next;
        if moved <= 6.0e-8 {
            break;
        }
    }
    return w;
}
