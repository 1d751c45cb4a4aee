// What does a whole step of one scalar emit and let through? It is computed: where walks have several steps, or several
// transfer functions.
#import "lib/stretch_of_one.wgsl"

fn steps_at(scalar: f32, length: f32) -> Classified {
    return stretch_of_one(scalar, length);
}
