// Positions that users give: of lights, of clip shapes.
#import "lib/volume.wgsl"

struct Params {
    /// Where positions of lights and clip shapes count from: `box` from the middle of the volume's box, in halves of its
    /// smallest side; `world` from the world's origin, in its units. @default box @choices box world
    space: u32,
}

// A world position, as shaders count them, from one that the user gave.
fn space_point(given: vec3f) -> vec3f {
    return select(volume.centre + given * volume.half_side, volume.world_origin + given, params.space == 1u);
}

// A world length from one that the user gave.
fn space_length(given: f32) -> f32 {
    return given * select(volume.half_side, 1.0, params.space == 1u);
}
