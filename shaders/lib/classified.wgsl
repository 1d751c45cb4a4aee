// What classification makes of a segment.
#import "lib/ray.wgsl"

struct Classified {
    // Premultiplied: what the segment emits towards the eye, attenuated inside of the segment.
    color: vec3f,
    // The share of light that passes through the segment.
    transmittance: f32,
}

fn classified_behind(front: Classified, back: Classified) -> Classified {
    return Classified(front.color + front.transmittance * back.color, front.transmittance * back.transmittance);
}
