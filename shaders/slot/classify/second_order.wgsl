// Colour and opacity of a segment: pre-integrated along a scalar that runs through front, centre and back as a parabola
// ("second-order pre-integration"). The table of half segments gives two runs: `bent` straight to the centre's scalar and
// on, `straight` from front to back. What each of them misses is, to first order, in proportion to its distance from the
// parabola: a quarter for the bent one. So (4 bent - straight) / 3 misses nothing of that order. Order 4 in the step
// where field and transfer function are smooth, 3 across knots of the transfer function.
// @order 4
#import "lib/classified.wgsl"
#import "lib/transfer.wgsl"
#import slot "reconstruct"

// Premultiplied colour and depth of half a segment whose scalar runs straight. What leaves the table is cut there.
fn second_order_half(front: f32, back: f32, part: f32) -> vec4f {
    let ends = (vec2f(front, back) - transfer.low) * transfer.half_per_scalar;
    let inside = clamp(ends, vec2f(0.0), vec2f(transfer.half_last));
    if !transfer_reach_is_short() || all(inside == ends) {
        return second_order_within(inside, part);
    }
    let parts = transfer_shares(ends, transfer.half_last) * part;
    let before = second_order_within(inside.xx, parts.x);
    let between = second_order_within(inside, parts.y);
    let behind = second_order_within(inside.yy, parts.z);
    let rest = vec4f(between.xyz + exp(-between.w) * behind.xyz, between.w + behind.w);
    return vec4f(before.xyz + exp(-before.w) * rest.xyz, before.w + rest.w);
}

fn second_order_within(ends: vec2f, part: f32) -> vec4f {
    let entry = transfer_half_entries(ends);
    if abs(part - 1.0) < 1.0e-4 {
        return entry;
    }
    // The table is made for one length. With the same run backwards there are two facts, what is emitted and on which side
    // more of it; each is seen through the other depth. What that misses is of the fifth order in the length.
    let other = transfer_half_entries(ends.yx);
    let depth = entry.w * part;
    let opacity = max(1.0 - exp(-entry.w), 1.0e-12);
    let share = select(part, (1.0 - exp(-depth)) / opacity, entry.w > 1.0e-4);
    let skew = second_order_skew(depth, entry.w, part);
    return vec4f(0.5 * (share * (entry.xyz + other.xyz) + skew * (entry.xyz - other.xyz)), depth);
}

// How much more the near side counts at a depth than at the table's: the ratio of 1/2 (1 + exp(-x)) - (1 - exp(-x)) / x.
fn second_order_skew(depth: f32, whole: f32, part: f32) -> f32 {
    if max(depth, whole) < 0.05 {
        return part * part * (1.0 + 0.5 * (whole - depth));
    }
    return second_order_lean(depth) / second_order_lean(whole);
}

fn second_order_lean(x: f32) -> f32 {
    if x < 0.05 {
        return x * x / 12.0 * (1.0 - 0.5 * x);
    }
    return 0.5 * (1.0 + exp(-x)) - (1.0 - exp(-x)) / x;
}

// Mean colour and depth of a segment whose scalar runs straight to the middle, and straight on.
fn second_order_run(front: f32, middle: f32, back: f32, part: f32) -> vec4f {
    let near = second_order_half(front, middle, part);
    let far = second_order_half(middle, back, part);
    let depth = near.w + far.w;
    return vec4f((near.xyz + exp(-near.w) * far.xyz) / max(1.0 - exp(-depth), 1.0e-12), depth);
}

fn classify_segment(ray: Ray, segment: Segment) -> Classified {
    let front = segment.front.scalar;
    let back = segment.back.scalar;
    let part = 0.5 * segment.length / transfer.half_length;
    let centre = reconstruct_scalar(segment_centre(ray, segment));
    let bent = second_order_run(front, centre, back, part);
    let straight = second_order_run(front, 0.5 * (front + back), back, part);
    // Where one run meets a peak that the other one passes by, their difference says nothing. The bent run is trusted up
    // to a quarter of the smaller depth, and its colour is corrected by as much of what is left. Colours stay among those
    // that the transfer function has: what is right is among them, so this only brings them nearer.
    let change = (bent - straight) / 3.0;
    let trust = min(0.25 * min(bent.w, straight.w) / max(abs(change.w), 1.0e-30), 1.0);
    let mean = bent + trust * change;
    let transmittance = exp(-mean.w);
    let color = clamp(mean.xyz, transfer.color_least, transfer.color_most);
    return Classified(color * (1.0 - transmittance), transmittance);
}
