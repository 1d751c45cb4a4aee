// The material of the parameters: of everything, or of what the transfer function does not speak of.
#import "lib/material.wgsl"

struct Params {
    /// Share of the colour that needs no light. @default 0.3 @range 0 1
    ambient: f32,
    /// Share of the colour that the light gives. @default 0.7 @range 0 1
    diffuse: f32,
    /// Strength of the highlight. @default 0.25 @range 0 1
    specular: f32,
    /// Sharpness of the highlight. @default 32 @range 1 256
    shininess: f32,
}
