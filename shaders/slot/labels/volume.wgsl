// What the volume is made of: what a volume of labels says, which may have a grid of its own. Two labels meet where
// their trilinear memberships are equal; a ray is cut there as at a clip (Röttger et al. 2003, section 2). Outside of the
// grid is label 0.
#import "lib/stretch.wgsl"
#import "lib/volume.wgsl"
#import slot "transfer_tables"

struct Segmentation {
    // Index coordinates of the labels (0 at the first voxel's centre) from texture coordinates of the volume.
    index_from_texture: mat4x4f,
    // World gradients from gradients per voxel of the labels.
    world_from_index_gradient: mat3x3f,
    dims: vec3f,
    // The box of the labels in index coordinates; farther out where the volume's own box ends there.
    box_low: vec3f,
    box_high: vec3f,
    // 1 where labels meet at the faces of voxels.
    is_blocky: u32,
    // Of each label: the row of its parameters, that of its transfer function, whether it is drawn.
    rows: array<vec4u, 256>,
}

@group(1) @binding(20) var<uniform> segmentation: Segmentation;
// A voxel's label, and in how many voxels to each side there is no other one.
@group(1) @binding(21) var label_texture: texture_3d<u32>;

// The labels of the eight voxels around a place, and how much of each counts there. x runs fastest, z slowest.
struct LabelsPlace {
    near: vec4u,
    far: vec4u,
    near_weights: vec4f,
    far_weights: vec4f,
}

// A ray in index coordinates of the labels.
struct LabelsRay {
    origin: vec3f,
    // Change per world unit, and its largest component.
    slope: vec3f,
    largest: f32,
    // World distances between which it is inside of the grid.
    near: f32,
    far: f32,
}

struct LabelsCut {
    distance: f32,
    // The label behind it.
    label: u32,
}

var<private> labels_chosen: u32 = 0xffffffffu;

// Strides of one search at most; each goes half a voxel at least.
const LABELS_MAX_STRIDES: u32 = 8192u;
// A boundary is looked for from here on, in voxels: what is nearer is the boundary that the ray starts at.
const LABELS_PROBE: f32 = 1.0e-3;
const LABELS_REFINEMENTS: u32 = 6u;

fn labels_load(index: vec3i) -> vec2u {
    return textureLoad(label_texture, clamp(index, vec3i(0), vec3i(segmentation.dims) - 1), 0).xy;
}

fn labels_place(index: vec3f) -> LabelsPlace {
    let at = clamp(index, vec3f(0.0), segmentation.dims - 1.0);
    let low = vec3i(at);
    let part = at - vec3f(low);
    let x = vec2f(1.0 - part.x, part.x);
    let flat = vec4f(x * (1.0 - part.y), x * part.y);
    var place: LabelsPlace;
    place.near = labels_square(low);
    place.far = labels_square(low + vec3i(0, 0, 1));
    place.near_weights = flat * (1.0 - part.z);
    place.far_weights = flat * part.z;
    return place;
}

fn labels_square(low: vec3i) -> vec4u {
    return vec4u(
        labels_load(low).x,
        labels_load(low + vec3i(1, 0, 0)).x,
        labels_load(low + vec3i(0, 1, 0)).x,
        labels_load(low + vec3i(1, 1, 0)).x,
    );
}

// How much of a place is one label's, 0 to 1.
fn labels_membership(place: LabelsPlace, label: u32) -> f32 {
    let wanted = vec4u(label);
    return dot(place.near_weights, vec4f(place.near == wanted)) + dot(place.far_weights, vec4f(place.far == wanted));
}

// How much more a place is one label's than another's.
fn labels_lead(place: LabelsPlace, label: u32, rival: u32) -> f32 {
    return labels_membership(place, label) - labels_membership(place, rival);
}

// The label that has most of a place; of two with as much the lower one.
fn labels_of(place: LabelsPlace) -> u32 {
    let label = place.near.x;
    if all(place.near == vec4u(label)) && all(place.far == vec4u(label)) {
        return label;
    }
    return labels_better(place, labels_best(place, place.near), labels_best(place, place.far));
}

// The one of four labels that has most of a place.
fn labels_best(place: LabelsPlace, labels: vec4u) -> u32 {
    return labels_better(place, labels_better(place, labels.x, labels.y), labels_better(place, labels.z, labels.w));
}

// The one of two labels that has more of a place; of two with as much the lower one.
fn labels_better(place: LabelsPlace, a: u32, b: u32) -> u32 {
    let lead = labels_lead(place, a, b);
    return select(select(b, a, lead > 0.0), min(a, b), lead == 0.0);
}

// The label at index coordinates inside of the grid.
fn labels_inside(index: vec3f) -> u32 {
    if segmentation.is_blocky == 1u {
        return labels_load(vec3i(round(index))).x;
    }
    return labels_of(labels_place(index));
}

// Index coordinates at texture coordinates of the volume.
fn labels_index(position: vec3f) -> vec3f {
    return (segmentation.index_from_texture * vec4f(position, 1.0)).xyz;
}

// The label at a position in texture coordinates.
fn labels_at(position: vec3f) -> u32 {
    let index = labels_index(position);
    if any(index < segmentation.box_low) || any(index > segmentation.box_high) {
        return 0u;
    }
    return labels_inside(index);
}

fn labels_ray(ray: Ray) -> LabelsRay {
    let origin = labels_index(ray.entry);
    let slope = (segmentation.index_from_texture * vec4f(ray.slope, 0.0)).xyz;
    let divisor = labels_divisor(slope);
    let a = (segmentation.box_low - origin) / divisor;
    let b = (segmentation.box_high - origin) / divisor;
    let first = min(a, b);
    let last = max(a, b);
    let largest = max(max(abs(slope.x), abs(slope.y)), max(abs(slope.z), 1.0e-20));
    let near = max(max(first.x, first.y), first.z);
    return LabelsRay(origin, slope, largest, near, min(min(last.x, last.y), last.z));
}

// A slope that can be divided by.
fn labels_divisor(slope: vec3f) -> vec3f {
    return select(slope, vec3f(1.0e-20), abs(slope) < vec3f(1.0e-20));
}

fn labels_along(ray: LabelsRay, distance: f32) -> vec3f {
    return ray.origin + distance * ray.slope;
}

// World normal, towards the eye, from a gradient per voxel of the labels.
fn labels_facing(gradient: vec3f, direction: vec3f) -> vec3f {
    let world = segmentation.world_from_index_gradient * gradient;
    let magnitude = length(world);
    if magnitude < 1.0e-20 {
        return -direction;
    }
    return world / select(magnitude, -magnitude, dot(world, direction) > 0.0);
}

// Of the face of an axis-aligned box that the ray passes at index coordinates `at`; `size` are its half sides.
fn labels_face_normal(at: vec3f, centre: vec3f, half: vec3f, direction: vec3f) -> vec3f {
    let away = abs(at - centre) - half;
    let is_face = vec3f(away >= vec3f(max(max(away.x, away.y), away.z)));
    return labels_facing(is_face * sign(at - centre), direction);
}

fn labels_change(index: vec3f, aside: vec3f, label: u32, rival: u32) -> f32 {
    return labels_lead(labels_place(index + aside), label, rival) - labels_lead(labels_place(index - aside), label, rival);
}

// Of the boundary of two labels: the gradient of how much one leads, over half a voxel to each side.
fn labels_normal(index: vec3f, label: u32, rival: u32, direction: vec3f) -> vec3f {
    let gradient = vec3f(
        labels_change(index, vec3f(0.5, 0.0, 0.0), label, rival),
        labels_change(index, vec3f(0.0, 0.5, 0.0), label, rival),
        labels_change(index, vec3f(0.0, 0.0, 0.5), label, rival),
    );
    return labels_facing(gradient, direction);
}

// Between two places less than a voxel apart, of which the first has most of a label: one where it has not, 0 where
// there seems to be none. A ray that only dips into another label is caught by the vertex of the parabola through the
// memberships at both ends and half-way.
fn labels_other(ray: LabelsRay, first: f32, last: f32, label: u32) -> f32 {
    let half_way = 0.5 * (first + last);
    let middle = labels_place(labels_along(ray, half_way));
    if labels_of(middle) != label {
        return half_way;
    }
    let end = labels_place(labels_along(ray, last));
    if labels_of(end) != label {
        return last;
    }
    let share = labels_membership(middle, label);
    let before = labels_membership(labels_place(labels_along(ray, first)), label) - share;
    let after = labels_membership(end, label) - share;
    let bend = before + after;
    if bend <= 1.0e-6 || abs(before - after) >= 2.0 * bend {
        return 0.0;
    }
    let vertex = half_way + 0.25 * (before - after) / bend * (last - first);
    return select(0.0, vertex, labels_of(labels_place(labels_along(ray, vertex))) != label);
}

// Between a place where a label has most and one where it has not: where it ends first. By secants, of which an end
// that stays twice counts half (the Illinois method); a third label that shows up takes the second one's place.
fn labels_cut(ray: LabelsRay, first: f32, last: f32, label: u32) -> LabelsCut {
    var low = first;
    var high = last;
    let end = labels_place(labels_along(ray, last));
    var rival = labels_of(end);
    var low_lead = labels_lead(labels_place(labels_along(ray, first)), label, rival);
    var high_lead = labels_lead(end, label, rival);
    // The end that the turn before has moved.
    var side = 0;
    for (var turn = 0u; turn < LABELS_REFINEMENTS; turn++) {
        let between = labels_secant(low, high, low_lead, high_lead);
        let place = labels_place(labels_along(ray, between));
        let found = labels_of(place);
        if found == label {
            low = between;
            low_lead = labels_lead(place, label, rival);
            high_lead *= select(1.0, 0.5, side < 0);
            side = -1;
        } else {
            high = between;
            low_lead *= select(1.0, 0.5, side > 0);
            side = 1;
            if found != rival {
                rival = found;
                low_lead = labels_lead(labels_place(labels_along(ray, low)), label, rival);
            }
            high_lead = labels_lead(place, label, rival);
        }
    }
    return LabelsCut(labels_secant(low, high, low_lead, high_lead), rival);
}

fn labels_secant(low: f32, high: f32, low_lead: f32, high_lead: f32) -> f32 {
    let fall = low_lead - high_lead;
    return mix(low, high, select(0.5, clamp(low_lead / fall, 0.0, 1.0), fall > 1.0e-7));
}

// The stretch of one label at the ray's entry, up to a world distance from it at most.
fn labels_next(whole: Ray, end: f32) -> Stretch {
    let ray = labels_ray(whole);
    let probe = max(LABELS_PROBE / ray.largest, 2.0 * volume_least());
    var at = min(probe, 0.5 * end);
    var label = 0u;
    if at >= ray.near && at <= ray.far {
        label = labels_inside(labels_along(ray, at));
    }
    let centre = 0.5 * (segmentation.box_low + segmentation.box_high);
    let half = segmentation.box_high - centre;
    for (var stride = 0u; stride < LABELS_MAX_STRIDES; stride++) {
        if at < ray.near && ray.near < min(ray.far, end) {
            at = ray.near + probe;
            if labels_inside(labels_along(ray, at)) != label {
                let normal = labels_face_normal(labels_along(ray, ray.near), centre, half, whole.direction);
                return Stretch(ray.near, label, normal);
            }
        }
        if at < ray.near || at >= min(ray.far, end) {
            break;
        }
        let index = labels_along(ray, at);
        let voxel = clamp(round(index), vec3f(0.0), segmentation.dims - 1.0);
        let room = f32(labels_load(vec3i(voxel)).y);
        // In this cube there is one label alone.
        let reach = select(room, room + 0.5, segmentation.is_blocky == 1u);
        let exits = (voxel + sign(ray.slope) * reach - index) / labels_divisor(ray.slope);
        let limits = select(vec3f(3.0e38), exits, ray.slope != vec3f(0.0));
        var length = min(min(limits.x, limits.y), limits.z);
        if segmentation.is_blocky == 1u {
            let face = at + max(length, 0.0);
            let next = face + probe;
            if next < min(ray.far, end) && labels_inside(labels_along(ray, next)) != label {
                return Stretch(face, label, labels_face_normal(labels_along(ray, face), voxel, vec3f(reach), whole.direction));
            }
            at = next;
            continue;
        }
        if room > 0.0 {
            at += max(length, 0.25 / ray.largest);
            continue;
        }
        let next = min(at + 0.5 / ray.largest, min(ray.far, end));
        let other = labels_other(ray, at, next, label);
        if other > at {
            let cut = labels_cut(ray, at, other, label);
            return Stretch(cut.distance, label, labels_normal(labels_along(ray, cut.distance), label, cut.label, whole.direction));
        }
        at = next;
    }
    // Outside of the grid is label 0.
    if label != 0u && ray.far > 0.0 && ray.far < end && at >= ray.far {
        return Stretch(ray.far, label, labels_face_normal(labels_along(ray, ray.far), centre, half, whole.direction));
    }
    return Stretch(end, label, vec3f(0.0));
}

// Whether a label is drawn.
fn labels_is_visible(label: u32) -> bool {
    return segmentation.rows[label].z != 0u;
}

// Makes the parameters and the transfer function those of a label, or the node's own for STRETCH_NO_LABEL.
fn labels_select(label: u32) {
    if label == labels_chosen {
        return;
    }
    labels_chosen = label;
    var row = vec4u(0u);
    if label < STRETCH_NO_LABEL {
        row = segmentation.rows[label];
    }
    params_select(row.x);
    transfer_select(row.y);
}

// The label that was selected last.
fn labels_selected() -> u32 {
    return labels_chosen;
}
