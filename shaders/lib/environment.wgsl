// The image of what surfaces mirror, and how much of it.
#import "lib/surface_point.wgsl"

struct Params {
    /// Share of the environment that a surface mirrors where it is seen from straight above. @default 0.3 @range 0 1
    reflectivity: f32,
    /// How much more it mirrors at grazing angles: 1 as Schlick's law has it, up to all of it; 0 no more.
    /// @default 0 @range 0 1
    fresnel: f32,
    /// Brightness of the environment. @default 1 @range 0 100
    environment_intensity: f32,
}

@group(3) @binding(20) var environment_texture: texture_2d<f32>;

// What a surface makes of the environment's colour (Schlick 1994, equation 15, of the share in `fresnel`).
fn environment_share(point: SurfacePoint, ray: Ray) -> f32 {
    let away = 1.0 - clamp(-dot(point.normal, ray.direction), 0.0, 1.0);
    let square = away * away;
    let grazing = (1.0 - params.reflectivity) * params.fresnel * square * square * away;
    return params.environment_intensity * (params.reflectivity + grazing);
}
