// Clip shapes: what is left of a ray by a shape that it is inside of between two distances.
#import "lib/step.wgsl"

// Both stay in the uniform: as constants they make the compiler of llvmpipe's Vulkan (Mesa 22.3) crash on the clip `box`.
struct Params {
    /// What is kept of the volume: what lies inside of the clip shape, or what lies outside. @default inside @choices inside outside
    /// @uniform
    clip_keep: u32,
    /// Where segments end at the clip shape: `accurate` at its surface, whatever the step is (Röttger et al. 2003,
    /// section 2); `naive` draws each segment whole whose front is visible (their appendix 8.1), to compare.
    /// @default accurate @choices accurate naive @uniform
    clip_method: u32,
}

fn clip_keeps_outside() -> bool {
    return params.clip_keep == 1u;
}

fn clip_is_naive() -> bool {
    return params.clip_method == 1u;
}

// The first part of a ray that is visible where it is inside of a convex shape between two world distances from its
// entry (the first larger for nowhere): where it starts and ends, the same twice for none.
fn clip_part(ray: Ray, inside: vec2f) -> vec2f {
    let length = ray.far - ray.near;
    let first = clamp(inside.x, 0.0, length);
    let last = clamp(inside.y, first, length);
    if !clip_keeps_outside() {
        return clip_snapped(vec2f(first, last), length);
    }
    if last - first <= volume_least() {
        return vec2f(0.0, length);
    }
    let before = clip_snapped(vec2f(0.0, first), length);
    // What is left of a part that has been shown already is no part.
    if before.y - before.x > volume_least() {
        return before;
    }
    return clip_snapped(vec2f(last, length), length);
}

// A visible part as the method draws it. Naively those segments are drawn whose fronts, whole steps from the entry,
// are in it: an entry is that of the box, or a whole number of steps behind it.
fn clip_snapped(part: vec2f, length: f32) -> vec2f {
    if !clip_is_naive() {
        return part;
    }
    let step = step_world();
    return min(ceil((part - volume_least()) / step) * step, vec2f(length));
}

// The world normal, towards the eye, of a cut from any normal of its surface. Naively nothing is cut.
fn clip_facing(normal: vec3f, ray: Ray) -> vec3f {
    let magnitude = length(normal);
    if clip_is_naive() || magnitude < 1.0e-20 {
        return vec3f(0.0);
    }
    return normal / select(magnitude, -magnitude, dot(normal, ray.direction) > 0.0);
}
