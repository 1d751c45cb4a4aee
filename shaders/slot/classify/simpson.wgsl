// Colour and opacity of a segment: its two ends and its centre by Simpson's rule, of order 4 in the step for smooth
// transfer functions and a smooth field, with one more sample than the walk takes. The depth to the centre is that of the
// Lobatto IIIA method; the mean colour of the segment times its opacity stays right where the segment is opaque.
// @order 4
#import "lib/classified.wgsl"
#import "lib/transfer.wgsl"
#import slot "reconstruct"

fn classify_segment(ray: Ray, segment: Segment) -> Classified {
    let front = transfer_linear(segment.front.scalar);
    let centre = transfer_linear(reconstruct_scalar(segment_centre(ray, segment)));
    let back = transfer_linear(segment.back.scalar);
    let halvings = segment.length * transfer.halvings_per_world;
    let depth = (front.w + 4.0 * centre.w + back.w) / 6.0 * halvings;
    // A parabola through the three extinctions may dip below 0: neither half is less than empty.
    let half_depth = clamp((5.0 * front.w + 8.0 * centre.w - back.w) / 24.0 * halvings, 0.0, depth);
    // Never 0, so that there is a colour where what is in front has no extinction.
    let far = max(exp2(half_depth - depth), 1.0e-20) * back.w;
    let near = max(exp2(-half_depth), 1.0e-20);
    let sum = front.w + near * (4.0 * centre.w + far);
    let color = front.w * front.xyz + near * (4.0 * centre.w * centre.xyz + far * back.xyz);
    let transmittance = exp2(-depth);
    return Classified(color / max(sum, 1.0e-30) * (1.0 - transmittance), transmittance);
}
