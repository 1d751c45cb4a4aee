// The window of scalars that projections show.
#import "lib/volume.wgsl"

struct Params {
    /// The scalar that shows nothing. @default 0
    window_low: f32,
    /// The scalar that shows most; below `window_low` for the negative. @default 1
    window_high: f32,
    /// The unit of both: `range`, 0 to 1 over the values that the data has; `normalised`, over the range of the stored type
    /// (of floats: of the data); or `data`. @default range @choices range normalised data
    window_unit: u32,
}

fn window_scalar(given: f32) -> f32 {
    return volume_scalar(volume, given, params.window_unit);
}

// Where in the window a scalar is: 0 at its low end, 1 at its high end, less and more beyond.
fn window_share(scalar: f32) -> f32 {
    let low = window_scalar(params.window_low);
    let span = window_scalar(params.window_high) - low;
    let least = 1.0e-7 * volume.value_range;
    return (scalar - low) / select(span, select(-least, least, span >= 0.0), abs(span) < least);
}
