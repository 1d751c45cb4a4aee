// How a point is lit: not at all; it shows its own colour.
#import "lib/classified.wgsl"

fn light_segment(classified: Classified, position: vec3f, ray: Ray) -> vec3f {
    return classified.color;
}
