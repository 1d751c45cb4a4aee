// What a point makes of light.
#import "lib/classified.wgsl"

struct Material {
    // Linear premultiplied colour: what it shows without any light, and what it shows of white light from above.
    ambient: vec3f,
    diffuse: vec3f,
    // Strength of its highlight, premultiplied.
    specular: f32,
}
