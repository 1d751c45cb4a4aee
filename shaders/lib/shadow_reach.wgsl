// How far a shadow's ray goes: to the light; one at the eye shines from there, and what is behind the eye casts no shadow.
#import "lib/eye.wgsl"
#import "lib/lights.wgsl"

fn shadow_reach(world: vec3f, light: Light, index: u32) -> f32 {
    return select(light.distance, eye_towards(world).w, lights_is_at_eye(index));
}
