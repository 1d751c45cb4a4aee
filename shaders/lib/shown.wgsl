// What a ray shows, for the layers beside the colour.
#import "lib/ray.wgsl"

struct Shown {
    result: RayResult,
    // The part that the ray ended in.
    ray: Ray,
    // Samples of the volume that the walk took; a technique's own (shadows, refinements) do not count.
    samples: u32,
    // Estimated error of the colour; 0 where nobody wants it.
    error: f32,
}

fn shown_nothing() -> Shown {
    var shown: Shown;
    shown.result = ray_nothing();
    return shown;
}

fn shown_is_something(shown: Shown) -> bool {
    return shown.result.depth < RAY_NO_DEPTH;
}

// World distance from the entry of the part that the ray ended in.
fn shown_distance(shown: Shown) -> f32 {
    return shown.result.depth - shown.ray.near;
}
