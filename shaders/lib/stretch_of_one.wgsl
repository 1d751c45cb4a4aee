// What a stretch of one scalar emits and lets through.
#import "lib/classified.wgsl"
#import "lib/transfer.wgsl"

// Of a world length.
fn stretch_of_one(scalar: f32, length: f32) -> Classified {
    let entry = transfer_at(scalar);
    let transmittance = exp2(-entry.w * (length * transfer.halvings_per_world));
    return Classified(entry.xyz * (1.0 - transmittance), transmittance);
}
