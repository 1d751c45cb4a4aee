// What does a whole step of one scalar emit and let through? What a table says that is made for the walk's step.
#import "lib/classified.wgsl"
#import "lib/nearest_sampler.wgsl"
#import "lib/transfer.wgsl"

@group(2) @binding(8) var step_table: texture_2d<f32>;

fn steps_at(scalar: f32, length: f32) -> Classified {
    let place = vec2f(transfer_coordinate(scalar), 0.5);
    let entry = textureSampleLevel(step_table, nearest_sampler, place, 0.0);
    return Classified(entry.xyz, entry.w);
}
