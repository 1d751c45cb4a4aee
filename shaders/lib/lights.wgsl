// Lights: up to four, each directional, at a point or at the eye. No light grows weaker with its distance.
#import "lib/space.wgsl"

struct Params {
    /// How many of the lights shine. @default 1 @range 0 4 @constant
    lights: u32,
    /// The first light: a world direction towards it and 0, or its position and 1 (see `space`); all zeros for a light at
    /// the eye. @default 0 0 0 0
    light_1: vec4f,
    /// Its linear colour, as bright as it is. @default 1 1 1 @range 0 100 @color
    light_1_color: vec3f,
    /// The second light: a world direction towards it and 0, or its position and 1 (see `space`); all zeros for a light at
    /// the eye. @default 0 0 0 0
    light_2: vec4f,
    /// Its linear colour, as bright as it is. @default 1 1 1 @range 0 100 @color
    light_2_color: vec3f,
    /// The third light: a world direction towards it and 0, or its position and 1 (see `space`); all zeros for a light at
    /// the eye. @default 0 0 0 0
    light_3: vec4f,
    /// Its linear colour, as bright as it is. @default 1 1 1 @range 0 100 @color
    light_3_color: vec3f,
    /// The fourth light: a world direction towards it and 0, or its position and 1 (see `space`); all zeros for a light at
    /// the eye. @default 0 0 0 0
    light_4: vec4f,
    /// Its linear colour, as bright as it is. @default 1 1 1 @range 0 100 @color
    light_4_color: vec3f,
}

// A light as a point sees it.
struct Light {
    // Unit world direction towards it, and the world distance to it.
    direction: vec3f,
    distance: f32,
    color: vec3f,
}

// Stands for the distance to a directional light.
const LIGHT_FAR: f32 = 3.0e38;

// A light as the user gave it.
fn lights_given(index: u32) -> vec4f {
    let first = select(params.light_1, params.light_2, index == 1u);
    let second = select(params.light_3, params.light_4, index == 3u);
    return select(first, second, index > 1u);
}

// Whether a light is at the eye.
fn lights_is_at_eye(index: u32) -> bool {
    let given = lights_given(index);
    return given.w == 0.0 && dot(given.xyz, given.xyz) == 0.0;
}

// The linear colour of a light, as bright as it is.
fn lights_color(index: u32) -> vec3f {
    let first = select(params.light_1_color, params.light_2_color, index == 1u);
    let second = select(params.light_3_color, params.light_4_color, index == 3u);
    return select(first, second, index > 1u);
}
