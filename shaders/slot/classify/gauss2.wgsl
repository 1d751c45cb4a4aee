// Colour and opacity of a segment: two samples at the points of Gauss and Legendre, of order 4 in the step for smooth
// transfer functions and a smooth field. The depth between both points is that of the method's collocation matrix; the
// mean colour of the segment times its opacity stays right, and below the opacity, where the segment is opaque.
// @order 4
#import "lib/classified.wgsl"
#import "lib/transfer.wgsl"
#import slot "reconstruct"

// Half of the distance between both points, of the segment's length: sqrt(3) / 6.
const GAUSS2_AWAY: f32 = 0.28867513459;

fn gauss2_entry(ray: Ray, segment: Segment, place: f32) -> vec4f {
    return transfer_linear(reconstruct_scalar(ray_position(ray, segment.start + place * segment.length)));
}

fn classify_segment(ray: Ray, segment: Segment) -> Classified {
    let near = gauss2_entry(ray, segment, 0.5 - GAUSS2_AWAY);
    let far = gauss2_entry(ray, segment, 0.5 + GAUSS2_AWAY);
    let both = near.w + far.w;
    let halvings = segment.length * transfer.halvings_per_world;
    // Depths to the points are (1/4, 1/4 - sqrt(3)/6) and (1/4 + sqrt(3)/6, 1/4) times both extinctions. The first may be
    // negative; a mean colour needs their difference alone, which is not. Never 0, so that the far point still has a colour
    // where the near one has no extinction.
    let seen = max(exp2(-GAUSS2_AWAY * both * halvings), 1.0e-20) * far.w;
    let color = (near.w * near.xyz + seen * far.xyz) / max(near.w + seen, 1.0e-30);
    let transmittance = exp2(-0.5 * both * halvings);
    return Classified(color * (1.0 - transmittance), transmittance);
}
