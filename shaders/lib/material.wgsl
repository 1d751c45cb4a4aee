// What a point makes of light.
#import "lib/classified.wgsl"

struct Material {
    // Linear premultiplied colour: what it shows without any light, and what it shows of white light from above.
    ambient: vec3f,
    diffuse: vec3f,
    // Strength of its highlight, premultiplied; and the highlight's sharpness.
    specular: f32,
    shininess: f32,
}

// How much of a segment's material is seen in the light at its back end, where the light changes from front to back:
// its `diffuse` and its `specular`. The rest is seen in the light at its front end.
struct MaterialBack {
    diffuse: vec3f,
    specular: f32,
}
